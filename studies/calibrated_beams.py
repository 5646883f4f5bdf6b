# SPDX-License-Identifier: LGPL-3.0-or-later
"""Accuracy of calibrated beams relative to the shell that calibrates them.

The study runs the paper's boom with friction for several plays, and for loads up to ten times the
paper's, with contact near webs and at pads. It compares textbook beams, the beam with springs, the
beam with section fields, and shells with different numbers of coordinates. The reference is the
shell of the same mesh. The study ``working_load`` measures the error of this shell.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.reduction import condense
from protractile.geometry.arrays import Array
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.schema import Case, Model
from protractile.runs.report.tables import Cell, Table
from studies.motions import build_all, friction_case, model_of, run_parallel, shell_of, with_pads
from studies.study import Criterion, Piece, Progress, Verification, define_study
from studies.working_load import Point, PointMotion, set_point

# Permitted errors of the tip as fractions of its range, of first peaks, and of frequencies.
SPRINGS, FIELDED, PEAK, FREQUENCY = 0.025, 0.01, 0.003, 0.001
# Number of frequencies with closed contacts that springs and fields preserve; higher ones depend on
# the inertia of the section.
OF_SPRINGS, OF_FIELDS = 2, 6
SHELL, EULER, PLAIN = "shell", "Euler–Bernoulli", "Timoshenko"
SPRUNG, WITH_FIELDS = "with springs", "with section fields"


class Sizes(NamedTuple):
    """Parameters of the study."""

    mesh_size: float = 0.2  #: edge length of the shells in m
    plays: Sequence[float] = (0.0, 2.0e-3, 4.0e-3, 7.0e-3, 10.0e-3, 14.0e-3)  #: 2Δ in m
    loads: Sequence[float] = (1.0, 3.0, 10.0)  #: loads over the paper's
    pad: tuple[float, float] = (0.1, 0.06)  #: length and width of pads in m
    coordinates: Sequence[int] = (
        10,
        20,
    )  #: numbers of coordinates of each segment of reduced shells
    duration: float = 5.0  #: duration of the motions in s


def move_all(
    systems: Mapping[str, GapSystem], points: Sequence[Point], duration: float
) -> dict[str, list[PointMotion]]:
    """Return the motions of each system at all points, by name; the duration is in s."""
    return {
        name: run_parallel(
            partial(PointMotion.of, duration=duration),
            (set_point(system, point) for point in points),
        )
        for name, system in systems.items()
    }


def tip_errors(moved: Sequence[PointMotion], shell: Sequence[PointMotion]) -> Array:
    """Return the largest deviations (num_points,) of the tip as fractions of the shell's range."""
    return np.array([one.tip_error(other) for one, other in zip(moved, shell, strict=True)])


def peak_errors(moved: Sequence[PointMotion], shell: Sequence[PointMotion]) -> Array:
    """Return the relative errors (num_points,) of the first peaks; NaN without a peak."""
    return np.array([one.peak_errors(other)[0] for one, other in zip(moved, shell, strict=True)])


class ModelComparison(NamedTuple):
    """Results of all models with one type of contact."""

    where: str  #: contact of the segments, in words
    points: Sequence[Point]  #: points of all motions
    #: Motions by the name of the model, the shell's first.
    systems: Mapping[str, GapSystem]
    moved: Mapping[str, Sequence[PointMotion]]
    seconds: tuple[float, float]  #: wall time of the reduction, and of the calibration

    def off(self, name: str) -> Array:
        """Return the errors (num_points,) of the tip, as fractions of the shell's range."""
        return tip_errors(self.moved[name], self.moved[SHELL])

    def peak_errors(self, name: str) -> float:
        """Return the largest error of the first peak over all points that have one."""
        return float(np.nanmax(peak_errors(self.moved[name], self.moved[SHELL])))

    def frequencies_off(self, name: str, count: int) -> float:
        """Return the largest relative error of the first frequencies with closed contacts."""
        # At rest without play all contacts are closed.
        point = self.points[0]._replace(play=0.0)
        pressed = [
            closed_contact_modes(set_point(self.systems[one], point))[0][:count]
            for one in (SHELL, name)
        ]
        return float(np.abs(pressed[1] / pressed[0] - 1.0).max())

    def rows(self) -> Iterator[Sequence[Cell]]:
        """Yield a row of the table for every model but the shell."""
        seconds = {name: sum(one.seconds for one in moved) for name, moved in self.moved.items()}
        for name, system in self.systems.items():
            if name == SHELL:
                continue
            off = self.off(name)
            yield (
                self.where,
                name,
                system.num_modes,
                100.0 * off.max(),
                100.0 * float(np.median(off)),
                str(self.points[int(off.argmax())]),
                100.0 * self.peak_errors(name),
                100.0 * self.frequencies_off(name, OF_SPRINGS),
                seconds[name] / seconds[PLAIN],
            )

    def verifications(self) -> Iterator[Verification]:
        """Yield the verifications of the beam with springs and of the beam with section fields."""
        for name, allowed, count in (
            (SPRUNG, SPRINGS, OF_SPRINGS),
            (WITH_FIELDS, FIELDED, OF_FIELDS),
        ):
            off = self.off(name)
            point = self.points[int(off.argmax())]
            for what, value, bar in (
                (f"tip, part of its range, worst of {len(self.points)} points ({point})",
                 float(off.max()), allowed),
                ("first tip peak, worst of all", self.peak_errors(name), PEAK),
                (f"first {count} frequencies, joints pressed", self.frequencies_off(name, count),
                 FREQUENCY),
            ):  # fmt: skip
                criterion: Criterion = ("other code", "the shell that calibrates it", bar)
                yield Verification(f"beam {name}, {self.where}: {what}", value, 0.0, "", *criterion)


