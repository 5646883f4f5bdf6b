# SPDX-License-Identifier: LGPL-3.0-or-later
"""From models that have been built and have moved to what a designer asks."""

from __future__ import annotations

from geometry.boom import Boom
from runs.case.kinds.model import Built
from runs.case.schema import Case, Model
from runs.pipeline.answers import Answers, AtRest, ModelAnswers
from runs.pipeline.at_rest import NUMERICS, told
from runs.pipeline.statics import reactions, statics


def of_model(boom: Boom, case: Case, model: Model, built: Built) -> ModelAnswers:
    """What one model answers, on the first rank."""
    own = boom.play_free if model.play_free else boom
    duration = case.time.duration
    return ModelAnswers(
        rests=told(own, built.system, model.lines(boom, built), duration),
        tied=_tied(boom, model, duration),
    )


def _tied(boom: Boom, model: Model, duration: float) -> list[AtRest]:
    try:
        system, lines = model.without_play(boom)
    except NUMERICS:
        # Rigid segments that are tied leave nothing to move.
        return []
    return told(boom.play_free, system, lines, duration)


def of_run(boom: Boom, case: Case, models: dict[str, ModelAnswers]) -> Answers:
    """What all of them answer together."""
    found = statics(case, boom)
    if found is None:
        return Answers(models)
    return Answers(models, reactions(boom, found.played), reactions(boom.play_free, found.tied))
