# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error of the default mesh under high contact forces.

The study runs the paper's boom with friction and constant sections. Plays are at most the paper's;
loads are up to ten times the paper's, of the order of the weight. Each pair of play and load is
computed on the default mesh, and on meshes with edges half and twice as long. One reduction serves
all pairs on a mesh, since only contact laws and loads differ.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from time import perf_counter
from typing import NamedTuple

import numpy as np

from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.report.tables import Cell, Table
from studies.mesh import peak_heights
from studies.motions import (
    friction_case,
    gap_system,
    move,
    run_parallel,
    scale_mesh,
    shell_of,
    with_pads,
)
from studies.study import Piece, Progress, Verification, define_study

# Permitted errors of the first peak, and of the tip as a part of its range.
PEAK, TIP = 0.002, 0.02
TIP_OF_RANGE = "tip, part of its range"
# Number of outputs over which a pad's force is averaged, since single impacts last microseconds.
HELD = 20


class Point(NamedTuple):
    """A play in m, and a ratio of the load to the paper's load."""

    play: float
    load: float

    def __str__(self) -> str:
        return f"{1e3 * self.play:g} mm, load × {self.load:g}"

    @classmethod
    def each(cls, plays: Sequence[float], loads: Sequence[float]) -> list[Point]:
        """Return a point for each pair of a play and a load."""
        return [cls(*one) for one in product(plays, loads)]


class Sizes(NamedTuple):
    """Parameters of the study."""

    #: Ratios of edge lengths to the default ones, each half the previous ratio.
    meshes: Sequence[float] = (2.0, 1.0, 0.5)
    plays: Sequence[float] = (0.0, 2.0e-3, 4.0e-3, 7.0e-3, 10.0e-3, 14.0e-3)  #: 2Δ in m
    loads: Sequence[float] = (1.0, 3.0, 10.0)  #: ratios to the paper's load
    pads: Sequence[tuple[float, float]] = ((0.1, 0.06), (0.2, 0.06))  #: lengths and widths in m
    #: Points of motions in space, which last ``spatial_duration``.
    in_space: Sequence[Point] = (Point(14.0e-3, 1.0), Point(14.0e-3, 10.0), Point(4.0e-3, 10.0))
    #: Durations in s of planar motions and of motions in space.
    duration: float = 5.0
    spatial_duration: float = 1.0
    peaks: int = 3  #: number of compared peaks of the tip


class PointMotion(NamedTuple):
    """Motion of one point of the study."""

    tip: Array  #: (num_times,) in m
    peaks: Array  #: (num_peaks,) heights of the first peaks of the tip in m; NaN for missing ones
    forces: Array  #: (num_stations,) largest force in N, as a mean over ``HELD`` outputs
    seconds: float = 0.0  #: computing time on one core

    @classmethod
    def of(cls, system: GapSystem, duration: float, num_peaks: int = 1) -> PointMotion:
        """Compute the motion from rest over a duration in s."""
        begin = perf_counter()
        motion = move(system, duration)
        seconds = perf_counter() - begin
        held = np.cumsum(np.pad(motion.data["contact_force"].values, ((1, 0), (0, 0))), axis=0)
        means = (held[HELD:] - held[:-HELD]) / HELD
        peaks = np.full(num_peaks, np.nan)
        heights = peak_heights(motion)[:num_peaks]
        peaks[: len(heights)] = heights
        tip = np.asarray(motion.data["tip"].values)
        return cls(tip, peaks, np.abs(means).max(axis=0), seconds)

    def tip_error(self, reference: PointMotion) -> float:
        """Return the largest deviation of the tip, as a fraction of the reference's range."""
        return float(np.abs(self.tip - reference.tip).max() / np.ptp(reference.tip))

    def peak_errors(self, reference: PointMotion) -> Array:
        """Return the relative errors (num_peaks,) of the peaks."""
        return np.asarray(np.abs(self.peaks / reference.peaks - 1.0))

    def changes(self, finer: PointMotion) -> Array:
        """Return the relative changes (num_peaks + 2,) from this motion to a finer mesh.

        First come the changes of the peaks. The last two are the change of station forces relative
        to the largest force, and the change of the tip deflection relative to its range.
        """
        forces = np.abs(self.forces - finer.forces).max() / finer.forces.max()
        return np.append(self.peak_errors(finer), [forces, self.tip_error(finer)])


class ContactType(NamedTuple):
    """Type of contact."""

    name: str  #: name of the table
    where: str  #: places of contact, in words
    case: Case  #: case with this contact
    points: Sequence[Point]  #: points of the motions
    duration: float  #: duration of the motions in s


