# SPDX-License-Identifier: LGPL-3.0-or-later
"""How near a beam that a shell calibrates comes to that shell.

The paper's boom with friction over plays and loads up to ten times the paper's, near webs and with
pads: textbook beams, the beam with springs, the beam with the fields of its section, and between
them the shell in ever more of its coordinates. All share one mesh: what they are held against is
the shell of that mesh, whose own error is another study's (``working_load``).
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter

import numpy as np

from dynamics.condensation import condensed
from dynamics.damping import pressed_modes
from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from runs.case.build import build_boom
from runs.case.kinds.finite_element import FIELDS, FiniteElementTable
from runs.case.kinds.model import Built
from runs.case.schema import Case, Model
from runs.folder.cache import Cache
from runs.pipeline.models import build, workshop
from runs.report.tables import Cell, Table
from runs.studies.mesh import peak_heights
from runs.studies.motions import friction_case, model_of, move, shell_of
from runs.studies.pads import with_pads
from runs.studies.study import Plot, Proof, Study
from runs.studies.working_load import Point, at_point

# What is allowed of the tip, as parts of its range, of first peaks, and of frequencies.
SPRINGS, FIELDED, PEAK, FREQUENCY = 0.025, 0.01, 0.003, 0.001
# Frequencies of the pressed boom that springs and fields are to keep; those beyond have the inertia
# of the section in them.
OF_SPRINGS, OF_FIELDS = 2, 6
SHELL, EULER, PLAIN = "shell", "Euler–Bernoulli", "Timoshenko"
SPRUNG, WITH_FIELDS = "with springs", "with section fields"


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        mesh_size: of the shells in m.
        plays: 2Δ in m.
        loads: over the paper's.
        pad: length and width in m.
        coordinates: of each segment of shells in fewer of them.
        duration: in s.
    """

    mesh_size: float = 0.2
    plays: Sequence[float] = (0.0, 2.0e-3, 4.0e-3, 7.0e-3, 10.0e-3, 14.0e-3)
    loads: Sequence[float] = (1.0, 3.0, 10.0)
    pad: tuple[float, float] = (0.1, 0.06)
    coordinates: Sequence[int] = (10, 20)
    duration: float = 5.0


@dataclass(frozen=True, slots=True)
class Moved:
    """A model over all points.

    Args:
        tips: (num_points, num_times) in m.
        peaks: (num_points,) heights of the first ones in m.
        seconds: that all motions have taken, on one core each.
    """

    tips: Array
    peaks: Array
    seconds: float

    @classmethod
    def of(cls, system: GapSystem, points: Sequence[Point], duration: float) -> Moved:
        """From rest, in s."""

        def one(point: Point) -> tuple[Array, float, float]:
            begin = perf_counter()
            motion = move(at_point(system, point), duration)
            seconds = perf_counter() - begin
            heights = peak_heights(motion)
            return np.asarray(motion.data["tip"].values), (heights or [np.nan])[0], seconds

        with ThreadPoolExecutor(os.cpu_count()) as pool:
            tips, peaks, seconds = zip(*pool.map(one, points), strict=True)
        return cls(np.array(tips), np.array(peaks), sum(seconds))

    def off(self, shell: Moved) -> Array:
        """(num_points,) the tip's largest distance as a part of the shell's range."""
        return np.asarray(np.abs(self.tips - shell.tips).max(axis=1) / np.ptp(shell.tips, axis=1))

    def peaks_off(self, shell: Moved) -> Array:
        """(num_points,) relative errors of the first peaks."""
        return np.asarray(np.abs(self.peaks / shell.peaks - 1.0))


@dataclass(frozen=True, slots=True)
class Compared:
    """All models of one way to touch.

    Args:
        where: segments touch.
        points: of all motions.
        systems, moved: by the name of the model, the shell's first.
        seconds: of its reduction, and of the calibration.
    """

    where: str
    points: Sequence[Point]
    systems: Mapping[str, GapSystem]
    moved: Mapping[str, Moved]
    seconds: tuple[float, float]

    def off(self, name: str) -> Array:
        """(num_points,) see :class:`Moved`."""
        return self.moved[name].off(self.moved[SHELL])

    def peaks_off(self, name: str) -> float:
        """The worst of all points that have a first peak."""
        return float(np.nanmax(self.moved[name].peaks_off(self.moved[SHELL])))

    def frequencies_off(self, name: str, count: int) -> float:
        """The worst relative error of the first frequencies with the joints pressed."""
        # At rest without play all that presses is pressed.
        point = self.points[0]._replace(play=0.0)
        pressed = [
            pressed_modes(at_point(self.systems[one], point))[0][:count] for one in (SHELL, name)
        ]
        return float(np.abs(pressed[1] / pressed[0] - 1.0).max())

    def rows(self) -> list[Sequence[Cell]]:
        """A row of every model."""
        plain = self.moved[PLAIN].seconds
        return [
            (
                self.where,
                name,
                self.systems[name].num_modes,
                100.0 * self.off(name).max(),
                100.0 * float(np.median(self.off(name))),
                str(self.points[int(self.off(name).argmax())]),
                100.0 * self.peaks_off(name),
                100.0 * self.frequencies_off(name, OF_SPRINGS),
                moved.seconds / plain,
            )
            for name, moved in self.moved.items()
            if name != SHELL
        ]

    def proofs(self) -> list[Proof]:
        """What is asked of springs and of fields."""
        source = "the shell that calibrates it"
        found = []
        for name, allowed, count in (
            (SPRUNG, SPRINGS, OF_SPRINGS),
            (WITH_FIELDS, FIELDED, OF_FIELDS),
        ):
            worst, point = self.off(name).max(), self.points[int(self.off(name).argmax())]
            for what, value, bar in (
                (f"tip, part of its range, worst of {len(self.points)} points ({point})",
                 float(worst), allowed),
                ("first tip peak, worst of all", self.peaks_off(name), PEAK),
                (f"first {count} frequencies, joints pressed", self.frequencies_off(name, count),
                 FREQUENCY),
            ):  # fmt: skip
                title = f"beam {name}, {self.where}: {what}"
                found.append(Proof(title, value, 0.0, "", "other code", source, bar))
        return found


