# SPDX-License-Identifier: LGPL-3.0-or-later
"""The friction impulses of one step: in its middle against sliding, at its end for rest.

In the middle of the step, between two half flows, the impulse r_l acts on the modes through the
row D_l filtered by φ_i = sin(ω_i h/2)/(ω_i h/2). The slip of the rows over the whole step then is

    s = s_free + G r,    G = (h/2) D φ² Dᵀ,    r_l ∈ −h μ_l N_l Sign(s_l)

and the work of the impulses is r·s/h exactly (without damping, under a constant load): friction
takes its force times the way that it slides, and nothing from a row that it holds. Rows that are
held end where they began; the rest of their speed goes at the end of the step, by impulses that
leave |r_l| ≤ h μ_l N_l. The filter is that of the mollified impulse method (García-Archilla et
al. 1999).
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

from dynamics.bounded_impulses import bounded_impulses, slip
from dynamics.contact_kicks import contact_forces
from dynamics.integrator_state import BOUND, HELD, IMPULSE, PLACE, SLIDING, SPEED

Array = npt.NDArray[np.float64]

_EPSILON = 2.0 * float(np.finfo(np.float64).eps)


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"})
def push_rows(v: Array, rows: Array, impulse: Array) -> None:
    """v += rowsᵀ impulse."""
    for j in range(rows.shape[0]):
        if impulse[j] != 0.0:
            for i in range(v.size):
                v[i] += rows[j, i] * impulse[j]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"})
def filter_rows(rows: Array, half: Array, time: float, filtered: Array, matrix: Array) -> None:
    """Fill in the filtered rows, φ = 2 av/h by the half flow, and G = (h/2) D φ² Dᵀ."""
    for j in range(rows.shape[0]):
        for i in range(rows.shape[1]):
            filtered[j, i] = 2.0 / time * half[1, i] * rows[j, i]
        for k in range(j + 1):
            total = 0.0
            for i in range(rows.shape[1]):
                total += filtered[j, i] * filtered[k, i]
            matrix[j, k] = matrix[k, j] = 0.5 * time * total


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"})
def round_off(row_masses: Array, a: Array, noise: Array) -> None:
    """Round-off of a row times ``a``, by the norms of both."""
    total = 0.0
    for i in range(a.size):
        total += a[i] * a[i]
    for j in range(noise.size):
        noise[j] = _EPSILON * np.sqrt(row_masses[j, j] * total)


@njit(cache=True, nogil=True, error_model="numpy")
def sliding_bounds(
    ahead: Array,
    v: Array,
    contact_rows: Array,
    law: Array,
    push: Array,
    pressing: Array,
    given: Array,
    time: float,
    y: Array,
    force: Array,
    bound: Array,
) -> None:
    """h μ N of every row: μ times the contact impulses of the step, and the prescribed part.

    Args:
        ahead: (num_modes,) modes at the end of the step but for friction.
        v: (num_modes,) their speeds in its middle.
        push: (num_rows,) contact forces at its start in N.
        y, force: (num_rows,) scratch.
        bound: (num_frictions,) is set, in N·s.
    """
    for j in range(bound.size):
        bound[j] = given[1, j]
    if pressing.size > 0:
        contact_forces(ahead, contact_rows, law, y, force)
        for k in range(force.size):
            if law[4, k] > 0.0 and force[k] != 0.0:
                rate = np.sign(force[k]) * np.dot(contact_rows[k], v)
                force[k] *= max(0.0, 1.0 + law[4, k] * rate)
            for j in range(bound.size):
                bound[j] += pressing[j, k] * 0.5 * (abs(push[k]) + abs(force[k]))
    for j in range(bound.size):
        bound[j] *= time * given[0, j]


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"})
def look_ahead(a: Array, v: Array, half: Array, ahead: Array) -> None:
    """Where the modes would be at the end of the step without friction and excitations."""
    for i in range(a.size):
        ahead[i] = half[0, i] * a[i] + half[1, i] * v[i] + half[2, i]


@njit(cache=True, nogil=True, error_model="numpy")
def rub(
    v: Array,
    filtered: Array,
    matrix: Array,
    free: Array,
    noise: Array,
    grip: Array,
    impulse: Array,
    low: Array,
    bound: Array,
    factor: Array,
    change: Array,
    inner: npt.NDArray[np.int64],
    time: float,
) -> float:
    """The impulses in the middle of a step of ``time``; gives the friction loss in J.

    Args:
        free: (num_frictions,) s_free in m, its round-off in ``noise``.
        impulse, bound: (num_frictions,) those of ``grip``.
        low, factor, change, inner: scratch.
    """
    for j in range(free.size):
        low[j] = -bound[j]
    bounded_impulses(matrix, free, low, bound, noise, impulse, factor, change, inner)
    loss = 0.0
    for j in range(free.size):
        way = slip(matrix, free, impulse, j)
        inside = abs(impulse[j]) < bound[j] or (bound[j] > 0.0 and abs(way) <= noise[j])
        grip[HELD, j] = 1.0 if inside else 0.0
        if not inside:
            grip[PLACE, j] += way
            loss -= impulse[j] * way / time
    push_rows(v, filtered, impulse)
    return loss


@njit(cache=True, nogil=True, error_model="numpy")
def settle(
    v: Array,
    rows: Array,
    masses: Array,
    raw: Array,
    noise: Array,
    grip: Array,
    rest: Array,
    low: Array,
    high: Array,
    factor: Array,
    change: Array,
    inner: npt.NDArray[np.int64],
) -> float:
    """Take the speed of held rows at the end of a step; gives the friction loss in J.

    Args:
        raw: (num_frictions,) the rows' speeds in m/s, their round-off in ``noise``.
        rest: (num_frictions,) of ``grip``.
        low, high, factor, change, inner: scratch.
    """
    holding = False
    for j in range(raw.size):
        bound, impulse, held = grip[BOUND, j], grip[IMPULSE, j], grip[HELD, j]
        rest[j] = 0.0
        low[j] = held * min(-bound - impulse, 0.0)
        high[j] = held * max(bound - impulse, 0.0)
        holding = holding or held > 0.0
    if not holding:
        return 0.0
    bounded_impulses(masses, raw, low, high, noise, rest, factor, change, inner)
    push_rows(v, rows, rest)
    loss = 0.0
    for j in range(raw.size):
        loss -= rest[j] * 0.5 * (raw[j] + slip(masses, raw, rest, j))
    return loss


@njit(cache=True, nogil=True, error_model="numpy")
def note_directions(
    masses: Array, raw: Array, noise: Array, grip: Array, rest: Array, slid: Array, before: Array
) -> bool:
    """Note speeds and directions of the rows at the end of a step; whether a direction changed.

    Args:
        slid, before: (num_frictions,) are set to the directions and speeds at its start.
    """
    changed = False
    for j in range(raw.size):
        slid[j], before[j] = grip[SLIDING, j], grip[SPEED, j]
        after = slip(masses, raw, rest, j)
        still = grip[HELD, j] > 0.0 or abs(after) <= noise[j]
        grip[SPEED, j] = after
        grip[SLIDING, j] = 0.0 if still else np.sign(after)
        changed = changed or grip[SLIDING, j] != slid[j]
    return changed


@njit(cache=True, nogil=True, error_model="numpy")
def find_turns(
    masses: Array, raw: Array, grip: Array, slid: Array, before: Array, time: float, turns: Array
) -> float:
    """When in a step of ``time`` the first row turned, infinity if none did.

    A row that slid at the start and is at rest or slides back at the end has turned: on the line
    between its speed then and the one that friction without any change of direction would have
    left it with. ``turns`` (num_frictions,) is set, to infinity where a row did not.
    """
    first = np.inf
    for j in range(raw.size):
        straight = raw[j]
        for k in range(raw.size):
            if slid[k] != 0.0:
                straight -= masses[j, k] * (slid[k] * grip[BOUND, k] + grip[IMPULSE, k])
        turns[j] = np.inf
        if grip[BOUND, j] > 0.0 and grip[SLIDING, j] != slid[j] and straight * slid[j] < 0.0:
            turns[j] = time * before[j] / (before[j] - straight)
            first = min(first, turns[j])
    return first
