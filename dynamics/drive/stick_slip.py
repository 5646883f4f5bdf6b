# SPDX-License-Identifier: LGPL-3.0-or-later
"""A segment that a drive of a given stiffness draws along, which sticks and slips.

What it is drawn out by, s(t), lags behind what the drive asks, s_c(t):

    m s̈ + c (ṡ − ṡ_c) + k (s − s_c) = p − R sign(ṡ),   |k (s_c − s) + c ṡ_c + p| ≤ R_s where ṡ = 0

with R = μ Σ|N| of the pads as the boom moves that is drawn out as far as asked, R_s that of static
friction, and p what other drives do as they speed up. The boom does not feel how far it lags. R is
that of the mean N of each output interval: where pads chatter faster, fewer sticks are told.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dynamics.arrays import Array
from dynamics.excitation import History

# Of the angle in rad by which the mass swings on the spring, or of a decay: a step at most.
_PART = 0.1

# Beyond it a swing between two sticks grows past all numbers.
_FARTHEST = 1.0e6


# What a trajectory holds of it, behind each name the suffix of its travel.
FOLLOWED = {
    "drive_force": {
        "units": "N",
        "long_name": "force of the drive as it gives way, mean of the output interval",
    },
    "drive_lag": {"units": "m", "long_name": "what is drawn lags behind its drive"},
    "drawn_speed": {"units": "m/s", "long_name": "speed of what is drawn in the outer segment"},
    "drawn_acceleration": {"units": "m/s2", "long_name": "acceleration of what is drawn"},
}


@dataclass(frozen=True, slots=True)
class Pulled:
    """What a drive of a given stiffness draws along.

    >>> rope = Pulled(mass=500.0, stiffness=1e5, dashpot=1e3, sticking=1.5)
    >>> print(f"{rope.frequency:.2f} Hz, smooth from {rope.critical_speed(1000.0):.3f} m/s on")
    2.25 Hz, smooth from 0.062 m/s on

    Args:
        mass: of all that goes along, in kg.
        stiffness: k of rope, chain or cylinder in N/m.
        dashpot: c beside it in N·s/m.
        sticking: static friction over that of sliding, 1 or more.
        thrust: what presses it along the boom towards the base in N, its weight say.
        beside: the part of the mass in kg that another drive moves, too, and the history of each.

    Raises:
        ValueError: a number out of range.
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
        """Of the mass on the spring in Hz, without damping."""
        return float(np.sqrt(self.stiffness / self.mass) / (2.0 * np.pi))

    @property
    def damping_ratio(self) -> float:
        """ζ = c / 2√(k m)."""
        return 0.5 * self.dashpot / float(np.sqrt(self.stiffness * self.mass))

    def critical_speed(self, friction: float) -> float:
        """From which constant speed in m/s on it does not stick again, once it has slipped.

        Infinite without damping.

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
        """(num_times,) p in N, by second differences over a step in s.

        Mirrored at t = 0, where a way that begins with a jump of its speed gives all of its impulse
        within the first step.
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
    """What a drive of a given stiffness does.

    Args:
        mean: of |its force| in N while it moves.
        peak: the largest |force| in N.
        sticks: how often what it draws comes to stick while it moves.
        slip: the longest way in m by which that catches up with it in one slip.
        speed, acceleration: the largest of what it draws, in m/s and m/s².
        behind: how far that lags behind at the end of the run in m, negative where it is ahead.
        energy_residual: what of its work is not accounted for, as a part of all energy put in.
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
class Followed:
    """How what is pulled follows, (num_times,) each.

    Args:
        drive_force: in N, the mean of the output interval that ends then.
        drive_lag: by what it is behind the drive in m.
        drawn_speed, drawn_acceleration: its own in m/s and m/s².
        told: what is to be known of all that.
    """

    drive_force: Array
    drive_lag: Array
    drawn_speed: Array
    drawn_acceleration: Array
    told: StickSlip


def follow(pulled: Pulled, way: History, time: Array, friction: Array) -> Followed:
    """How what is pulled follows its drive, from rest with the thrust held.

    Between steps, of which a swing takes 63 at least, s_c and p go straight, and all else is exact.

    Args:
        pulled: by the drive.
        way: how far that draws out, in m.
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
        kernel.Body(pulled.mass, pulled.stiffness, pulled.dashpot, pulled.sticking),
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
    return Followed(force, lag, speed, acceleration, told)


def _unaccounted(pulled: Pulled, lag: Array, speed: Array, sums: Array) -> float:
    """What was put in less what there is and what was lost, as a part of the most put in."""
    work, pushed, damped, rubbed, _ = sums.T
    there = 0.5 * pulled.mass * speed**2 + 0.5 * pulled.stiffness * lag**2
    most = float((np.abs(work) + np.abs(pushed)).max())
    off = float(np.abs(there + damped + rubbed - work - pushed).max())
    return off / most if most > 0.0 else off


def _critical_drop(ratio: float) -> float:
    """(R_s − R)/(v √(k m)) at which what slips at ζ comes to stick just no more.

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
