# SPDX-License-Identifier: LGPL-3.0-or-later
"""Evaluation of models after the run: design results with and without play."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from protractile.analysis.bonded import bonded_system
from protractile.analysis.equilibria import (
    equilibria,
    extended_equilibria,
    instants,
    vibrating_state,
)
from protractile.analysis.fatigue import HAS_RAINFLOW, life
from protractile.analysis.model import AnalysisModel
from protractile.analysis.modes import ModeComparison, match_modes, modes
from protractile.analysis.motion_results import evaluate_motion
from protractile.analysis.plate_buckling import weakest_panels
from protractile.analysis.states import static_results
from protractile.analysis.stresses import wall_stresses
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.telescoping import travel
from protractile.runs.case.kinds.model import BuiltModel
from protractile.runs.case.motions import with_initial_slack
from protractile.runs.case.schema import Case, Model
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.design_results import DesignResults, ModelDesignResults, play_effects
from protractile.runs.pipeline.model_quality import quality_notes, reference_of
from protractile.runs.pipeline.model_run import ModelRun
from protractile.runs.pipeline.models import MotionPlan, complete_system
from protractile.runs.pipeline.proofs import prove
from protractile.runs.pipeline.residual_vibration import residual_vibration
from protractile.runs.pipeline.statics import reactions, statics
from protractile.runs.pipeline.summary import Summary
from protractile.runs.pipeline.turning import crane_drives, hoisting


def loaded_model(boom: Boom, model: Model, built: BuiltModel) -> AnalysisModel:
    """Return a built model of a boom under all constant loads."""
    boom_of_model = boom.bonded if model.bonded else boom
    return AnalysisModel.of(boom_of_model, built.system, model.lines(boom, built))


def results_at_rest(
    loaded: AnalysisModel,
    rests: Mapping[float, Array],
    extended: Mapping[float, Array] = MappingProxyType({}),
) -> ModelDesignResults:
    """Return modes and static states at equilibria.

    Equilibria are (num_modes,), by time in s; ``extended`` are those at the largest and smallest
    extension.
    """
    static, static_extended = (
        static_results(loaded, np.array([*positions]), np.array([*positions.values()]))
        if positions
        else []
        for positions in (rests, extended)
    )
    first = []
    if rests:
        still, rest = vibrating_state(loaded.system, rests)
        first = modes(replace(loaded, system=still), rest)
    return ModelDesignResults(static=static, static_extended=static_extended, modes=first)


def with_motion(
    results: ModelDesignResults,
    loaded: AnalysisModel,
    rests: Mapping[float, Array],
    trajectory: Trajectory,
    case: Case,
    model: Model,
) -> ModelDesignResults:
    """Return static results, completed by results of the motion and by fatigue damage."""
    rest_positions = np.array([*rests.values()]).reshape(-1, loaded.system.num_modes)
    static = [*results.static, *results.static_extended]
    motion, varying = evaluate_motion(loaded, trajectory, rest_positions, static, not model.smooth)
    fatigue = case.life.detail_category, case.life.partial_factor, case.life.repeats
    lives = [life(one, *fatigue) for one in varying] if HAS_RAINFLOW else []
    return replace(results, motion=motion, life=lives)


def evaluate_model(boom: Boom, case: Case, ran: ModelRun, bonded: bool) -> ModelDesignResults:
    """Return the design results of a model after its run, also without play if ``bonded``."""
    model, trajectory, shell = ran.model, ran.motion.trajectory, ran.shell
    loaded, duration = loaded_model(boom, model, ran.built), case.time.duration
    times = instants(loaded.system, duration)
    rests = equilibria(loaded.system, times)
    extended = extended_equilibria(loaded.system, duration)
    results = results_at_rest(loaded, rests, extended)
    results = with_motion(results, loaded, rests | extended, trajectory, case, model)
    if shell is not None:
        assert results.motion is not None
        motion = replace(results.motion, walls=wall_stresses(loaded.boom, shell.stresses))
        buckled = [] if shell.buckling is None else shell.buckling.segments
        results = replace(results, motion=motion, buckling=buckled)
    if case.buckling is not None and (rest := results.farthest_static) is not None:
        results = replace(results, panels=weakest_panels(loaded.boom.segments, rest))
    results = replace(
        results,
        residual_vibration=residual_vibration(loaded.system, trajectory, case, model),
        hoisting=hoisting(case, boom, trajectory),
        drives=crane_drives(case, boom, trajectory.data),
    )
    if not bonded or model.bonded or not boom.joints:
        return results
    try:
        without_play = _bonded_model(boom, case, model, loaded, rests)
        return _add_bonded(results, boom, case, model, without_play, times)
    except NUMERICAL_ERRORS:
        # Rigid segments without play, for example, have no degree of freedom.
        return results


def _add_bonded(
    results: ModelDesignResults,
    boom: Boom,
    case: Case,
    model: Model,
    bonded: AnalysisModel,
    times: Sequence[float],
) -> ModelDesignResults:
    """Return design results, completed by static results at ``times`` and a motion without play."""
    rests = equilibria(bonded.system, times)
    other = results_at_rest(bonded, rests)
    results = replace(
        results,
        static_bonded=[state for state in other.static if _at_initial_extension(boom, state.time)],
        # Shapes are left out, since play hardly changes them.
        modes_bonded=[replace(mode, shapes=[]) for mode in other.modes],
    )
    if boom.telescopes:
        # A boom without play cannot telescope.
        return results
    try:
        motion = MotionPlan.of(bonded.system, case, model).trajectory()
        other = with_motion(other, bonded, rests, motion, case, model)
    except NUMERICAL_ERRORS:
        # The static results remain valid.
        return results
    return replace(results, motion_bonded=other.motion, life_bonded=other.life)


def _bonded_model(
    boom: Boom, case: Case, model: Model, loaded: AnalysisModel, rests: Mapping[float, Array]
) -> AnalysisModel:
    """Return the model with all joints bonded, without play."""
    without = boom.bonded
    if (bonded := model.system_without_play(boom)) is not None:
        lines = bonded[1]
        return AnalysisModel.of(without, complete_system(bonded[0], case, without, lines), lines)
    initial = [position for time, position in rests.items() if _at_initial_extension(boom, time)]
    initial_system = loaded.system.at_time(0.0) if boom.telescopes else loaded.system
    system, basis = bonded_system(initial_system, initial)
    system = with_initial_slack(system, case)
    return AnalysisModel(without, system, [line.transform(basis) for line in loaded.lines])


def _at_initial_extension(boom: Boom, time: float) -> bool:
    """Return True if all driven segments are in their initial positions at a time in s."""
    return not any(travel(boom, segment, time) for segment in range(len(boom.segments)))


def evaluate_run(
    boom: Boom, case: Case, summary: Summary, models: Mapping[str, ModelDesignResults]
) -> DesignResults:
    """Return the design results of all models of a run.

    ``models`` are the design results of models that did not fail.
    """
    static = statics(case, boom)
    completed = [model for model in case.models if model.name in models]
    design = DesignResults(
        models=dict(models),
        reactions=[] if static is None else reactions(static.with_play),
        reactions_bonded=[] if static is None else reactions(static.bonded),
        modes=_compare_modes(boom, completed, models),
        play=play_effects(completed, models) if boom.joints else [],
    )
    if case.load_cases or case.combinations:
        states = combination_states(case)
        design = replace(design, combinations=[one.result for one in states])
        with suppress(*NUMERICAL_ERRORS):
            # A combination without an equilibrium has no proofs; the table of combinations states
            # this.
            design = replace(design, proofs=prove(case, states))
    return replace(design, quality_notes=[*quality_notes(summary, design, case.time)])


def _compare_modes(
    boom: Boom, completed: Sequence[Model], models: Mapping[str, ModelDesignResults]
) -> ModeComparison | None:
    with_modes = [model for model in completed if models[model.name].modes]
    reference = reference_of(with_modes)
    others = [m.name for m in with_modes if not m.bonded and m.name != reference]
    if reference is None or not others:
        return None
    reference_modes = models[reference].modes
    matches = {name: match_modes(boom, reference_modes, models[name].modes) for name in others}
    return ModeComparison(reference, matches)
