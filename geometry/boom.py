# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom: telescoping segments with their joints, loads and stops.

x runs along the boom, z is the plane of bending, y is lateral. Everything is in SI units.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import pairwise

from geometry.axial import passed_over
from geometry.cylinder import Cylinder, forces
from geometry.fault import BoomError
from geometry.fit import check_flats, check_pads, check_room
from geometry.holding import check_held
from geometry.joint import Joint, PadSize, SlidePad, Stop
from geometry.load import Load
from geometry.observation import IN_SPACE, KINDS, Observation, Quantity
from geometry.section import Direction
from geometry.segment import (
    SAME_PLACE,
    Collar,
    Diaphragm,
    Lateral,
    Material,
    PointMass,
    Segment,
)
from geometry.support import Support
from geometry.telescoping import check_drives, drives_of, places, reach

__all__ = [
    "SAME_PLACE",
    "Boom",
    "BoomError",
    "Collar",
    "Cylinder",
    "Diaphragm",
    "Direction",
    "Joint",
    "Lateral",
    "Load",
    "Material",
    "Observation",
    "PadSize",
    "PointMass",
    "Segment",
    "SlidePad",
    "Stop",
    "Support",
]


# Fraction of the inner segment's length below which an overlap counts as none.
LEAST_OVERLAP = 1.0e-4


