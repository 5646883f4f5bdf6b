# SPDX-License-Identifier: LGPL-3.0-or-later
"""Checks of a boom: compatibility of its parts."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from protractile.geometry.assembly import Assembly
from protractile.geometry.fields import BoomError
from protractile.geometry.fit import check_contact_faces, check_pads, check_room
from protractile.geometry.ground import forces
from protractile.geometry.joint import Joint, Stop
from protractile.geometry.load import PartialLoad
from protractile.geometry.observation import KINDS, SPATIAL_QUANTITIES
from protractile.geometry.section import Direction
from protractile.geometry.segment import SAME_PLACE
from protractile.geometry.segment_checks import check_segment
from protractile.geometry.support_check import check_supported
from protractile.geometry.telescoping import check_drives

# Minimum overlap as a fraction of the length of the inner segment.
LEAST_OVERLAP = 1.0e-4


def check_boom(boom: Assembly) -> None:
    """Check that the parts of a boom are compatible.

    Raises:
        BoomError: they are not; see :class:`.geometry.boom.Boom`.
    """
    names = [segment.name for segment in boom.segments]
    for number, segment in enumerate(boom.segments):
        check_segment(segment, f"segments[{number}]")
        if segment.name in names[:number]:
            what = f"{segment.name!r} is the name of another segment already; give each its own"
            raise BoomError(f"segments[{number}].name", what)
    for number, joint in enumerate(boom.joints):
        _check_joint(boom, f"joints[{number}]", joint)
    _check_order(boom)
    _check_mirrors(boom)
    _check_diaphragms(boom)
    _check_contact_faces(boom)
    if boom.spatial:
        _check_space(boom)
    for number, joint in enumerate(boom.joints):
        _check_friction(f"joints[{number}]", joint, boom.spatial)
        check_pads(f"joints[{number}]", joint, boom)
        _check_contact_length(boom, f"joints[{number}]", joint)
    _check_loads(boom)
    _check_stops(boom)
    for number, cylinder in enumerate(boom.cylinders):
        boom.segments[cylinder.segment].check_place(f"cylinders[{number}].x", cylinder.x)
        cylinder.check(f"cylinders[{number}]", boom.spatial)
    _check_observations(boom)
    check_supported(boom)
    check_drives(boom)


def _check_order(boom: Assembly) -> None:
    for number, (before, after) in enumerate(pairwise(boom.segments), start=1):
        if after.start < before.start or after.end < before.end:
            raise BoomError(
                f"segments[{number}].start",
                f"must start and end beyond {before.name!r}; give the segments from the base "
                "to the tip",
            )
    names = [segment.name for segment in boom.segments]
    for number, joint in enumerate(boom.joints):
        check_order(f"joints[{number}]", names[joint.outer], names[joint.inner], names)


def _check_mirrors(boom: Assembly) -> None:
    """Check that sections have the symmetry that uncouples vertical and lateral motion."""
    for number, segment in enumerate(boom.segments):
        if segment.section is None:
            continue
        where, mirrors = f"segments[{number}].section", segment.section.mirrors
        if "y" not in mirrors:
            raise BoomError(
                where, "does not mirror itself in y, and would bend sideways under its weight"
            )
        if boom.spatial and "z" not in mirrors:
            raise BoomError(
                where,
                "does not mirror itself in z, and would twist as it bends sideways, which no "
                "model in space knows; leave lateral_play out, or make the flanges alike",
            )
        needed: tuple[Direction, ...] = ("y", "z") if boom.spatial else ("y",)
        for index, collar in enumerate(segment.collars):
            if not all(collar.is_symmetric(segment.widest, axis) for axis in needed):
                raise BoomError(
                    f"segments[{number}].collars[{index}].walls",
                    f"do not mirror themselves in {' and '.join(needed)}; give the opposite walls, "
                    "too",
                )


def _check_diaphragms(boom: Assembly) -> None:
    """Check that no diaphragm is at an x where another segment is inside the box."""
    for joint in boom.joints:
        outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
        for number, diaphragm in enumerate(outer.diaphragms):
            if inner.holds(diaphragm.x):
                raise BoomError(
                    f"segments[{joint.outer}].diaphragms[{number}].x",
                    f"{inner.name!r} slides inside {outer.name!r} at {diaphragm.x:g} m, and no "
                    f"plate can close the box there; it must be below {inner.start:g} m",
                )


def _check_contact_faces(boom: Assembly) -> None:
    for stop in boom.stops:
        check_contact_faces(f"segments[{stop.segment}]", boom.segments[stop.segment], ("z",), ())
    for joint in boom.joints:
        if joint.bonded:
            continue
        outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
        where, places = f"segments[{joint.inner}]", joint.stations
        check_contact_faces(f"segments[{joint.outer}]", outer, boom.directions, places)
        check_contact_faces(where, inner, boom.directions, places, outer)


def _check_space(boom: Assembly) -> None:
    for number, joint in enumerate(boom.joints):
        if joint.lateral_play is None:
            raise BoomError(
                f"joints[{number}].lateral_play",
                "missing, and another joint has it; a boom is flat or in space as a whole",
            )
    for number, segment in enumerate(boom.segments):
        for key, use in (
            ("lateral", "bend along y and twist"),
            ("section", "touch in corners"),
        ):
            if getattr(segment, key) is None:
                raise BoomError(
                    f"segments[{number}].{key}",
                    f"missing; with lateral play the segments {use}",
                )


def _check_contact_length(boom: Assembly, where: str, place: Joint | Stop) -> None:
    length = place.contact_length
    if length is None:
        return
    if isinstance(place, Stop):
        what, room = "segment", boom.segments[place.segment].length
    elif place.bonded:
        raise BoomError(
            f"{where}.contact_length", "the joint is bonded, and nothing touches; leave it out"
        )
    else:
        start, end = boom.overlap(place)
        what, room = "overlap", end - start
    if not 0.0 < length <= room:
        raise BoomError(
            f"{where}.contact_length",
            f"must be above 0 and not above the {what}'s {room:g} m, got {length:g} m",
        )


def _check_loads(boom: Assembly) -> None:
    for number, load in enumerate(boom.loads):
        for key, x in load.places.items():
            boom.segments[load.segment].check_place(f"loads[{number}].{key}", x)
        if isinstance(load, PartialLoad) and not load.span[0] < load.span[1]:
            start, end = load.span
            raise BoomError(
                f"loads[{number}].to", f"must be beyond from, {start:g} m, got {end:g} m"
            )
        if load.direction == "y" and not boom.spatial:
            raise BoomError(
                f"loads[{number}].direction",
                "the boom is flat, and nothing moves along 'y'; give 'z', or the joints "
                "lateral_play",
            )


def _check_stops(boom: Assembly) -> None:
    for number, stop in enumerate(boom.stops):
        segment = boom.segments[stop.segment]
        segment.check_place(f"stops[{number}].x", stop.x)
        _check_contact_length(boom, f"stops[{number}]", stop)
        for support in segment.supports:
            near = SAME_PLACE * segment.length
            if support.stiffness is None and abs(support.x - stop.x) <= near:
                raise BoomError(
                    f"stops[{number}].x",
                    f"a support holds {segment.name!r} at {stop.x:g} m already; move one of them",
                )


def _check_observations(boom: Assembly) -> None:
    names = {*forces(boom), *(place.name for place in boom.end_observations(KINDS))}
    for number, place in enumerate(boom.observations):
        where = f"observations[{number}]"
        if place.name in names:
            raise BoomError(
                f"{where}.name",
                f"{place.name!r} is the name of another output already; give it its own",
            )
        names.add(place.name)
        boom.segments[place.segment].check_place(f"{where}.x", place.x)
        if place.kind.displacement in SPATIAL_QUANTITIES and not boom.spatial:
            raise BoomError(
                f"{where}.quantity",
                "the boom is flat, and nothing moves along 'y' or twists; give another "
                "quantity, or the joints lateral_play",
            )


def _check_joint(boom: Assembly, where: str, joint: Joint) -> None:
    outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
    start, end = boom.overlap(joint)
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
    if joint.bonded and joint.dashpot > 0.0:
        raise BoomError(f"{where}.dashpot", "the joint is bonded, and nothing moves; leave it out")
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
            "since a flat boom has no lateral contact forces",
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
        where: attribute of the boom with this joint, for messages.
        outer, inner: names of its segments.
        names: names of all segments, from the base to the tip.

    Raises:
        BoomError: the outer segment is farther from the base.
    """
    if names.index(outer) > names.index(inner):
        raise BoomError(
            where, f"{inner!r} is nearer to the base than {outer!r}; exchange inner and outer"
        )
