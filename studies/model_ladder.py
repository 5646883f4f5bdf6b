# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contributions of single model features to the difference between series and shell.

Features that the shell has and the series lacks are added one after another.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from runs.case import reading as case_file
from runs.case.schema import Case
from runs.report.tables import Table
from studies.motions import CASE, friction_case, trajectories
from studies.study import Progress, define_study

# From the paper's series to the shell: change, and model with it.
LADDER = (
    ("the paper's five-term series", "kantorovich-5"),
    ("linear contact", "kantorovich-5-linear"),
    ("more terms", "kantorovich-24-printed"),
    ("a complete base", "kantorovich-24"),
    ("beam elements", "beam-fe"),
    ("rotary inertia", "beam-fe-rotary"),
    ("shear", "timoshenko"),
    ("local flexibility", "timoshenko-local"),
    ("section distortion", "timoshenko-distorting"),
    ("stiffness and springs read from the shell", "sprung"),
    ("fields of its section", "fielded"),
    ("plates", "shell"),
)
# Up to when the ladder is to explain all but a hundredth, in s.
EXPLAINED = 5.0


def ladder_table(case: Case) -> Table:
    """Compare the rungs of ``LADDER``: change of the tip, and remaining difference to the shell.

    Differences are the largest ones, as parts of the shell's range.

    Args:
        case: with its models.
    """
    names = [name for _, name in LADDER]
    runs = trajectories(case_file.select(case, str(CASE), names))
    # A selection keeps the case's order.
    order = [model.name for model in case.models if model.name in names]
    tip = {name: run.data["tip"].values for name, run in zip(order, runs, strict=True)}
    shell = tip[names[-1]]
    early = case.time.output_step * np.arange(shell.size) <= EXPLAINED

    def apart(one: str, other: str) -> tuple[float, float]:
        distance = 100.0 * np.abs(tip[one] - tip[other]) / np.ptp(shell)
        return float(distance[early].max()), float(distance.max())

    before = [names[0], *names[:-1]]
    columns = {
        "with": "", "model": "", f"changes, to {EXPLAINED:g} s (% of the range)": ".2f",
        "changes, to the end": ".2f", f"left to the shell, to {EXPLAINED:g} s": ".2f",
        "left, to the end": ".2f",
    }  # fmt: skip
    return Table.of_rows(
        "ladder",
        "From the paper's series to the shell",
        columns,
        [
            (what, name, *apart(name, previous), *apart(name, names[-1]))
            for (what, name), previous in zip(LADDER, before, strict=True)
        ],
    )


@define_study("model-ladder", "From the paper's series to the shell")
def study(progress: Progress) -> Iterator[Table]:
    """Run the ladder."""
    progress("the models from the series to the shell")
    yield ladder_table(friction_case())
