# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments as beams, and their way to a gap system.

Kantorovich series and beam finite elements both end here; from here on they are the same. So
are the flat boom and the one in space, which has more components and more pads.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

from beam_model.boom_modes import BoomModes
from beam_model.component import SegmentModel
from beam_model.drawn_rows import travels
from dynamics.gap_builder import GapBuilder, Observed
from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from geometry.axial import pin_moments
from geometry.boom import Boom, Direction
from geometry.contact_places import Pad, pads
from geometry.cylinder import ground_lines
from geometry.drawing import drives_below
from geometry.observation import Observation, Quantity
from geometry.section import Offset


class Touch(NamedTuple):
    """Where beams touch.

    Args:
        sides: of a pad or stop that presses both ways, see ``GapBuilder.press``.
        x: m of a pad's approach, and of its slide.
        offsets: (y, z) in m of a pad's inner and outer point.
    """

    sides: Sequence[int]
    x: Callable[[Pad], tuple[float, float]]
    offsets: Callable[[Pad], tuple[Offset, Offset]]


# At the stations, by the whole law on the axis.
AT_STATIONS = Touch((0,), lambda pad: (pad.x, pad.x), lambda pad: (pad.inner, pad.outer))
# Where a shell's pads are, each side by itself, as a shell's walls do.
AT_PADS = Touch((1, -1), lambda pad: (pad.middle, pad.slid), lambda pad: pad.covered)


def gap_system(
    boom: Boom,
    models: Sequence[SegmentModel],
    touch: Touch = AT_STATIONS,
) -> GapSystem:
    """Segments side by side in modal coordinates, coupled by contact, friction and ties alone.

    ``touch`` tells where pads are read.
    """
    modes = BoomModes(boom, models)
    rows_at = partial(_rows, boom, modes, touch)
    system = _standing(boom, modes, rows_at({}))
    return replace(system, travels=travels(boom, models, rows_at, modes.displacement))


def standing_system(boom: Boom, modes: BoomModes) -> GapSystem:
    """The same where drives have not drawn anything yet, and do not.

    Args:
        boom: as of :func:`gap_system`.
        modes: of the boom's segments.
    """
    return _standing(boom, modes, _rows(boom, modes, AT_STATIONS, {}))


def _standing(boom: Boom, modes: BoomModes, rows: GapBuilder[Array]) -> GapSystem:
    members = [_Member(modes, number) for number in range(len(boom.segments))]
    return rows.system(
        lambda row: row,
        modes.omega2,
        sum((push for _, push in pin_moments(boom.segments, boom.joints, members)), modes.load),
        boom.stations,
        _observed(boom, modes),
        [(load.push(members[load.segment]), load.history) for load in boom.loads],
        [
            (line.force, line.push, line.stiffness, line.dashpot)
            for line in ground_lines(boom, members)
        ],
        modes.damping,
    )


def tied_system(boom: Boom, models: Sequence[SegmentModel]) -> GapSystem:
    """The play-free boom: every joint's segments move alike at its stations."""
    return gap_system(boom.play_free, models)


def _rows(
    boom: Boom,
    modes: BoomModes,
    touch: Touch,
    ways: Mapping[int, float],
) -> GapBuilder[Array]:
    """What touches, rubs and drags where joints are drawn out by their ways in m."""
    rows: GapBuilder[Array] = GapBuilder()
    for pad in pads(boom):
        on_outer, on_inner = pad.ways(ways.get(pad.number, 0.0))
        pressed, slid = touch.x(pad)
        read = partial(_relative, modes, pad)
        points_of = touch.offsets(pad), (pad.inner, pad.outer)
        approach = read(pad.direction, (pressed + on_inner, pressed + on_outer), points_of[0])
        slide = read(pad.rubs, (slid + on_inner, slid + on_outer), points_of[1])
        sides = (pad.side,) if pad.side else touch.sides
        points = [(side, pad.weight, approach) for side in sides]
        law = pad.joint.law(pad.direction)
        pressing = rows.press(pad.station, law, points, pad.raised)
        rows.drag(pad.station, pad.joint.dashpot, points)
        rows.rub(pad.station, pad.joint.friction, slide, pad.normal_force, pressing)
    for station, stop in boom.numbered_stops:
        way = sum(ways.get(number, 0.0) for number in drives_below(boom.joints, stop.segment))
        row = modes.displacement(stop.segment, stop.x - way, "z")
        rows.stop(station, stop.law, [(side, 1.0, row) for side in touch.sides])
    return rows


def _relative(
    modes: BoomModes,
    pad: Pad,
    direction: Direction,
    places: tuple[float, float],
    offsets: tuple[Offset, Offset],
) -> Array:
    """(num_modes,) row that reads u − w of a pad's two points at x in m of inner and outer."""
    inner = modes.displacement(pad.joint.inner, places[0], direction, offsets[0])
    return inner - modes.displacement(pad.joint.outer, places[1], direction, offsets[1])


def _observed(boom: Boom, modes: BoomModes) -> dict[str, Observed[Array]]:
    """Deflections of the boom's ends, and what is observed besides."""
    ends: tuple[Quantity, ...] = ("deflection", "lateral") if boom.spatial else ("deflection",)
    return {
        place.name: Observed(_row(place, modes), place.kind.unit, place.kind.derivative)
        for place in boom.recorded(ends)
    }


def _row(place: Observation, modes: BoomModes) -> Array:
    """(num_modes,) that reads a quantity, or what it is the derivative of."""
    match place.kind.read:
        case "rotation":
            return modes.rotation(place.segment, place.x, "z")
        case "twist":
            return modes.twist(place.segment, place.x)
        case "lateral":
            return modes.displacement(place.segment, place.x, "y")
        case "distortion":
            raise ValueError("the cross-section of a beam keeps its shape")
        case "deflection":
            return modes.displacement(place.segment, place.x, "z")


@dataclass(frozen=True, slots=True)
class _Member:
    """A segment as loads push it, see :class:`geometry.load.Member`."""

    modes: BoomModes
    segment: int

    def force(self, x: float, direction: Direction) -> Array:
        return self.modes.displacement(self.segment, x, direction)

    def moment(self, x: float, direction: Direction) -> Array:
        return self.modes.rotation(self.segment, x, direction)

    def torque(self, x: float) -> Array:
        return self.modes.twist(self.segment, x)

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        if span is None:
            return self.modes.unit_load(self.segment, direction)
        return self.modes.load_between(self.segment, direction, *span)

    def inertia(self, direction: Direction, force: float) -> Array:
        return force * self.modes.inertia(self.segment, direction)

    def turning(self, direction: Direction) -> Array:
        return self.modes.turning(self.segment, direction)
