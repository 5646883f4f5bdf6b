# SPDX-License-Identifier: LGPL-3.0-or-later
"""Whether the default mesh is fine enough where segments press each other hard.

The paper's boom with friction, with its sections held, over plays from none to the paper's and
loads up to ten times the paper's, which is what gravity does: each point on the default mesh, and
with all edges half and twice as long. One reduction serves all points of a mesh: plays and loads
are the laws' and the load's.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import NamedTuple

import numpy as np

from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from runs.case.build import build_boom
from runs.case.schema import Case
from runs.studies.mesh import peak_heights
from runs.studies.motions import finer, friction_case, gap_system, move, shell_of
from runs.studies.pads import with_pads
from runs.studies.refined import Refined, refined_table
from runs.studies.study import Cell, Proof, Study, Table

# What is allowed of the first peak, and of the tip as a part of its range.
ALLOWED = 0.002, 0.02
# Outputs over which a pad's force is averaged: single blows are a matter of microseconds.
HELD = 20


class Point(NamedTuple):
    """Play in m, and load over the paper's."""

    play: float
    load: float

    def __str__(self) -> str:
        return f"{1e3 * self.play:g} mm, load × {self.load:g}"


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        meshes: edge lengths over the default ones, each half the one before.
        plays: 2Δ in m.
        loads: over the paper's.
        pads: lengths and widths in m.
        in_space: points, whose motion lasts ``spatial_duration``.
        duration, spatial_duration: in s.
        peaks: how many of the tip's first ones.
    """

    meshes: Sequence[float] = (2.0, 1.0, 0.5)
    plays: Sequence[float] = (0.0, 2.0e-3, 4.0e-3, 7.0e-3, 10.0e-3, 14.0e-3)
    loads: Sequence[float] = (1.0, 3.0, 10.0)
    pads: Sequence[tuple[float, float]] = ((0.1, 0.06), (0.2, 0.06))
    in_space: Sequence[Point] = (Point(14.0e-3, 1.0), Point(14.0e-3, 10.0), Point(4.0e-3, 10.0))
    duration: float = 5.0
    spatial_duration: float = 1.0
    peaks: int = 3


@dataclass(frozen=True, slots=True)
class Moved:
    """A point's motion on one mesh.

    Args:
        tip: (num_times,) in m.
        peaks: heights of its first peaks in m.
        forces: (num_stations,) largest of each, in N, over ``HELD`` outputs.
    """

    tip: Array
    peaks: Sequence[float]
    forces: Array

    def peak(self, which: int = 0) -> float:
        """Height of one in m; NaN without it."""
        return self.peaks[which] if which < len(self.peaks) else float("nan")

    @classmethod
    def of(cls, system: GapSystem, duration: float, peaks: int) -> Moved:
        """From rest, in s."""
        motion = move(system, duration)
        held = np.cumsum(np.pad(motion.data["contact_force"].values, ((1, 0), (0, 0))), axis=0)
        means = (held[HELD:] - held[:-HELD]) / HELD
        tip = np.asarray(motion.data["tip"].values)
        return cls(tip, peak_heights(motion)[:peaks], np.abs(means).max(axis=0))


@dataclass(frozen=True, slots=True)
class Contact:
    """A way to touch on every mesh.

    Args:
        name: of it.
        moved: point → its motions, from the coarsest mesh to the finest.
    """

    name: str
    moved: Mapping[Point, Sequence[Moved]]

    def peak_change(self, point: Point, which: int = 0) -> float:
        """Relative change of a peak from the default mesh to the finest; NaN without it."""
        default, fine = (moved.peak(which) for moved in self.moved[point][-2:])
        return abs(default / fine - 1.0)

    def force_change(self, point: Point) -> float:
        """Largest change of a station's force, as a part of the largest force."""
        default, fine = (moved.forces for moved in self.moved[point][-2:])
        return float(np.abs(default - fine).max() / fine.max())

    def tip_change(self, point: Point) -> float:
        """Largest change of the tip, as a part of its range."""
        default, fine = (moved.tip for moved in self.moved[point][-2:])
        return float(np.abs(default - fine).max() / np.ptp(fine))

    def worst(self, change: Callable[[Point], float]) -> tuple[float, Point]:
        """The largest change over all points, and where it is; NaN where there is none."""
        known = [(change(p), p) for p in self.moved if np.isfinite(change(p))]
        return max(known, default=(float("nan"), next(iter(self.moved))))

    @property
    def proofs(self) -> list[Proof]:
        """First peaks and tips of the default mesh against half of all edges."""
        found = []
        for what, change, allowed in zip(
            ("first tip peak", "tip, part of its range"),
            (self.peak_change, self.tip_change),
            ALLOWED,
            strict=True,
        ):
            value, point = self.worst(change)
            name = f"{what}, {self.name}, worst of {len(self.moved)} points ({point})"
            source = "all edges half as long"
            found.append(Proof(name, value, 0.0, "", "other code", source, allowed))
        return found

    def hardest(self, sizes: Sizes) -> list[Refined]:
        """Peaks and pad forces at the largest play and load."""
        meshes = self.moved[max(self.moved, key=lambda p: (p.load, p.play))]
        values = {
            ("tip peak", "mm"): [[1e3 * peak for peak in moved.peaks] for moved in meshes],
            ("pad force", "kN"): [(1e-3 * moved.forces).tolist() for moved in meshes],
        }
        return [
            Refined(f"{self.name}: {what} {i}", unit, sizes.meshes, of_meshes)
            for (what, unit), each in values.items()
            # As many as all meshes have.
            for i, of_meshes in enumerate(zip(*each, strict=False), start=1)
        ]


