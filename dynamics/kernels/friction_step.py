# SPDX-License-Identifier: LGPL-3.0-or-later
"""The friction impulses of one step: in its middle against sliding, at its end for rest.

In the middle of the step, between two half flows, the impulse r_l acts on the modes through the
row D_l filtered by φ_i = sin(ω_i h/2)/(ω_i h/2). The slip of the rows over the whole step then is

    s = s_free + G r,    G = (h/2) D φ S φ Dᵀ,    r_l ∈ −h μ_l N_l Sign(s_l)

where S is what damping leaves of speeds over half a step; it acts before and after the impulse. The
work of the impulses is r·s/h exactly (without damping, under a constant load): friction takes its
force times the way that it slides, and nothing from a row that it holds. Rows that are held end
where they began; the rest of their speed goes at the end of the step, by impulses that leave
|r_l| ≤ h μ_l N_l. The filter is that of the mollified impulse method (García-Archilla et al. 1999).
"""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.contact_term import Limits, Terms
from dynamics.kernels.bounded_impulses import (
    FREE,
    HIGH,
    IMPULSE,
    LOW,
    NOISE,
    SLID,
    SPED,
    TURN,
    bounded_impulses,
    slip,
)
from dynamics.kernels.compiled import LOOP, SUMS
from dynamics.kernels.contact_kicks import contact_forces
from dynamics.kernels.integrator_state import (
    BOUND,
    HELD,
    MIDDLE,
    PLACE,
    REST,
    SLIDING,
    SPEED,
    read,
)

# Rows that turn within this part of a step of one another turn together.
_TOGETHER = 1.0e-9

_EPSILON = 2.0 * float(np.finfo(np.float64).eps)


@njit(**SUMS)
def push_rows(v: Array, rows: Array, problem: Array) -> None:
    """v += rowsᵀ p."""
    for j in range(rows.shape[0]):
        impulse = problem[IMPULSE, j]
        if impulse != 0.0:
            for i in range(v.size):
                v[i] += rows[j, i] * impulse


@njit(**SUMS)
def filter_rows(rows: Array, half: Array, time: float, filtered: Array) -> None:
    """Fill in the filtered rows, φ = 2 av/h by the half flow."""
    for j in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            filtered[j, i] = 2.0 / time * half[1, i] * rows[j, i]


