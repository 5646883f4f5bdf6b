# SPDX-License-Identifier: LGPL-3.0-or-later
"""Quantities of each model that a sweep charts, and distances of models from a reference.

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
from geometry.typography import TO_KILO, TO_MEGA, TO_MILLI, TO_PERCENT
from runs.case.build import build_boom
from runs.case.kinds.model import Workshop
from runs.case.schema import Case, Model
from runs.pipeline.design_results import ModelDesignResults
from runs.pipeline.low_pass import mean_period
from runs.pipeline.metrics import Metric, metrics, records
from runs.pipeline.models import MotionPlan, build
from runs.pipeline.results import Results
from runs.pipeline.summary import ModelSummary

if TYPE_CHECKING:
    from mpi4py import MPI

    from runs.folder.cache import Cache

# Name of the quantity → its value in SI units, None where a model has none.
Measured = dict[str, float | None]

# The tip has settled when it stays within this part of its initial amplitude.
BAND = 0.05
# Its final mean is that of the last part of the run, for which it must have stayed there at least.
FINAL = 0.2
# A tip at rest, for example started in equilibrium, moves by round-off of this part.
ROUND_OFF = 1.0e-12
# Relative change of the loads that measures the predictability of the reference.
CHANGE = 1.0e-6
# Time in s over which the force of a pad is averaged: single impacts last microseconds.
HELD = 0.02


# Sources of a model's numbers beside its fields: results that are records, and its summary.
_DECLARING: list[type] = [*records(ModelDesignResults).values(), ModelSummary]

# Quantities of the boom at rest, of its motion, and of its accuracy.
QUANTITIES = (
    Metric("tip_at_rest", "m", "tip at rest", TO_MILLI, "mm"),
    Metric("tip_amplitude", "m", "tip amplitude", TO_MILLI, "mm"),
    Metric("dynamic_factor", "1", "dynamic factor", 1.0, "–"),
    Metric("contact_force", "N", "contact force", TO_KILO, "kN"),
    Metric("stress", "Pa", "stress", TO_MEGA, "MPa"),
    Metric("wall_stress", "Pa", "wall stress", TO_MEGA, "MPa"),
    Metric("damage", "1", "damage", 1.0, "–", logarithmic=True),
    Metric("first_frequency", "Hz", "first frequency", 1.0, "Hz"),
    Metric("mass", "kg", "mass", 1.0, "kg"),
    Metric("settling_time", "s", "settling time", 1.0, "s"),
    Metric("drive_force", "N", "largest force of an elastic drive", TO_KILO, "kN"),
    Metric("drive_slip", "m", "longest slip on a drive", TO_MILLI, "mm"),
    *(one for kind in _DECLARING for one in metrics(kind).values() if one.name),
)

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


def measure(results: Results, model: str) -> Measured:
    """Return the quantities of one model of a run.

    The tip at rest is the static deflection under the largest loads, at any extension. The tip's
    amplitude, its dynamic part, is half the distance between its highest and its lowest place. The
    dynamic factor is the largest deflection over the largest at rest. The contact force is the
    largest mean of an output interval at any station, since the peak of an impact is too short to
    load a pad. The stress is that of an outer fibre, from section forces. The wall stress is a
    shell's own over a patch. The damage is that of a fatigue life at the governing place. Residual
    vibration is that of :class:`runs.pipeline.residual_vibration.ResidualVibration`; force and slip
    of elastic drives are those of :class:`dynamics.drive.stick_slip.StickSlip`.
    """
    time = np.asarray(results.trajectories["time"].values, dtype=float)
    tip = np.asarray(results.trajectories["tip"].sel(model=model).values, dtype=float)
    summary = results.summary.models[model]
    own = results.summary.design.models.get(model, ModelDesignResults())
    declaring = [*(getattr(own, name) for name in records(ModelDesignResults)), summary]
    moved = own.motion
    peaks = () if moved is None else moved.peaks
    deflection = next((peak for peak in peaks if peak.what == "deflection"), None)
    contacts = (peak.largest for peak in peaks if peak.what == "contact force")
    fibres = () if moved is None else (abs(fibre.stress) for fibre in moved.fibres)
    walls = () if moved is None else (wall.patch for wall in moved.walls)
    damages = (one.life_damage for one in own.life if one.life_damage is not None)
    return {
        "tip_at_rest": None if deflection is None else deflection.at_rest,
        "tip_amplitude": float(0.5 * np.ptp(tip)),
        "dynamic_factor": None if deflection is None else deflection.factor,
        "contact_force": max(contacts, default=None),
        "stress": max(fibres, default=None),
        "wall_stress": max(walls, default=None),
        "damage": max(damages, default=None),
        "first_frequency": own.modes[0].frequency if own.modes else None,
        # Of all segments and the masses that they carry.
        "mass": sum(segment.mass for segment in results.boom.segments),
        "drive_force": max((one.peak for one in summary.stick_slip.values()), default=None),
        "drive_slip": max((one.slip for one in summary.stick_slip.values()), default=None),
        "settling_time": settling_time(time, tip),
    } | {
        metric.name: getattr(record, field, None)
        for record, kind in zip(declaring, _DECLARING, strict=True)
        for field, metric in metrics(kind).items()
        if metric.name
    }


def settling_time(time: Array, tip: Array) -> float | None:
    """Return the time from which the tip stays within 5 % of its initial amplitude.

    The band lies around the final mean, that of the last fifth of the run; the initial amplitude is
    the largest distance from it. None where the tip leaves the band within that last fifth: it does
    not settle within the run. That fifth must be longer than the slowest oscillation for this to
    mean much.

    Args:
        time: (num_times,) in s, rising.
        tip: (num_times,) in m.
    """
    last = time >= time[-1] - FINAL * (time[-1] - time[0])
    off = np.abs(tip - tip[last].mean())
    outside = off > max(BAND * off.max(), ROUND_OFF * np.abs(tip).max())
    if outside[last].any():
        return None
    # A tip inside from the start settles at once.
    return float(time[np.flatnonzero(outside)[-1] + 1]) if outside.any() else float(time[0])


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
