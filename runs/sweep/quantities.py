# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a sweep charts of each model: at rest, in motion, and what it is worth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.boom import Boom
from geometry.typography import TO_KILO, TO_MEGA, TO_MILLI, TO_PERCENT
from runs.pipeline.answers import ModelAnswers
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
    """One number of a model."""

    name: str  #: in files
    unit: str  #: in files, SI
    title: str  #: for people, a lower-case phrase
    factor: float  #: from the SI unit to the shown one
    shown_unit: str  #: of tables and charts
    logarithmic: bool = False  #: whether it spans decades
    charted: bool = True  #: whether it is a curve and no noise


# Of the tip, as a part of its range.
STEP_ERROR = Quantity("step_error", "1", "error by the time step", TO_PERCENT, "%", charted=False)

# Of the boom at rest, of its motion, and of what it is worth.
QUANTITIES = (
    Quantity("tip_at_rest", "m", "tip at rest", TO_MILLI, "mm"),
    Quantity("tip_amplitude", "m", "tip amplitude", TO_MILLI, "mm"),
    Quantity("dynamic_factor", "1", "dynamic factor", 1.0, "–"),
    Quantity("contact_force", "N", "contact force", TO_KILO, "kN"),
    Quantity("stress", "Pa", "stress", TO_MEGA, "MPa"),
    Quantity("wall_stress", "Pa", "wall stress", TO_MEGA, "MPa"),
    Quantity("damage", "1", "damage", 1.0, "–", logarithmic=True),
    Quantity("first_frequency", "Hz", "first frequency", 1.0, "Hz"),
    Quantity("mass", "kg", "mass", 1.0, "kg"),
    Quantity("settling_time", "s", "settling time", 1.0, "s"),
    Quantity("first_contact", "s", "first contact", 1.0, "s"),
    Quantity("swing", "m", "swing while drawn out", TO_MILLI, "mm"),
    Quantity(
        "swing_where_begun", "m", "swing at rest where it begins", TO_MILLI, "mm", charted=False
    ),
    Quantity(
        "swing_where_ended", "m", "swing at rest where it ends", TO_MILLI, "mm", charted=False
    ),
    Quantity("drive_force", "N", "largest force of a drive that gives way", TO_KILO, "kN"),
    Quantity("drive_slip", "m", "longest slip on a drive", TO_MILLI, "mm"),
    Quantity("drive_speed", "m/s", "mean speed of the drive", 1.0, "m/s", charted=False),
    Quantity("peak_contact_force", "N", "peak of a blow", TO_KILO, "kN", charted=False),
    Quantity("energy_residual", "1", "energy residual", 1.0, "–", charted=False),
    STEP_ERROR,
)


def measure(results: Results, model: str) -> Measured:
    """The quantities of one model of a run.

    The tip at rest is that under the largest loads, wherever it is drawn to, the deflection's
    static part; the tip's amplitude, its dynamic part, is half the way between its highest and its
    lowest place. The dynamic factor is the largest deflection over the largest at rest. The contact
    force is the largest mean of an output interval at any station, the peak of a blow what no pad
    feels as long; the stress that of an outer fibre, of section forces, the wall stress a shell's
    own over a patch, the damage that of a life at the worst place. Swings are those of
    :class:`runs.pipeline.answers.Swing`; force and slip of drives of a given stiffness are those of
    :class:`dynamics.drive.stick_slip.StickSlip`.
    """
    time = np.asarray(results.trajectories["time"].values, dtype=float)
    tip = np.asarray(results.trajectories["tip"].sel(model=model).values, dtype=float)
    summary, answers = results.summary.models[model], results.summary.answers.models
    return {
        **_answered(answers.get(model, ModelAnswers())),
        "tip_amplitude": float(0.5 * np.ptp(tip)),
        "peak_contact_force": summary.peak_contact_force,
        "mass": mass(results.boom),
        "drive_force": max((one.peak for one in summary.stick_slip.values()), default=None),
        "drive_slip": max((one.slip for one in summary.stick_slip.values()), default=None),
        "settling_time": settling_time(time, tip),
        "first_contact": summary.first_contact,
        "energy_residual": summary.energy_residual,
        STEP_ERROR.name: summary.step_error,
    }


def _answered(own: ModelAnswers) -> Measured:
    """What a model answers."""
    peaks = () if own.moved is None else own.moved.peaks
    fibres, walls = ((), ()) if own.moved is None else (own.moved.fibres, own.moved.walls)
    tip = next((peak for peak in peaks if peak.what == "deflection"), None)
    contacts = (peak.largest for peak in peaks if peak.what == "contact force")
    damages = (one.life_damage for one in own.life if one.life_damage is not None)
    return {
        "tip_at_rest": None if tip is None else tip.at_rest,
        "dynamic_factor": None if tip is None else tip.factor,
        "contact_force": max(contacts, default=None),
        "stress": max((abs(fibre.stress) for fibre in fibres), default=None),
        "wall_stress": max((wall.patch for wall in walls), default=None),
        "damage": max(damages, default=None),
        "first_frequency": own.modes[0].frequency if own.modes else None,
        "swing": None if own.swing is None else own.swing.tip,
        "swing_where_begun": None if own.swing is None else own.swing.where_begun,
        "swing_where_ended": None if own.swing is None else own.swing.where_ended,
        "drive_speed": None if own.swing is None else own.swing.speed,
    }


def mass(boom: Boom) -> float:
    """Of all segments and of what they carry, in kg."""
    return sum(segment.mass for segment in boom.segments)


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