def calibrated_beam(case: Case, model: Model, fields: bool) -> Model:
    """Return a beam that a shell of the case calibrates, with the shell's contact."""
    return BeamElements.model_validate(
        {
            "name": "calibrated_beam",
            "kind": "finite-element",
            "calibrated_by": model.model_dump(exclude_none=True),
            "section_fields": fields,
            "contact": model.contact,
        }
    )


def measure(case: Case, where: str, sizes: Sizes) -> ModelComparison:
    """Return the results of all models at all points, for one type of contact."""
    shell = shell_of(case).model_copy(update={"mesh_size": sizes.mesh_size})
    models = {
        SHELL: shell,
        EULER: model_of(case, "beam-fe-rotary"),
        PLAIN: model_of(case, "timoshenko"),
        SPRUNG: calibrated_beam(case, shell, fields=False),
        WITH_FIELDS: calibrated_beam(case, shell, fields=True),
    }
    built = build_all(case, models)
    systems = {name: one.system for name, one in built.items()}
    for count in sizes.coordinates:
        fewer, _ = condense(systems[SHELL], count * len(case.segments))
        systems[f"section fields, {count} coordinates a segment"] = fewer
    points = Point.each(sizes.plays, sizes.loads)
    moved = move_all(systems, points, sizes.duration)
    reduction = built[SHELL].seconds["reduction"]
    calibration = built[SPRUNG].seconds["calibration"]
    return ModelComparison(where, points, systems, moved, (reduction, calibration))


def summary_table(compared: Sequence[ModelComparison], sizes: Sizes) -> Table:
    """Return the table of largest errors, with a row for each model and type of contact."""
    columns = {
        "contact": "", "model": "", "coordinates": ".0f", "tip, worst\n(% of range)": ".2f",
        "tip, median\n(% of range)": ".2f", "worst at": "", "first peak,\nworst (%)": ".3f",
        f"first {OF_SPRINGS} frequencies,\npressed (%)": ".3f", "time over\nTimoshenko's": ".2f",
    }  # fmt: skip
    return Table.of_rows(
        "calibrated_beam-beams",
        "Beams against the shell that calibrates them",
        columns,
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


def point_table(compared: ModelComparison) -> Table:
    """Return the table of errors at all points for a type of contact, a column for each model."""
    names = [name for name in compared.moved if name != SHELL]
    rows = zip(map(str, compared.points), *(100.0 * compared.off(n) for n in names), strict=True)
    return Table.of_rows(
        f"calibrated_beam-beams-{compared.where.split()[0]}",
        f"The tip off the shell's, {compared.where} (% of its range)",
        {"point": "", **dict.fromkeys(names, ".2f")},
        [tuple(row) for row in rows],
    )


@define_study("calibrated_beam-beams", "Beams that a shell calibrates")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Study the paper's boom with friction, near its webs and with pads."""
    sizes = sizes or Sizes()
    case = friction_case()
    compared = []
    for where, touching in (
        ("near webs", case),
        ("with pads of {:g} x {:g} m".format(*sizes.pad), with_pads(case, *sizes.pad)),
    ):
        progress(where)
        compared.append(measure(touching, where, sizes))
    yield summary_table(compared, sizes)
    for one in compared:
        yield point_table(one)
        yield from one.verifications()
