# SPDX-License-Identifier: LGPL-3.0-or-later
"""From models that have been built and have moved to what a designer asks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dynamics.gap_system import GapSystem
from dynamics.line import Line
from dynamics.trajectory import Trajectory
from geometry.arrays import Array
from geometry.boom import Boom
from runs.case.kinds.model import Built
from runs.case.schema import Case, Model
from runs.pipeline.answers import Answers, AtRest, Mode, ModelAnswers, ModesBeside
from runs.pipeline.at_rest import NUMERICS, at_rest, positions
from runs.pipeline.comparisons import reference_of
from runs.pipeline.life import COUNTS, life
from runs.pipeline.modes import matched, modes
from runs.pipeline.moved import Motions, wall_stresses
from runs.pipeline.play import added
from runs.pipeline.shell_output import ShellOutput
from runs.pipeline.statics import reactions, statics
from runs.pipeline.summary import Summary
from runs.pipeline.trust import known


class Resting(NamedTuple):
    """A boom at rest, (num_rests, num_modes), what is told of it, and its modes there."""

    positions: Array
    rests: list[AtRest]
    modes: list[Mode]


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
    own = boom.play_free if model.play_free else boom
    lines, duration = model.lines(boom, built), case.time.duration
    played = _resting(own, built.system.gathered(), lines, duration)
    tied = _tied(boom, model, duration)
    motions = Motions(own, lines, trajectory, played.positions, played.rests, not model.smooth)
    walls = [] if shell is None else wall_stresses(own, shell.stresses)
    return ModelAnswers(
        rests=played.rests,
        tied=tied.rests,
        modes=played.modes,
        # Their shapes are those of the pressed boom to the eye.
        tied_modes=[replace(mode, shapes=[]) for mode in tied.modes],
        moved=replace(motions.told, walls=walls),
        life=[life(one, case.life) for one in motions.varying] if COUNTS else [],
    )


def _resting(boom: Boom, system: GapSystem, lines: Sequence[Line], duration: float) -> Resting:
    found = positions(system, duration)
    if not found:
        return Resting(np.zeros((0, system.num_modes)), [], [])
    return Resting(
        np.array(list(found.values())),
        [at_rest(boom, system, lines, time, position) for time, position in found.items()],
        modes(boom, system, lines, found[0.0]),
    )


def _tied(boom: Boom, model: Model, duration: float) -> Resting:
    try:
        system, lines = model.without_play(boom)
    except NUMERICS:
        # Rigid segments that are tied leave nothing to move.
        return Resting(np.zeros((0, 0)), [], [])
    return _resting(boom.play_free, system.gathered(), lines, duration)


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
        reactions=[] if found is None else reactions(boom, found.played),
        tied_reactions=[] if found is None else reactions(boom.play_free, found.tied),
        modes=_beside(boom, ran, models),
        play=added(ran, models) if boom.joints else [],
    )
    return replace(answers, trust=known(summary, answers, case.time.duration))


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