def at_point(system: GapSystem, point: Point) -> GapSystem:
    """The system with another play and load, its coordinates as they were."""
    laws = [law.behind(0.5 * point.play) for law in system.laws]
    return replace(system, laws=laws, load=point.load * system.load)


def in_space(case: Case) -> Case:
    """The case with play and half its load sideways, too."""
    joints = tuple(joint.model_copy(update={"lateral_play": joint.play}) for joint in case.joints)
    segments = tuple(
        segment.model_copy(update={"lateral_load": 0.5 * segment.load}) for segment in case.segments
    )
    return case.model_copy(update={"joints": joints, "segments": segments})


def measure(
    name: str, case: Case, points: Sequence[Point], duration: float, sizes: Sizes
) -> Contact:
    """All points on all meshes."""
    boom, shell = build_boom(case), shell_of(case)
    systems = [gap_system(case, boom, finer(shell, part)) for part in sizes.meshes]
    tasks = [at_point(system, point) for point in points for system in systems]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        moved = list(pool.map(lambda task: Moved.of(task, duration, sizes.peaks), tasks))
    count = len(systems)
    return Contact(
        name, {point: moved[count * i : count * (i + 1)] for i, point in enumerate(points)}
    )


def summary_table(contacts: Sequence[Contact], sizes: Sizes) -> Table:
    """The largest changes of each way to touch."""
    rows: list[Sequence[Cell]] = []
    for contact in contacts:
        read: list[Callable[[Point], float]] = [
            *(partial(contact.peak_change, which=which) for which in range(sizes.peaks)),
            contact.force_change,
            contact.tip_change,
        ]
        worst = [contact.worst(change) for change in read]
        changes = [100.0 * change for change, _ in worst]
        rows.append((contact.name, len(contact.moved), *changes, str(worst[-1][1])))
    return Table(
        "working-load",
        "From the default mesh to one with all edges half as long",
        {
            "contact": "",
            "points": ".0f",
            **{f"peak {which}\n(%)": ".2f" for which in range(1, sizes.peaks + 1)},
            "pad forces\n(%)": ".2f",
            "tip, part of\nits range (%)": ".2f",
            "where": "",
        },
        rows,
        (
            f"The largest change over plays of {1e3 * min(sizes.plays):g} to "
            f"{1e3 * max(sizes.plays):g} mm and loads of {min(sizes.loads):g} to "
            f"{max(sizes.loads):g} times the paper's, with its friction, over {sizes.duration:g} s "
            f"(in space {sizes.spatial_duration:g} s). A pad force is the largest mean over "
            f"{HELD} ms.",
        ),
    )


def point_table(contact: Contact) -> Table:
    """First peaks and the changes at every point of one way to touch, a row each."""
    return Table(
        f"points-{contact.name.replace(' ', '-')}",
        f"Every point, {contact.name}",
        {
            "point": "",
            "first peak (mm)": ".1f",
            "its change (%)": ".3f",
            "tip (% of range)": ".2f",
            "largest pad force (kN)": ".4g",
        },
        [
            (
                str(point),
                1e3 * meshes[-2].peak(),
                100.0 * contact.peak_change(point),
                100.0 * contact.tip_change(point),
                1e-3 * float(meshes[-1].forces.max()),
            )
            for point, meshes in contact.moved.items()
        ],
    )


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """The paper's boom with friction under working loads, on three meshes."""
    sizes = sizes or Sizes()
    case = friction_case()
    every = [Point(*point) for point in product(sizes.plays, sizes.loads)]
    padded = {
        f"pads of {length:g} m x {width:g} m": with_pads(case, length, width)
        for length, width in sizes.pads
    }
    contacts = []
    for name, touching in {"near webs": case, **padded}.items():
        tell(name)
        contacts.append(measure(name, touching, every, sizes.duration, sizes))
    tell("in space")
    contacts.append(
        measure(
            "in space, near webs",
            in_space(case),
            sizes.in_space,
            sizes.spatial_duration,
            sizes,
        )
    )
    title = "Where refinement leads, at the largest play and load"
    hardest = [one for contact in contacts for one in contact.hardest(sizes)]
    note = "Order, Richardson's limit and the grid convergence index as for the paper's load."
    return Study(
        "working-load",
        "Meshes under working loads",
        [
            summary_table(contacts, sizes),
            *map(point_table, contacts),
            refined_table("working-load-limits", title, hardest, "edges × {:g}", (note,)),
        ],
        [proof for contact in contacts for proof in contact.proofs],
    )
