# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows of a gap system at a time, and what acts along them while they move.

Within a part of a step rows go straight from where they were to where they will be, so that a gap
changes by B̄ Δa + ΔB ā exactly, with the means of both ends: what the modes make of it and what the
drive does. ΔB a over the time of the part is the convective rate of the gap.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.contact import Limits
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import SUMS
from dynamics.travel import KINDS

# Knots of all travels in m, where those of each begin (num_travels + 1,), coefficients of all
# pieces (num_pieces of all rows, 4, num_modes), and for each row that moves its position among all
# rows, its travel, and the first of its pieces (num_moving, 3).
Tables = tuple[Array, Indices, Array, Indices]


def stacked_rows(system: GapSystem) -> Array:
    """(num_rows + num_frictions + num_dashpots, num_modes) as they are at t = 0."""
    return np.concatenate([getattr(system, kind) for kind in KINDS])


def row_tables(system: GapSystem) -> Tables:
    """The tables of a system in the layout of the compiled loop."""
    firsts = np.cumsum([0, *(len(getattr(system, kind)) for kind in KINDS)])
    first_of = dict(zip(KINDS, firsts[:-1].tolist(), strict=True))
    coefficients, moving, pieces = [np.zeros((0, 4, system.num_modes))], [], 0
    for number, travel in enumerate(system.travels):
        for row, (kind, position) in enumerate(travel.moving):
            moving.append((first_of[kind] + position, number, pieces))
            coefficients.append(travel.table.coefficients[:, :, row])
            pieces += len(coefficients[-1])
    knots = [travel.table.knots for travel in system.travels]
    starts = np.cumsum([0, *(len(one) for one in knots)])
    flat = np.ascontiguousarray(np.concatenate(coefficients))
    return np.concatenate(knots), starts, flat, np.array(moving, dtype=np.int64).reshape(-1, 3)


@njit(**SUMS)
def place_rows(ways: Array, tables: Tables, rows: Array) -> None:
    """Set those of all rows that move to where travels have come, ``ways`` (num_travels,) in m."""
    knots, starts, coefficients, moving = tables
    for m in range(moving.shape[0]):
        row, travel, first = moving[m]
        low, high = starts[travel], starts[travel + 1] - 1
        while high - low > 1:
            middle = (low + high) // 2
            if knots[middle] <= ways[travel]:
                low = middle
            else:
                high = middle
        u = (ways[travel] - knots[low]) / (knots[low + 1] - knots[low])
        piece = first + low - starts[travel]
        for i in range(rows.shape[1]):
            bent = coefficients[piece, 2, i] + u * coefficients[piece, 3, i]
            straight = coefficients[piece, 1, i] + u * bent
            rows[row, i] = coefficients[piece, 0, i] + u * straight


@njit(**SUMS)
def carry(now: Array, then: Array, a: Array, time: float, rates: Array) -> None:
    """Fill in the convective rates ΔB a/τ of all rows in m/s."""
    for j in range(now.shape[0]):
        total = 0.0
        for i in range(a.size):
            total += (then[j, i] - now[j, i]) * a[i]
        rates[j] = total / time


@njit(**SUMS)
def moving_kick(
    v: Array,
    rows: Array,
    carried: Array,
    force: Array,
    limits: Limits,
    duration: float,
    backward: bool,
    push: Array,
    driven: Array,
) -> float:
    """Change the speeds by contact forces, as :func:`damped_kick` does; gives the loss in J.

    Args:
        carried: (num_rows,) convective rates in m/s.
        driven: (num_rows,) is given what the drive does at each row in J.
    """
    loss = 0.0
    count = force.size
    for position in range(count):
        j = count - 1 - position if backward else position
        push[j] = 0.0
        if force[j] == 0.0:
            continue
        side = np.sign(force[j])
        rate = side * carried[j]
        square = 0.0
        for i in range(v.size):
            rate += side * rows[j, i] * v[i]
            square += rows[j, i] * rows[j, i]
        elastic = duration * abs(force[j])
        strength = elastic * limits[j]["damping"]
        impulse = max(0.0, (elastic + strength * rate) / (1.0 + 0.5 * strength * square))
        loss += (impulse - elastic) * (rate - 0.5 * impulse * square)
        driven[j] += side * impulse * carried[j]
        push[j] = side * impulse / duration
        for i in range(v.size):
            v[i] -= side * rows[j, i] * impulse
    return loss


@njit(**SUMS)
def moving_drag(
    v: Array, rows: Array, carried: Array, time: float, backward: bool, driven: Array
) -> float:
    """Change the speeds by dashpots, one after the other, each exactly; gives the loss in J.

    Args:
        rows: (num_dashpots, num_modes) in 1/√s, and
        carried: (num_dashpots,) their convective rates.
        driven: (num_dashpots,) is given what the drive does at each in J.
    """
    loss = 0.0
    for position in range(rows.shape[0]):
        d = rows.shape[0] - 1 - position if backward else position
        rate = carried[d]
        square = 0.0
        for i in range(v.size):
            rate += rows[d, i] * v[i]
            square += rows[d, i] * rows[d, i]
        if square == 0.0:
            continue
        after = rate * np.exp(-square * time)
        taken = (rate - after) / square
        loss += 0.5 * taken * (rate + after)
        driven[d] += taken * carried[d]
        for i in range(v.size):
            v[i] -= rows[d, i] * taken
    return loss
