# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stick-slip of a mass that a spring pulls against dry friction.

See :mod:`.dynamics.stick_slip` for the symbols. The solution is exact for data that are linear
in time. In a slip, m Δs̈ + c_d Δṡ + k_d Δs = R sign ṡ − f_d + m s̈_c with s̈_c = 0; it ends when ṡ
changes its sign. In stick, Δṡ = ṡ_c until |k_d Δs + c_d Δṡ + f_d| exceeds the static friction.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from protractile.dynamics.arrays import Array
from protractile.dynamics.kernels.compiled import LOOP


class SlidingMass(NamedTuple):
    """Mass on a spring: m in kg, k_d in N/m, c_d in N·s/m, ratio of static to sliding friction."""

    mass: float
    stiffness: float
    dashpot: float
    sticking: float


class LinearInterval(NamedTuple):
    """Interval of time with linear data of the driven mass."""

    rate: float  #: speed ṡ_c of the driven end in m/s
    push: float  #: external force f_d on the mass in N at the start
    load_rate: float  #: rate of f_d in N/s
    friction: float  #: friction force R in N


# State: Δs in m, ṡ in m/s, sign of ṡ (0 in stick), and the largest lag of this slip in m.
LAG, SPEED, SIGN, MAX_LAG = range(4)

# Sums: work of the driven end, work of f_d, losses of dashpot and friction in J, and impulse of
# spring and dashpot in N·s.
WORK, LOAD_WORK, DAMPING_LOSS, FRICTION_LOSS, IMPULSE = range(5)

# Extremes: maximum and minimum force of spring and dashpot in N, largest |ṡ| in m/s, |s̈| in m/s²
# and decrease of the lag in one slip in m, and the number of sticks.
MAX_FORCE, MIN_FORCE, MAX_SPEED, MAX_ACCELERATION, MAX_SLIP, STICKS = range(6)

# Number of phases (stick or slip) in an interval after which the mass sticks until its end.
_MAX_PHASES = 20

# Number of times within an interval at which the end of a phase is checked, so that reversals of
# the speed longer than 1e-5 of the interval are found, and number of bisections of this end.
_CHECKS, _HALVINGS = 16, 60

# The five points of Lobatto quadrature on [0, 1], and their weights.
_PLACES = np.array([0.0, 0.5 - np.sqrt(3.0 / 28.0), 0.5, 0.5 + np.sqrt(3.0 / 28.0), 1.0])
_WEIGHTS = np.array([9.0, 49.0, 64.0, 49.0, 9.0]) / 180.0


@njit(**LOOP)
def motion_after(
    body: SlidingMass, state: Array, interval: LinearInterval, time: float
) -> tuple[float, float, float]:
    """Return lag in m, ṡ in m/s and drive force in N after ``time`` in s of the same phase."""
    if state[SIGN] == 0.0:
        lag, rate = state[LAG] + interval.rate * time, interval.rate
    else:
        decay, omega2 = 0.5 * body.dashpot / body.mass, body.stiffness / body.mass
        drift = -interval.load_rate / body.stiffness
        offset = (
            state[SIGN] * interval.friction - interval.push - body.dashpot * drift
        ) / body.stiffness
        initial, initial_rate = state[LAG] - offset, interval.rate - state[SPEED] - drift
        # Imaginary with overcritical damping.
        damped, decayed = np.sqrt(complex(omega2 - decay**2)), np.exp(-decay * time)
        cosine = decayed * np.cos(damped * time).real
        sine = decayed * (time if damped == 0.0 else (np.sin(damped * time) / damped).real)
        lag = offset + drift * time + initial * (cosine + decay * sine) + initial_rate * sine
        rate = drift + initial_rate * (cosine - decay * sine) - omega2 * initial * sine
    pull = body.stiffness * lag + body.dashpot * rate
    return lag, interval.rate - rate, pull + interval.push + interval.load_rate * time