@dataclass(frozen=True)
class Boom:
    """Segments from the base to the tip, the joints between them, their loads and cylinders.

    A clamped arm, and a fly of which 2 m slide in it:

    >>> steel = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
    >>> boxes = (
    ...     pt.BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006),
    ...     pt.BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005),
    ... )
    >>> wall = pt.Support(0.0, "clamped")
    >>> arm = pt.Segment.of_section("arm", 0.0, 8.0, steel, boxes[0], supports=(wall,))
    >>> fly = pt.Segment.of_section("fly", 6.0, 14.0, steel, boxes[1], load=-500.0)
    >>> law = pt.PowerContact(1e9, exponent=1.0)
    >>> joint = pt.Joint("arm", "fly", stations=(6.0, 8.0), play=0.01, contact=law)
    >>> boom = pt.Boom([arm, fly], [joint])
    >>> boom.tip, boom.stations
    (14.0, [(6.0, 'z'), (8.0, 'z')])
    >>> pt.BeamElements(boom).system().num_modes
    66

    Joints, loads, stops, cylinders and observations give their segments by name, or by position.

    Raises:
        BoomError: a name that is no segment, supports, stations, loads or stops outside the
            segments, an inner box that does not fit its outer one, a section that does not mirror
            itself, a segment without restraint, friction without a normal force, a boom in space
            without lateral properties, an observation that the boom does not have.
    """

    segments: Sequence[Segment]
    joints: Sequence[Joint] = ()
    loads: Sequence[Load] = ()
    stops: Sequence[Stop] = ()
    observations: Sequence[Observation] = ()
    cylinders: Sequence[Cylinder] = ()

    def __post_init__(self) -> None:
        if not self.segments:
            raise BoomError("segment", "a boom needs at least one segment")
        self._find_segments()
        for number, segment in enumerate(self.segments, start=1):
            segment.check(f"segment[{number}]")
        for number, joint in enumerate(self.joints, start=1):
            _check_joint(f"joint[{number}]", joint, self.segments)
        self._check_order()
        self._check_mirrors()
        self._check_diaphragms()
        self._check_touching()
        if self.spatial:
            self._check_space()
        for number, joint in enumerate(self.joints, start=1):
            _check_friction(f"joint[{number}]", joint, self.spatial)
            check_pads(f"joint[{number}]", joint, self)
        for number, joint in enumerate(self.joints, start=1):
            self._check_contact_length(f"joint[{number}]", joint)
        self._check_loads()
        self._check_stops()
        self._check_cylinders()
        self._check_observations()
        check_held(self)
        check_drives(self)

    @property
    def tip(self) -> float:
        """x of the free end of the last segment in m."""
        return self.segments[-1].end

    @property
    def length(self) -> float:
        """Length from the start of the first segment to the tip in m."""
        return self.tip - self.segments[0].start

    @property
    def spatial(self) -> bool:
        """True if the segments also move along y and twist."""
        return any(joint.lateral_play is not None for joint in self.joints)

    @cached_property
    def play_free(self) -> Boom:
        """The same boom with all joints bonded."""
        tied = tuple(joint.without_play for joint in self.joints)
        return replace(self, joints=tied)

    @property
    def driven(self) -> bool:
        """True if a joint telescopes during the motion."""
        return any(joint.drive is not None for joint in self.joints)

    @property
    def compressed(self) -> bool:
        """True if a segment carries an axial force."""
        return any(segment.compression for segment in self.segments)

    @property
    def directions(self) -> tuple[Direction, ...]:
        """Directions along which the segments touch."""
        return ("z", "y") if self.spatial else ("z",)

    @property
    def stations(self) -> list[tuple[float, Direction]]:
        """x in m and direction of all contact stations; bonded joints are left out.

        First those of joints along z, in space those of joints along y, then those of stops.
        """
        return self._stations_of_joints + [(stop.x, "z") for stop in self.stops]

    @property
    def numbered_stops(self) -> Iterator[tuple[int, Stop]]:
        """Position in ``stations`` and stop, of each stop."""
        return enumerate(self.stops, start=len(self._stations_of_joints))

    @property
    def _stations_of_joints(self) -> list[tuple[float, Direction]]:
        return [
            (x, direction)
            for direction in self.directions
            for joint in self.joints
            if not joint.tied
            for x in joint.stations
        ]

    def telescoped_over(self, segment: int) -> tuple[float, ...]:
        """Return x on a segment, rising, between which stations or axial forces move along it."""
        found = {
            place[joint.inner == segment]
            for joint in self.joints
            if joint.drive is not None and segment in (joint.outer, joint.inner)
            for way in (0.0, *joint.drive.reach)
            for place in places(joint, way)
        }
        if drives := drives_of(self.joints, segment):
            moved = [stop.x for stop in self.stops if stop.segment == segment]
            found |= {x - way for x in moved for way in reach(drives)}
        return tuple(sorted(found | passed_over(self.segments, self.joints, segment)))

    def stations_of(self, segment: int) -> tuple[float, ...]:
        """Return the x of all places at which something acts on a segment, rising.

        Stations of its joints, stops, lugs of cylinders, point loads and point masses.
        """
        places = {
            x for joint in self.joints if segment in (joint.outer, joint.inner)
            for x in joint.stations
        }  # fmt: skip
        places |= {stop.x for stop in self.stops if stop.segment == segment}
        places |= {lug.x for lug in self.cylinders if lug.segment == segment}
        places |= {
            x for load in self.loads if load.segment == segment for x in load.places.values()
        }
        places |= {mass.x for mass in self.segments[segment].masses}
        return tuple(sorted(places))

    def overlap(self, joint: Joint) -> tuple[float, float]:
        """Return the x in m between which both segments of a joint are."""
        return _overlap(joint, self.segments)

    def overlap_left(self, joint: Joint) -> float:
        """Return the overlap in m at the largest extension; without a drive the initial one."""
        start, end = self.overlap(joint)
        return end - start - (0.0 if joint.drive is None else joint.drive.reach[1])

    @property
    def observed(self) -> dict[str, tuple[int, float]]:
        """Places whose deflection every model reports: name → (segment, x).

        ``tip`` is the end of the last segment, ``head`` the end of an outer and ``tail`` the start
        of an inner segment. From the second joint on the joint's number follows the name.
        """
        places = {"tip": (len(self.segments) - 1, self.tip)}
        for number, joint in enumerate(self.joints, start=1):
            suffix = "" if number == 1 else f"-{number}"
            places[f"head{suffix}"] = (joint.outer, self.segments[joint.outer].end)
            places[f"tail{suffix}"] = (joint.inner, self.segments[joint.inner].start)
        return places

    def recorded(self, of_ends: Sequence[Quantity]) -> list[Observation]:
        """Return what a model records: several quantities of every end, then the observations.

        The quantity follows an end's name, ``tip_rotation``, unless it is the deflection.
        """
        return [*self._at_ends(of_ends), *self.observations]

    def _at_ends(self, quantities: Iterable[Quantity]) -> list[Observation]:
        return [
            Observation(f"{name}_{what}".removesuffix("_deflection"), segment, x, what)
            for name, (segment, x) in self.observed.items()
            for what in quantities
        ]

    def _find_segments(self) -> None:
        """Replace the segments' names by positions, and lists by tuples."""
        names = [segment.name for segment in self.segments]
        for group in (field.name for field in fields(self)):
            parts = list(getattr(self, group))
            for number, part in enumerate(parts):
                for key in ("outer", "inner", "segment"):
                    name = getattr(part, key, None)
                    if isinstance(name, str) and name not in names:
                        where = f"{group.removesuffix('s')}[{number + 1}].{key}"
                        known = ", ".join(map(repr, names))
                        raise BoomError(where, f"{name!r} is no segment; give one of {known}")
                    if isinstance(name, str):
                        parts[number] = replace(parts[number], **{key: names.index(name)})
            object.__setattr__(self, group, tuple(parts))

    def _check_order(self) -> None:
        for number, (before, after) in enumerate(pairwise(self.segments), start=2):
            if after.start < before.start or after.end < before.end:
                raise BoomError(
                    f"segment[{number}].span",
                    f"must start and end beyond {before.name!r}; give the segments from the base "
                    "to the tip",
                )
        names = [segment.name for segment in self.segments]
        for number, joint in enumerate(self.joints, start=1):
            check_order(f"joint[{number}]", names[joint.outer], names[joint.inner], names)

    def _check_mirrors(self) -> None:
        """Check that bending along z is uncoupled; in space that along y and the twist are, too."""
        for number, segment in enumerate(self.segments, start=1):
            if segment.section is None:
                continue
            where, mirrors = f"segment[{number}].section", segment.section.mirrors
            if "y" not in mirrors:
                raise BoomError(
                    where, "does not mirror itself in y, and would bend sideways under its weight"
                )
            if self.spatial and "z" not in mirrors:
                raise BoomError(
                    where,
                    "does not mirror itself in z, and would twist as it bends sideways, which no "
                    "model in space knows; leave lateral_play out, or make the flanges alike",
                )

    def _check_diaphragms(self) -> None:
        """Check that no diaphragm closes a box where another segment is inside.

        Segments end one beyond the other, so a segment deeper inside is inside the next one, too.
        """
        for joint in self.joints:
            outer, inner = self.segments[joint.outer], self.segments[joint.inner]
            for number, diaphragm in enumerate(outer.diaphragms, start=1):
                if inner.holds(diaphragm.x):
                    raise BoomError(
                        f"segment[{joint.outer + 1}].diaphragms[{number}].x",
                        f"{inner.name!r} slides inside {outer.name!r} at {diaphragm.x:g} m, and no "
                        f"plate can close the box there; it must be below {inner.start:g} m",
                    )

    def _check_touching(self) -> None:
        for stop in self.stops:
            check_flats(f"segment[{stop.segment + 1}]", self.segments[stop.segment], ("z",), ())
        for joint in self.joints:
            if joint.tied:
                continue
            outer, inner = self.segments[joint.outer], self.segments[joint.inner]
            where, places = f"segment[{joint.inner + 1}]", joint.stations
            check_flats(f"segment[{joint.outer + 1}]", outer, self.directions, places)
            check_flats(where, inner, self.directions, places, outer)

    def _check_space(self) -> None:
        for number, joint in enumerate(self.joints, start=1):
            if joint.lateral_play is None:
                raise BoomError(
                    f"joint[{number}].lateral_play",
                    "missing, and another joint has it; a boom is flat or in space as a whole",
                )
        for number, segment in enumerate(self.segments, start=1):
            for key, use in (
                ("lateral", "bend along y and twist"),
                ("section", "touch in corners"),
            ):
                if getattr(segment, key) is None:
                    raise BoomError(
                        f"segment[{number}].{key}",
                        f"missing; with lateral play the segments {use}",
                    )

    def _check_contact_length(self, where: str, place: Joint | Stop) -> None:
        length = place.contact_length
        if length is None:
            return
        if isinstance(place, Stop):
            what, room = "segment", self.segments[place.segment].length
        elif place.tied:
            raise BoomError(
                f"{where}.contact_length", "the joint is tied, and nothing touches; leave it out"
            )
        else:
            start, end = self.overlap(place)
            what, room = "overlap", end - start
        if not 0.0 < length <= room:
            raise BoomError(
                f"{where}.contact_length",
                f"must be above 0 and not above the {what}'s {room:g} m, got {length:g} m",
            )

    def _check_loads(self) -> None:
        for number, load in enumerate(self.loads, start=1):
            for key, x in load.places.items():
                check_place(f"load[{number}].{key}", x, self.segments[load.segment])
            if load.direction == "y" and not self.spatial:
                raise BoomError(
                    f"load[{number}].direction",
                    "the boom is flat, and nothing moves along 'y'; give 'z', or the joints "
                    "lateral_play",
                )

    def _check_stops(self) -> None:
        for number, stop in enumerate(self.stops, start=1):
            segment = self.segments[stop.segment]
            check_place(f"stop[{number}].x", stop.x, segment)
            self._check_contact_length(f"stop[{number}]", stop)
            for support in segment.supports:
                near = SAME_PLACE * segment.length
                if support.stiffness is None and abs(support.x - stop.x) <= near:
                    raise BoomError(
                        f"stop[{number}].x",
                        f"a support holds {segment.name!r} at {stop.x:g} m already; move one of "
                        "them",
                    )

    def _check_observations(self) -> None:
        own = {*forces(self), *(place.name for place in self._at_ends(KINDS))}
        for number, place in enumerate(self.observations, start=1):
            where = f"observe[{number}]"
            if place.name in own:
                raise BoomError(
                    f"{where}.name",
                    f"{place.name!r} is the name of another output already; give it its own",
                )
            own.add(place.name)
            check_place(f"{where}.x", place.x, self.segments[place.segment])
            if place.kind.read in IN_SPACE and not self.spatial:
                raise BoomError(
                    f"{where}.quantity",
                    "the boom is flat, and nothing moves along 'y' or twists; give another "
                    "quantity, or the joints lateral_play",
                )

    def _check_cylinders(self) -> None:
        for number, cylinder in enumerate(self.cylinders, start=1):
            where = f"cylinder[{number}]"
            check_place(f"{where}.x", cylinder.x, self.segments[cylinder.segment])
            cylinder.check(where, self.spatial)


