# SPDX-License-Identifier: LGPL-3.0-or-later
"""What play adds: every number of a boom beside that of the same boom tied."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from runs.case.schema import Model
from runs.pipeline.answers import Added, ModelAnswers, PlayAdds


def added(models: list[Model], answers: Mapping[str, ModelAnswers]) -> list[PlayAdds]:
    """Of each model with play.

    Args:
        models: of the case, those that ran.
        answers: of each.
    """
    return [
        PlayAdds(model.name, [*_at_rest(own), *_in_motion(own)])
        for model in models
        if not model.play_free
        for own in [answers[model.name]]
    ]


def _at_rest(own: ModelAnswers) -> Iterator[Added]:
    tied = {rest.time: rest for rest in own.tied}
    both = [(rest, tied[rest.time]) for rest in own.rests if rest.time in tied]
    if both:
        rest, other = max(both, key=lambda pair: abs(pair[0].tip))
        yield Added("deflection at rest", "tip", "m", abs(rest.tip), abs(other.tip))
    if own.modes and own.tied_modes:
        first = own.modes[0]
        alike = (mode.frequency for mode in own.tied_modes if mode.way == first.way)
        yield Added("first frequency", first.way, "Hz", first.frequency, next(alike, 0.0))


def _in_motion(own: ModelAnswers) -> Iterator[Added]:
    if own.moved is None or own.tied_moved is None:
        return
    others = {(peak.what, peak.where): peak.largest for peak in own.tied_moved.peaks}
    for peak in own.moved.peaks:
        if (named := (peak.what, peak.where)) in others:
            yield Added(*named, peak.unit, peak.largest, others[named])
    stresses = {fibre.segment: abs(fibre.stress) for fibre in own.tied_moved.fibres}
    for fibre in own.moved.fibres:
        if fibre.segment in stresses:
            here = abs(fibre.stress), stresses[fibre.segment]
            yield Added("stress", fibre.segment, "Pa", *here)
    damages = {life.segment: life.life_damage for life in own.tied_life}
    for life in own.life:
        other = damages.get(life.segment)
        if life.life_damage is not None and other is not None:
            yield Added("damage", life.segment, "1", life.life_damage, other)
