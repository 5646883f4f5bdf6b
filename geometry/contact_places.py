# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact geometry: where the segments of a joint touch and slide.

In a flat boom a joint touches on the axis of its segments, above and below in one place. In
space it touches in the corners of its sections, where slide pads sit because plates that meet are
stiff there: at both ends of each face. Pads of a given size are
patches beside the corners, or press these along their length.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from geometry.arrays import Array
from geometry.boom import Boom, Direction, Joint, Stop
from geometry.joint import Carrier
from geometry.section import Face, Offset, Side
from geometry.segment import Segment
from geometry.telescoping import drives_of, reach

ContactLine = Literal["near webs", "across", "surface"]

# Length over which a station presses a segment's corners, as a part of the least overlap: about
# 0.1 m in the paper's boom, as slide pads are long.
_OF_OVERLAP = 0.1

_SIDES: tuple[Side, Side] = (1, -1)
_BOTH: tuple[Side] = (0,)


@dataclass(frozen=True, slots=True)
class Patch:
    """Area of a pad of a given size on a wall of the inner segment.

    It is centred at its station, but moved inwards where the overlap ends, and reaches inwards from
    its offset from the corner of the inner box.

    Args:
        start, end: x in m.
        offset: offset of its edge from that of the wall in m.
        width: across the wall in m.
    """

    start: float
    end: float
    offset: float
    width: float

    def across(self, face: Face) -> tuple[float, float]:
        """Return where it begins and ends on a wall of the inner segment, in m from its middle."""
        far = 0.5 * face.width - self.offset
        return far - self.width, far


@dataclass(frozen=True, slots=True)
class Stretch:
    """Length of a segment's corners that a station presses.

    Args:
        start, end: x in m.
        station: x in m through which the resultant goes.
    """

    start: float
    end: float
    station: float

    @classmethod
    def on(cls, segment: Segment, station: float, length: float) -> Stretch:
        """Return a stretch centred at a station, but moved inwards where the segment ends."""
        start = min(max(station - 0.5 * length, segment.start), segment.end - length)
        return cls(start, start + length, station)

    def moved(self, segment: Segment, by: float) -> Stretch:
        """Return the same stretch moved along the segment by ``by`` in m."""
        if by == 0.0:
            return self
        return Stretch.on(segment, self.station + by, self.end - self.start)

    def density(self, x: Array) -> Array:
        """Return (num_places,) a unit force per length in 1/m.

        Uniform where the station is in the middle, else linear with the resultant at the station.
        As a weight of the deflection, it gives the value at the station of the straight line that
        fits the deflection of the stretch best.
        """
        length, middle = self.end - self.start, 0.5 * (self.start + self.end)
        return 1.0 / length + 12.0 * (self.station - middle) * (x - middle) / length**3


