# SPDX-License-Identifier: LGPL-3.0-or-later
"""Design results of a boom in ``summary.json``, in SI units."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import hypot

from protractile.analysis.fatigue import Life
from protractile.analysis.modes import Mode, ModeComparison
from protractile.analysis.motion_results import MotionResult
from protractile.analysis.plate_buckling import PanelBuckling
from protractile.analysis.states import StaticResult
from protractile.runs.case.schema import Model
from protractile.runs.pipeline.combinations import CombinationResult
from protractile.runs.pipeline.proofs import Proofs
from protractile.runs.pipeline.residual_vibration import ResidualVibration
from protractile.runs.pipeline.statics import Reaction
from protractile.runs.pipeline.turning import CraneDrives, Hoisting
from protractile.runs.pipeline.wall_buckling import WallBuckling

# Fraction of the value with play below which a value without play is near zero.
_LEAST = 0.01


@dataclass(frozen=True, slots=True)
class ModelDesignResults:
    """Design results of one model."""

    #: static states under the loads at t = 0 and, if loads vary, under their extreme values; empty
    #: without an equilibrium
    static: list[StaticResult] = field(default_factory=list)
    #: static states at the largest and smallest extension, under the loads at the time of this
    #: extension and the extreme loads while it lasts
    static_extended: list[StaticResult] = field(default_factory=list)
    #: static states without play, at times with the initial extension
    static_bonded: list[StaticResult] = field(default_factory=list)
    #: the first modes about the equilibrium under the loads at t = 0; empty without an equilibrium
    modes: list[Mode] = field(default_factory=list)
    #: modes of the boom without play; their shapes are not stored
    modes_bonded: list[Mode] = field(default_factory=list)
    motion: MotionResult | None = None  #: extreme values of the motion
    #: extreme values without play, except wall stresses of shells; None for a model without play,
    #: or if they cannot be computed
    motion_bonded: MotionResult | None = None
    #: fatigue damage of each segment with a known section
    life: list[Life] = field(default_factory=list)
    life_bonded: list[Life] = field(default_factory=list)  #: fatigue damage without play
    #: buckling of the walls of each segment of a shell, in the static state with the largest tip
    #: deflection; empty for beams and without the table ``buckling``
    buckling: list[WallBuckling] = field(default_factory=list)
    #: estimates of the lowest buckling factors by panel formulas, in the same state
    panels: list[PanelBuckling] = field(default_factory=list)
    #: residual vibration of telescoping; None without telescoping, without an equilibrium, or if
    #: the run ends before the drives stop
    residual_vibration: ResidualVibration | None = None
    hoisting: Hoisting | None = None  #: extreme values of a load on a rope; None without a hoist
    #: demand on the drives of hoisting, slewing and luffing; None without them
    drives: CraneDrives | None = None

    @property
    def farthest_static(self) -> StaticResult | None:
        """The static state with the largest total tip deflection; None if there is none."""
        return max(
            [*self.static, *self.static_extended],
            key=lambda rest: hypot(rest.tip, rest.tip_lateral or 0.0),
            default=None,
        )


@dataclass(frozen=True, slots=True)
class PlayDifference:
    """Effect of play on one result."""

    #: name of the result, as in :class:`Peak`, or ``deflection at rest``, ``first frequency``,
    #: ``stress``
    what: str
    where: str  #: location of the result; empty for the whole boom
    unit: str  #: SI unit
    with_play: float  #: absolute value of the result with play
    bonded: float  #: absolute value of the result without play

    @property
    def increase(self) -> float:
        """The increase by play, in the unit of the result."""
        return self.with_play - self.bonded

    @property
    def share(self) -> float | None:
        """The increase as a fraction of the value without play; None if this value is near zero."""
        return self.increase / self.bonded if self.bonded > _LEAST * self.with_play else None


@dataclass(frozen=True, slots=True)
class PlayEffect:
    """Effect of play on the results of one model."""

    model: str  #: name of the model with play
    numbers: list[PlayDifference]  #: static, modal and dynamic results, with and without play


@dataclass(frozen=True, slots=True)
class QualityNote:
    """Note on the accuracy of the results."""

    #: subject: ``agreement``, ``horizon``, ``reduction``, ``mesh``, ``energy`` or ``step``
    what: str
    line: str  #: text of the note


@dataclass(frozen=True, slots=True)
class DesignResults:
    """Design results of a run."""

    models: dict[str, ModelDesignResults]  #: design results of each model, by its name
    #: static support reactions under the loads at t = 0, of beam elements as in ``check``; empty
    #: without an equilibrium
    reactions: list[Reaction] = field(default_factory=list)
    #: static support reactions without play
    reactions_bonded: list[Reaction] = field(default_factory=list)
    #: comparison of the modes of all models; None if fewer than two models have modes
    modes: ModeComparison | None = None
    play: list[PlayEffect] = field(default_factory=list)  #: effect of play in each model with play
    quality_notes: list[QualityNote] = field(default_factory=list)  #: notes on the accuracy
    #: statics of all load cases and combinations, as beam elements
    combinations: list[CombinationResult] = field(default_factory=list)
    proofs: Proofs | None = None  #: their proofs; None without load cases and combinations


def play_effects(models: list[Model], design: Mapping[str, ModelDesignResults]) -> list[PlayEffect]:
    """Return the effect of play in each model with play.

    ``models`` are those that did not fail.
    """
    return [
        PlayEffect(model.name, [*_static_differences(results), *_motion_differences(results)])
        for model in models
        if not model.bonded
        for results in [design[model.name]]
    ]


def _static_differences(results: ModelDesignResults) -> Iterator[PlayDifference]:
    bonded = {rest.time: rest for rest in results.static_bonded}
    both = [(rest, bonded[rest.time]) for rest in results.static if rest.time in bonded]
    if both:
        rest, other = max(both, key=lambda pair: abs(pair[0].tip))
        yield PlayDifference("deflection at rest", "tip", "m", abs(rest.tip), abs(other.tip))
    if results.modes and results.modes_bonded:
        first = results.modes[0]
        alike = (mode.frequency for mode in results.modes_bonded if mode.motion == first.motion)
        yield PlayDifference(
            "first frequency", first.motion, "Hz", first.frequency, next(alike, 0.0)
        )


def _motion_differences(results: ModelDesignResults) -> Iterator[PlayDifference]:
    if results.motion is None or results.motion_bonded is None:
        return
    others = {(peak.what, peak.where): peak.largest for peak in results.motion_bonded.peaks}
    for peak in results.motion.peaks:
        if (named := (peak.what, peak.where)) in others:
            yield PlayDifference(*named, peak.unit, peak.largest, others[named])
    stresses = {fibre.segment: abs(fibre.stress) for fibre in results.motion_bonded.fibres}
    for fibre in results.motion.fibres:
        if fibre.segment in stresses:
            here = abs(fibre.stress), stresses[fibre.segment]
            yield PlayDifference("stress", fibre.segment, "Pa", *here)
    damages = {life.segment: life.life_damage for life in results.life_bonded}
    for life in results.life:
        other = damages.get(life.segment)
        if life.life_damage is not None and other is not None:
            yield PlayDifference("damage", life.segment, "1", life.life_damage, other)
