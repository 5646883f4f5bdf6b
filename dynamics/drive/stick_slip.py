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

import numpy as np

from dynamics.arrays import Array
from dynamics.excitation import History

# Largest step as an angle in rad of the mass on its spring, or as a part of its decay time.
_PART = 0.1

# Bound of (R_s − R)/(v √(k m)) in the search for the critical speed.
_FARTHEST = 1.0e6


# Variables of a trajectory; the suffix of the travel follows each name.
OF_ELASTIC_DRIVES = {
    "drive_force": {
        "units": "N",
        "long_name": "force of the drive as it gives way, mean of the output interval",
    },
    "drive_lag": {"units": "m", "long_name": "lag of the segment behind its drive"},
    "drawn_speed": {"units": "m/s", "long_name": "speed of the segment in the outer one"},
    "drawn_acceleration": {"units": "m/s2", "long_name": "acceleration of the segment"},
}


@dataclass(frozen=True, slots=True)
class ElasticDrive:
    """An elastic drive, and the mass that it moves.

    >>> rope = ElasticDrive(mass=500.0, stiffness=1e5, dashpot=1e3, sticking=1.5)
    >>> print(f"{rope.frequency:.2f} Hz, smooth from {rope.critical_speed(1000.0):.3f} m/s on")
    2.25 Hz, smooth from 0.062 m/s on

    Args:
        mass: of all moved segments in kg.
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

    def critical_speed(self, friction: float) -> float:
        """Return the constant speed in m/s above which it slips without sticking again.

        It is infinite without damping.

        Args:
            friction: R of sliding in N.
        """
        drop = (self.sticking - 1.0) * friction
        if drop == 0.0 or self.damping_ratio >= 1.0:
            return 0.0
        if self.damping_ratio == 0.0:
            return np.inf
        impedance = float(np.sqrt(self.stiffness * self.mass))
        return drop / (_critical_drop(self.damping_ratio) * impedance)

    def pushed(self, time: Array, step: float) -> Array:
        """Return p (num_times,) in N, by second differences over a step in s.

        The histories are mirrored at t = 0, so that one that begins with a jump of its speed gives
        its whole impulse within the first step.
        """
        return -sum(
            (
                mass * (way(time + step) - 2.0 * way(time) + way(np.abs(time - step))) / step**2
                for mass, way in self.beside
            ),
            np.zeros(time.shape),
        )


@dataclass(frozen=True, slots=True)
class StickSlip:
    """Results of an elastic drive.

    Args:
        mean: of |drive force| in N while the drive moves.
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


@dataclass(frozen=True, slots=True)
class DriveMotion:
    """Motion of the segment that an elastic drive moves, (num_times,) each.

    Args:
        drive_force: in N, the mean of the output interval that ends then.
        drive_lag: in m.
        drawn_speed, drawn_acceleration: of the segment in m/s and m/s².
        told: the results.
    """

    drive_force: Array
    drive_lag: Array
    drawn_speed: Array
    drawn_acceleration: Array
    told: StickSlip


def follow(pulled: ElasticDrive, way: History, time: Array, friction: Array) -> DriveMotion:
    """Return the motion of the segment, from rest with the axial load held.

    s_c and p are linear within steps, of which a period takes 63 at least; all else is exact.

    Args:
        pulled: the drive.
        way: its command s_c in m.
        time: (num_times,) in s, evenly spaced from 0 on.
        friction: (num_times,) R in N, the mean of the interval that ends then.
    """
    from dynamics.kernels import stick_slip_steps as kernel

    fastest = max(2.0 * np.pi * pulled.frequency, pulled.dashpot / pulled.mass)
    output_step = float(time[1] - time[0])
    substeps = max(1, int(np.ceil(output_step * fastest / _PART)))
    count, step = time.size - 1, output_step / substeps
    times = step * np.arange(count * substeps + 1)
    recorded, sums, largest = np.zeros((count + 1, 3)), np.zeros((count + 1, 5)), np.zeros(6)
    kernel.march_pulled(
        kernel.SlidingMass(pulled.mass, pulled.stiffness, pulled.dashpot, pulled.sticking),
        step, substeps, way(times), pulled.pushed(times, step), friction, recorded, sums, largest,
    )  # fmt: skip
    lag, speed, acceleration = recorded.T
    force = np.diff(sums[:, kernel.IMPULSE], prepend=0.0) / output_step + pulled.thrust
    moving = np.diff(way(time), prepend=0.0) != 0.0
    told = StickSlip(
        mean=float(np.abs(force[moving]).mean()) if moving.any() else 0.0,
        peak=max(abs(float(largest[end]) + pulled.thrust) for end in (kernel.HIGH, kernel.LOW)),
        sticks=int(largest[kernel.STICKS]),
        slip=float(largest[kernel.JUMP]),
        speed=float(largest[kernel.FASTEST]),
        acceleration=float(largest[kernel.HARDEST]),
        behind=float(lag[-1]),
        energy_residual=_unaccounted(pulled, lag, speed, sums),
    )
    return DriveMotion(force, lag, speed, acceleration, told)


def _unaccounted(pulled: ElasticDrive, lag: Array, speed: Array, sums: Array) -> float:
    """Return the unaccounted energy as a part of the largest energy put in."""
    work, pushed, damped, rubbed, _ = sums.T
    there = 0.5 * pulled.mass * speed**2 + 0.5 * pulled.stiffness * lag**2
    most = float((np.abs(work) + np.abs(pushed)).max())
    off = float(np.abs(there + damped + rubbed - work - pushed).max())
    return off / most if most > 0.0 else off


def _critical_drop(ratio: float) -> float:
    """Return (R_s − R)/(v √(k m)) up to which a slip at the damping ratio ζ does not end.

    ż/v begins a slip with 1 and the slope −D, in units of 1/ω, swings freely, and is largest again,
    for all ζ below 1, where it is √(1 − 2ζD + D²) e^{−ζ(θ + π)/√(1 − ζ²)},
    θ = arg((ζD − 1)/√(1 − ζ²) + iD); it sticks where that is 1. At little damping D = √(4πζ).
    """
    from scipy.optimize import brentq

    beat = np.sqrt(1.0 - ratio**2)

    def beyond(drop: float) -> float:
        angle = np.arctan2(drop, (ratio * drop - 1.0) / beat)
        grown = 0.5 * np.log1p(drop * (drop - 2.0 * ratio))
        return float(grown - ratio * (angle + np.pi) / beat)

    if beyond(_FARTHEST) < 0.0:
        return np.inf
    return float(brentq(beyond, 2.0 * ratio, _FARTHEST, xtol=1e-14))