def _overlap(joint: Joint, segments: Sequence[Segment]) -> tuple[float, float]:
    outer, inner = segments[joint.outer], segments[joint.inner]
    return max(outer.start, inner.start), min(outer.end, inner.end)


def _check_joint(where: str, joint: Joint, segments: Sequence[Segment]) -> None:
    outer, inner = segments[joint.outer], segments[joint.inner]
    start, end = _overlap(joint, segments)
    if not start < end:
        raise BoomError(
            where,
            f"{outer.name!r} ends at {outer.end:g} m before {inner.name!r} starts at "
            f"{inner.start:g} m; the segments of a joint must overlap",
        )
    if end - start < LEAST_OVERLAP * inner.length:
        raise BoomError(
            where,
            f"{inner.name!r} overlaps {outer.name!r} by {end - start:g} m; it must be at least "
            f"{LEAST_OVERLAP * inner.length:.3g} m, usual is a tenth of its length",
        )
    for x in joint.stations:
        if not (outer.holds(x) and inner.holds(x)):
            raise BoomError(
                f"{where}.stations",
                f"{x:g} m lies outside the overlap of {outer.name!r} and {inner.name!r}; it must "
                f"be between {start:g} and {end:g} m",
            )
    if joint.tied and joint.dashpot > 0.0:
        raise BoomError(f"{where}.dashpot", "the joint is tied, and nothing moves; leave it out")
    if not 0.0 <= joint.dashpot < float("inf"):
        raise BoomError(
            f"{where}.dashpot", f"must be a number of N s/m from 0 on, got {joint.dashpot:g}"
        )
    near = SAME_PLACE * outer.length
    if any(right - left <= near for left, right in pairwise(joint.stations)):
        raise BoomError(f"{where}.stations", "must rise from the base to the tip, each given once")
    if joint.locked_at is not None and not outer.start - near <= joint.locked_at <= end + near:
        raise BoomError(
            f"{where}.locked_at",
            f"{joint.locked_at:g} m is no place at which {inner.name!r} is locked in "
            f"{outer.name!r}; it must be between {outer.start:g} and {end:g} m",
        )
    check_room(where, joint, outer, inner)


