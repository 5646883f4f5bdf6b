# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distances of the models of a sweep from a reference.

Tips are compared pointwise while they are predictable: over the whole run if friction makes the
motion regular, otherwise until a small change of the loads diverges. Other quantities are compared
over the whole run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from dynamics.failure import NumericsError
from dynamics.predictability.ensemble import EnsembleMember, Vary, run_members
from dynamics.predictability.horizon import SHARES, horizon
from geometry.arrays import Array
from geometry.typography import TO_PERCENT
from runs.case.build import build_boom
from runs.case.kinds.model import BuildContext
from runs.case.schema import Case, Model
from runs.pipeline.low_pass import mean_period
from runs.pipeline.metrics import Metric
from runs.pipeline.models import MotionPlan, build
from runs.pipeline.quantities import Quantities
from runs.pipeline.results import Results

if TYPE_CHECKING:
    from mpi4py import MPI

    from runs.folder.cache import Cache

# Relative change of the loads whose growth ends the comparison of tips.
CHANGE = 1.0e-6
# Averaging time of pad forces in s. Single impacts last microseconds.
AVERAGING_TIME = 0.02

TIP_DEVIATION = "tip_off"
# Distances, as fractions of the values of the reference.
DISTANCES = (
    Metric("first_peak_off", "1", "first peak deviation", TO_PERCENT, "%"),
    Metric("slow_period_off", "1", "slow period deviation", TO_PERCENT, "%"),
    Metric("pad_force_off", "1", "pad force deviation", TO_PERCENT, "%"),
    Metric("stress_off", "1", "stress deviation", TO_PERCENT, "%"),
    Metric(TIP_DEVIATION, "1", "tip deviation", TO_PERCENT, "%"),
)
# Variable with the end of the comparison of tips in s.
UNTIL = "compared_until"
# Contours in percent.
LEVELS = (1.0, 5.0, 20.0)


@dataclass(frozen=True, slots=True)
class Features:
    """Results of a model for comparison with the reference."""

    tip: Array  #: tip deflection (num_times,) in m up to the end of the comparison
    first_peak: float  #: height of the first peak in m
    slow_period: float  #: mean time between the main peaks of the tip in s
    pad_force: float  #: largest force at any station in N, averaged over 0.02 s
    stress: float  #: largest stress of an outer fibre in Pa

    @classmethod
    def of(cls, results: Results, model: str, stress: float | None, until: float) -> Features:
        """Return the compared results of a model; ``until`` is the end of the comparison in s."""
        data = results.trajectories.sel(model=model)
        time = np.asarray(data["time"].values, dtype=float)
        tip = np.asarray(data["tip"].values, dtype=float)
        _, height = results.summary.models[model].first_peak["tip"]
        return cls(
            tip[time <= until],
            np.nan if height is None else height,
            mean_period(time, tip),
            sustained_force(time, np.asarray(data["contact_force"].values)),
            np.nan if stress is None else stress,
        )

    def distances_from(self, reference: Features) -> Quantities:
        """Return the distances from the reference; None if either model has no value."""
        span = float(np.ptp(reference.tip)) if reference.tip.size else 0.0
        apart = float(np.abs(self.tip - reference.tip).max()) / span if span else np.nan
        parts = {
            name: abs(getattr(self, name) / getattr(reference, name) - 1.0)
            for name in ("first_peak", "slow_period", "pad_force", "stress")
            if getattr(reference, name)
        } | {"tip": apart}
        distances = {
            one.name: parts.get(one.name.removesuffix("_off"), np.nan) for one in DISTANCES
        }
        return {name: part if np.isfinite(part) else None for name, part in distances.items()}


def sustained_force(time: Array, forces: Array) -> float:
    """Return the largest contact force in N, averaged over 0.02 s; NaN if the run is too short.

    Args:
        time: evenly spaced times (num_times,) in s.
        forces: means (num_times, num_stations) over output intervals in N.
    """
    if time.size < 2 or not np.isfinite(forces).any():
        return float("nan")
    count = max(1, round(AVERAGING_TIME / (time[1] - time[0])))
    sums = np.cumsum(np.pad(forces, ((1, 0), (0, 0))), axis=0)
    means = (sums[count:] - sums[:-count]) / count
    return float(np.nanmax(np.abs(means))) if means.size else float("nan")


def comparable_until(
    case: Case,
    model: Model,
    results: Results,
    comm: MPI.Intracomm | None,
    cache: Cache | None,
) -> float:
    """Return the time in s up to which motions are compared pointwise.

    Args:
        case: a checked case.
        model: reference model of the case.
        results: results of the run.
        comm: ranks that share shells; None without shells.
        cache: cache of reduced shells.
    """
    time = np.asarray(results.trajectories["time"].values, dtype=float)
    end = float(time[-1])
    if model.bonded or case.regular:
        return end
    tools = None if comm is None else BuildContext(comm, cache=cache)
    plan = MotionPlan.of(build(case, build_boom(case), model, tools).system, case, model)
    vary: Vary = "load" if plan.motion.system.largest_load.any() else "velocity"
    try:
        same = plan.integrator.like(plan.trajectory())
        (run,) = run_members([EnsembleMember(plan.motion, vary, CHANGE, same, ("tip",))])
    except NumericsError:
        # The changed motion cannot be computed, and only the initial state is compared.
        return float(time[0])
    tip = results.trajectories["tip"].sel(model=model.name).values
    return float(
        np.nan_to_num(horizon(np.array([tip, run["tip"].values]), time, SHARES[0]), nan=end)
    )
