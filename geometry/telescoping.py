# SPDX-License-Identifier: LGPL-3.0-or-later
"""Telescoping: stations and segments that drives move, and checks of drives."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from protractile.geometry.assembly import Assembly
from protractile.geometry.fields import BoomError
from protractile.geometry.fit import check_pads_in_travel, check_room
from protractile.geometry.joint import Drive, Joint
from protractile.geometry.segment import SAME_PLACE, Segment

# Number of times at which a boom with drives is checked.
_SAMPLES = 9


@dataclass(frozen=True, slots=True)
class TelescopingStations:
    """Stations that move with the same drives."""

    #: indices of the joints of the drives in ``Boom.joints``, from the base
    joints: tuple[int, ...]
    drives: tuple[Drive, ...]  #: drives of these joints
    stations: tuple[int, ...]  #: indices of the stations in ``Boom.stations``

    @property
    def suffix(self) -> str | None:
        """The suffix of result names; None if several joints move the stop's segment."""
        if len(self.joints) > 1:
            return None
        return "" if self.joints[0] == 0 else f"-{self.joints[0] + 1}"

    def extensions(self, extension: float) -> dict[int, float]:
        """Return the extensions in m, by index of the joint, that add up to ``extension`` in m."""
        return {self.joints[0]: extension}


def telescoping_stations(boom: Assembly) -> list[TelescopingStations]:
    """Return the stations that move, grouped by drives; stops on moving segments are included."""
    groups = defaultdict[tuple[int, ...], list[int]](list)
    for station in boom.stations:
        if station.joint is None:
            joints = drives_below(boom.joints, station.segment)
        else:
            joints = () if station.joint.drive is None else (station.number,)
        groups[joints].append(station.index)
    return [
        TelescopingStations(
            joints,
            tuple(drive for n in joints if (drive := boom.joints[n].drive) is not None),
            tuple(indices),
        )
        for joints, indices in groups.items()
        if joints
    ]


def drives_below(joints: Sequence[Joint], segment: int) -> tuple[int, ...]:
    """Return the indices of the driven joints between the base and a segment, base first."""
    for number, joint in enumerate(joints):
        if joint.inner == segment:
            drive = () if joint.drive is None else (number,)
            return drives_below(joints, joint.outer) + drive
    return ()


def travel(boom: Assembly, segment: int, time: float) -> float:
    """Return the travel of a segment in m since the start, at a time in s."""
    return sum(float(drive.history(np.array(time))) for drive in drives_of(boom.joints, segment))


def drives_of(joints: Sequence[Joint], segment: int) -> list[Drive]:
    """Return the drives between a segment and the ground, from the base."""
    drives = (joints[number].drive for number in drives_below(joints, segment))
    return [drive for drive in drives if drive is not None]


def reach(drives: Sequence[Drive]) -> tuple[float, float]:
    """Return the range of the sum of the drives' extensions in m."""
    return sum(drive.reach[0] for drive in drives), sum(drive.reach[1] for drive in drives)


def farthest_travel(boom: Assembly, segment: int) -> float:
    """Return a segment's largest outward travel in m; negative if the segment only retracts."""
    reaches = (drive.reach for drive in drives_of(boom.joints, segment))
    return sum(high or low for low, high in reaches)


def sample_extensions(boom: Assembly) -> list[dict[int, float]]:
    """Return the extensions in m at several times, by joint; they include all extremes."""
    drives = {n: joint.drive for n, joint in enumerate(boom.joints) if joint.drive is not None}
    times = np.unique(np.concatenate([np.zeros(1), *(drive.times for drive in drives.values())]))
    extensions = np.array([drive.history(times) for drive in drives.values()]).reshape(
        -1, times.size
    )
    between = np.linspace(0, times.size - 1, _SAMPLES).astype(int)
    steps = np.unique([*between, *extensions.argmin(axis=1), *extensions.argmax(axis=1)])
    return [dict(zip(drives, there.tolist(), strict=True)) for there in extensions[:, steps].T]


def station_positions(joint: Joint, extension: float) -> list[tuple[float, float]]:
    """Return the material coordinates (x on outer, x on inner segment) in m of each station.

    ``extension`` is the extension in m since t = 0.
    """
    carriers = () if joint.drive is None else joint.drive.carriers
    return [
        (x, x - extension) if carrier == "outer" else (x + extension, x)
        for x, carrier in zip(joint.stations, carriers, strict=True)
    ]


def check_drives(boom: Assembly) -> None:
    """Check that each drive has space for its travel, and moves no supported segment.

    Raises:
        BoomError: a drive is invalid.
    """
    driven = [(n, joint) for n, joint in enumerate(boom.joints) if joint.drive is not None]
    if not driven:
        return
    for number, joint in driven:
        outer, inner = boom.segments[joint.outer], boom.segments[joint.inner]
        _check_travel(f"joints[{number}].drive", joint, outer, inner)
        check_pads_in_travel(f"joints[{number}]", joint, boom)
        for segment in (outer, inner):
            if boom.spatial and segment.head_section is not None:
                raise BoomError(
                    f"joints[{number}].drive",
                    f"{segment.name!r} tapers, and in space its corners would move away from the "
                    "pads; leave drive or head_section out",
                )
        _check_lock(f"joints[{number}].locked_at", joint, outer, inner)
    _check_order(boom)
    for number in range(len(boom.segments)):
        if drives_below(boom.joints, number):
            _check_unsupported(boom, number)


