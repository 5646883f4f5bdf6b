# SPDX-License-Identifier: LGPL-3.0-or-later
"""Evaluation of built and integrated models: the design results of each model and of a run."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dynamics.failure import NUMERICS
from dynamics.gap_system import GapSystem
from dynamics.line import Line
from dynamics.trajectory import Trajectory
from geometry.arrays import Array
from geometry.boom import Boom
from geometry.telescoping import travel
from runs.case.kinds.model import Built
from runs.case.schema import Case, Model
from runs.pipeline.bonded import bonded_system
from runs.pipeline.design_results import DesignResults, ModelDesignResults, play_effects
from runs.pipeline.model_output import ShellOutput
from runs.pipeline.model_quality import quality_notes, reference_of
from runs.pipeline.models import MotionPlan
from runs.pipeline.modes import Mode, ModeComparison, matched, modes
from runs.pipeline.motion_results import MotionResult, Motions, evaluate_motion
from runs.pipeline.residual_vibration import residual_vibration
from runs.pipeline.section_forces import with_cylinders
from runs.pipeline.static_results import (
    StaticResult,
    extended_positions,
    instants,
    positions,
    static_result,
)
from runs.pipeline.statics import reactions, statics
from runs.pipeline.strength import COUNTS, Life, life, wall_stresses
from runs.pipeline.summary import Summary


class _Model(NamedTuple):
    """A model of a boom, with all constant loads in the load of its system, and its lines."""

    boom: Boom
    system: GapSystem
    lines: Sequence[Line]

    def static(self, found: Mapping[float, Array]) -> list[StaticResult]:
        """Return the static states at equilibria (num_modes,) by their time in s."""
        return [static_result(*self, time, position) for time, position in found.items()]

    def modes(self, found: Mapping[float, Array]) -> list[Mode]:
        """Return the first modes at the equilibrium of t = 0."""
        return modes(*self, found[0.0]) if found else []

    def motion(
        self,
        trajectory: Trajectory,
        found: Mapping[float, Array],
        rests: Sequence[StaticResult],
        case: Case,
        model: Model,
    ) -> tuple[MotionResult, list[Life]]:
        """Return the largest values of a motion beside those at rest, and the fatigue life."""
        still = np.array([*found.values()]).reshape(-1, self.system.num_modes)
        smooth = model.smooth
        motions = Motions(self.boom, self.lines, trajectory, still, rests, jumps=not smooth)
        moved, varying = evaluate_motion(motions)
        return moved, [life(one, case.life) for one in varying] if COUNTS else []


def answer_model(
    boom: Boom,
    case: Case,
    model: Model,
    built: Built,
    trajectory: Trajectory,
    shell: ShellOutput | None,
) -> ModelDesignResults:
    """Return the design results of one model, on the first rank.

    Args:
        boom: that of the case.
        case: the case of the model.
        model: a model of the case.
        built: the model before its motion.
        trajectory: its motion.
        shell: its output besides the trajectory; None for a beam.
    """
    system, shown = built.system.gather_loads(), boom.play_free if model.play_free else boom
    lines = with_cylinders(shown, system, model.lines(boom, built))
    played, times = _Model(shown, system, lines), instants(system, case.time.duration)
    found, farthest = positions(system, times), extended_positions(system, case.time.duration)
    rests, drawn = played.static(found), played.static(farthest)
    moved, lives = played.motion(trajectory, found | farthest, [*rests, *drawn], case, model)
    walls = [] if shell is None else wall_stresses(shown, shell.stresses)
    answers = ModelDesignResults(
        static=rests,
        static_extended=drawn,
        modes=played.modes(found),
        motion=replace(moved, walls=walls),
        life=lives,
        residual_vibration=residual_vibration(system, trajectory, case, model),
    )
    if model.play_free or not boom.joints:
        return answers
    try:
        tied = _tied(boom, model, played, found)
        return _beside_tied(answers, tied, positions(tied.system, times), boom, model, case)
    except NUMERICS:
        # For example, rigid segments without play leave no degree of freedom.
        return answers


def _tied(boom: Boom, model: Model, played: _Model, found: Mapping[float, Array]) -> _Model:
    """Return the same model without play."""
    without = boom.play_free
    if (own := model.without_play(boom)) is not None:
        system = own[0].gather_loads()
        return _Model(without, system, with_cylinders(without, system, own[1]))
    begun = [position for time, position in found.items() if _as_begun(boom, time)]
    system, basis = bonded_system(played.system.at_time(0.0), begun)
    return _Model(without, system, [line.on(basis) for line in played.lines])


def _beside_tied(
    answers: ModelDesignResults,
    tied: _Model,
    found: Mapping[float, Array],
    boom: Boom,
    model: Model,
    case: Case,
) -> ModelDesignResults:
    rests = tied.static(found)
    answers = replace(
        answers,
        static_bonded=[rest for rest in rests if _as_begun(boom, rest.time)],
        # Their shapes look the same as those of the boom with play.
        modes_bonded=[replace(mode, shapes=[]) for mode in tied.modes(found)],
    )
    if boom.driven:
        # The boom without play cannot extend.
        return answers
    try:
        motion = MotionPlan.of(tied.system, case, model).trajectory()
        moved, lives = tied.motion(motion, found, rests, case, model)
    except NUMERICS:
        # The static states remain available.
        return answers
    return replace(answers, motion_bonded=moved, life_bonded=lives)


def _as_begun(boom: Boom, time: float) -> bool:
    """Return whether drives have all segments in their initial positions at a time in s."""
    return not any(travel(boom, segment, time) for segment in range(len(boom.segments)))


def answer_run(
    boom: Boom, case: Case, summary: Summary, models: Mapping[str, ModelDesignResults]
) -> DesignResults:
    """Return the design results of all models of a run.

    Args:
        boom: that of the case.
        case: the case of the run.
        summary: that of the run, without design results.
        models: models of the run without failure.
    """
    found = statics(case, boom)
    ran = [model for model in case.models if model.name in models]
    answers = DesignResults(
        models=dict(models),
        reactions=[] if found is None else reactions(found.with_play),
        reactions_bonded=[] if found is None else reactions(found.bonded),
        modes=_beside(boom, ran, models),
        play=play_effects(ran, models) if boom.joints else [],
    )
    return replace(answers, quality_notes=[*quality_notes(summary, answers, case.time.duration)])


def _beside(
    boom: Boom, ran: Sequence[Model], models: Mapping[str, ModelDesignResults]
) -> ModeComparison | None:
    with_modes = [model for model in ran if models[model.name].modes]
    reference = reference_of(with_modes)
    others = [m.name for m in with_modes if not m.play_free and m.name != reference]
    if reference is None or not others:
        return None
    own = models[reference].modes
    return ModeComparison(
        reference, {name: matched(boom, own, models[name].modes) for name in others}
    )
