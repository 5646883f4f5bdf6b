# SPDX-License-Identifier: LGPL-3.0-or-later
"""How the motion settles as steps, series, elements and meshes refine."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

import numpy as np

from runs.case.kinds.kantorovich import KantorovichTable
from runs.case.kinds.model import of_kind
from runs.case.kinds.shell import ShellTable
from runs.case.schema import Case, Model
from runs.report.tables import TextTable
from runs.report.theme import number
from runs.studies.motions import finer, friction_case, model_of, trajectories
from runs.studies.study import Study

# The models whose integration is refined, and parts of the case's own step.
STEPPED = ("kantorovich-5", "kantorovich-24", "timoshenko", "shell")
STEPS = (1.0, 0.5, 0.25)
# Small enough, in s, for the highest modes of all further refinements.
FINE_STEP = 1.25e-6
TERMS = (3, 6, 12, 24)
ELEMENTS = (2.0, 1.0, 0.5, 0.25)
MESHES = (0.4, 0.2, 0.1, 0.05)


@dataclass(frozen=True, slots=True)
class Refinement:
    """A model with one thing refined.

    Args:
        what: is refined.
        model: its name in the case.
        sizes: of each run, from the coarsest to the finest.
        unit: of the sizes.
        differences: largest difference of each run's tip from the next finer one's, as a part of
            the finest one's range.
        first_peaks: of the tip in m, one for each run.
    """

    what: str
    model: str
    sizes: Sequence[float]
    unit: str
    differences: Sequence[float]
    first_peaks: Sequence[float]

    @property
    def orders(self) -> list[float]:
        """Observed orders: slopes of the differences over the sizes in a log-log plot."""
        sizes = np.log(self.sizes[: len(self.differences)])
        slopes = np.diff(np.log(self.differences)) / np.diff(sizes)
        return [float(order) for order in np.abs(slopes)]


def refine(
    case: Case,
    what: str,
    model: Model,
    sizes: Sequence[float],
    unit: str,
    at: Callable[[Model, float], Model],
) -> Refinement:
    """Run one model at several sizes.

    Args:
        case: the model's.
        what: is refined.
        model: of the case.
        sizes: from the coarsest to the finest.
        unit: of the sizes.
        at: the model at a size.
    """
    refined = tuple(
        at(model, size).model_copy(update={"name": f"{model.name} {i}"})
        for i, size in enumerate(sizes)
    )
    runs = trajectories(case.model_copy(update={"models": refined}))
    tips = np.array([run.data["tip"].values for run in runs])
    peaks = [run.first_peak()[1] for run in runs]
    apart = np.abs(np.diff(tips, axis=0)).max(axis=1) / np.ptp(tips[-1])
    return Refinement(what, model.name, list(sizes), unit, apart.tolist(), peaks)


def survey(case: Case, tell: Callable[[str], None]) -> list[Refinement]:
    """Every refinement of the case with friction.

    Args:
        case: with the models of ``runs/cases/friction-walk.toml``.
        tell: told what is being refined.
    """
    found = []
    for name in STEPPED:
        tell(f"{name}: step")
        model = model_of(case, name)
        own = model.step or case.time.step
        assert own is not None
        steps = [factor * own for factor in STEPS]
        found.append(refine(case, "step", model, steps, "s", _with_step))
    asked: Sequence[tuple[str, str, Sequence[float], str, Callable[[Model, float], Model]]] = [
        ("terms of each segment", "kantorovich-24", TERMS, "", _with_terms),
        ("element length", "beam-fe", ELEMENTS, "m", _with_elements),
        ("element length", "timoshenko", ELEMENTS, "m", _with_elements),
        ("mesh size", "shell", MESHES, "m", _with_mesh),
    ]
    for what, name, sizes, unit, at in asked:
        tell(f"{name}: {what}")
        found.append(
            refine(case, what, _with_step(model_of(case, name), FINE_STEP), sizes, unit, at)
        )
    return found


def table(found: Sequence[Refinement]) -> TextTable:
    """One row a run."""
    rows = []
    for refinement in found:
        orders = [None, *refinement.orders]
        for i, size in enumerate(refinement.sizes):
            finest = i == len(refinement.sizes) - 1
            rows.append(
                (
                    f"{refinement.model}: {refinement.what}" if i == 0 else "",
                    f"{number(size)} {refinement.unit}".strip(),
                    "" if finest else number(100.0 * refinement.differences[i]),
                    "" if finest else number(orders[i], 2),
                    f"{1e3 * refinement.first_peaks[i]:.2f}",
                )
            )
    return TextTable(
        "Convergence of the paper's example with friction",
        ("refined", "size", "off the next (% of the range)", "order", "first tip peak (mm)"),
        rows,
        (
            "Largest difference of the tip over the whole run from that of the next finer one. The "
            "order is that of the differences.",
        ),
        name="convergence",
    )


def study(tell: Callable[[str], None]) -> Study:
    """Steps of all integrations, terms, elements, meshes."""
    found = survey(friction_case(), tell)
    return Study(
        name="refinement",
        title="How the motion settles",
        tables=[table(found)],
        data={"refinements": [{**asdict(one), "orders": one.orders} for one in found]},
    )


def _with_step(model: Model, step: float) -> Model:
    return model.model_copy(update={"step": step})


def _with_terms(model: Model, terms: float) -> Model:
    (series,) = of_kind(KantorovichTable, [model])
    return series.model_copy(update={"terms": (round(terms),) * len(series.terms)})


def _with_elements(model: Model, length: float) -> Model:
    return model.model_copy(update={"element_length": length})


def _with_mesh(model: Model, size: float) -> Model:
    (shell,) = of_kind(ShellTable, [model])
    return finer(shell, size / shell.mesh_size)