class ContactResults(NamedTuple):
    """Results for a type of contact on every mesh."""

    touch: ContactType  #: the type of contact
    #: Motions of each point, from the coarsest mesh to the finest.
    moved: Mapping[Point, Sequence[PointMotion]]

    @property
    def changes(self) -> Array:
        """Changes (num_points, num_peaks + 2) from default to finest mesh; NaN without a peak."""
        return np.array([meshes[-2].changes(meshes[-1]) for meshes in self.moved.values()])

    def worst(self, which: int) -> tuple[float, Point]:
        """Return the largest change over all points, and its point; ``which`` is its column."""
        changes = self.changes[:, which]
        points = list(self.moved)
        if np.isnan(changes).all():
            return float("nan"), points[0]
        at = int(np.nanargmax(changes))
        return float(changes[at]), points[at]

    @property
    def verifications(self) -> list[Verification]:
        """The verifications of first peaks and tip deflections against the finest mesh."""
        found = []
        for what, which, allowed in (("first tip peak", 0, PEAK), (TIP_OF_RANGE, -1, TIP)):
            compared = int(np.isfinite(self.changes[:, which]).sum())
            if not compared:
                continue
            value, point = self.worst(which)
            name = f"{what}, {self.touch.where}, worst of {compared} points ({point})"
            source = "all edges half as long"
            found.append(Verification(name, value, 0.0, "", "other code", source, allowed))
        return found


def set_point(system: GapSystem, point: Point) -> GapSystem:
    """Return the system with the play and load of a point; the coordinates stay the same."""
    laws = [law.scale_clearances(0.0).with_clearance(0.5 * point.play) for law in system.laws]
    return replace(system, laws=laws, load=point.load * system.load)


def in_space(case: Case) -> Case:
    """Return the case with lateral play, in which half of the load also acts sideways."""
    joints = tuple(replace(joint, lateral_play=joint.play) for joint in case.joints)
    segments = tuple(
        segment.model_copy(update={"lateral_load": 0.5 * segment.load}) for segment in case.segments
    )
    return case.model_copy(update={"joints": joints, "segments": segments})


def measure(touch: ContactType, sizes: Sizes) -> ContactResults:
    """Return the results of all points for a type of contact, on all meshes."""
    boom, shell = build_boom(touch.case), shell_of(touch.case)
    systems = [gap_system(touch.case, boom, scale_mesh(shell, part)) for part in sizes.meshes]
    tasks = [set_point(system, point) for point in touch.points for system in systems]
    moved = run_parallel(lambda task: PointMotion.of(task, touch.duration, sizes.peaks), tasks)
    count = len(systems)
    return ContactResults(
        touch, {point: moved[count * i : count * (i + 1)] for i, point in enumerate(touch.points)}
    )


def contact_types(case: Case, sizes: Sizes) -> list[ContactType]:
    """Return the types of contact: near webs, by pads, and in space."""
    every = Point.each(sizes.plays, sizes.loads)
    return [
        ContactType("points-webs", "near webs", case, every, sizes.duration),
        *(
            ContactType(f"points-pads-{i}", f"pads of {length:g} m x {width:g} m",
                  with_pads(case, length, width), every, sizes.duration)
            for i, (length, width) in enumerate(sizes.pads, start=1)
        ),
        ContactType("points-in-space", "in space, near webs", in_space(case), sizes.in_space,
              sizes.spatial_duration),
    ]  # fmt: skip


def summary_table(contacts: Sequence[ContactResults], sizes: Sizes) -> Table:
    """Return a table of the largest changes of each type of contact."""
    peaks = [f"peak {which}\n(%)" for which in range(1, sizes.peaks + 1)]
    changes = [*peaks, "pad forces\n(%)", "tip, part of\nits range (%)"]
    rows: list[Sequence[Cell]] = []
    for contact in contacts:
        worst = [contact.worst(which) for which in range(len(changes))]
        parts = [100.0 * change for change, _ in worst]
        rows.append((contact.touch.where, len(contact.moved), *parts, str(worst[-1][1])))
    return Table.of_rows(
        "working-load",
        "From the default mesh to one with all edges half as long",
        {"contact": "", "points": ".0f", **dict.fromkeys(changes, ".2f"), "where": ""},
        rows,
        (
            f"The largest change over plays of {1e3 * min(sizes.plays):g} to "
            f"{1e3 * max(sizes.plays):g} mm and loads of {min(sizes.loads):g} to "
            f"{max(sizes.loads):g} times the paper's, with its friction, over {sizes.duration:g} s "
            f"(in space {sizes.spatial_duration:g} s). A pad force is the largest mean over "
            f"{HELD} ms.",
        ),
    )


def point_table(contact: ContactResults) -> Table:
    """Return a table of first peaks and changes at every point of one type of contact."""
    columns = {
        "point": "", "first peak (mm)": ".1f", "its change (%)": ".3f", "tip (% of range)": ".2f",
        "largest pad force (kN)": ".4g",
    }  # fmt: skip
    return Table.of_rows(
        contact.touch.name,
        f"Every point, {contact.touch.where}",
        columns,
        [
            (str(point), 1e3 * meshes[-2].peaks[0], *(100.0 * changes[[0, -1]]),
             1e-3 * meshes[-1].forces.max())
            for (point, meshes), changes in zip(
                contact.moved.items(), contact.changes, strict=True
            )
        ],
    )  # fmt: skip


@define_study("working-load", "Meshes under working loads")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Study the paper's boom with friction under working loads, on three meshes."""
    sizes = sizes or Sizes()
    contacts = []
    for touch in contact_types(friction_case(), sizes):
        progress(touch.where)
        contacts.append(measure(touch, sizes))
    yield summary_table(contacts, sizes)
    for contact in contacts:
        yield point_table(contact)
        yield from contact.verifications
