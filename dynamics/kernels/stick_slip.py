# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a mass that a spring pulls against dry friction: phases of sticking and slipping.

The solution is exact for data that are linear in time. z = s_c − s is the lag of the mass behind
the far end of the spring. While it slips, m z̈ + c ż + k z = σ R − p. While it sticks, z grows with
that end, until |k z + c ż + p| exceeds the static friction. A slip ends where ṡ changes its sign.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.kernels.compiled import LOOP


class SlidingMass(NamedTuple):
    """Mass on a spring: m in kg, k in N/m, c in N·s/m, and ratio of static to sliding friction."""

    mass: float
    stiffness: float
    dashpot: float
    sticking: float


class Leg(NamedTuple):
    """Data that are linear for a time: ṡ_c in m/s, p at its start in N, its rise in N/s, R in N."""

    rate: float
    push: float
    rise: float
    friction: float


# State: z in m, ṡ in m/s, σ of a slip and 0 while it sticks, the largest lag in this slip in m.
LAG, SPEED, SIGN, CREST = range(4)

# Sums: work of the far end, work of p, loss in the dashpot and by friction in J, impulse of the
# spring and the dashpot in N·s.
WORK, PUSHED, DAMPED, RUBBED, IMPULSE = range(5)

# Extremes: largest and least force of spring and dashpot in N, largest |ṡ| in m/s, |s̈| in m/s² and
# distance in m that is caught up in one slip; the number of times it has come to stick.
HIGH, LOW, FASTEST, HARDEST, JUMP, STICKS = range(6)

# Changes of phase within a leg after which it sticks to the end of it.
_MOST_TURNS = 20

# Places in a leg at which the phase is checked, so that the speed at which it dips back is right to
# 1e-5; and bisections, which find a time to round-off.
_LOOKS, _HALVINGS = 16, 60

# Lobatto's five places in a stretch, its ends among them, and their weights.
_PLACES = np.array([0.0, 0.5 - np.sqrt(3.0 / 28.0), 0.5, 0.5 + np.sqrt(3.0 / 28.0), 1.0])
_WEIGHTS = np.array([9.0, 49.0, 64.0, 49.0, 9.0]) / 180.0


@njit(**LOOP)
def motion_after(
    body: SlidingMass, state: Array, leg: Leg, time: float
) -> tuple[float, float, float]:
    """Return z in m, ṡ in m/s and all forces but friction in N after a time in s of this phase."""
    if state[SIGN] == 0.0:
        lag, rate = state[LAG] + leg.rate * time, leg.rate
    else:
        decay, omega2 = 0.5 * body.dashpot / body.mass, body.stiffness / body.mass
        drift = -leg.rise / body.stiffness
        rest = (state[SIGN] * leg.friction - leg.push - body.dashpot * drift) / body.stiffness
        off, swing = state[LAG] - rest, leg.rate - state[SPEED] - drift
        # Imaginary where it creeps.
        beat, kept = np.sqrt(complex(omega2 - decay**2)), np.exp(-decay * time)
        cosine = kept * np.cos(beat * time).real
        sine = kept * (time if beat == 0.0 else (np.sin(beat * time) / beat).real)
        lag = rest + drift * time + off * (cosine + decay * sine) + swing * sine
        rate = drift + swing * (cosine - decay * sine) - omega2 * off * sine
    pull = body.stiffness * lag + body.dashpot * rate
    return lag, leg.rate - rate, pull + leg.push + leg.rise * time


@njit(**LOOP)
def advance(
    body: SlidingMass, state: Array, leg: Leg, time: float, sums: Array, largest: Array
) -> None:
    """Move on in the same phase through a time in s."""
    sign, lag, speed = state[SIGN], state[LAG], state[SPEED]
    for number in range(_PLACES.size):
        place, weight = _PLACES[number] * time, _WEIGHTS[number] * time
        lag, speed, force = motion_after(body, state, leg, place)
        push = leg.push + leg.rise * place
        sums[WORK] += weight * leg.rate * (force - push)
        sums[PUSHED] += weight * push * speed
        sums[DAMPED] += weight * body.dashpot * (leg.rate - speed) ** 2
        sums[RUBBED] += weight * sign * leg.friction * speed
        sums[IMPULSE] += weight * (force - push)
        largest[HIGH] = max(largest[HIGH], force - push)
        largest[LOW] = min(largest[LOW], force - push)
        largest[FASTEST] = max(largest[FASTEST], abs(speed))
        if sign != 0.0:
            acceleration = (force - sign * leg.friction) / body.mass
            largest[HARDEST] = max(largest[HARDEST], abs(acceleration))
            state[CREST] = max(state[CREST], sign * lag)
            largest[JUMP] = max(largest[JUMP], state[CREST] - sign * lag)
    state[LAG], state[SPEED] = lag, speed


