# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far the models of a point are from one of them, the reference.

Tips are compared from moment to moment as long as that says anything: to the end where friction
under given forces makes motions regular, else until a small change of the loads parts the reference
from itself. All else is of the whole run.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.signal import find_peaks

from dynamics.failure import NumericsError
from dynamics.predictability.ensemble import Member, Vary, run_members
from dynamics.predictability.horizon import SHARES, horizon
from geometry.arrays import Array
from geometry.typography import TO_PERCENT
from runs.case.build import build_boom
from runs.case.kinds.model import Workshop
from runs.case.schema import Case, Model
from runs.pipeline.models import Plan, build
from runs.pipeline.results import Results
from runs.sweep.quantities import Measured, Quantity

if TYPE_CHECKING:
    from mpi4py import MPI

    from runs.folder.cache import Cache

TIP_OFF = "tip_off"
# Each as a part of the reference's.
DISTANCES = (
    Quantity("first_peak_off", "1", "first peak off", TO_PERCENT, "%"),
    Quantity("slow_period_off", "1", "slow period off", TO_PERCENT, "%"),
    Quantity("pad_force_off", "1", "pad force off", TO_PERCENT, "%"),
    Quantity("stress_off", "1", "stress off", TO_PERCENT, "%"),
    Quantity(TIP_OFF, "1", "tip off", TO_PERCENT, "%"),
)
# Up to when tips are compared, in s: of a point, and of all its models.
UNTIL = "compared_until"
# Contours in percent.
LEVELS = (1.0, 5.0, 20.0)

# The relative change of the loads that tells how long the reference can be predicted.
CHANGE = 1.0e-6
# In s, over which the force of a pad is averaged: single blows are a matter of microseconds.
HELD = 0.02
# Slow peaks stand out by this part of the tip's range.
OUTSTANDING = 0.2


@dataclass(frozen=True, slots=True)
class Seen:
    """What is compared of a model."""

    tip: Array  #: (num_times,) in m, as long as it is compared
    first_peak: float  #: in m
    slow_period: float  #: mean time between the tip's outstanding peaks in s
    pad_force: float  #: the largest mean over ``HELD`` at any station in N
    stress: float  #: the largest of an outer fibre in Pa

    @classmethod
    def of(cls, results: Results, model: str, stress: float | None, until: float) -> Seen:
        """Of a model of a run, whose tip is compared up to a time in s."""
        data = results.trajectories.sel(model=model)
        time = np.asarray(data["time"].values, dtype=float)
        tip = np.asarray(data["tip"].values, dtype=float)
        _, height = results.summary.models[model].first_peak["tip"]
        return cls(
            tip[time <= until],
            np.nan if height is None else height,
            slow_period(time, tip),
            held_force(time, np.asarray(data["contact_force"].values)),
            np.nan if stress is None else stress,
        )

    def off(self, reference: Seen) -> Measured:
        """The distances from the reference; None where one of both has no such number."""
        span = float(np.ptp(reference.tip)) if reference.tip.size else 0.0
        apart = float(np.abs(self.tip - reference.tip).max()) / span if span else np.nan
        parts = {
            name: abs(getattr(self, name) / getattr(reference, name) - 1.0)
            for name in ("first_peak", "slow_period", "pad_force", "stress")
            if getattr(reference, name)
        } | {"tip": apart}
        found = {one.name: parts.get(one.name.removesuffix("_off"), np.nan) for one in DISTANCES}
        return {name: part if np.isfinite(part) else None for name, part in found.items()}


def slow_period(time: Array, tip: Array) -> float:
    """In s; NaN where fewer than two peaks stand out.

    Args:
        time: (num_times,) in s.
        tip: (num_times,) in m, which sets out from its first value.
    """
    if tip.size < 3:
        return float("nan")
    off = tip - tip[0]
    side = np.sign(off[np.abs(off).argmax()])
    peaks, _ = find_peaks(side * tip, prominence=OUTSTANDING * np.ptp(tip))
    return float(np.diff(time[peaks]).mean()) if peaks.size > 1 else float("nan")


def held_force(time: Array, forces: Array) -> float:
    """The largest mean over ``HELD`` in N; NaN where nothing is known to touch for so long.

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
    """Until when motions can be compared from moment to moment, in s.

    Args:
        case: a checked one.
        model: the reference, of the case.
        results: what it has left.
        comm, cache: as of :class:`runs.pipeline.means.Means`.
    """
    time = np.asarray(results.trajectories["time"].values, dtype=float)
    end = float(time[-1])
    if model.play_free or case.regular:
        return end
    tools = None if comm is None else Workshop(comm, cache=cache)
    plan = Plan.of(build(case, build_boom(case), model, tools).system, case, model)
    vary: Vary = "load" if plan.motion.system.largest_load.any() else "velocity"
    try:
        same = plan.integrator.like(plan.trajectory())
        (run,) = run_members([Member(plan.motion, vary, CHANGE, same, ("tip",))])
    except NumericsError:
        # What one step more or less decides is compared nowhere.
        return float(time[0])
    tip = results.trajectories["tip"].sel(model=model.name).values
    return float(
        np.nan_to_num(horizon(np.array([tip, run["tip"].values]), time, SHARES[0]), nan=end)
    )
