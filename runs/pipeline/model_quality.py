# SPDX-License-Identifier: LGPL-3.0-or-later
"""Accuracy of the results of a run: comparison of models, notes on accuracy, cautions.

All models are compared with one reference model. Chaotic motions are compared by ensembles, at
three levels. Motions that friction makes regular are compared over the whole run.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial

import numpy as np
import xarray as xr

from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.trajectory import PointwiseDifferences
from protractile.geometry.axial import moving_force
from protractile.geometry.boom import Boom
from protractile.geometry.typography import TO_PERCENT, join_words
from protractile.runs.case.actions import series_notes
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case, Model, TimeTable
from protractile.runs.pipeline.comparison import Distributions, PeakDifferences, compare
from protractile.runs.pipeline.design_results import DesignResults, ModelDesignResults, QualityNote
from protractile.runs.pipeline.drives import lag_cautions, stick_slip_cautions, stick_slip_estimates
from protractile.runs.pipeline.hoisting_error import hoisting_cautions
from protractile.runs.pipeline.largest_loads import BeamStates
from protractile.runs.pipeline.pad_walls import deflection_advice
from protractile.runs.pipeline.proportions import proportion_cautions
from protractile.runs.pipeline.response_cautions import (
    CHECK_UNITS,
    buckling_cautions,
    deflection_errors,
    period_cautions,
    tip_cautions,
)
from protractile.runs.pipeline.static_results import bulge_cautions
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.pipeline.summary import Comparisons, Summary, WholeRun
from protractile.runs.pipeline.turning import pendulum_frequency, swing_cautions, turning_cautions
from protractile.runs.report.formatting import number, signed_percent

# Members whose tips differ by more than this fraction of the range have diverged.
_DIVERGED = 0.2

# Ratio of a mode's frequency to the pendulum's frequency above which the mode belongs to the boom.
_APART = 1.2

# Relative error of a reduction or a mesh above which a caution is given.
MAX_RELATIVE_ERROR = 0.01


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
    summary: Summary, design: DesignResults, time: TimeTable
) -> Iterator[QualityNote]:
    """Yield notes on the accuracy of a run.

    The summary has no design results yet; ``time`` is the table of times of the case.
    """
    models = summary.models
    for line in _agreement(design):
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


def _agreement(design: DesignResults) -> Iterator[str]:
    """Yield a sentence on the deviations of each other model with play from the reference."""
    if design.modes is None:
        return
    reference = design.modes.reference
    results = design.models[reference]
    for name, matches in design.modes.matches.items():
        other, first, dynamic = design.models[name], matches[0], None
        if results.motion and other.motion and results.motion.peaks[0].largest:
            dynamic = other.motion.peaks[0].largest / results.motion.peaks[0].largest - 1.0
        deviations = {
            "static tip deflection": static_deviation(results, other),
            "first frequency": None if first is None else first.off,
            "maximum tip deflection": dynamic,
        }
        parts = [
            f"{signed_percent(off)} in the {what}"
            for what, off in deviations.items()
            if off is not None
        ]
        if parts:
            yield f"{name} differs from {reference} by {join_words(parts)}."


def static_deviation(results: ModelDesignResults, other: ModelDesignResults) -> float | None:
    """Return the relative deviation of another model's largest static tip deflection, or None."""
    tips = [
        max((rest.tip for rest in one.static), key=abs, default=None) for one in (results, other)
    ]
    if tips[1] is None or not tips[0]:
        return None
    return tips[1] / tips[0] - 1.0


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


def cautions(case: Case, boom: Boom, data: xr.Dataset, summary: Summary) -> list[str]:
    """Return cautions on the validity of the results.

    The summary has all failures, and ``data`` the trajectories of all models.
    """
    return [
        *proportion_cautions(case, boom),
        *stick_slip_cautions(stick_slip_estimates(case, boom), case.system),
        *lag_cautions(boom, data, case.system),
        *(f"failed: {name}: {why}" for name, why in summary.failures.items()),
        *_static(summary, case, boom),
        *stress_cautions(summary, boom),
        *(
            caution
            for name, results in summary.design.models.items()
            if results.static
            for caution in bulge_cautions(f"in {name}", results.static[0], boom)
        ),
        *_large_displacements(case, boom, data),
        *_straight_path(case, boom),
        *swing_cautions(case, data),
        *_numerical(summary, case),
        *series_notes(case),
    ]