def _check_travel(where: str, joint: Joint, outer: Segment, inner: Segment) -> None:
    drive = joint.drive
    assert drive is not None
    if joint.bonded:
        raise BoomError(where, "the joint is bonded, and nothing slides; leave it out")
    low, high = drive.reach
    if low == high:
        raise BoomError(where, f"does not move {inner.name!r}; leave it out")
    near = SAME_PLACE * outer.length
    overlap = min(outer.end, inner.end) - inner.start - high
    if not overlap > 0.0 or overlap < drive.least_overlap - near:
        least = f"at least {drive.least_overlap:g}" if drive.least_overlap else "above 0"
        raise BoomError(
            where,
            f"extends {inner.name!r} by {high:g} m until {overlap:g} m of overlap are left; it "
            f"must leave {least} m",
        )
    room = min(inner.start - outer.start, inner.end - outer.end)
    if -low > room + near:
        raise BoomError(
            where,
            f"retracts {inner.name!r} by {-low:g} m; it must be at most {room:g} m, where it is "
            f"wholly in {outer.name!r}",
        )
    for plate in outer.diaphragms:
        if inner.start + low <= plate.x + near:
            raise BoomError(
                where,
                f"retracts {inner.name!r} by {-low:g} m, and the diaphragm of {outer.name!r} at "
                f"{plate.x:g} m is in its way; it must be less than {inner.start - plate.x:g} m",
            )
    for extension in (low, high):
        there = station_positions(joint, extension)
        for x, (on_outer, on_inner) in zip(joint.stations, there, strict=True):
            if not (outer.holds(on_outer) and inner.holds(on_inner)):
                raise BoomError(
                    where,
                    f"the station at {x:g} m leaves the overlap as {inner.name!r} telescopes by "
                    f"{extension:g} m; make the travel shorter, or move the station",
                )
        if any(right - left <= near for (left, _), (right, _) in pairwise(there)):
            raise BoomError(
                where,
                f"stations pass one another as {inner.name!r} telescopes by {extension:g} m; "
                "make the travel shorter, or move them",
            )
        check_room(where, joint, outer, inner, extension)


def _check_lock(where: str, joint: Joint, outer: Segment, inner: Segment) -> None:
    """Check that the lock stays on both segments, or is at the foot below the inner segment."""
    drive, x = joint.drive, joint.locked_at
    assert drive is not None
    if x is None:
        return
    low, high = drive.reach
    if drive.locked == "outer" and x < inner.start:
        if x > inner.start + low:
            raise BoomError(
                where,
                f"{inner.name!r} retracts by {-low:g} m, past {x:g} m, where it is pushed; "
                "make the travel shorter, or move the place",
            )
        return
    for extension in (low, high):
        segment, place = (
            (outer, x + extension) if drive.locked == "inner" else (inner, x - extension)
        )
        if not segment.holds(place):
            raise BoomError(
                where,
                f"{x:g} m leaves the overlap as {inner.name!r} telescopes by {extension:g} m; "
                "make the travel shorter, or move the place",
            )


def _check_order(boom: Assembly) -> None:
    """Check that all joints of a segment move it by the same extension."""
    for number, joint in enumerate(boom.joints):
        drive = () if joint.drive is None else (number,)
        if drives_below(boom.joints, joint.inner) != drives_below(boom.joints, joint.outer) + drive:
            inner = boom.segments[joint.inner].name
            raise BoomError(
                f"joints[{number}].drive",
                f"{inner!r} slides in two joints, which would draw it differently; let no drive be "
                "between them",
            )


def _check_unsupported(boom: Assembly, number: int) -> None:
    """Check that a segment that telescopes has no supports and cylinders; stops may touch it."""
    segment = boom.segments[number]
    restraints = [f"segments[{number}].supports"] if segment.supports else []
    restraints += [f"cylinders[{k}]" for k, c in enumerate(boom.cylinders) if c.segment == number]
    if restraints:
        raise BoomError(
            restraints[0],
            f"the ground holds {segment.name!r}, which a drive moves along; let it hold a segment "
            "that stays, or leave drive out",
        )
    for k, stop in enumerate(boom.stops):
        low, high = reach(drives_of(boom.joints, number))
        if stop.segment == number and not (
            segment.holds(stop.x - low) and segment.holds(stop.x - high)
        ):
            raise BoomError(
                f"stops[{k}].x",
                f"{segment.name!r} moves past {stop.x:g} m; it must be there over the whole travel",
            )
