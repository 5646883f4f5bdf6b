# SPDX-License-Identifier: LGPL-3.0-or-later
"""Differences of the models of a sweep from a reference model.

Tip deflections are compared at equal times while they are predictable: over the whole run if
friction prevents divergence, otherwise until a run with slightly changed loads diverges. Other
quantities are compared over the whole run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from protractile.analysis.low_pass import mean_period
from protractile.analysis.quantities import Quantity
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.motion import Motion
from protractile.dynamics.predictability import SHARES, EnsembleMember, Vary, horizon, run_members
from protractile.geometry.arrays import Array
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.schema import Case, Model
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.models import MotionPlan, build
from protractile.runs.pipeline.quantities import Quantities
from protractile.runs.pipeline.results import Results

if TYPE_CHECKING:
    from mpi4py import MPI

# Relative change of the loads in the run whose divergence ends the comparison of tips.
CHANGE = 1.0e-6
# Time in s over which pad forces are averaged, since single impacts last microseconds.
AVERAGING_TIME = 0.02

TIP_DEVIATION = "tip_off"
# Relative differences from the reference.
DISTANCES = (
    Quantity("first_peak_off", "1", "first peak deviation", shown="%"),
    Quantity("slow_period_off", "1", "slow period deviation", shown="%"),
    Quantity("pad_force_off", "1", "pad force deviation", shown="%"),
    Quantity("stress_off", "1", "stress deviation", shown="%"),
    Quantity(TIP_DEVIATION, "1", "tip deviation", shown="%"),
)
# Name of the variable with the time in s up to which tips are compared.
UNTIL = "compared_until"
# Levels of contour lines in percent.
LEVELS = (1.0, 5.0, 20.0)


@dataclass(frozen=True, slots=True)
class Features:
    """Results of a model that are compared with the reference."""

    tip: Array  #: tip deflections (num_times,) in m, up to the end of the comparison
    first_peak: float  #: height of the first peak in m
    slow_period: float  #: mean time between the main peaks of the tip in s
    pad_force: float  #: largest force at any station in N, averaged over 0.02 s
    stress: float  #: largest stress of an outer fibre in Pa

    @classmethod
    def of(cls, results: Results, model: str, stress: float | None, until: float) -> Features:
        """Return the results of a model; ``until`` in s is the end of the comparison of the tip."""
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
        """Return the relative differences by name; None where either model has no value."""
        span = float(np.ptp(reference.tip)) if reference.tip.size else 0.0
        tip_difference = float(np.abs(self.tip - reference.tip).max()) / span if span else np.nan
        differences = {
            name: abs(getattr(self, name) / getattr(reference, name) - 1.0)
            for name in ("first_peak", "slow_period", "pad_force", "stress")
            if getattr(reference, name)
        } | {"tip": tip_difference}
        distances = {
            distance.name: differences.get(distance.name.removesuffix("_off"), np.nan)
            for distance in DISTANCES
        }
        return {name: part if np.isfinite(part) else None for name, part in distances.items()}


def sustained_force(time: Array, forces: Array) -> float:
    """Return the largest moving mean of contact forces in N over 0.02 s; NaN for shorter runs.

    Args:
        time: evenly spaced times (num_times,) in s.
        forces: mean forces (num_times, num_stations) in N over output intervals.
    """
    if time.size < 2 or not np.isfinite(forces).any():
        return float("nan")
    count = max(1, round(AVERAGING_TIME / (time[1] - time[0])))
    sums = np.cumsum(np.pad(forces, ((1, 0), (0, 0))), axis=0)
    means = (sums[count:] - sums[:-count]) / count
    return float(np.nanmax(np.abs(means))) if means.size else float("nan")


def varied_data(motion: Motion) -> Vary:
    """Return the data of a motion whose small changes show where it is predictable."""
    return "load" if motion.system.largest_load.any() else "velocity"


def comparison_end(
    case: Case,
    model: Model,
    results: Results,
    comm: MPI.Intracomm | None,
    cache: Cache | None,
) -> float:
    """Return the time in s up to which tips are compared, from the results of the reference."""
    time = np.asarray(results.trajectories["time"].values, dtype=float)
    end = float(time[-1])
    if model.bonded or case.regular:
        return end
    context = None if comm is None else BuildContext(comm, cache=cache)
    plan = MotionPlan.of(build(case, build_boom(case), model, context).system, case, model)
    try:
        integrator = plan.integrator.like(plan.trajectory())
        vary = varied_data(plan.motion)
        (run,) = run_members([EnsembleMember(plan.motion, vary, CHANGE, integrator, ("tip",))])
    except NumericsError:
        # The run with changed loads fails, and only the initial states are compared.
        return float(time[0])
    tip = results.trajectories["tip"].sel(model=model.name).values
    return float(
        np.nan_to_num(horizon(np.array([tip, run["tip"].values]), time, SHARES[0]), nan=end)
    )
