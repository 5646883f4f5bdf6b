# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact geometry: positions and areas of contact between the segments of a joint.

In a flat boom, contact is on the axes of the segments, on both sides at the same x. In space, it is
at the corners of the sections, where slide pads usually are. Pads of a given size are patches
beside the corners, or bear on the corners along their length.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Direction, Joint, Stop
from protractile.geometry.section import EACH_SIDE, Face, Offset, Side
from protractile.geometry.segment import Segment
from protractile.geometry.station import Station
from protractile.geometry.telescoping import drives_of, reach

ContactLine = Literal["near webs", "across", "surface"]

# Default length of contact along the corners, as a fraction of the smallest overlap. It is about
# 0.1 m in the paper's boom, a typical length of slide pads.
_OF_OVERLAP = 0.1

_BOTH: tuple[Side] = (0,)


@dataclass(frozen=True, slots=True)
class Patch:
    """Area of a pad of a given size on a wall of the inner segment.

    Args:
        start, end: x of its ends in m.
        offset: distance across the wall from the corner of the inner section to the pad in m.
        width: width across the wall in m.
    """

    start: float
    end: float
    offset: float
    width: float

    def across(self, face: Face) -> tuple[float, float]:
        """Return both edges of the patch across a wall, in m from the middle of the wall."""
        far = 0.5 * face.width - self.offset
        return far - self.width, far


@dataclass(frozen=True, slots=True)
class ContactInterval:
    """Interval along x on which a contact force acts at the corners of a segment.

    Args:
        start, end: x of its ends in m.
        station: x of the resultant in m.
    """

    start: float
    end: float
    station: float

    @classmethod
    def from_station(cls, segment: Segment, station: float, length: float) -> ContactInterval:
        """Return an interval around a station, shifted to fit the segment; ``length`` is in m."""
        start = min(max(station - 0.5 * length, segment.start), segment.end - length)
        return cls(start, start + length, station)

    def shift(self, segment: Segment, by: float) -> ContactInterval:
        """Return the interval shifted along the segment by ``by`` in m."""
        if by == 0.0:
            return self
        return ContactInterval.from_station(segment, self.station + by, self.end - self.start)

    def line_load(self, x: Array) -> Array:
        """Return the line load (num_places,) in 1/m that has a unit resultant at the station.

        It is linear in x. The integral of load times deflection is the value at the station of the
        straight line that fits the deflection best.
        """
        length, middle = self.end - self.start, 0.5 * (self.start + self.end)
        return 1.0 / length + 12.0 * (self.station - middle) * (x - middle) / length**3


@dataclass(frozen=True, slots=True)
class ContactPair:
    """Contact pair: a point of the inner segment and a point of the outer segment of a joint.

    Args:
        station: its station.
        joint: joint of the station.
        side: 1 if contact is at positive displacement of the inner segment, −1 if it is at
            negative displacement, 0 if it is at both.
        inner, outer: (y, z) in m of the points from the axes of their segments.
        weight: fraction of the side's contact law that this pad has.
        sliding_direction: direction of friction.
        normal_force: prescribed normal force of friction in N; None for the contact force.
        intervals: intervals along x on which the force acts on inner and outer segment.
        patch: area on the wall; None for a point, or a pad that bears on a corner.
        shim: reduction of the clearance by a shim in m.
        face: face of the inner segment at whose corner the pad is; None in a flat boom.
        travel: displacement in m of the contact along the inner and the outer segment.
    """

    station: Station
    joint: Joint
    side: Side
    inner: Offset
    outer: Offset
    weight: float
    sliding_direction: Direction
    normal_force: float | None
    intervals: tuple[ContactInterval, ContactInterval]
    patch: Patch | None
    shim: float = 0.0
    face: Face | None = None
    travel: tuple[float, float] = (0.0, 0.0)

    @property
    def half(self) -> int:
        """The half of the wall with the point: the sign of its coordinate across the wall."""
        return int(np.sign(self._corner))

    @property
    def _corner(self) -> float:
        """The coordinate of the point across the wall in m."""
        return self.inner[0] if self.station.direction == "z" else self.inner[1]

    @property
    def across(self) -> float:
        """The offset in m across the wall from the point to the centre of the patch."""
        if self.patch is None or self.face is None:
            return 0.0
        return self.half * 0.5 * sum(self.patch.across(self.face)) - self._corner

    @property
    def reach(self) -> tuple[float, float]:
        """The range of the joint's extension in m."""
        return (0.0, 0.0) if self.joint.drive is None else self.joint.drive.reach

    @property
    def midpoint(self) -> float:
        """The x in m of the resultant contact force, at the centre of the patch."""
        if self.patch is None:
            return self.intervals[0].station
        return 0.5 * (self.patch.start + self.patch.end)

    def travels(self, extension: float) -> tuple[float, float]:
        """Return the travel in m of the contact on outer and inner segment at an extension in m."""
        drive = self.joint.drive
        carrier = None if drive is None else drive.carriers[self.station.place]
        on_outer = extension if carrier == "inner" else 0.0
        return on_outer, -extension if carrier == "outer" else 0.0

    def at_extension(self, boom: Boom, extension: float) -> ContactPair:
        """Return the pad at an ``extension`` of the joint in m."""
        on_outer, on_inner = self.travels(extension)
        inner, outer = (
            interval.shift(boom.segments[number], by)
            for interval, number, by in zip(
                self.intervals,
                (self.joint.inner, self.joint.outer),
                (on_inner, on_outer),
                strict=True,
            )
        )
        return replace(self, intervals=(inner, outer), travel=(on_inner, on_outer))

    @property
    def area_centres(self) -> tuple[Offset, Offset]:
        """The patch centres (y, z) in m on inner and outer segment, from the segment's axis."""
        step = (self.across, 0.0) if self.station.direction == "z" else (0.0, self.across)
        (a, b), (c, d) = self.inner, self.outer
        return (a + step[0], b + step[1]), (c + step[0], d + step[1])


