# SPDX-License-Identifier: LGPL-3.0-or-later
"""What of the distance from the paper's series to the shell each thing makes.

One thing after another is changed that the series leaves out and the shell has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.case.schema import Case
from runs.report.tables import TextTable
from runs.studies.motions import (
    CASE,
    SLOW,
    compliance,
    friction_case,
    gap_system,
    model_of,
    trajectories,
)
from runs.studies.study import Study

# From the paper's series to the shell: what is changed, and the model that has it.
WALK = (
    ("the paper's five-term series", "kantorovich-5"),
    ("linear contact", "kantorovich-5-linear"),
    ("more terms", "kantorovich-24-printed"),
    ("a complete base", "kantorovich-24"),
    ("beam elements", "beam-fe"),
    ("rotary inertia", "beam-fe-rotary"),
    ("shear", "timoshenko"),
    ("local flexibility", "timoshenko-local"),
    ("section distortion", "timoshenko-distorting"),
    ("plates", "shell"),
)
# Up to when the walk is to explain all but a hundredth, in s.
EXPLAINED = 5.0


@dataclass(frozen=True, slots=True)
class Step:
    """A step of the walk from the series to the shell.

    Args:
        what: is changed.
        model: that has it.
        changes: largest difference from the model before, up to ``EXPLAINED`` and to the end, as
            parts of the shell's range.
        left: the same from the shell.
    """

    what: str
    model: str
    changes: tuple[float, float]
    left: tuple[float, float]


def walk(case: Case) -> list[Step]:
    """Measure each step of ``WALK``.

    Args:
        case: with its models.
    """
    names = [name for _, name in WALK]
    runs = trajectories(case_file.select(case, str(CASE), names))
    # A selection keeps the case's order.
    order = [model.name for model in case.models if model.name in names]
    tip = {name: run.data["tip"].values for name, run in zip(order, runs, strict=True)}
    shell = tip[names[-1]]
    early = case.time.output_step * np.arange(shell.size) <= EXPLAINED

    def apart(one: str, other: str) -> tuple[float, float]:
        distance = np.abs(tip[one] - tip[other]) / np.ptp(shell)
        return float(distance[early].max()), float(distance.max())

    before = [names[0], *names[:-1]]
    return [
        Step(what, name, apart(name, previous), apart(name, names[-1]))
        for (what, name), previous in zip(WALK, before, strict=True)
    ]


def walk_table(steps: Sequence[Step]) -> TextTable:
    """One row a step."""

    def percent(parts: tuple[float, float]) -> list[str]:
        return [f"{100.0 * part:.2f}" for part in parts]

    return TextTable(
        "From the paper's series to the shell",
        (
            "with",
            "model",
            f"changes, to {EXPLAINED:g} s (% of the range)",
            "to the end",
            f"left to the shell, to {EXPLAINED:g} s",
            "to the end",
        ),
        [(step.what, step.model, *percent(step.changes), *percent(step.left)) for step in steps],
        name="walk",
    )


def flexibilities(case: Case) -> TextTable:
    """How much more a shell's stations give way than those of Timoshenko's beam.

    Args:
        case: with both, in the plane.
    """
    boom = build_boom(case)
    stiff = gap_system(case, boom, model_of(case, "timoshenko"))
    soft = gap_system(case, boom, model_of(case, "shell"))
    rigid = compliance(stiff, stiff.rows)
    together = compliance(soft, soft.friction_rows) - rigid
    upper = [int(np.argmax(soft.station_of_row == i)) for i in range(len(soft.stations))]
    alone = compliance(soft, soft.rows[upper]) - rigid
    return TextTable(
        "Flexibility of the shell's stations beyond Timoshenko's beam",
        ("x (m)", "both flanges together (m/N)", "one flange more (m/N)"),
        [
            (f"{x:g}", f"{both:.2e}", f"{one - both:.2e}")
            for x, both, one in zip(soft.stations, together, alone, strict=True)
        ],
        (f"Read at σ = (2π · {SLOW:g} Hz)², with every segment free of the others.",),
        name="flexibility",
    )


def study(tell: Callable[[str], None]) -> Study:
    """The walk, and how much more the shell's stations give way than a beam's."""
    case = friction_case()
    tell("the models from the series to the shell")
    steps = walk(case)
    tell("flexibility of the stations")
    return Study(
        name="walk",
        title="From the paper's series to the shell",
        tables=[walk_table(steps), flexibilities(case)],
        data={"walk": [asdict(step) for step in steps]},
    )