@njit(**LOOP)
def stays(body: SlidingMass, state: Array, leg: Leg, time: float) -> bool:
    """Return whether it is in the same phase after a time in s."""
    _, speed, force = motion_after(body, state, leg, time)
    if state[SIGN] == 0.0:
        return bool(abs(force) <= body.sticking * leg.friction)
    return bool(state[SIGN] * speed >= 0.0)


@njit(**LOOP)
def time_in_phase(body: SlidingMass, state: Array, leg: Leg, left: float) -> float:
    """Return for how many of the s left it stays in its phase, which a moment may end."""
    low = 0.0
    for place in range(_LOOKS + 1):
        high = left * place / _LOOKS
        if not stays(body, state, leg, high):
            for _ in range(_HALVINGS):
                middle = 0.5 * (low + high)
                if stays(body, state, leg, middle):
                    low = middle
                else:
                    high = middle
            return high
        low = high
    return left


@njit(**LOOP)
def advance_leg(
    body: SlidingMass, state: Array, leg: Leg, time: float, sums: Array, largest: Array
) -> None:
    """Advance the state through a leg of linear data, phase by phase."""
    left, turns = time, 0
    while left > 0.0 and turns < _MOST_TURNS:
        turns += 1
        gone = time_in_phase(body, state, leg, left)
        advance(body, state, leg, gone, sums, largest)
        leg = Leg(leg.rate, leg.push + leg.rise * gone, leg.rise, leg.friction)
        left -= gone
        if left > 0.0 and state[SIGN] != 0.0:
            state[SPEED], state[SIGN] = 0.0, 0.0
            largest[STICKS] += leg.rate != 0.0 and stays(body, state, leg, 0.0)
        elif left > 0.0:
            state[SIGN] = np.sign(motion_after(body, state, leg, 0.0)[2])
            state[CREST] = state[SIGN] * state[LAG]
    if left > 0.0:
        state[SPEED], state[SIGN] = 0.0, 0.0
        advance(body, state, leg, left, sums, largest)


@njit(**LOOP)
def march_stick_slip(
    body: SlidingMass, step: float, substeps: int, commands: Array, pushes: Array, frictions: Array,
    recorded: Array, sums: Array, largest: Array,
) -> None:  # fmt: skip
    """Advance from output to output.

    Args:
        body: that is pulled.
        step: between commands, in s; ``substeps`` of them make an output.
        commands, pushes: (num_outputs · substeps + 1,) s_c in m and p in N.
        frictions: (num_outputs + 1,) R in N up to each output.
        recorded: (num_outputs + 1, 3) gets z in m, ṡ in m/s, s̈ in m/s².
        sums: (num_outputs + 1, 5), gets the sums up to then.
        largest: (6,), gets the extremes.
    """
    state = np.zeros(4)
    for output in range(1, frictions.size):
        for number in range(sums.shape[1]):
            sums[output, number] = sums[output - 1, number]
        for number in range((output - 1) * substeps, output * substeps):
            rate = (commands[number + 1] - commands[number]) / step
            rise = (pushes[number + 1] - pushes[number]) / step
            leg = Leg(rate, pushes[number], rise, frictions[output])
            advance_leg(body, state, leg, step, sums[output], largest)
        recorded[output, 0], recorded[output, 1] = state[LAG], state[SPEED]
        if state[SIGN] != 0.0:
            leg = Leg(leg.rate, pushes[output * substeps], leg.rise, leg.friction)
            force = motion_after(body, state, leg, 0.0)[2]
            recorded[output, 2] = (force - state[SIGN] * leg.friction) / body.mass
