# SPDX-License-Identifier: LGPL-3.0-or-later
"""Evaluation of models after the run: design results with and without play."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

from protractile.analysis.bonded import bonded_system
from protractile.analysis.curves import Curve, Curves, diagrams, histories
from protractile.analysis.equilibria import (
    equilibria,
    instants,
    vibrating_state,
)
from protractile.analysis.evaluation import evaluate, evaluate_motion
from protractile.analysis.fatigue import Life
from protractile.analysis.measure import measure_walls
from protractile.analysis.model import AnalysisModel
from protractile.analysis.modes import (
    Mode,
    ModeComparison,
    match_modes,
    mode_rows,
    modes,
)
from protractile.analysis.rows import (
    MOTION,
    REST,
    Row,
    Rows,
    extremes,
    static_rows,
)
from protractile.analysis.states import States
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.boom import Boom
from protractile.geometry.telescoping import travel
from protractile.runs.case.motions import with_initial_slack
from protractile.runs.case.schema import Case, Model
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.design_results import DesignResults, ModelDesignResults
from protractile.runs.pipeline.model_quality import quality_notes, reference_of
from protractile.runs.pipeline.model_run import ModelRun
from protractile.runs.pipeline.models import MotionPlan, complete_system
from protractile.runs.pipeline.proofs import prove
from protractile.runs.pipeline.quantities import tip_limit
from protractile.runs.pipeline.residual_vibration import residual_vibration
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.statics import reaction_rows, statics
from protractile.runs.pipeline.turning import crane_drives, hoisting


class Evaluation(NamedTuple):
    """Results of a model after its motion."""

    rows: Sequence[Row]  #: extremes at rest and in motion, with and without play
    curves: Sequence[Curve]  #: diagrams, envelopes and mode shapes
    modes: Sequence[Mode]  #: the first modes about the equilibrium; empty without an equilibrium
    design: ModelDesignResults  #: other design results
    loaded: AnalysisModel | None = None  #: the model with its lines; None if it failed


def life_of(case: Case, boom: Boom) -> Life:
    """Return the data of fatigue damage and of wear of a case with its boom."""
    life, tip = case.life, tip_limit(case, boom)
    return Life(life.detail_category, life.partial_factor, life.repeats, life.wear, tip)


def evaluate_model(boom: Boom, case: Case, ran: ModelRun) -> Evaluation:
    """Return the results of a model after its run."""
    model, trajectory, shell = ran.model, ran.motion.trajectory, ran.shell
    loaded, panels = model.analysis_model(boom, ran.built), case.buckling is not None
    rows, curves, first = evaluate(
        loaded, model.name, trajectory, case.time.duration, panels, life_of(case, boom)
    )
    if shell is not None:
        rows += extremes(measure_walls(loaded.boom, shell.stresses), model.name, MOTION)
        curves += histories(shell.stresses, model.name)
    design = ModelDesignResults(
        buckling=ran.buckling,
        residual_vibration=residual_vibration(loaded.system, trajectory, case, model),
        hoisting=hoisting(case, boom, trajectory),
        drives=crane_drives(case, boom, trajectory.data),
    )
    return Evaluation(rows, curves, first, design, loaded)


def evaluate_both(boom: Boom, case: Case, ran: ModelRun, found: Evaluation) -> Evaluation:
    """Return the results of a model after its run, with play as ``found``, and without play."""
    if ran.model.bonded or not boom.joints or found.loaded is None:
        return found
    rows, curves = [*found.rows], [*found.curves]
    # Rigid segments without play, for example, have no degree of freedom.
    with suppress(*NUMERICAL_ERRORS):
        for more_rows, more_curves in _without_play(boom, case, ran.model, found.loaded):
            rows += more_rows
            curves += more_curves
    return found._replace(rows=rows, curves=curves)


def _without_play(
    boom: Boom, case: Case, model: Model, loaded: AnalysisModel
) -> Iterator[tuple[list[Row], list[Curve]]]:
    """Yield rows and curves of a model without play: of static states, then of a motion.

    A motion that cannot be computed is left out. ``loaded`` is the model with play.
    """
    times = instants(loaded.system, case.time.duration)
    rests = States.of(loaded, equilibria(loaded.system, times))
    bonded = _bonded_model(boom, case, model, rests)
    found = equilibria(bonded.system, times)
    initial = {time: rest for time, rest in found.items() if _at_initial_extension(boom, time)}
    rows, curves = list[Row](), list[Curve]()
    if initial:
        rests = States.of(bonded, initial)
        rows += static_rows(rests, model.name, play=False)
        curves += diagrams(rests, model.name, REST, play=False)
    if found:
        system, rest = vibrating_state(bonded.system, found)
        rows += mode_rows(modes(replace(bonded, system=system), rest), model.name, play=False)
    yield rows, curves
    # A boom without play cannot telescope.
    if not boom.telescopes:
        with suppress(*NUMERICAL_ERRORS):
            motion = MotionPlan.of(bonded.system, case, model).trajectory()
            yield evaluate_motion(
                States.in_motion(bonded, motion), model.name, life_of(case, boom), False
            )


def _bonded_model(boom: Boom, case: Case, model: Model, rests: States) -> AnalysisModel:
    """Return the model with all joints bonded, without play, from its static states with play."""
    without = boom.bonded
    if (bonded := model.system_without_play(boom)) is not None:
        lines = bonded[1]
        system = complete_system(bonded[0], case, without, lines)
        return AnalysisModel.of(without, system, lines, model.smooth)
    loaded, states = rests.model, zip(rests.time.tolist(), rests.positions, strict=True)
    initial = [position for time, position in states if _at_initial_extension(boom, time)]
    initial_system = loaded.system.at_time(0.0) if boom.telescopes else loaded.system
    system, basis = bonded_system(initial_system, initial)
    system = with_initial_slack(system, case)
    lines = [line.transform(basis) for line in loaded.lines]
    return AnalysisModel(without, system, lines, model.smooth)


def _at_initial_extension(boom: Boom, time: float) -> bool:
    """Return True if all driven segments are in their initial positions at a time in s."""
    return not any(travel(boom, segment, time) for segment in range(len(boom.segments)))


def evaluate_run(results: Results, evaluations: Mapping[str, Evaluation]) -> None:
    """Add rows, curves and design results of all models, of load cases and of proofs to results.

    ``evaluations`` are those of models that did not fail.
    """
    case, boom = results.case, results.boom
    completed = [model for model in case.models if model.name in evaluations]
    rows = [row for evaluation in evaluations.values() for row in evaluation.rows]
    results.curves = Curves(
        curve for evaluation in evaluations.values() for curve in evaluation.curves
    )
    if (static := statics(case, boom)) is not None:
        rows += [*reaction_rows(static.with_play), *reaction_rows(static.bonded, play=False)]
    design = DesignResults(
        models={name: evaluation.design for name, evaluation in evaluations.items()},
        modes=_compare_modes(boom, completed, evaluations),
    )
    if case.load_cases or case.combinations:
        states = combination_states(case)
        rows += (row for state in states for row in state.rows)
        design = replace(design, combinations=[state.combined.name for state in states])
        with suppress(*NUMERICAL_ERRORS):
            # A combination without an equilibrium has no proofs; the table of combinations states
            # this.
            proofs = prove(case, states)
            rows += proofs.rows
            design = replace(design, proof_notes=[*proofs.notes])
    results.rows, results.summary.design = Rows(rows), design
    notes = [*quality_notes(results.summary, results.rows, design.modes, case.time)]
    results.summary.design = replace(design, quality_notes=notes)


def _compare_modes(
    boom: Boom, completed: Sequence[Model], models: Mapping[str, Evaluation]
) -> ModeComparison | None:
    with_modes = [model for model in completed if models[model.name].modes]
    reference = reference_of(with_modes)
    others = [m.name for m in with_modes if not m.bonded and m.name != reference]
    if reference is None or not others:
        return None
    reference_modes = models[reference].modes
    matches = {name: match_modes(boom, reference_modes, models[name].modes) for name in others}
    return ModeComparison(reference, matches)
