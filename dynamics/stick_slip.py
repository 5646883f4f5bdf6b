# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stick-slip of a segment that an elastic drive telescopes.

The extension s of the mass m lags by Δs = s_c − s behind the extension s_c that the drive commands:

    m s̈ + c_d (ṡ − ṡ_c) + k_d (s − s_c) = f_d − R sign ṡ,   |k_d Δs + c_d ṡ_c + f_d| ≤ R_s in stick

k_d and c_d are stiffness and dashpot of the drive. R = μ Σ|N_l| is the friction of the pads, R_s
the static friction, f_d the inertia force that other drives cause. The boom moves with s_c; the lag
does not affect it. R is the mean over each output interval, which smooths the chatter of pads.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from protractile.dynamics.arrays import Array
from protractile.dynamics.excitation import History

# Largest step, as a phase angle in rad of the vibrating mass or a fraction of its decay time.
_PART = 0.1

# Variables of a trajectory for each elastic drive; the suffix of its travel follows each name.
ELASTIC_DRIVE_VARIABLES = {
    "drive_force": {"units": "N", "long_name": "drive force, mean of the output interval"},
    "drive_lag": {"units": "m", "long_name": "lag of the segment behind its drive"},
    "extension_speed": {"units": "m/s", "long_name": "speed of the segment in the outer one"},
    "extension_acceleration": {"units": "m/s2", "long_name": "acceleration of the segment"},
}


@dataclass(frozen=True, slots=True)
class ElasticDrive:
    """Elastic drive and the mass that it moves.

    >>> rope = ElasticDrive(mass=500.0, stiffness=1e5, dashpot=1e3, sticking=1.5)
    >>> print(f"{rope.frequency:.2f} Hz, damped by {100.0 * rope.damping_ratio:.1f} %")
    2.25 Hz, damped by 7.1 %

    Args:
        mass: mass of all moved segments in kg.
        stiffness: k_d of rope, chain or cylinder in N/m.
        dashpot: c_d parallel to the stiffness in N·s/m.
        sticking: ratio of static to sliding friction, at least 1.
        thrust: axial load towards the base in N, such as weight.
        coupled_drives: (mass in kg that both drives move, history) of each other drive.

    Raises:
        ValueError: a number is out of range.
    """

    mass: float
    stiffness: float
    dashpot: float = 0.0
    sticking: float = 1.0
    thrust: float = 0.0
    coupled_drives: tuple[tuple[float, History], ...] = ()

    def __post_init__(self) -> None:
        limits = {"mass": 0.0, "stiffness": 0.0, "dashpot": 0.0, "sticking": 1.0}
        for name, least in limits.items():
            value, above = getattr(self, name), name in ("mass", "stiffness")
            if not least <= value < np.inf or (above and value == least):
                word = "above" if above else "at least"
                raise ValueError(f"{name} must be finite and {word} {least:g}, got {value}")

    @property
    def frequency(self) -> float:
        """The undamped natural frequency in Hz."""
        return float(np.sqrt(self.stiffness / self.mass) / (2.0 * np.pi))

    @property
    def damping_ratio(self) -> float:
        """The damping ratio ζ = c_d / 2√(k_d m)."""
        return 0.5 * self.dashpot / float(np.sqrt(self.stiffness * self.mass))


@dataclass(frozen=True, slots=True)
class StickSlip:
    """Results of an elastic drive.

    Args:
        mean: mean |drive force| in N while the drive moves.
        peak: largest |drive force| in N.
        sticks: number of times that the segment sticks while the drive moves.
        slip: longest slip in m.
        speed, acceleration: largest speed in m/s and acceleration in m/s² of the segment.
        behind: lag at the end of the run in m, negative if the segment is ahead of its drive.
        energy_residual: error of the energy balance as a fraction of the input energy.
    """

    mean: float
    peak: float
    sticks: int
    slip: float
    speed: float
    acceleration: float
    behind: float
    energy_residual: float


class DriveMotion(NamedTuple):
    """Motion of a segment on an elastic drive: variables over time, and results."""

    series: dict[str, Array]
    results: StickSlip


def move_segment(
    drive: ElasticDrive, command: History, time: Array, friction: Array
) -> DriveMotion:
    """Return the motion of the segment from rest under the axial load.

    Within each step, the extension s_c of the drive and the inertia force f_d of other drives are
    linear; each period has at least 63 steps. Accelerations in f_d are second differences.
    Histories of other drives are mirrored at t = 0, so that an initial jump of their speed gives
    its whole impulse within the first step.

    Args:
        drive: elastic drive of the segment.
        command: history of s_c in m.
        time: (num_times,) in s, evenly spaced from 0 on.
        friction: R (num_times,) in N, the mean over the output interval that ends at each time.
    """
    from protractile.dynamics.kernels import stick_slip as kernel

    fastest = max(2.0 * np.pi * drive.frequency, drive.dashpot / drive.mass)
    output_step = float(time[1] - time[0])
    substeps = max(1, int(np.ceil(output_step * fastest / _PART)))
    count, step = time.size - 1, output_step / substeps
    times = step * np.arange(count * substeps + 1)
    push = np.zeros(times.size)
    for mass, other in drive.coupled_drives:
        change = other(times + step) - 2.0 * other(times) + other(np.abs(times - step))
        push -= mass * change / step**2
    recorded, sums, largest = np.zeros((count + 1, 3)), np.zeros((count + 1, 5)), np.zeros(6)
    kernel.march_stick_slip(
        kernel.SlidingMass(drive.mass, drive.stiffness, drive.dashpot, drive.sticking),
        step, substeps, command(times), push, friction, recorded, sums, largest,
    )  # fmt: skip
    lag, speed, _ = recorded.T
    force = np.diff(sums[:, kernel.IMPULSE], prepend=0.0) / output_step + drive.thrust
    moving = np.diff(command(time), prepend=0.0) != 0.0
    work, load_work, damping_loss, friction_loss, _ = sums.T
    stored = 0.5 * drive.mass * speed**2 + 0.5 * drive.stiffness * lag**2
    most = float((np.abs(work) + np.abs(load_work)).max())
    missing = float(np.abs(stored + damping_loss + friction_loss - work - load_work).max())
    results = StickSlip(
        mean=float(np.abs(force[moving]).mean()) if moving.any() else 0.0,
        peak=max(
            abs(float(largest[end]) + drive.thrust) for end in (kernel.MAX_FORCE, kernel.MIN_FORCE)
        ),
        sticks=int(largest[kernel.STICKS]),
        slip=float(largest[kernel.MAX_SLIP]),
        speed=float(largest[kernel.MAX_SPEED]),
        acceleration=float(largest[kernel.MAX_ACCELERATION]),
        behind=float(lag[-1]),
        energy_residual=missing / most if most > 0.0 else missing,
    )
    series = dict(zip(ELASTIC_DRIVE_VARIABLES, (force, *recorded.T), strict=True))
    return DriveMotion(series, results)