def pads(boom: Boom) -> list[ContactPair]:
    """Return the pads of all joints that are not bonded, in the order of stations.

    The weights of each side of a station sum to one.
    """
    pairs: list[ContactPair] = []
    for station in boom.stations:
        joint, x, direction = station.joint, station.x, station.direction
        if joint is None:
            continue
        overlap = boom.overlap(joint)
        length = joint.contact_length or _OF_OVERLAP * boom.smallest_overlap(joint)
        inner_segment, outer_segment = boom.segments[joint.inner], boom.segments[joint.outer]
        normal_force = joint.normal_forces[station.place] if joint.normal_forces else None
        at_corners = (
            ContactInterval.from_station(inner_segment, x, length),
            ContactInterval.from_station(outer_segment, x, length),
        )
        for side, inner, outer, whole, face in _points(boom, joint, direction, x):
            for size, share, shim in joint.pads_of(direction, side):
                weight = whole * share
                patch, intervals = None, at_corners
                # Without a section, pads are points.
                if size is not None and inner_segment.section is not None:
                    span = size.span(x, overlap)
                    if size.bears == "wall":
                        patch = Patch(*span, size.offset, size.width)
                    else:
                        intervals = (ContactInterval(*span, 0.5 * sum(span)),) * 2
                pad = ContactPair(
                    station=station,
                    joint=joint,
                    side=side,
                    inner=inner,
                    outer=outer,
                    weight=weight,
                    sliding_direction="y" if boom.spatial and direction == "z" else "z",
                    # Both sides share the normal force of the station.
                    normal_force=None
                    if normal_force is None
                    else normal_force * weight * (0.5 if side else 1.0),
                    intervals=intervals,
                    patch=patch,
                    shim=shim,
                    face=face,
                )
                pairs.append(pad)
    return pairs


def contact_centres(boom: Boom, joint: Joint) -> list[list[float]]:
    """Return the ascending x in m of the centres of top and bottom pads at each station."""
    overlap = boom.overlap(joint)
    sizes = [size for side in EACH_SIDE for size, _, _ in joint.pads_of("z", side)]
    has_section = boom.segments[joint.inner].section is not None
    return [
        sorted({0.5 * sum(size.span(x, overlap)) if size and has_section else x for size in sizes})
        for x in joint.stations
    ]


def pad_places(boom: Boom, number: int) -> set[float]:
    """Return the x in m of the centres of top and bottom pads on a segment."""
    joints = (joint for joint in boom.joints if number in (joint.outer, joint.inner))
    return {x for joint in joints for centres in contact_centres(boom, joint) for x in centres}


def load_places(boom: Boom, number: int) -> tuple[float, ...]:
    """Return the x in m of all forces and masses on a segment, including centres of pads."""
    return tuple(sorted({*boom.stations_of(number), *pad_places(boom, number)}))


def _points(
    boom: Boom, joint: Joint, direction: Direction, x: float
) -> Iterator[tuple[Side, Offset, Offset, float, Face | None]]:
    """Yield (side, inner point, outer point, weight, inner face) of each contact of a station.

    Points are (y, z) in m from the axis of their segment.
    """
    if joint.lateral_play is None:
        for side in EACH_SIDE if joint.pads else _BOTH:
            yield side, (0.0, 0.0), (0.0, 0.0), 1.0, None
        return
    inner, outer = (boom.segments[number].section_at(x) for number in (joint.inner, joint.outer))
    clearance = 0.5 * (joint.play if direction == "z" else joint.lateral_play)
    for side in EACH_SIDE:
        touching, surface = inner.face(direction, side), outer.face(direction, side).inside
        for corner in (touching.low, touching.high):
            within, around = (corner, surface - side * clearance), (corner, surface)
            if direction == "y":
                within, around = within[::-1], around[::-1]
            yield side, within, around, 0.5, touching


# Default length of contact of a stop, as a fraction of the height of the section. It is about
# 0.1 m in the paper's boom.
_OF_HEIGHT = 0.2


@dataclass(frozen=True, slots=True)
class StopPatch:
    """Contact of a stop with the corners of a segment."""

    station: Station  #: its station
    stop: Stop  #: stop of the station
    interval: ContactInterval  #: interval of the corners on which the force acts
    reach: tuple[float, float]  #: range of the travel of the segment in m

    def at_extension(self, boom: Boom, extension: float) -> StopPatch:
        """Return the contact after the segment has moved by ``extension`` in m."""
        interval = self.interval.shift(boom.segments[self.stop.segment], -extension)
        return replace(self, interval=interval)


def stop_patches(boom: Boom) -> list[StopPatch]:
    """Return the contacts of all stops of a boom with sections."""
    patches = []
    for station in boom.stations:
        stop = station.stop
        if stop is None:
            continue
        segment = boom.segments[stop.segment]
        extended = reach(drives_of(boom.joints, stop.segment))
        length = stop.contact_length or min(
            _OF_HEIGHT * segment.section_at(stop.x).size("z"), segment.length
        )
        patches.append(
            StopPatch(
                station, stop, ContactInterval.from_station(segment, stop.x, length), extended
            )
        )
    return patches
