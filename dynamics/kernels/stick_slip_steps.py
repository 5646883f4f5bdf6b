# SPDX-License-Identifier: LGPL-3.0-or-later
"""A mass that a spring draws along against dry friction, from sticking to slipping and back.

Each stretch through which its data go straight is exact. z = s_c − s is what the mass lags behind
the far end of the spring. While it slips, m z̈ + c ż + k z = σ R − p; while it sticks, z grows as
fast as that end goes, until k z + c ż + p leaves ± the static friction; a slip ends where ṡ changes
its sign.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.kernels.compiled import LOOP

# Of the body: m in kg, k in N/m, c in N·s/m, static friction over that of sliding.
MASS, STIFFNESS, DASHPOT, STICKING = range(4)

# Of the leg that lies before it: ṡ_c in m/s, p in N, its rise in N/s, R in N.
RATE, PUSH, RISE, FRICTION = range(4)

# Of the state: z in m, ṡ in m/s, σ of a slip and 0 while it sticks, the farthest that it has lagged
# behind in this slip in m.
LAG, SPEED, SIGN, CREST = range(4)

# Summed up: work of the far end, work of p, loss in the dashpot and by friction in J, impulse of
# the spring and the dashpot in N·s.
WORK, PUSHED, DAMPED, RUBBED, IMPULSE = range(5)

# Largest and least force of spring and dashpot in N, largest |ṡ| in m/s, |s̈| in m/s² and way in m
# that is caught up in one slip; how often it has come to stick.
HIGH, LOW, FASTEST, HARDEST, JUMP, STICKS = range(6)

# Turns within a leg after which it rests to the end of it.
_MOST_TURNS = 20

# They find a time to round-off.
_HALVINGS = 60

# Lobatto's five places in a stretch, its ends among them, and their weights.
_PLACES = np.array([0.0, 0.5 - np.sqrt(3.0 / 28.0), 0.5, 0.5 + np.sqrt(3.0 / 28.0), 1.0])
_WEIGHTS = np.array([9.0, 49.0, 64.0, 49.0, 9.0]) / 180.0


@njit(**LOOP)
def fades(body: Array, time: float) -> tuple[float, float]:
    """e^{−δt} cos ωt and e^{−δt} sin ωt/ω of the free swing, also where it creeps."""
    decay, omega2 = 0.5 * body[DASHPOT] / body[MASS], body[STIFFNESS] / body[MASS]
    if decay**2 < omega2:
        beat, kept = np.sqrt(omega2 - decay**2), np.exp(-decay * time)
        return kept * np.cos(beat * time), kept * np.sin(beat * time) / beat
    if decay**2 == omega2:
        return np.exp(-decay * time), time * np.exp(-decay * time)
    beat = np.sqrt(decay**2 - omega2)
    slow, fast = np.exp(-(decay - beat) * time), np.exp(-(decay + beat) * time)
    return 0.5 * (slow + fast), 0.5 * (slow - fast) / beat


@njit(**LOOP)
def slid(body: Array, state: Array, leg: Array, time: float) -> tuple[float, float]:
    """z in m and ż in m/s after a time in s of slipping."""
    decay, omega2 = 0.5 * body[DASHPOT] / body[MASS], body[STIFFNESS] / body[MASS]
    drift = -leg[RISE] / body[STIFFNESS]
    rest = (state[SIGN] * leg[FRICTION] - leg[PUSH] - body[DASHPOT] * drift) / body[STIFFNESS]
    off, swing = state[LAG] - rest, leg[RATE] - state[SPEED] - drift
    cosine, sine = fades(body, time)
    lag = rest + drift * time + off * (cosine + decay * sine) + swing * sine
    return lag, drift + swing * (cosine - decay * sine) - omega2 * off * sine


@njit(**LOOP)
def pull(body: Array, lag: float, rate: float) -> float:
    """k z + c ż in N."""
    return float(body[STIFFNESS] * lag + body[DASHPOT] * rate)


@njit(**LOOP)
def note(body: Array, state: Array, leg: Array, time: float, largest: Array) -> float:
    """What is larger than before, after a time in s of slipping; gives ż there in m/s."""
    lag, rate = slid(body, state, leg, time)
    force, behind = pull(body, lag, rate), state[SIGN] * lag
    pushed = leg[PUSH] + leg[RISE] * time - state[SIGN] * leg[FRICTION]
    largest[HIGH], largest[LOW] = max(largest[HIGH], force), min(largest[LOW], force)
    largest[FASTEST] = max(largest[FASTEST], abs(leg[RATE] - rate))
    largest[HARDEST] = max(largest[HARDEST], abs(force + pushed) / body[MASS])
    state[CREST] = max(state[CREST], behind)
    largest[JUMP] = max(largest[JUMP], state[CREST] - behind)
    return float(rate)


@njit(**LOOP)
def slide(body: Array, state: Array, leg: Array, time: float, sums: Array, largest: Array) -> None:
    """Slip through a time in s."""
    lag, speed, sign = state[LAG], state[SPEED], state[SIGN]
    for number in range(_PLACES.size):
        place, weight = _PLACES[number] * time, _WEIGHTS[number] * time
        rate = note(body, state, leg, place, largest)
        sums[DAMPED] += weight * body[DASHPOT] * rate**2
        sums[PUSHED] += weight * (leg[PUSH] + leg[RISE] * place) * (leg[RATE] - rate)
    end, rate = slid(body, state, leg, time)
    state[LAG], state[SPEED] = end, leg[RATE] - rate
    impulse = body[MASS] * (state[SPEED] - speed) + sign * leg[FRICTION] * time
    impulse -= (leg[PUSH] + 0.5 * leg[RISE] * time) * time
    sums[IMPULSE] += impulse
    sums[WORK] += leg[RATE] * impulse
    sums[RUBBED] += sign * leg[FRICTION] * (leg[RATE] * time - end + lag)


@njit(**LOOP)
def hold(body: Array, state: Array, leg: Array, time: float, sums: Array, largest: Array) -> None:
    """Stick through a time in s."""
    lag, rate = state[LAG], leg[RATE]
    state[LAG], state[SPEED] = lag + rate * time, 0.0
    for there in (lag, state[LAG]):
        force = pull(body, there, rate)
        largest[HIGH], largest[LOW] = max(largest[HIGH], force), min(largest[LOW], force)
    impulse = pull(body, 0.5 * (lag + state[LAG]), rate) * time
    sums[IMPULSE] += impulse
    sums[WORK] += rate * impulse
    sums[DAMPED] += body[DASHPOT] * rate**2 * time


@njit(**LOOP)
def held_for(body: Array, state: Array, leg: Array, left: float) -> float:
    """For how many of the s left it sticks on, which gives σ of the slip to come, if one does."""
    bound = body[STICKING] * leg[FRICTION]
    force = pull(body, state[LAG], leg[RATE]) + leg[PUSH]
    growth = body[STIFFNESS] * leg[RATE] + leg[RISE]
    sign, time = np.sign(force), 0.0
    if abs(force) <= bound:
        sign = np.sign(growth)
        time = (sign * bound - force) / growth if growth != 0.0 else left
    if time < left:
        state[SIGN], state[CREST] = sign, sign * state[LAG]
        return time
    return left


@njit(**LOOP)
def onward(body: Array, state: Array, leg: Array, time: float) -> tuple[float, float]:
    """σ ṡ in m/s and σ s̈ in m/s² after a time in s of slipping."""
    lag, rate = slid(body, state, leg, time)
    forces = pull(body, lag, rate) + leg[PUSH] + leg[RISE] * time - state[SIGN] * leg[FRICTION]
    return state[SIGN] * (leg[RATE] - rate), state[SIGN] * forces / body[MASS]


@njit(**LOOP)
def turns_within(
    body: Array, state: Array, leg: Array, which: int, rising: float, left: float
) -> float:
    """When within the s left the speed, 0, falls below 0, or the acceleration, 1, rises above."""
    low, high = 0.0, left
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        if rising * onward(body, state, leg, middle)[which] < 0.0:
            low = middle
        else:
            high = middle
    return high


@njit(**LOOP)
def slips_for(body: Array, state: Array, leg: Array, left: float) -> float:
    """For how many of the s left it slips on, until ṡ changes its sign, be it for a moment."""
    (_, begin), (speed, end) = onward(body, state, leg, 0.0), onward(body, state, leg, left)
    least = left
    if speed >= 0.0 and begin < 0.0 and end > 0.0:
        least = turns_within(body, state, leg, 1, 1.0, left)
        speed = onward(body, state, leg, least)[0]
    return left if speed >= 0.0 else turns_within(body, state, leg, 0, -1.0, least)


@njit(**LOOP)
def stands(body: Array, state: Array, leg: Array) -> bool:
    """Whether what stands sticks."""
    force = pull(body, state[LAG], leg[RATE]) + leg[PUSH]
    return bool(abs(force) <= body[STICKING] * leg[FRICTION])


@njit(**LOOP)
def cover(body: Array, state: Array, leg: Array, time: float, sums: Array, largest: Array) -> None:
    """Go through a time in s whose data are straight."""
    left, turns = time, 0
    while left > 0.0 and turns < _MOST_TURNS:
        turns += 1
        slips = state[SIGN] != 0.0
        if slips:
            gone = slips_for(body, state, leg, left)
            slide(body, state, leg, gone, sums, largest)
        else:
            gone = held_for(body, state, leg, left)
            hold(body, state, leg, gone, sums, largest)
        leg[PUSH] += leg[RISE] * gone
        if slips and gone < left:
            state[SPEED], state[SIGN] = 0.0, 0.0
            if leg[RATE] != 0.0 and stands(body, state, leg):
                largest[STICKS] += 1.0
        left -= gone
    if left > 0.0:
        state[SIGN] = 0.0
        hold(body, state, leg, left, sums, largest)


@njit(**LOOP)
def march_pulled(
    body: Array,
    step: float,
    substeps: int,
    ways: Array,
    pushes: Array,
    frictions: Array,
    recorded: Array,
    sums: Array,
    largest: Array,
) -> None:
    """From output to output.

    Args:
        body: (4,).
        step: between ways, in s; ``substeps`` of them make an output.
        ways, pushes: (num_outputs · substeps + 1,) s_c in m and p in N.
        frictions: (num_outputs + 1,) R in N up to each output.
        recorded: (num_outputs + 1, 3) gets z in m, ṡ in m/s, s̈ in m/s².
        sums: (num_outputs + 1, 5), gets what is summed up by then.
        largest: (6,).
    """
    state, leg = np.zeros(4), np.zeros(4)
    for output in range(1, frictions.size):
        sums[output] = sums[output - 1]
        leg[FRICTION] = frictions[output]
        for number in range((output - 1) * substeps, output * substeps):
            leg[RATE] = (ways[number + 1] - ways[number]) / step
            leg[PUSH] = pushes[number]
            leg[RISE] = (pushes[number + 1] - pushes[number]) / step
            cover(body, state, leg, step, sums[output], largest)
        recorded[output, 0], recorded[output, 1] = state[LAG], state[SPEED]
        if state[SIGN] != 0.0:
            recorded[output, 2] = state[SIGN] * onward(body, state, leg, 0.0)[1]
