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
import numpy.typing as npt

from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from dynamics.splitting import integrate
from dynamics.step import contact_step
from runs.case.build import build_boom
from runs.case.schema import Case
from runs.report.tables import TextTable
from runs.report.theme import fixed, number
from runs.studies.grid_convergence import GridConvergence
from runs.studies.mesh import RATIO, peak_heights
from runs.studies.motions import finer, friction_case, gap_system, shell_of
from runs.studies.pads import with_pads
from runs.studies.study import Proof, Study

Array = npt.NDArray[np.float64]

OUTPUT_STEP = 1.0e-3
# Of the highest frequency of the contacts, see dynamics.step: about the step of the case itself. A
# third of it changes the tip by 0.02 % of its range in a second at the paper's play and ten times
# its load.
PHASE = 0.2
# What is allowed of the first peak and of the tip, near webs and with pads, which give way more.
NEAR_WEBS, WITH_PADS = (0.002, 0.02), (0.002, 0.02)
# Outputs over which a pad's force is averaged: single blows are a matter of microseconds.
HELD = 20


class Point(NamedTuple):
    """Play in m, and load over the paper's."""

    play: float
    load: float


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

    @property
    def points(self) -> list[Point]:
        """Every play with every load."""
        return [Point(*point) for point in product(self.plays, self.loads)]


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


@dataclass(frozen=True, slots=True)
class Contact:
    """A way to touch on every mesh.

    Args:
        name: of it.
        allowed: of the first peak, and of the tip as a part of its range.
        moved: point → its motions, from the coarsest mesh to the finest.
    """

    name: str
    allowed: tuple[float, float]
    moved: Mapping[Point, Sequence[Moved]]

    def peak_change(self, point: Point, which: int = 0) -> float:
        """Relative change of a peak from the default mesh to the finest; NaN without it."""
        peaks = [moved.peaks for moved in self.moved[point][-2:]]
        if any(len(found) <= which for found in peaks):
            return float("nan")
        default, fine = (found[which] for found in peaks)
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


def _systems(case: Case, sizes: Sizes) -> list[GapSystem]:
    shell = shell_of(case)
    boom = build_boom(case)
    return [gap_system(case, boom, finer(shell, part)) for part in sizes.meshes]


def _move(system: GapSystem, duration: float, peaks: int) -> Moved:
    step = contact_step(system, OUTPUT_STEP, phase=PHASE)
    motion = integrate(Motion(system, duration, OUTPUT_STEP), step)
    forces = motion.data["contact_force"].values
    held = np.cumsum(np.pad(forces, ((1, 0), (0, 0))), axis=0)
    means = (held[HELD:] - held[:-HELD]) / HELD
    return Moved(
        np.asarray(motion.data["tip"].values),
        peak_heights(motion)[:peaks],
        np.abs(means).max(axis=0),
    )


def measure(
    name: str,
    case: Case,
    points: Sequence[Point],
    duration: float,
    allowed: tuple[float, float],
    sizes: Sizes,
) -> Contact:
    """All points on all meshes."""
    systems = _systems(case, sizes)
    tasks = [at_point(system, point) for point in points for system in systems]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        moved = list(pool.map(lambda task: _move(task, duration, sizes.peaks), tasks))
    count = len(systems)
    return Contact(
        name,
        allowed,
        {point: moved[count * i : count * (i + 1)] for i, point in enumerate(points)},
    )


def summary_table(contacts: Sequence[Contact], sizes: Sizes) -> TextTable:
    """The largest changes of each way to touch."""
    rows = []
    for contact in contacts:
        changes: list[Callable[[Point], float]] = [
            *(partial(contact.peak_change, which=which) for which in range(sizes.peaks)),
            contact.force_change,
            contact.tip_change,
        ]
        worst = [contact.worst(change) for change in changes]
        rows.append(
            (
                contact.name,
                str(len(contact.moved)),
                *(fixed(change, 2, 100.0) for change, _ in worst),
                _label(worst[-1][1]),
            )
        )
    return TextTable(
        "From the default mesh to one with all edges half as long",
        (
            "contact",
            "points",
            *(f"peak {which}\n(%)" for which in range(1, sizes.peaks + 1)),
            "pad forces\n(%)",
            "tip, part of\nits range (%)",
            "where",
        ),
        rows,
        (
            f"The largest change over plays of {1e3 * min(sizes.plays):g} to "
            f"{1e3 * max(sizes.plays):g} mm and loads of {min(sizes.loads):g} to "
            f"{max(sizes.loads):g} times the paper's, with its friction, over {sizes.duration:g} s "
            f"(in space {sizes.spatial_duration:g} s). A pad force is the largest mean over "
            f"{HELD} ms.",
        ),
        name="working-load",
    )