@dataclass(frozen=True, slots=True)
class Pad:
    """A pair of points, one of each segment of a joint, that touch across its clearance.

    Args:
        station: position in ``Boom.stations``.
        joint: the joint.
        number: position of the joint in ``Boom.joints``.
        x: m.
        direction: direction of its normal.
        side: 1 touches where the inner segment presses up (along y: towards larger y), −1 where
            it presses down, 0 both ways.
        inner, outer: (y, z) in m of the points from the axes of their segments.
        weight: the part of the joint's law on this side that the pad carries.
        rubs: direction of sliding.
        normal_force: normal force of its friction in N; None where its own contact presses.
        pressed: its stretches of the corners of the inner and of the outer segment.
        patch: the wall that it covers; None where it is a point or bears on a corner.
        raised: its protrusion into the joint's clearance in m.
        face: face of the inner segment in space, which touches in a corner of it; None in a flat
            boom.
        carrier: the segment to which it is fixed as the joint telescopes; None without a drive.
        moved: m by which it has moved along the inner and the outer segment.
    """

    station: int
    joint: Joint
    number: int
    x: float
    direction: Direction
    side: Side
    inner: Offset
    outer: Offset
    weight: float
    rubs: Direction
    normal_force: float | None
    pressed: tuple[Stretch, Stretch]
    patch: Patch | None
    raised: float = 0.0
    face: Face | None = None
    carrier: Carrier | None = None
    moved: tuple[float, float] = (0.0, 0.0)

    @property
    def half(self) -> int:
        """Half of its wall in space: 1 where the coordinate across the wall is positive."""
        return int(np.sign(self._corner))

    @property
    def _corner(self) -> float:
        """Position of its point across its wall in m."""
        return self.inner[0] if self.direction == "z" else self.inner[1]

    @property
    def across(self) -> float:
        """Distance of the middle of its area from its points, across its wall, in m."""
        if self.patch is None or self.face is None:
            return 0.0
        return self.half * 0.5 * sum(self.patch.across(self.face)) - self._corner

    @property
    def reach(self) -> tuple[float, float]:
        """Range of its joint's extension in m."""
        return (0.0, 0.0) if self.joint.drive is None else self.joint.drive.reach

    @property
    def middle(self) -> float:
        """x in m through which its resultant goes: the middle of its area."""
        if self.patch is None:
            return self.pressed[0].station
        return 0.5 * (self.patch.start + self.patch.end)

    def travels(self, extension: float) -> tuple[float, float]:
        """Return its travel in m along the outer and the inner segment at an extension in m."""
        on_outer = extension if self.carrier == "inner" else 0.0
        return on_outer, -extension if self.carrier == "outer" else 0.0

    def extended(self, boom: Boom, extension: float) -> Pad:
        """Return the pad where its joint is extended by ``extension`` in m."""
        on_outer, on_inner = self.travels(extension)
        inner, outer = (
            stretch.moved(boom.segments[number], by)
            for stretch, number, by in zip(
                self.pressed,
                (self.joint.inner, self.joint.outer),
                (on_inner, on_outer),
                strict=True,
            )
        )
        return replace(self, pressed=(inner, outer), moved=(on_inner, on_outer))

    @property
    def slide_x(self) -> float:
        """x in m where its slide is read: of a flat boom in its middle, in space at its corner."""
        return self.middle if self.joint.lateral_play is None else self.x

    @property
    def covered(self) -> tuple[Offset, Offset]:
        """Middles (y, z) in m of its areas on both segments, from their axes."""
        step = (self.across, 0.0) if self.direction == "z" else (0.0, self.across)
        (a, b), (c, d) = self.inner, self.outer
        return (a + step[0], b + step[1]), (c + step[0], d + step[1])


def pads(boom: Boom) -> list[Pad]:
    """Return every pad of every joint that is not bonded, by rising station.

    The weights of one side of a station sum to one. When the segments approach each other
    without roll, the pads together have the force of one contact on the axis.
    """
    found: list[Pad] = []
    station = 0
    for direction in boom.directions:
        for number, joint in enumerate(boom.joints):
            if joint.tied:
                continue
            overlap = boom.overlap(joint)
            extended = 0.0 if joint.drive is None else joint.drive.reach[1]
            length = joint.contact_length or _OF_OVERLAP * (overlap[1] - overlap[0] - extended)
            inner_segment, outer_segment = boom.segments[joint.inner], boom.segments[joint.outer]
            for k, x in enumerate(joint.stations):
                normal_force = joint.normal_forces[k] if joint.normal_forces else None
                pressed = Stretch.on(inner_segment, x, length), Stretch.on(outer_segment, x, length)
                for side, inner, outer, whole, face in _points(boom, joint, direction, x):
                    for size, share, shim in joint.pads_of(direction, side):
                        weight = whole * share
                        patch, stretches = None, pressed
                        # Where plates are not known, pads are points.
                        if size is not None and inner_segment.section is not None:
                            span = size.span(x, overlap)
                            if size.bears == "wall":
                                patch = Patch(*span, size.offset, size.width)
                            else:
                                stretches = (Stretch(*span, 0.5 * sum(span)),) * 2
                        pad = Pad(
                            station=station,
                            joint=joint,
                            number=number,
                            x=x,
                            direction=direction,
                            side=side,
                            inner=inner,
                            outer=outer,
                            weight=weight,
                            rubs="y" if boom.spatial and direction == "z" else "z",
                            # Both sides together have the friction of the one on the axis.
                            normal_force=None
                            if normal_force is None
                            else normal_force * weight * (0.5 if side else 1.0),
                            pressed=stretches,
                            patch=patch,
                            raised=shim,
                            face=face,
                            carrier=None if joint.drive is None else joint.drive.carriers[k],
                        )
                        found.append(pad)
                station += 1
    return found


