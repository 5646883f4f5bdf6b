# SPDX-License-Identifier: LGPL-3.0-or-later
"""Convergence of the motion with steps, series, elements and meshes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from runs.case.schema import Case, Model
from runs.report.tables import Cell, Table
from studies.motions import finer, friction_case, model_of, trajectories
from studies.study import Tell, titled

# The models whose integration is refined, its steps in s, and that of all further refinements.
STEPPED = ("kantorovich-5", "kantorovich-24", "timoshenko", "shell")
STEPS = (8.0e-5, 4.0e-5, 2.0e-5, 1.0e-5)
FINE_STEP = 1.0e-5
TERMS = (3, 6, 12, 24)
ELEMENTS = (2.0, 1.0, 0.5, 0.25)
MESHES = (0.4, 0.2, 0.1, 0.05)

NOTE = (
    "Largest difference of the tip over the whole run from that of the next finer one. The order "
    "is that of the differences."
)


def orders(sizes: Sequence[float], differences: Sequence[float]) -> list[float]:
    """Return observed orders: slopes of the differences over the sizes in a log-log plot."""
    slopes = np.diff(np.log(differences)) / np.diff(np.log(sizes[: len(differences)]))
    return [float(order) for order in np.abs(slopes)]


def refine(
    case: Case, name: str, model: Model, sizes: Sequence[float], at: Callable[[Model, float], Model]
) -> list[Sequence[Cell]]:
    """Run one model at several sizes; return a row for each.

    Args:
        case: the model's.
        name: that of the rows.
        model: one of the case.
        sizes: from the coarsest to the finest.
        at: the model at a size.
    """
    refined = tuple(
        at(model, size).model_copy(update={"name": f"{model.name} {i}"})
        for i, size in enumerate(sizes)
    )
    runs = trajectories(case.model_copy(update={"models": refined}))
    tips = np.array([run.data["tip"].values for run in runs])
    apart = (np.abs(np.diff(tips, axis=0)).max(axis=1) / np.ptp(tips[-1])).tolist()
    peaks = [1.0e3 * run.first_peak()[1] for run in runs]
    parts = [*(100.0 * part for part in apart), None]
    slopes = [None, *orders(sizes, apart), None]
    return [(name, *row) for row in zip(sizes, parts, slopes, peaks, strict=True)]


@titled("refinement", "How the motion settles")
def study(tell: Tell) -> Iterator[Table]:
    """Refine steps of all integrations, terms, elements and meshes of the case with friction."""
    case = friction_case()
    rows: list[Sequence[Cell]] = []
    for what, name, sizes, unit, at in (
        *(("step", name, STEPS, " (s)", with_step) for name in STEPPED),
        ("terms of each segment", "kantorovich-24", TERMS, "",
         lambda model, terms: model.model_copy(update={"terms": (round(terms),) * 2})),
        *(
            ("element length", name, ELEMENTS, " (m)",
             lambda model, length: model.model_copy(update={"element_length": length}))
            for name in ("beam-fe", "timoshenko")
        ),
        ("mesh size", "shell", MESHES, " (m)",
         lambda model, size: finer(model, size / model.mesh_size)),
    ):  # fmt: skip
        tell(f"{name}: {what}")
        model = model_of(case, name)
        stepped = model if at is with_step else with_step(model, FINE_STEP)
        rows += refine(case, f"{name}: {what}{unit}", stepped, sizes, at)
    columns = {
        "refined": "", "size": ".3g", "off the next (% of the range)": ".3g", "order": ".2g",
        "first tip peak (mm)": ".2f",
    }  # fmt: skip
    title = "Convergence of the paper's example with friction"
    yield Table.of_rows("convergence", title, columns, rows, (NOTE,))


def with_step(model: Model, step: float) -> Model:
    """Return the model with steps in s."""
    return model.model_copy(update={"step": step})