def calibrated(case: Case, model: Model, fields: bool) -> Model:
    """A beam that a shell of the case calibrates, with its contact."""
    return FiniteElementTable.model_validate(
        {
            "name": "calibrated",
            "kind": "finite-element",
            "calibrated_by": model.model_dump(exclude_none=True),
            "section_fields": fields,
            "contact": model.contact,
        }
    )


def measure(case: Case, where: str, sizes: Sizes) -> Compared:
    """All models at all points."""
    from mpi4py import MPI

    boom = build_boom(case)
    shell = shell_of(case).model_copy(update={"mesh_size": sizes.mesh_size})
    models = {
        SHELL: shell,
        EULER: model_of(case, "beam-fe-rotary"),
        PLAIN: model_of(case, "timoshenko"),
        SPRUNG: calibrated(case, shell, fields=False),
        WITH_FIELDS: calibrated(case, shell, fields=True),
    }
    built: dict[str, Built] = {}
    with TemporaryDirectory(prefix="protractile-") as scratch:
        cache = Cache(Path(scratch) / "cache")
        for name, model in models.items():
            tools = workshop(MPI.COMM_SELF, Path(scratch) / name, cache=cache)
            built[name] = build(case, boom, model, tools)
    systems = {name: one.system for name, one in built.items()}
    for count in sizes.coordinates:
        fewer, _ = condensed(systems[SHELL], count * len(boom.segments))
        systems[f"section fields, {count} coordinates a segment"] = fewer
    points = [Point(*point) for point in product(sizes.plays, sizes.loads)]
    moved = {name: Moved.of(system, points, sizes.duration) for name, system in systems.items()}
    reduction = built[SHELL].seconds["reduction"]
    calibration = built[SHELL].seconds["far field"] + built[SPRUNG].seconds["calibration"]
    return Compared(where, points, systems, moved, (reduction, calibration))


def summary_table(compared: Sequence[Compared], sizes: Sizes) -> Table:
    """A row of every model and way to touch."""
    return Table.of_rows(
        "calibrated-beams",
        "Beams against the shell that calibrates them",
        {
            "contact": "",
            "model": "",
            "coordinates": ".0f",
            "tip, worst\n(% of range)": ".2f",
            "tip, median\n(% of range)": ".2f",
            "worst at": "",
            "first peak,\nworst (%)": ".3f",
            f"first {OF_SPRINGS} frequencies,\npressed (%)": ".3f",
            "time over\nTimoshenko's": ".2f",
        },
        [row for one in compared for row in one.rows()],
        (
            f"Plays of {1e3 * min(sizes.plays):g} to {1e3 * max(sizes.plays):g} mm, loads of "
            f"{min(sizes.loads):g} to {max(sizes.loads):g} times the paper's, with its friction, "
            f"{sizes.duration:g} s, shells of {sizes.mesh_size:g} m.",
            *(
                f"{one.where}: reduction {one.seconds[0]:.1f} s, "
                f"calibration {one.seconds[1]:.1f} s."
                for one in compared
            ),
        ),
    )


def point_table(compared: Compared) -> Table:
    """Every point of one way to touch, a column for each model."""
    names = [name for name in compared.moved if name != SHELL]
    rows = zip(map(str, compared.points), *(100.0 * compared.off(n) for n in names), strict=True)
    return Table.of_rows(
        f"calibrated-beams-{compared.where.split()[0]}",
        f"The tip off the shell's, {compared.where} (% of its range)",
        {"point": "", **dict.fromkeys(names, ".2f")},
        [tuple(row) for row in rows],
    )


def plot(compared: Sequence[Compared]) -> Plot:
    """Coordinates of a segment against the worst error."""
    curves = {}
    for one in compared:
        for name in (PLAIN, SPRUNG):
            size, off = one.systems[name].num_modes / 2.0, 100.0 * float(one.off(name).max())
            curves[f"{one.where}: {name}"] = ([size], [off])
        fielded = [name for name in one.moved if "fields" in name]
        sizes = [one.systems[name].num_modes / 2.0 for name in fielded]
        worst = [100.0 * float(one.off(name).max()) for name in fielded]
        order = np.argsort(sizes)
        curves[f"{one.where}: section fields"] = (
            [sizes[i] for i in order],
            [worst[i] for i in order],
        )
    return Plot(
        "calibrated-beams",
        "Springs bring a beam within 2 % of its shell, fields of the section within 1 %",
        "coordinates of each segment",
        "tip off the shell's, worst of all points (% of its range)",
        curves,
        f"Single marks: beams as they are, and with springs. Lines: the shell in fewer of its own "
        f"coordinates, of which a beam with section fields has {FIELDS}.",
    )


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """The paper's boom with friction, near its webs and with pads."""
    sizes = sizes or Sizes()
    case = friction_case()
    compared = []
    for where, touching in (
        ("near webs", case),
        ("with pads of {:g} x {:g} m".format(*sizes.pad), with_pads(case, *sizes.pad)),
    ):
        tell(where)
        compared.append(measure(touching, where, sizes))
    return Study(
        "calibrated-beams",
        "Beams that a shell calibrates",
        [summary_table(compared, sizes), *map(point_table, compared)],
        [proof for one in compared for proof in one.proofs()],
        [plot(compared)],
    )