@njit(**SUMS)
def round_off(row_masses: Array, a: Array, noise: Array) -> None:
    """Round-off of a row times ``a``, by the norms of both."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * a[i]
    for j in range(noise.size):
        noise[j] = _EPSILON * np.sqrt(row_masses[j, j] * total)


@njit(**LOOP)
def bound_impulses(
    ahead: Array, v: Array, contact_rows: Array, terms: Terms, limits: Limits, push: Array,
    pressing: Array, given: Array, time: float, y: Array, force: Array, grip: Array,
) -> None:  # fmt: skip
    """h μ N of every row in N·s, by its prescribed N and the contact impulses that press it.

    Args:
        ahead: (num_modes,) modes at the end of the step but for friction.
        v: (num_modes,) their speeds in its middle.
        push: (num_rows,) contact forces at its start in N.
        y, force: (num_rows,) scratch.
    """
    for j in range(given.shape[1]):
        grip[BOUND, j] = time * given[0, j] * given[1, j]
    if pressing.size == 0:
        return
    contact_forces(ahead, contact_rows, terms, y, force)
    for k in range(force.size):
        damping = limits[k]["damping"]
        if damping > 0.0 and force[k] != 0.0:
            rate = 0.0
            for i in range(v.size):
                rate += contact_rows[k, i] * v[i]
            force[k] *= max(0.0, 1.0 + damping * np.sign(force[k]) * rate)
        impulse = 0.5 * time * (abs(push[k]) + abs(force[k]))
        for j in range(given.shape[1]):
            grip[BOUND, j] += given[0, j] * pressing[j, k] * impulse


@njit(**SUMS)
def look_ahead(a: Array, v: Array, half: Array, ahead: Array) -> None:
    """Where the modes would be at the end of the step without friction and excitations."""
    for i in range(a.size):
        ahead[i] = half[0, i] * a[i] + half[1, i] * v[i] + half[2, i]


@njit(**LOOP)
def rub(
    v: Array, ahead: Array, rows: Array, masses: Array, filtered: Array, matrix: Array, grip: Array,
    problem: Array, time: float,
) -> float:  # fmt: skip
    """The impulses in the middle of a step of ``time``; gives the friction loss in J.

    Args:
        ahead: (num_modes,) modes at its end but for friction.
        rows: (num_frictions, num_modes) there.
        grip: with the bounds, and the guess.
    """
    read(rows, ahead, problem[FREE])
    round_off(masses, ahead, problem[NOISE])
    size = matrix.shape[0]
    for j in range(size):
        problem[FREE, j] -= grip[PLACE, j]
        problem[HIGH, j] = grip[BOUND, j]
        problem[LOW, j] = -grip[BOUND, j]
        problem[IMPULSE, j] = grip[MIDDLE, j]
    bounded_impulses(matrix, problem)
    loss = 0.0
    for j in range(size):
        impulse, bound = problem[IMPULSE, j], grip[BOUND, j]
        way = slip(matrix, problem, j)
        inside = abs(impulse) < bound or (bound > 0.0 and abs(way) <= problem[NOISE, j])
        grip[MIDDLE, j] = impulse
        grip[HELD, j] = 1.0 if inside else 0.0
        if not inside:
            grip[PLACE, j] += way
            loss -= impulse * way / time
    push_rows(v, filtered, problem)
    return loss


@njit(**LOOP)
def settle(
    v: Array, rows: Array, carried: Array, masses: Array, grip: Array, problem: Array
) -> float:
    """Take the speed of held rows at the end of a step; gives the friction loss in J.

    The impulses are kept in ``grip``; ``carried`` (num_frictions,) are convective rates in m/s.
    """
    read(rows, v, problem[FREE])
    round_off(masses, v, problem[NOISE])
    size = masses.shape[0]
    holding = False
    for j in range(size):
        problem[FREE, j] += carried[j]
        bound, impulse, held = grip[BOUND, j], grip[MIDDLE, j], grip[HELD, j]
        problem[IMPULSE, j] = grip[REST, j] = 0.0
        problem[LOW, j] = held * min(-bound - impulse, 0.0)
        problem[HIGH, j] = held * max(bound - impulse, 0.0)
        holding = holding or held > 0.0
    if not holding:
        return 0.0
    bounded_impulses(masses, problem)
    push_rows(v, rows, problem)
    loss = 0.0
    for j in range(size):
        grip[REST, j] = problem[IMPULSE, j]
        loss -= problem[IMPULSE, j] * 0.5 * (problem[FREE, j] + slip(masses, problem, j))
    return loss


@njit(**LOOP)
def note_directions(masses: Array, grip: Array, problem: Array) -> bool:
    """Note speeds and directions of the rows at the end of a step; whether a direction changed."""
    changed = False
    for j in range(masses.shape[0]):
        problem[SLID, j], problem[SPED, j] = grip[SLIDING, j], grip[SPEED, j]
        after = slip(masses, problem, j)
        still = grip[HELD, j] > 0.0 or abs(after) <= problem[NOISE, j]
        grip[SPEED, j] = after
        grip[SLIDING, j] = 0.0 if still else np.sign(after)
        changed = changed or grip[SLIDING, j] != problem[SLID, j]
    return changed


@njit(**LOOP)
def find_turns(masses: Array, grip: Array, problem: Array, time: float) -> float:
    """When in a step of ``time`` the first row turned, infinity if none did.

    A row that slid at the start and is at rest or slides back at the end has turned: on the line
    between its speed then and the one that friction without any change of direction would have
    left it with.
    """
    first = np.inf
    size = masses.shape[0]
    for j in range(size):
        slid, speed = problem[SLID, j], problem[SPED, j]
        straight = problem[FREE, j]
        for k in range(size):
            if problem[SLID, k] != 0.0:
                kept = problem[SLID, k] * grip[BOUND, k] + grip[MIDDLE, k]
                straight -= masses[j, k] * kept
        problem[TURN, j] = np.inf
        if grip[BOUND, j] > 0.0 and grip[SLIDING, j] != slid and straight * slid < 0.0:
            problem[TURN, j] = time * speed / (speed - straight)
            first = min(first, problem[TURN, j])
    return first


@njit(**LOOP)
def stop(problem: Array, time: float, grip: Array) -> None:
    """Let rows rest that turn at a time, or so shortly after it that they turn together."""
    for j in range(grip.shape[1]):
        if problem[TURN, j] <= time * (1.0 + _TOGETHER):
            grip[SLIDING, j] = 0.0
