# SPDX-License-Identifier: LGPL-3.0-or-later
"""Design results of a run in ``summary.json`` beside its rows, in SI units."""

from __future__ import annotations

from dataclasses import dataclass, field

from protractile.analysis.modes import ModeComparison
from protractile.analysis.wall_buckling import WallBuckling
from protractile.runs.pipeline.residual_vibration import ResidualVibration
from protractile.runs.pipeline.turning import CraneDrives, Hoisting


@dataclass(frozen=True, slots=True)
class ModelDesignResults:
    """Design results of one model that are no extremes of a quantity at a place."""

    #: buckling of the walls of each segment of a shell, in the static state with the largest tip
    #: deflection; empty for beams and without the table ``buckling``
    buckling: list[WallBuckling] = field(default_factory=list)
    #: residual vibration of telescoping; None without telescoping, without an equilibrium, or if
    #: the run ends before the drives stop
    residual_vibration: ResidualVibration | None = None
    hoisting: Hoisting | None = None  #: extreme values of a load on a rope; None without a hoist
    #: demand on the drives of hoisting, slewing and luffing; None without them
    drives: CraneDrives | None = None


@dataclass(frozen=True, slots=True)
class QualityNote:
    """Note on the accuracy of the results."""

    #: subject: ``agreement``, ``horizon``, ``reduction``, ``mesh``, ``energy`` or ``step``
    what: str
    line: str  #: text of the note


@dataclass(frozen=True, slots=True)
class DesignResults:
    """Design results of a run that are no extremes of a quantity at a place."""

    models: dict[str, ModelDesignResults]  #: design results of each model, by its name
    #: comparison of the modes of all models; None if fewer than two models have modes
    modes: ModeComparison | None = None
    quality_notes: list[QualityNote] = field(default_factory=list)  #: notes on the accuracy
    #: names of all load cases and combinations; without rows, one has no equilibrium
    combinations: list[str] = field(default_factory=list)
    proof_notes: list[str] = field(default_factory=list)  #: notes on missing proofs
