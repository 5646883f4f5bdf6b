# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a sweep charts of each model's motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from runs.pipeline.results import Results

# Name of the quantity → its value in SI, None where a model has none.
Measured = dict[str, float | None]

# The tip has settled when it stays within this part of its initial amplitude.
BAND = 0.05
# Its final mean is that of the last part of the run, for which it must have stayed there at least.
FINAL = 0.2
# A tip at rest, which started in equilibrium say, moves by round-off of this part.
ROUND_OFF = 1.0e-12


@dataclass(frozen=True, slots=True)
class Quantity:
    """One number of a model's motion.

    Args:
        name: in files.
        unit: in files, SI.
        title: for people, a lower-case phrase.
        factor: from the SI unit to the shown one.
        shown_unit: of tables and charts.
        logarithmic: whether it spans decades.
    """

    name: str
    unit: str
    title: str
    factor: float
    shown_unit: str
    logarithmic: bool = False


QUANTITIES = (
    Quantity("tip_amplitude", "m", "tip amplitude", 1.0e3, "mm"),
    Quantity("peak_contact_force", "N", "peak contact force", 1.0e-3, "kN"),
    Quantity("settling_time", "s", "settling time", 1.0, "s"),
    Quantity("first_contact", "s", "first contact", 1.0, "s"),
    Quantity("energy_residual", "1", "energy residual", 1.0, "–", logarithmic=True),
)


def measure(results: Results, model: str) -> Measured:
    """The quantities of one model of a run.

    The tip's amplitude is half the way between its highest and its lowest place, without what it
    sags by at rest; the peak contact force the largest at any station.
    """
    time = np.asarray(results.trajectories["time"].values, dtype=float)
    tip = np.asarray(results.trajectories["tip"].sel(model=model).values, dtype=float)
    summary = results.summary.models[model]
    return {
        "tip_amplitude": float(0.5 * np.ptp(tip)),
        "peak_contact_force": summary.peak_contact_force,
        "settling_time": settling_time(time, tip),
        "first_contact": summary.first_contact,
        "energy_residual": summary.energy_residual,
    }


def settling_time(time: Array, tip: Array) -> float | None:
    """After which time the tip stays within 5 % of its initial amplitude around its final mean.

    The final mean is that of the last fifth of the run; the initial amplitude is the largest
    distance from it. None where the tip leaves the band within that last fifth: it does not settle
    within the run. That fifth must be longer than the slowest oscillation for this to mean much.

    Args:
        time: (num_times,) in s, rising.
        tip: (num_times,) in m.
    """
    last = time >= time[-1] - FINAL * (time[-1] - time[0])
    off = np.abs(tip - tip[last].mean())
    outside = off > max(BAND * off.max(), ROUND_OFF * np.abs(tip).max())
    if outside[last].any():
        return None
    # What is inside from the start settles at once.
    return float(time[np.flatnonzero(outside)[-1] + 1]) if outside.any() else float(time[0])
