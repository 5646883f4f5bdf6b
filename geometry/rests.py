# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where stops press a segment."""

from __future__ import annotations

from dataclasses import dataclass, replace

from geometry.boom import Boom, Stop
from geometry.contact_places import Stretch
from geometry.drawing import drives_of, reach

# What stops press of a segment's corners, over the height of the box: about 0.1 m in the paper's
# boom.
_OF_HEIGHT = 0.2


@dataclass(frozen=True, slots=True)
class Rest:
    """Where a stop presses a segment's corners.

    Args:
        station: position in ``Boom.stations``.
        stop: the stop.
        pressed: of the corners.
        reach: how far in and out its segment is drawn, in m.
    """

    station: int
    stop: Stop
    pressed: Stretch
    reach: tuple[float, float]

    def drawn(self, boom: Boom, way: float) -> Rest:
        """Where its segment is drawn out by ``way`` in m."""
        pressed = self.pressed.moved(boom.segments[self.stop.segment], -way)
        return replace(self, pressed=pressed)


def rests(boom: Boom) -> list[Rest]:
    """Every stop of a boom whose sections are known."""
    found = []
    for station, stop in boom.numbered_stops:
        segment = boom.segments[stop.segment]
        assert segment.section is not None
        drawn = reach(drives_of(boom.joints, stop.segment))
        length = stop.contact_length or min(
            _OF_HEIGHT * segment.section_at(stop.x).size("z"), segment.length
        )
        found.append(Rest(station, stop, Stretch.on(segment, stop.x, length), drawn))
    return found