def _static(summary: Summary, case: Case, boom: Boom) -> Iterator[str]:
    """Yield cautions on axial forces, static deflection, duration and Coriolis forces."""
    for name, model in summary.models.items():
        yield from buckling_cautions(name, model.critical_factor)
        advise = partial(_advice, case, boom, name)
        rests = summary.design.models[name].static if name in summary.design.models else []
        tip = max((rest.tip for rest in rests), key=abs, default=model.static_tip)
        yield from tip_cautions(f"in {name}", tip, boom, advise)
    designs = summary.design.models.items()
    frequencies = sorted((mode.frequency, name) for name, one in designs for mode in one.modes)
    for frequency, name in frequencies[:1]:
        yield from period_cautions(f"in {name}", frequency, case)
    bending = [one for one in frequencies if one[0] > _APART * pendulum_frequency(case)]
    for frequency, name in bending[:1]:
        yield from turning_cautions(f"in {name}", frequency, case)


def stress_cautions(summary: Summary, boom: Boom) -> Iterator[str]:
    """Yield cautions on wall stresses of shells if axial forces vary along a segment."""
    numbers = range(len(boom.joints))
    if any(moving_force(boom.segments, boom.joints, number) for number in numbers):
        for name in (name for name, one in summary.models.items() if one.stress is not None):
            yield (
                f"caution: the walls of {name} carry the axial forces of the initial extension: "
                "their stresses and utilisations neglect the change of axial forces by drives, "
                "unlike stresses of outer fibres"
            )


def _advice(case: Case, boom: Boom, name: str) -> str:
    """Return the advice on a large deflection of the named model."""
    if any(model.name == name and model.needs_shell for model in case.models):
        with suppress(*NUMERICAL_ERRORS):
            return deflection_advice(case, BeamStates.of(case, boom_with_play(case, boom)))
    return CHECK_UNITS


def _large_displacements(case: Case, boom: Boom, data: xr.Dataset) -> Iterator[str]:
    largest = np.abs(data["tip"].values).max(axis=1)
    for name, move in zip(data["model"].values, largest, strict=True):
        what, advise = (
            f"in {name} the tip moves by {move:.3g} m",
            partial(_advice, case, boom, name),
        )
        yield from deflection_errors(what, float(move), boom, advise)


def _straight_path(case: Case, boom: Boom) -> Iterator[str]:
    """Yield a caution on the path of a tip with a hanging load, by the beam of ``check``."""
    if case.hoist is not None:
        with suppress(*NUMERICAL_ERRORS):
            yield from hoisting_cautions(case, BeamStates.of(case, boom_with_play(case, boom)))


def _numerical(summary: Summary, case: Case) -> Iterator[str]:
    """Yield cautions on errors of reductions and meshes."""
    # Shells whose mesh follows from contact_tolerance near contacts.
    refined = {
        one.name
        for one in select_kind(Shell, case.models)
        if one.contact_tolerance != "any" and one.contact_line != "surface"
    }
    for name, model in summary.models.items():
        if (error := model.reduction_errors.get("contact_compliance") or 0.0) > MAX_RELATIVE_ERROR:
            yield (
                f"caution: the reduction of {name} to {model.modes} coordinates has an error of "
                f"{_percent(error)} of the local contact compliance; allow more modes, or "
                "--modes auto"
            )
    for name, model in summary.models.items():
        if (error := model.reduction_error or 0.0) > MAX_RELATIVE_ERROR:
            yield (
                f"caution: the reduction of {name} may change the tip's motion by "
                f"{_percent(error)} of its range, since friction depends on vibrations of its "
                f"plates; {_remedy(case, name)}"
            )
    for name, model in summary.models.items():
        if (error := model.mesh_error or 0.0) > MAX_RELATIVE_ERROR:
            yield (
                f"caution: the mesh of {name} causes an error of {_percent(error)} of the "
                "local contact compliance; give a smaller "
                f"{'contact_tolerance' if name in refined else 'mesh_size'}"
            )


def _remedy(case: Case, name: str) -> str:
    """Return what makes the motion of a reduced shell more accurate."""
    (shell,) = (model for model in select_kind(Shell, case.models) if model.name == name)
    finer = "a smaller tolerance" if shell.modes == "auto" else "more modes"
    damped = case.damping.modal or case.damping.mass or case.damping.stiffness
    return f"give {finer}" if damped else f"give damping, which ends these vibrations, and {finer}"
