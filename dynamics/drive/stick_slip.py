# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stick-slip of a segment that an elastic drive extends.

The extension s(t) lags behind the command s_c(t) of the drive:

    m s̈ + c (ṡ − ṡ_c) + k (s − s_c) = p − R sign(ṡ),   |k (s_c − s) + c ṡ_c + p| ≤ R_s where ṡ = 0

with R = μ Σ|N| of the pads of the boom that follows the command, R_s that of static friction, and
p the force of other drives that accelerate. The boom does not feel the lag. R is that of the mean N
of each output interval: where pads chatter faster, fewer sticks are counted.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from dynamics.arrays import Array
from dynamics.excitation import History

# Largest step as an angle in rad of the mass on its spring, or as a part of its decay time.
_PART = 0.1

# Variables of a trajectory; the suffix of the travel follows each name.
OF_ELASTIC_DRIVES = {
    "drive_force": {"units": "N", "long_name": "drive force, mean of the output interval"},
    "drive_lag": {"units": "m", "long_name": "lag of the segment behind its drive"},
    "drawn_speed": {"units": "m/s", "long_name": "speed of the segment in the outer one"},
    "drawn_acceleration": {"units": "m/s2", "long_name": "acceleration of the segment"},
}


@dataclass(frozen=True, slots=True)
class ElasticDrive:
    """An elastic drive, and the mass that it moves.

    >>> rope = ElasticDrive(mass=500.0, stiffness=1e5, dashpot=1e3, sticking=1.5)
    >>> print(f"{rope.frequency:.2f} Hz, damped by {100.0 * rope.damping_ratio:.1f} %")
    2.25 Hz, damped by 7.1 %

    Args:
        mass: mass of all moved segments in kg.
        stiffness: k of rope, chain or cylinder in N/m.
        dashpot: c in parallel in N·s/m.
        sticking: static over sliding friction, at least 1.
        thrust: axial load towards the base in N, as by the weight.
        beside: the mass in kg that each other drive moves, too, and the history of that drive.

    Raises:
        ValueError: a number is out of range.
    """

    mass: float
    stiffness: float
    dashpot: float = 0.0
    sticking: float = 1.0
    thrust: float = 0.0
    beside: tuple[tuple[float, History], ...] = ()

    def __post_init__(self) -> None:
        limits = {"mass": 0.0, "stiffness": 0.0, "dashpot": 0.0, "sticking": 1.0}
        for name, least in limits.items():
            value, above = getattr(self, name), name in ("mass", "stiffness")
            if not least <= value < np.inf or (above and value == least):
                word = "above" if above else "at least"
                raise ValueError(f"{name} must be finite and {word} {least:g}, got {value}")

    @property
    def frequency(self) -> float:
        """Undamped natural frequency in Hz."""
        return float(np.sqrt(self.stiffness / self.mass) / (2.0 * np.pi))

    @property
    def damping_ratio(self) -> float:
        """ζ = c / 2√(k m)."""
        return 0.5 * self.dashpot / float(np.sqrt(self.stiffness * self.mass))


@dataclass(frozen=True, slots=True)
class StickSlip:
    """Results of an elastic drive.

    Args:
        mean: mean of |drive force| in N while the drive moves.
        peak: largest |drive force| in N.
        sticks: number of times that the segment sticks while the drive moves.
        slip: longest distance in m caught up in one slip.
        speed, acceleration: largest of the segment in m/s and m/s².
        behind: lag at the end of the run in m, negative where the segment is ahead.
        energy_residual: unaccounted energy as a part of the energy put in.
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
    """Motion of a segment on an elastic drive: ``OF_ELASTIC_DRIVES`` over time, and the results."""

    series: dict[str, Array]
    results: StickSlip


def move_segment(
    drive: ElasticDrive, command: History, time: Array, friction: Array
) -> DriveMotion:
    """Return the motion of the segment, from rest with the axial load held.

    s_c and p are linear within steps, of which a period takes 63 at least; all else is exact. The
    accelerations in p are second differences. Other drives are mirrored at t = 0, so that one that
    begins with a jump of its speed gives its whole impulse within the first step.

    Args:
        drive: moves the segment.
        command: s_c in m.
        time: (num_times,) in s, evenly spaced from 0 on.
        friction: (num_times,) R in N, the mean of the interval that ends then.
    """
    from dynamics.kernels import stick_slip as kernel

    fastest = max(2.0 * np.pi * drive.frequency, drive.dashpot / drive.mass)
    output_step = float(time[1] - time[0])
    substeps = max(1, int(np.ceil(output_step * fastest / _PART)))
    count, step = time.size - 1, output_step / substeps
    times = step * np.arange(count * substeps + 1)
    push = np.zeros(times.size)
    for mass, other in drive.beside:
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
    work, pushed, damped, rubbed, _ = sums.T
    stored = 0.5 * drive.mass * speed**2 + 0.5 * drive.stiffness * lag**2
    most = float((np.abs(work) + np.abs(pushed)).max())
    missing = float(np.abs(stored + damped + rubbed - work - pushed).max())
    results = StickSlip(
        mean=float(np.abs(force[moving]).mean()) if moving.any() else 0.0,
        peak=max(abs(float(largest[end]) + drive.thrust) for end in (kernel.HIGH, kernel.LOW)),
        sticks=int(largest[kernel.STICKS]),
        slip=float(largest[kernel.JUMP]),
        speed=float(largest[kernel.FASTEST]),
        acceleration=float(largest[kernel.HARDEST]),
        behind=float(lag[-1]),
        energy_residual=missing / most if most > 0.0 else missing,
    )
    series = dict(zip(OF_ELASTIC_DRIVES, (force, *recorded.T), strict=True))
    return DriveMotion(series, results)
