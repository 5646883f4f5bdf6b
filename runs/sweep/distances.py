# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distances of the models of a sweep from a reference.

Tips are compared at every instant as long as they are predictable: to the end where friction under
prescribed forces makes motions regular, else until a small change of the loads makes the reference
diverge from itself. All other quantities are of the whole run.
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
from runs.case.kinds.model import Workshop
from runs.case.schema import Case, Model
from runs.pipeline.low_pass import mean_period
from runs.pipeline.metrics import Metric
from runs.pipeline.models import MotionPlan, build
from runs.pipeline.quantities import Measured
from runs.pipeline.results import Results

if TYPE_CHECKING:
    from mpi4py import MPI

    from runs.folder.cache import Cache

# Relative change of the loads that measures the predictability of the reference.
CHANGE = 1.0e-6
# Time in s over which the force of a pad is averaged: single impacts last microseconds.
HELD = 0.02

TIP_OFF = "tip_off"
# Each as a part of the reference's.
DISTANCES = (
    Metric("first_peak_off", "1", "first peak deviation", TO_PERCENT, "%"),
    Metric("slow_period_off", "1", "slow period deviation", TO_PERCENT, "%"),
    Metric("pad_force_off", "1", "pad force deviation", TO_PERCENT, "%"),
    Metric("stress_off", "1", "stress deviation", TO_PERCENT, "%"),
    Metric(TIP_OFF, "1", "tip deviation", TO_PERCENT, "%"),
)
# Times in s up to which tips are compared: of a point, and of all its models.
UNTIL = "compared_until"
# Contours in percent.
LEVELS = (1.0, 5.0, 20.0)


@dataclass(frozen=True, slots=True)
class Features:
    """Compared features of a model."""

    tip: Array  #: (num_times,) in m, as long as it is compared
    first_peak: float  #: in m
    slow_period: float  #: mean time between the tip's outstanding peaks in s
    pad_force: float  #: the largest mean over ``HELD`` at any station in N
    stress: float  #: the largest of an outer fibre in Pa

    @classmethod
    def of(cls, results: Results, model: str, stress: float | None, until: float) -> Features:
        """Return the features of a model of a run, whose tip is compared up to a time in s."""
        data = results.trajectories.sel(model=model)
        time = np.asarray(data["time"].values, dtype=float)
        tip = np.asarray(data["tip"].values, dtype=float)
        _, height = results.summary.models[model].first_peak["tip"]
        return cls(
            tip[time <= until],
            np.nan if height is None else height,
            mean_period(time, tip),
            held_force(time, np.asarray(data["contact_force"].values)),
            np.nan if stress is None else stress,
        )

    def distances_from(self, reference: Features) -> Measured:
        """Return the distances from the reference; None where one of both has no number."""
        span = float(np.ptp(reference.tip)) if reference.tip.size else 0.0
        apart = float(np.abs(self.tip - reference.tip).max()) / span if span else np.nan
        parts = {
            name: abs(getattr(self, name) / getattr(reference, name) - 1.0)
            for name in ("first_peak", "slow_period", "pad_force", "stress")
            if getattr(reference, name)
        } | {"tip": apart}
        found = {one.name: parts.get(one.name.removesuffix("_off"), np.nan) for one in DISTANCES}
        return {name: part if np.isfinite(part) else None for name, part in found.items()}


def held_force(time: Array, forces: Array) -> float:
    """Return the largest mean over ``HELD`` in N; NaN where no contact lasts that long.

    Args:
        time: (num_times,) in s, evenly spaced.
        forces: (num_times, num_stations) in N, means of the output intervals.
    """
    if time.size < 2 or not np.isfinite(forces).any():
        return float("nan")
    count = max(1, round(HELD / (time[1] - time[0])))
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
    """Return the time in s up to which motions can be compared at every instant.

    Args:
        case: a checked one.
        model: the reference, of the case.
        results: of its run.
        comm, cache: as of :class:`runs.pipeline.context.RunContext`.
    """
    time = np.asarray(results.trajectories["time"].values, dtype=float)
    end = float(time[-1])
    if model.bonded or case.regular:
        return end
    tools = None if comm is None else Workshop(comm, cache=cache)
    plan = MotionPlan.of(build(case, build_boom(case), model, tools).system, case, model)
    vary: Vary = "load" if plan.motion.system.largest_load.any() else "velocity"
    try:
        same = plan.integrator.like(plan.trajectory())
        (run,) = run_members([EnsembleMember(plan.motion, vary, CHANGE, same, ("tip",))])
    except NumericsError:
        # Differences that one time step more or less decides are not compared.
        return float(time[0])
    tip = results.trajectories["tip"].sel(model=model.name).values
    return float(
        np.nan_to_num(horizon(np.array([tip, run["tip"].values]), time, SHARES[0]), nan=end)
    )
