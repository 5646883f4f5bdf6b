# SPDX-License-Identifier: LGPL-3.0-or-later
"""From models that have been built and have moved to what a designer asks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dynamics.failure import NUMERICS
from dynamics.gap_system import GapSystem
from dynamics.line import Line
from dynamics.reduction import tied_system
from dynamics.trajectory import Trajectory
from geometry.arrays import Array
from geometry.boom import Boom
from geometry.drawing import drawn
from runs.case.kinds.model import Built
from runs.case.schema import Case, Model
from runs.pipeline.answers import Answers, ModelAnswers, added
from runs.pipeline.at_rest import AtRest, at_rest, drawn_positions, instants, positions
from runs.pipeline.model_output import ShellOutput
from runs.pipeline.model_quality import quality_notes, reference_of
from runs.pipeline.models import Plan
from runs.pipeline.modes import Mode, ModesBeside, matched, modes
from runs.pipeline.moved import Motions, Moved, gone_through
from runs.pipeline.section_forces import with_cylinders
from runs.pipeline.statics import reactions, statics
from runs.pipeline.stresses import COUNTS, Life, life, wall_stresses
from runs.pipeline.summary import Summary
from runs.pipeline.swing import swing


class Resting(NamedTuple):
    """A boom at rest, (num_rests, num_modes), what is told of it, and its modes there."""

    positions: Array
    rests: list[AtRest]
    modes: list[Mode]

    def beside(self, other: Resting) -> Resting:
        """With the rests of another one."""
        positions = np.concatenate([self.positions, other.positions])
        return Resting(positions, [*self.rests, *other.rests], self.modes)


def of_model(
    boom: Boom,
    case: Case,
    model: Model,
    built: Built,
    trajectory: Trajectory,
    shell: ShellOutput | None,
) -> ModelAnswers:
    """What one model answers, on the first rank.

    Args:
        boom: of the case.
        case: the model's.
        model: one of the case's.
        built: the model before it moved.
        trajectory: its motion.
        shell: what it leaves besides.
    """
    shown = boom.play_free if model.play_free else boom
    played = Shown.of(shown, built.system.gathered(), model.lines(boom, built))
    times = instants(played.system, case.time.duration)
    resting = _resting(played, times)
    drawn = _drawn(played, case.time.duration)
    moved, lives = _moving(played, resting.beside(drawn), trajectory, model, case)
    walls = [] if shell is None else wall_stresses(played.boom, shell.stresses)
    answers = ModelAnswers(
        rests=resting.rests,
        drawn=drawn.rests,
        modes=resting.modes,
        moved=replace(moved, walls=walls),
        life=lives,
        swing=swing(played.system, trajectory, case, model),
    )
    if model.play_free or not boom.joints:
        return answers
    try:
        tied = _tied(boom, model, played, resting)
        tied_rests = _resting(tied, times)
    except NUMERICS:
        # Rigid segments that are tied leave nothing to move, for one.
        return answers
    return _beside_tied(answers, tied, tied_rests, boom, model, case)


class Shown(NamedTuple):
    """A model of a boom, all that stays constant in the load of its system, and along it."""

    boom: Boom
    system: GapSystem
    lines: Sequence[Line]

    @classmethod
    def of(cls, boom: Boom, system: GapSystem, lines: Sequence[Line]) -> Shown:
        """With what cylinders push along it."""
        return cls(boom, system, with_cylinders(boom, system, lines))


def _resting(shown: Shown, times: Sequence[float]) -> Resting:
    found = positions(shown.system, times)
    if not found:
        return Resting(np.zeros((0, shown.system.num_modes)), [], [])
    return Resting(
        np.array(list(found.values())),
        [at_rest(*shown, time, position) for time, position in found.items()],
        modes(*shown, found[0.0]),
    )


def _drawn(shown: Shown, duration: float) -> Resting:
    """Where drives have drawn it farthest; its modes there are left out."""
    found = drawn_positions(shown.system, duration)
    rests = [at_rest(*shown, time, position) for time, position in found.items()]
    positions = np.array(list(found.values())).reshape(-1, shown.system.num_modes)
    return Resting(positions, rests, [])


def _moving(
    shown: Shown, resting: Resting, trajectory: Trajectory, model: Model, case: Case
) -> tuple[Moved, list[Life]]:
    motions = Motions(
        shown.boom,
        shown.lines,
        trajectory,
        resting.positions,
        resting.rests,
        jumps=not model.smooth,
    )
    moved, varying = gone_through(motions)
    return moved, [life(one, case.life) for one in varying] if COUNTS else []


def _tied(boom: Boom, model: Model, played: Shown, resting: Resting) -> Shown:
    """The same without play."""
    own = model.without_play(boom)
    if own is not None:
        return Shown.of(boom.play_free, own[0].gathered(), own[1])
    rests = zip(resting.rests, resting.positions, strict=True)
    begun = [position for rest, position in rests if _as_begun(boom, rest.time)]
    system, basis = tied_system(played.system.standing(0.0), begun)
    return Shown(boom.play_free, system, [line.on(basis) for line in played.lines])


def _beside_tied(
    answers: ModelAnswers, tied: Shown, resting: Resting, boom: Boom, model: Model, case: Case
) -> ModelAnswers:
    answers = replace(
        answers,
        tied=[rest for rest in resting.rests if _as_begun(boom, rest.time)],
        # Their shapes are those of the pressed boom to the eye.
        tied_modes=[replace(mode, shapes=[]) for mode in resting.modes],
    )
    if boom.driven:
        # Tied it cannot be drawn out.
        return answers
    try:
        motion = Plan.of(tied.system, case, model).trajectory()
        moved, lives = _moving(tied, resting, motion, model, case)
    except NUMERICS:
        # What rests is known all the same.
        return answers
    return replace(answers, tied_moved=moved, tied_life=lives)


def _as_begun(boom: Boom, time: float) -> bool:
    """Whether drives have all segments where they were at t = 0, at a time in s."""
    return not any(drawn(boom, segment, time) for segment in range(len(boom.segments)))


def of_run(boom: Boom, case: Case, summary: Summary, models: Mapping[str, ModelAnswers]) -> Answers:
    """What all of them answer together.

    Args:
        boom: of the case.
        case: of the run.
        summary: of the run, without answers.
        models: those that ran.
    """
    found = statics(case, boom)
    ran = [model for model in case.models if model.name in models]
    answers = Answers(
        models=dict(models),
        reactions=[] if found is None else reactions(found.played),
        tied_reactions=[] if found is None else reactions(found.tied),
        modes=_beside(boom, ran, models),
        play=added(ran, models) if boom.joints else [],
    )
    return replace(answers, trust=quality_notes(summary, answers, case.time.duration))


def _beside(
    boom: Boom, ran: Sequence[Model], models: Mapping[str, ModelAnswers]
) -> ModesBeside | None:
    with_modes = [model for model in ran if models[model.name].modes]
    reference = reference_of(with_modes)
    others = [m.name for m in with_modes if not m.play_free and m.name != reference]
    if reference is None or not others:
        return None
    own = models[reference].modes
    return ModesBeside(reference, {name: matched(boom, own, models[name].modes) for name in others})