def point_table(contact: Contact, sizes: Sizes) -> TextTable:
    """First peaks and the tip's change at every point of one way to touch."""
    rows = []
    for play in sizes.plays:
        points = [Point(play, load) for load in sizes.loads]
        rows.append(
            (
                f"{1e3 * play:g}",
                *(fixed(contact.moved[p][-2].peaks[0], 1, 1e3) for p in points),
                *(fixed(contact.peak_change(p), 3, 100.0) for p in points),
                *(fixed(contact.tip_change(p), 2, 100.0) for p in points),
            )
        )
    return TextTable(
        f"Every point, {contact.name}",
        (
            "play (mm)",
            *(f"first peak (mm)\nload × {load:g}" for load in sizes.loads),
            *(f"its change (%)\nload × {load:g}" for load in sizes.loads),
            *(f"tip (% of range)\nload × {load:g}" for load in sizes.loads),
        ),
        rows,
        name=f"points-{contact.name.replace(' ', '-')}",
    )


def limit_table(contacts: Sequence[Contact], sizes: Sizes) -> TextTable:
    """Peaks and pad forces on every mesh, and where refinement leads them, at the hardest point."""
    rows = []
    for contact in contacts:
        point = max(contact.moved, key=lambda p: (p.load, p.play))
        meshes = contact.moved[point]
        peaks = min(len(moved.peaks) for moved in meshes)
        quantities = {
            **{
                f"tip peak {i} (mm)": [1e3 * m.peaks[i - 1] for m in meshes]
                for i in range(1, peaks + 1)
            },
            **{
                f"pad force {i} (kN)": [1e-3 * float(m.forces[i - 1]) for m in meshes]
                for i in range(1, meshes[0].forces.size + 1)
            },
        }
        for what, values in quantities.items():
            found = GridConvergence.of(values, RATIO)
            rows.append(
                (
                    f"{contact.name}: {what}",
                    *(number(value, 5) for value in values),
                    fixed(found.order, 2),
                    number(found.limit, 5),
                    fixed(found.index, 3, 100.0),
                )
            )
    return TextTable(
        "Where refinement leads, at the largest play and load",
        (
            "quantity",
            *(f"edges × {part:g}" for part in sizes.meshes),
            "order",
            "limit",
            "GCI (%)",
        ),
        rows,
        ("Order, Richardson's limit and the grid convergence index as for the paper's load.",),
        name="working-load-limits",
    )


def proofs(contacts: Sequence[Contact]) -> list[Proof]:
    """First peaks and tips of the default mesh against half of all edges."""
    found = []
    for contact in contacts:
        count = len(contact.moved)
        for what, change, allowed in (
            ("first tip peak", contact.peak_change, contact.allowed[0]),
            ("tip, part of its range", contact.tip_change, contact.allowed[1]),
        ):
            value, point = contact.worst(change)
            found.append(
                Proof(
                    f"{what}, {contact.name}, worst of {count} points ({_label(point)})",
                    value,
                    0.0,
                    "",
                    "other code",
                    "all edges half as long",
                    allowed,
                )
            )
    return found


def _label(point: Point) -> str:
    return f"{1e3 * point.play:g} mm, load × {point.load:g}"


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """The paper's boom with friction under working loads, on three meshes."""
    sizes = sizes or Sizes()
    case = friction_case()
    contacts = []
    for name, touching, allowed in (
        ("near webs", case, NEAR_WEBS),
        *(
            (
                f"pads of {length:g} m x {width:g} m",
                with_pads(case, length, width),
                WITH_PADS,
            )
            for length, width in sizes.pads
        ),
    ):
        tell(name)
        contacts.append(measure(name, touching, sizes.points, sizes.duration, allowed, sizes))
    tell("in space")
    contacts.append(
        measure(
            "in space, near webs",
            in_space(case),
            sizes.in_space,
            sizes.spatial_duration,
            NEAR_WEBS,
            sizes,
        )
    )
    flat = contacts[:-1]
    return Study(
        name="working-load",
        title="Meshes under working loads",
        tables=[
            summary_table(contacts, sizes),
            *(point_table(contact, sizes) for contact in flat),
            limit_table(contacts, sizes),
        ],
        proofs=proofs(contacts),
        data={
            contact.name: [
                {
                    "play": point.play,
                    "load": point.load,
                    "peaks": [list(moved.peaks) for moved in meshes],
                    "forces": [moved.forces.tolist() for moved in meshes],
                    "tip_change": contact.tip_change(point),
                }
                for point, meshes in contact.moved.items()
            ]
            for contact in contacts
        },
    )
