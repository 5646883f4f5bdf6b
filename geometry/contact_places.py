# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact geometry: the places where the segments of a joint touch and slide.

In a flat boom, contact is on the axis of the segments, above and below at the same x. In space, it
is at the corners of the sections, where slide pads usually are since folds are stiff: at both ends
of each face. Pads of a given size are patches beside the corners, or bear on the corners along
their length.
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

# Length of a station's contact along the corners, as a fraction of the least overlap: about 0.1 m
# in the paper's boom, a typical length of slide pads.
_OF_OVERLAP = 0.1

_SIDES: tuple[Side, Side] = (1, -1)
_BOTH: tuple[Side] = (0,)


@dataclass(frozen=True, slots=True)
class Patch:
    """Area of a pad of a given size on a wall of the inner segment.

    It is centred at its station, but shifted into the overlap if necessary. Across the wall, it
    begins at an offset from the corner of the inner box.

    Args:
        start, end: x in m.
        offset: distance of its edge from the edge of the wall in m.
        width: width across the wall in m.
    """

    start: float
    end: float
    offset: float
    width: float

    def across(self, face: Face) -> tuple[float, float]:
        """Return both ends of the patch across an inner segment's wall, in m from the middle."""
        far = 0.5 * face.width - self.offset
        return far - self.width, far


@dataclass(frozen=True, slots=True)
class Stretch:
    """Interval of a segment's corners on which a station's contact force acts.

    Args:
        start, end: x in m.
        station: x in m of the resultant.
    """

    start: float
    end: float
    station: float

    @classmethod
    def on(cls, segment: Segment, station: float, length: float) -> Stretch:
        """Return an interval centred at a station, but shifted into the segment if necessary."""
        start = min(max(station - 0.5 * length, segment.start), segment.end - length)
        return cls(start, start + length, station)

    def moved(self, segment: Segment, by: float) -> Stretch:
        """Return the interval shifted along the segment by ``by`` in m."""
        if by == 0.0:
            return self
        return Stretch.on(segment, self.station + by, self.end - self.start)

    def density(self, x: Array) -> Array:
        """Return the density (num_places,) in 1/m of a unit force.

        It is uniform if the station is in the middle, or else linear with the resultant at the
        station. A deflection weighted by it is the value at the station of the deflection's
        best-fit straight line.
        """
        length, middle = self.end - self.start, 0.5 * (self.start + self.end)
        return 1.0 / length + 12.0 * (self.station - middle) * (x - middle) / length**3


@dataclass(frozen=True, slots=True)
class Pad:
    """Contact pair: a point of each segment of a joint, which touch across the clearance.

    Args:
        station: index in ``Boom.stations``.
        joint: the joint.
        number: index of the joint in ``Boom.joints``.
        x: position in m.
        direction: direction of the contact normal.
        side: 1 for contact if the inner segment presses upwards (along y: towards larger y), −1 if
            it presses downwards, 0 for both.
        inner, outer: (y, z) in m of the points, from the axes of their segments.
        weight: share of the joint's law on this side.
        rubs: direction of sliding.
        normal_force: given normal force of friction in N; None if the contact force is the normal
            force.
        pressed: intervals of the corners of the inner and the outer segment on which the force
            acts.
        patch: area on the wall; None for a point, or a pad that bears on a corner.
        raised: protrusion into the joint's clearance in m.
        face: face of the inner segment in space, which touches at a corner; None in a flat boom.
        carrier: segment to which the pad is fixed while the joint telescopes; None without a drive.
        moved: travel in m along the inner and the outer segment.
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
        """The half of the wall in space: 1 at positive coordinates across the wall, else −1."""
        return int(np.sign(self._corner))

    @property
    def _corner(self) -> float:
        """The position of the point across the wall in m."""
        return self.inner[0] if self.direction == "z" else self.inner[1]

    @property
    def across(self) -> float:
        """The distance in m, across the wall, of the area's middle from the point."""
        if self.patch is None or self.face is None:
            return 0.0
        return self.half * 0.5 * sum(self.patch.across(self.face)) - self._corner

    @property
    def reach(self) -> tuple[float, float]:
        """The range of the joint's extension in m."""
        return (0.0, 0.0) if self.joint.drive is None else self.joint.drive.reach

    @property
    def middle(self) -> float:
        """The x in m of the area's middle, where the resultant acts."""
        if self.patch is None:
            return self.pressed[0].station
        return 0.5 * (self.patch.start + self.patch.end)

    def travels(self, extension: float) -> tuple[float, float]:
        """Return the travel in m along the outer and the inner segment at an extension in m."""
        on_outer = extension if self.carrier == "inner" else 0.0
        return on_outer, -extension if self.carrier == "outer" else 0.0

    def extended(self, boom: Boom, extension: float) -> Pad:
        """Return the pad at an ``extension`` of the joint in m."""
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
        """The x in m at which sliding is read: in a flat boom the middle, in space the corner."""
        return self.middle if self.joint.lateral_play is None else self.x

    @property
    def covered(self) -> tuple[Offset, Offset]:
        """The middles (y, z) in m of the areas on both segments, from their axes."""
        step = (self.across, 0.0) if self.direction == "z" else (0.0, self.across)
        (a, b), (c, d) = self.inner, self.outer
        return (a + step[0], b + step[1]), (c + step[0], d + step[1])


def pads(boom: Boom) -> list[Pad]:
    """Return the pads of all joints that are not bonded, in the order of stations.

    The weights of one side of a station sum to one, so that without roll the pads together have the
    force of one contact on the axis.
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
                            # Both sides together have the friction of one pad on the axis.
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
    """Return the x in m of the pads' middles along z, by station; without pads that of the station.

    The keys are the x of the stations in m.
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


def load_places(boom: Boom, number: int) -> tuple[float, ...]:
    """Return the x in m of all forces and masses on a segment, including middles of pads."""
    joints = (joint for joint in boom.joints if number in (joint.outer, joint.inner))
    middles = (x for joint in joints for at in contact_centres(boom, joint).values() for x in at)
    return tuple(sorted({*boom.stations_of(number), *middles}))


def _points(
    boom: Boom, joint: Joint, direction: Direction, x: float
) -> Iterator[tuple[Side, Offset, Offset, float, Face | None]]:
    """Yield a station's pads: side, inner and outer point, weight, and in space the inner face."""
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


# Length of a stop's contact along the corners, as a fraction of the box's height: about 0.1 m in
# the paper's boom.
_OF_HEIGHT = 0.2


@dataclass(frozen=True, slots=True)
class StopPatch:
    """Place at which a stop acts on a segment's corners.

    Args:
        station: index in ``Boom.stations``.
        stop: the stop.
        pressed: interval of the corners.
        reach: range of the segment's extension in m.
    """

    station: int
    stop: Stop
    pressed: Stretch
    reach: tuple[float, float]

    def extended(self, boom: Boom, extension: float) -> StopPatch:
        """Return the place at an ``extension`` of the segment in m."""
        pressed = self.pressed.moved(boom.segments[self.stop.segment], -extension)
        return replace(self, pressed=pressed)


def stop_patches(boom: Boom) -> list[StopPatch]:
    """Return the places of all stops of a boom with sections."""
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