def contact_centres(boom: Boom, joint: Joint) -> dict[float, tuple[float, ...]]:
    """Return the x in m of the middles of the pads along z at each station; without, the station.

    The keys are the stations' x in m.
    """
    overlap = boom.overlap(joint)
    sizes = [size for side in _SIDES for size, _, _ in joint.pads_of("z", side)]
    known = boom.segments[joint.inner].section is not None
    return {
        x: tuple(
            sorted({0.5 * sum(size.span(x, overlap)) if size and known else x for size in sizes})
        )
        for x in joint.stations
    }


def pressed_places(boom: Boom, number: int) -> tuple[float, ...]:
    """Return the x in m at which something acts on a segment, middles of pads among them."""
    joints = (joint for joint in boom.joints if number in (joint.outer, joint.inner))
    middles = (x for joint in joints for at in contact_centres(boom, joint).values() for x in at)
    return tuple(sorted({*boom.stations_of(number), *middles}))


def _points(
    boom: Boom, joint: Joint, direction: Direction, x: float
) -> Iterator[tuple[Side, Offset, Offset, float, Face | None]]:
    """Yield side, inner and outer point, weight, and inner face in space, of a station's pads."""
    if joint.lateral_play is None:
        for side in _SIDES if joint.pads else _BOTH:
            yield side, (0.0, 0.0), (0.0, 0.0), 1.0, None
        return
    inner, outer = (boom.segments[number].section_at(x) for number in (joint.inner, joint.outer))
    clearance = 0.5 * (joint.play if direction == "z" else joint.lateral_play)
    for side in _SIDES:
        touching, surface = inner.face(direction, side), outer.face(direction, side).inside
        for corner in (touching.low, touching.high):
            within, around = (corner, surface - side * clearance), (corner, surface)
            if direction == "y":
                within, around = within[::-1], around[::-1]
            yield side, within, around, 0.5, touching


# Length of a segment's corners that stops press, over the height of the box: about 0.1 m in the
# paper's boom.
_OF_HEIGHT = 0.2


@dataclass(frozen=True, slots=True)
class StopPatch:
    """Place where a stop presses a segment's corners.

    Args:
        station: position in ``Boom.stations``.
        stop: the stop.
        pressed: pressed of the corners.
        reach: range of its segment's extension in m.
    """

    station: int
    stop: Stop
    pressed: Stretch
    reach: tuple[float, float]

    def extended(self, boom: Boom, extension: float) -> StopPatch:
        """Return the rest where its segment is extended by ``extension`` in m."""
        pressed = self.pressed.moved(boom.segments[self.stop.segment], -extension)
        return replace(self, pressed=pressed)


def stop_patches(boom: Boom) -> list[StopPatch]:
    """Return every stop of a boom whose sections are known."""
    found = []
    for station, stop in boom.numbered_stops:
        segment = boom.segments[stop.segment]
        assert segment.section is not None
        extended = reach(drives_of(boom.joints, stop.segment))
        length = stop.contact_length or min(
            _OF_HEIGHT * segment.section_at(stop.x).size("z"), segment.length
        )
        found.append(StopPatch(station, stop, Stretch.on(segment, stop.x, length), extended))
    return found
