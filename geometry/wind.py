# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wind on the segments of a boom and on the load at its tip."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.fields import BoomError, HistoryRef
from protractile.geometry.joint import Joint
from protractile.geometry.load import Load, PartialLoad
from protractile.geometry.section import Direction
from protractile.geometry.segment import SAME_PLACE, Segment
from protractile.geometry.walls import outer_surfaces

# Density of air in kg/m³ for the pressure of a wind speed (EN 13001-2, ISO 4302).
AIR_DENSITY = 1.25
# Number of uniform loads on a tapered segment, each of its mean breadth.
_STEPS = 8


def wind_direction(angle: float, luffing: float) -> Array:
    """Return the horizontal direction (3,) of a wind in the axes x, y and z of the boom.

    Args:
        angle: angle in rad of the wind from the vertical plane of the boom: 0 from behind, π/2
            towards +y.
        luffing: luffing angle in rad.
    """
    forwards = np.cos(angle)
    return np.array([forwards * np.cos(luffing), np.sin(angle), -forwards * np.sin(luffing)])


def wind_loads(
    segments: Sequence[Segment],
    joints: Sequence[Joint],
    pressure: float,
    direction: Array,
    shape_factors: Sequence[float],
    history: HistoryRef,
) -> Iterator[Load]:
    """Yield the wind loads across the exposed parts of the segments.

    The flow across the axis alone acts, as on an inclined cylinder (Hoerner 1965, independence
    principle): with the components n_y, n_z of the direction across the axis and |n|² = sin² of the
    angle between wind and axis, f_y = q c h |n| n_y and f_z = q c b |n| n_z. Here h and b are the
    outer height and width of the section.

    >>> side = wind_direction(0.5 * np.pi, luffing=0.0)
    >>> loads = [*wind_loads(boom.segments, boom.joints, 250.0, side, [1.5, 1.5], pt.Step())]
    >>> [(load.direction, round(load.magnitude, 1), load.span) for load in loads]
    [('y', 153.0, (0.0, 8.0)), ('y', 137.2, (8.0, 14.0))]

    Args:
        segments, joints: segments and joints of the boom, with indices of segments.
        pressure: dynamic pressure q in Pa at the value 1 of the history.
        direction: unit vector (3,) from :func:`wind_direction`.
        shape_factors: force coefficient c of each segment.
        history: factor of the pressure over time.

    Raises:
        BoomError: an exposed segment has no section, whose size the wind meets.
    """
    _, lateral, up = direction.tolist()
    across = float(np.hypot(lateral, up))
    for number, segment in enumerate(segments):
        heads = [segments[joint.outer].end for joint in joints if joint.inner == number]
        start, end = max([segment.start, *heads]), segment.end
        if end - start <= SAME_PLACE * segment.length or not pressure:
            continue
        if segment.section is None:
            what = f"missing; the wind meets the height and width of {segment.name!r}"
            raise BoomError(f"segments[{number}].section", what)
        steps = 1 if segment.head_section is None else _STEPS
        for a, b in pairwise(np.linspace(start, end, steps + 1).tolist()):
            section = segment.section_at(0.5 * (a + b))
            # A force along y meets the height, one along z the width.
            facing: tuple[tuple[Direction, Direction, float], ...] = (
                ("y", "z", lateral), ("z", "y", up),
            )  # fmt: skip
            for along, met, part in facing:
                if abs(part) > SAME_PLACE:
                    low, high = outer_surfaces(section, met)
                    size = high - low
                    force = pressure * shape_factors[number] * size * across * part
                    yield PartialLoad(number, along, force, None, history, span=(a, b))