@njit(**LOOP)
def advance(
    body: SlidingMass,
    state: Array,
    interval: LinearInterval,
    time: float,
    sums: Array,
    largest: Array,
) -> None:
    """Advance ``state`` by ``time`` in s without change of phase; update ``sums``, ``largest``."""
    sign, lag, speed = state[SIGN], state[LAG], state[SPEED]
    for number in range(_PLACES.size):
        place, weight = _PLACES[number] * time, _WEIGHTS[number] * time
        lag, speed, force = motion_after(body, state, interval, place)
        push = interval.push + interval.load_rate * place
        sums[WORK] += weight * interval.rate * (force - push)
        sums[LOAD_WORK] += weight * push * speed
        sums[DAMPING_LOSS] += weight * body.dashpot * (interval.rate - speed) ** 2
        sums[FRICTION_LOSS] += weight * sign * interval.friction * speed
        sums[IMPULSE] += weight * (force - push)
        largest[MAX_FORCE] = max(largest[MAX_FORCE], force - push)
        largest[MIN_FORCE] = min(largest[MIN_FORCE], force - push)
        largest[MAX_SPEED] = max(largest[MAX_SPEED], abs(speed))
        if sign != 0.0:
            acceleration = (force - sign * interval.friction) / body.mass
            largest[MAX_ACCELERATION] = max(largest[MAX_ACCELERATION], abs(acceleration))
            state[MAX_LAG] = max(state[MAX_LAG], sign * lag)
            largest[MAX_SLIP] = max(largest[MAX_SLIP], state[MAX_LAG] - sign * lag)
    state[LAG], state[SPEED] = lag, speed


@njit(**LOOP)
def keeps_phase(body: SlidingMass, state: Array, interval: LinearInterval, time: float) -> bool:
    """Return whether the same phase, stick or slip, continues for a time in s."""
    _, speed, force = motion_after(body, state, interval, time)
    if state[SIGN] == 0.0:
        return bool(abs(force) <= body.sticking * interval.friction)
    return bool(state[SIGN] * speed >= 0.0)


@njit(**LOOP)
def phase_duration(body: SlidingMass, state: Array, interval: LinearInterval, left: float) -> float:
    """Return the time in s until stick or slip ends, at most ``left``."""
    low = 0.0
    for place in range(_CHECKS + 1):
        high = left * place / _CHECKS
        if not keeps_phase(body, state, interval, high):
            for _ in range(_HALVINGS):
                middle = 0.5 * (low + high)
                if keeps_phase(body, state, interval, middle):
                    low = middle
                else:
                    high = middle
            return high
        low = high
    return left


@njit(**LOOP)
def advance_interval(
    body: SlidingMass,
    state: Array,
    interval: LinearInterval,
    time: float,
    sums: Array,
    largest: Array,
) -> None:
    """Advance the state by a time in s with linear data, phase by phase."""
    left, phases = time, 0
    while left > 0.0 and phases < _MAX_PHASES:
        phases += 1
        gone = phase_duration(body, state, interval, left)
        advance(body, state, interval, gone, sums, largest)
        interval = LinearInterval(
            interval.rate,
            interval.push + interval.load_rate * gone,
            interval.load_rate,
            interval.friction,
        )
        left -= gone
        if left > 0.0 and state[SIGN] != 0.0:
            state[SPEED], state[SIGN] = 0.0, 0.0
            largest[STICKS] += interval.rate != 0.0 and keeps_phase(body, state, interval, 0.0)
        elif left > 0.0:
            state[SIGN] = np.sign(motion_after(body, state, interval, 0.0)[2])
            state[MAX_LAG] = state[SIGN] * state[LAG]
    if left > 0.0:
        state[SPEED], state[SIGN] = 0.0, 0.0
        advance(body, state, interval, left, sums, largest)


@njit(**LOOP)
def march_stick_slip(
    body: SlidingMass, step: float, substeps: int, commands: Array, pushes: Array, frictions: Array,
    recorded: Array, sums: Array, largest: Array,
) -> None:  # fmt: skip
    """Compute the motion of a mass from rest.

    Args:
        body: the mass.
        step: step of the data in s.
        substeps: number of steps per output.
        commands, pushes: s_c in m and f_d in N, each (num_outputs · substeps + 1,).
        frictions: R (num_outputs + 1,) in N during the interval before each output.
        recorded: array (num_outputs + 1, 3) for Δs in m, ṡ in m/s and s̈ in m/s².
        sums: array (num_outputs + 1, 5) for the sums up to each output.
        largest: array (6,) for the extremes.
    """
    state = np.zeros(4)
    for output in range(1, frictions.size):
        for number in range(sums.shape[1]):
            sums[output, number] = sums[output - 1, number]
        for number in range((output - 1) * substeps, output * substeps):
            rate = (commands[number + 1] - commands[number]) / step
            rise = (pushes[number + 1] - pushes[number]) / step
            interval = LinearInterval(rate, pushes[number], rise, frictions[output])
            advance_interval(body, state, interval, step, sums[output], largest)
        recorded[output, 0], recorded[output, 1] = state[LAG], state[SPEED]
        if state[SIGN] != 0.0:
            interval = LinearInterval(
                interval.rate, pushes[output * substeps], interval.load_rate, interval.friction
            )
            force = motion_after(body, state, interval, 0.0)[2]
            recorded[output, 2] = (force - state[SIGN] * interval.friction) / body.mass