def _check_friction(where: str, joint: Joint, spatial: bool) -> None:
    if joint.friction > 0.0 and not joint.normal_forces and not spatial:
        raise BoomError(
            f"{where}.normal_forces",
            "missing, and the joint has friction; give normal_forces, one in N for each station, "
            "since in a flat boom no other plane presses",
        )
    if joint.normal_forces and len(joint.normal_forces) != len(joint.stations):
        raise BoomError(
            f"{where}.normal_forces",
            f"must have one number for each of the {len(joint.stations)} stations, got "
            f"{len(joint.normal_forces)}",
        )


def check_order(where: str, outer: str, inner: str, names: Sequence[str]) -> None:
    """Check that the outer segment of a joint is nearer to the base than the inner one.

    Args:
        where: the key of the joint.
        outer, inner: the names of its segments.
        names: of all segments, from the base to the tip.

    Raises:
        BoomError: it is not.
    """
    if names.index(outer) > names.index(inner):
        raise BoomError(
            where, f"{inner!r} is nearer to the base than {outer!r}; exchange inner and outer"
        )


def check_place(where: str, x: float, segment: Segment) -> None:
    """Check that a place is on a segment.

    Args:
        where: its key.
        x: m.
        segment: its name is in the message.

    Raises:
        BoomError: it is not.
    """
    if not segment.holds(x):
        raise BoomError(
            where,
            f"{x:g} m lies outside {segment.name!r}; it must be between {segment.start:g} and "
            f"{segment.end:g} m",
        )
