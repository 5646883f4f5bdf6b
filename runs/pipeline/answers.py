# SPDX-License-Identifier: LGPL-3.0-or-later
"""Design results of a boom, part of ``summary.json``; SI units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

from runs.case.schema import Model
from runs.pipeline.at_rest import AtRest
from runs.pipeline.modes import Mode, ModesBeside
from runs.pipeline.moved import Moved
from runs.pipeline.residual_vibration import Swing
from runs.pipeline.statics import Reaction
from runs.pipeline.strength import Life


@dataclass(frozen=True, slots=True)
class ModelAnswers:
    """Design results of one model.

    Args:
        rests: static states under the loads of t = 0, and for variable loads also under the
            extreme ones; empty without an equilibrium.
        drawn: static states at the largest and least extension, under the loads of that time and
            under the extreme ones at that extension.
        tied: as ``rests``, without play, at the instants with the initial extension.
        modes: the first modes at rest under the loads of t = 0; empty without an equilibrium.
        tied_modes: those of the boom without play, without their shapes.
        moved: extreme values of the run.
        tied_moved: extreme values without play; None for a model without play, and where they
            cannot be computed. Walls of shells are left out.
        life: fatigue damage of each segment with a known section, where cycles can be counted.
        tied_life: likewise without play.
        swing: vibration during the extension; None without extension, for a run that ends before
            its drives, and without an equilibrium.
    """

    rests: list[AtRest] = field(default_factory=list)
    drawn: list[AtRest] = field(default_factory=list)
    tied: list[AtRest] = field(default_factory=list)
    modes: list[Mode] = field(default_factory=list)
    tied_modes: list[Mode] = field(default_factory=list)
    moved: Moved | None = None
    tied_moved: Moved | None = None
    life: list[Life] = field(default_factory=list)
    tied_life: list[Life] = field(default_factory=list)
    swing: Swing | None = None

    @property
    def farthest_rest(self) -> AtRest | None:
        """The static state with the farthest tip, at any extension; None without any."""
        return max([*self.rests, *self.drawn], key=lambda rest: abs(rest.tip), default=None)


@dataclass(frozen=True, slots=True)
class Added:
    """The increase of a number by play.

    Args:
        what: as of :class:`Peak`, or ``deflection at rest``, ``first frequency``, ``stress``.
        where: the place; empty for the whole boom.
        unit: SI unit.
        played, tied: the number with play and without, by its absolute value.
    """

    what: str
    where: str
    unit: str
    played: float
    tied: float

    @property
    def added(self) -> float:
        """Increase by play, in the unit."""
        return self.played - self.tied

    @property
    def share(self) -> float | None:
        """Increase as a part of the number without play; None where that is zero."""
        return self.added / self.tied if self.tied else None


@dataclass(frozen=True, slots=True)
class PlayAdds:
    """The increases of numbers by play in one model.

    Args:
        model: name of the model with play.
        numbers: numbers at rest, of modes and of motions, with and without play.
    """

    model: str
    numbers: list[Added]


@dataclass(frozen=True, slots=True)
class QualityNote:
    """A note of one line on the accuracy of the results.

    Args:
        what: ``agreement``, ``horizon``, ``reduction``, ``mesh``, ``energy`` or ``step``.
        line: the note.
    """

    what: str
    line: str


@dataclass(frozen=True, slots=True)
class Answers:
    """Design results of a run.

    Args:
        models: design results by the model's name.
        reactions: support reactions of beam elements at rest under the loads of t = 0, as in
            ``check``; empty without an equilibrium.
        tied_reactions: the same without play.
        modes: modes of all models side by side; None if fewer than two models have any.
        play: increases by play of each model with play.
        trust: notes on the accuracy.
    """

    models: dict[str, ModelAnswers]
    reactions: list[Reaction] = field(default_factory=list)
    tied_reactions: list[Reaction] = field(default_factory=list)
    modes: ModesBeside | None = None
    play: list[PlayAdds] = field(default_factory=list)
    trust: list[QualityNote] = field(default_factory=list)


def added(models: list[Model], answers: Mapping[str, ModelAnswers]) -> list[PlayAdds]:
    """Return the increases by play of each model with play.

    Args:
        models: those of the case without failure.
        answers: design results of each.
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
