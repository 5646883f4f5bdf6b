# SPDX-License-Identifier: LGPL-3.0-or-later
"""Accuracy of the results of a run: comparison of models, notes on accuracy.

All models are compared with one reference model. Chaotic motions are compared by ensembles, at
three levels. Motions that friction makes regular are compared over the whole run.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

from protractile.analysis.comparison import Distributions, PeakDifferences, compare
from protractile.analysis.modes import ModeComparison
from protractile.analysis.rows import MOTION, REST, Rows
from protractile.dynamics.trajectory import PointwiseDifferences
from protractile.geometry.typography import TO_PERCENT, join_words, number, signed_percent
from protractile.runs.case.schema import Case, Model, TimeTable
from protractile.runs.pipeline.design_results import QualityNote
from protractile.runs.pipeline.summary import Comparisons, Summary, WholeRun

if TYPE_CHECKING:
    import xarray as xr

# Members whose tips differ by more than this fraction of the range have diverged.
_DIVERGED = 0.2

# Regular motions are compared up to this time in s, and over the whole run.
HALFWAY = 5.0
# Scope of each level of comparison.
SCOPES: Mapping[str, str] = {
    "pointwise": PointwiseDifferences.scope,
    "peaks": PeakDifferences.scope,
    "distributions": Distributions.scope,
}


def reference_of(models: Iterable[Model]) -> str | None:
    """Return the name of the reference model: the last shell, else the last model with play."""
    with_play = [model for model in models if not model.bonded]
    shells = [model for model in with_play if model.meshed]
    candidates = shells or with_play
    return candidates[-1].name if candidates else None


def main_models(case: Case, models: Sequence[str]) -> set[str]:
    """Return the names of the main models: the last shell, the last beam, the first without play.

    With three or fewer models, all of them are main models. The last beam is one with play.
    """
    if len(models) <= 3:
        return set(models)
    ran = [model for model in case.models if model.name in models]
    loose = [model for model in ran if not model.bonded]
    shells = [model.name for model in loose if model.meshed]
    beams = [model.name for model in loose if not model.meshed]
    bonded = [model.name for model in ran if model.bonded]
    return {*shells[-1:], *beams[-1:], *bonded[:1]}


def compare_models(
    case: Case,
    trajectories: xr.Dataset,
    ensembles: xr.Dataset | None,
    cutoff: float | None,
) -> Comparisons | None:
    """Return the differences between models; None without two comparable models.

    ``tip`` is (model, time) in the trajectories and (model, member, time) in the ensembles, in m.
    The cut-off of the slow motion is in Hz.
    """
    ran = trajectories["model"].values
    reference = reference_of(model for model in case.models if model.name in ran)
    if reference is None:
        return None
    comparisons = Comparisons(reference=reference)
    if ensembles is not None and cutoff is not None:
        one, *others = (
            ensembles.sel(model=name).astype(float)
            for name in (reference, *_others(ensembles, reference))
        )
        comparisons.ensembles = {
            str(other["model"].item()): compare(one, other, cutoff) for other in others
        }
    if case.regular:
        time, whole = trajectories["time"].values, {}
        ends = dict.fromkeys(end for end in (HALFWAY, float(time[-1])) if end <= time[-1])
        tips = {name: trajectories["tip"].sel(model=name).values for name in ran}
        for name in _others(trajectories, reference):
            parts = [
                PointwiseDifferences.from_curves(tips[reference], tips[name], time, end)
                for end in ends
            ]
            whole[name] = WholeRun(
                until=[part.until for part in parts],
                largest=[part.largest for part in parts],
                rms=[part.rms for part in parts],
            )
        comparisons.whole = whole
    return comparisons if comparisons.ensembles or comparisons.whole else None


def _others(data: xr.Dataset, reference: str) -> list[str]:
    return [str(name) for name in data["model"].values if name != reference]


def quality_notes(
    summary: Summary, rows: Rows, modes: ModeComparison | None, time: TimeTable
) -> Iterator[QualityNote]:
    """Yield notes on the accuracy of a run.

    ``modes`` compares those of all models; ``time`` is the table of times of the case.
    """
    models = summary.models
    for line in _agreement(rows, modes):
        yield QualityNote("agreement", line)
    for line in _horizon(summary, time.duration):
        yield QualityNote("horizon", line)
    if errors := [model.step_error for model in models.values() if model.step_error]:
        line = (
            f"The estimated error by the time step is at most {_percent(max(errors))} of the range "
            "of a deflection."
        )
        above = [name for name, one in models.items() if (one.step_error or 0.0) > time.tolerance]
        if above and time.step is None:
            line += (
                f" It is above time.tolerance of {_percent(time.tolerance)} in "
                f"{join_words(above)}: the motion is chaotic, or needs too many steps."
            )
        yield QualityNote("step", line)
    for name, model in models.items():
        if (error := model.reduction_errors.get("contact_compliance")) is not None:
            yield QualityNote(
                "reduction",
                f"{name}: the reduced shell of {model.modes} generalised coordinates reproduces "
                f"the local contact compliance within a relative error of {number(error, 1)}.",
            )
    for name, model in models.items():
        if model.reduction_error is not None:
            yield QualityNote(
                "reduction",
                f"{name}: the reduction changes the tip's motion by about "
                f"{_percent(model.reduction_error)} of its range, by comparison with a coarser "
                "basis.",
            )
    for name, model in models.items():
        if model.mesh_error is not None:
            yield QualityNote(
                "mesh",
                f"{name}: the mesh error of the local contact compliance is "
                f"{_percent(model.mesh_error)}, by extrapolation to an infinitely fine mesh.",
            )
    name, worst = max(models.items(), key=lambda item: item[1].energy_residual)
    yield QualityNote(
        "energy",
        f"The energy balance holds within {number(worst.energy_residual, 1)} of the largest work "
        f"in every model; {name} has the largest error.",
    )


def _percent(part: float) -> str:
    """Return a fraction as a percentage with two significant digits."""
    return f"{TO_PERCENT * part:.2g} %"


def _agreement(rows: Rows, modes: ModeComparison | None) -> Iterator[str]:
    """Yield a sentence on the deviations of each other model with play from the reference."""
    if modes is None:
        return
    for name, matches in modes.matches.items():
        dynamic = _tips(rows, MOTION, modes.reference, name)
        deviations = {
            "static tip deflection": static_deviation(rows, modes.reference, name),
            "first frequency": None if matches[0] is None else matches[0].off,
            "maximum tip deflection": dynamic and abs(dynamic[1]) / abs(dynamic[0]) - 1.0,
        }
        parts = [
            f"{signed_percent(off)} in the {what}"
            for what, off in deviations.items()
            if off is not None
        ]
        if parts:
            yield f"{name} differs from {modes.reference} by {join_words(parts)}."


def static_deviation(rows: Rows, reference: str, model: str) -> float | None:
    """Return the relative deviation of another model's largest static tip deflection, or None."""
    tips = _tips(rows, REST, reference, model)
    return tips and tips[1] / tips[0] - 1.0


def _tips(rows: Rows, state: str, *models: str) -> tuple[float, float] | None:
    """Return the tip deflections of two models in m; None if one is missing or the first is 0."""
    of_models = (
        rows.where(model=model, state=state, play=True, quantity="tip") for model in models
    )
    tips = [row.value for of_model in of_models for row in of_model]
    return (tips[0], tips[1]) if len(tips) == 2 and tips[0] else None


def _horizon(summary: Summary, duration: float) -> Iterator[str]:
    """Yield a note on the horizons of the ensembles."""
    times = {
        name: model.ensemble.horizon(_DIVERGED)
        for name, model in summary.models.items()
        if model.ensemble is not None
    }
    diverged = {name: time for name, time in times.items() if time is not None}
    if diverged:
        which = join_words([f"{name} {time:.2f} s" for name, time in diverged.items()])
        yield (
            "The motion is chaotic: runs with immeasurably different data differ by "
            f"{_percent(_DIVERGED)} of the tip's range after these times: {which}. A later "
            "curve is one of many possible motions; slow peaks are predictable for longer."
        )
    regular = [name for name, time in times.items() if time is None]
    if regular:
        yield f"The motion of {join_words(regular)} can be predicted over the whole {duration:g} s."
