# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows of a gap system at a time, and what acts along them while they move.

Within a part of a step rows go straight from where they were to where they will be, so that a gap
changes by B̄ Δa + ΔB ā exactly, with the means of both ends: what the modes make of it and what the
drive does. ΔB a over the time of the part is the convective rate of the gap.

Entries of a stretch are counted by numbers without sign: of others numba asks whether they count
from the end, and no loop that asks is made of vector instructions.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.drive.travel import KINDS
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import SUMS

# Knots of all travels in m, where those of each begin (num_travels + 1,), coefficients of all
# pieces (num_pieces of all rows, 4, num_modes), and for each stretch of entries in which a row
# changes the position of the row among all, its travel, the first of its pieces, and between which
# entries it lies (num_stretches, 5).
Tables = tuple[Array, Indices, Array, Indices]

# An entry that changes by a smaller part of the largest is constant but for round-off.
_CONSTANT = 1.0e-13

# Stretches with fewer constant entries between them are one.
_NEAR = 8


def stacked_rows(system: GapSystem) -> Array:
    """(num_rows + num_frictions + num_dashpots, num_modes) as they are at t = 0."""
    return np.concatenate([getattr(system, kind) for kind in KINDS])


def row_tables(system: GapSystem) -> Tables:
    """The tables of a system in the layout of the compiled loop."""
    rubbing = any(f.pressed_by or f.normal_force * f.coefficient for f in system.frictions)
    firsts = np.cumsum([0, *(len(getattr(system, kind)) for kind in KINDS)])
    first_of = dict(zip(KINDS, firsts[:-1].tolist(), strict=True))
    coefficients, pieces = [np.zeros((0, 4, system.num_modes))], 0
    moving: list[tuple[int, ...]] = []
    for number, travel in enumerate(system.travels):
        for row, (kind, position) in enumerate(travel.moving):
            if kind == "friction_rows" and not rubbing:
                continue
            cubics = travel.table.coefficients[:, :, row]
            own = first_of[kind] + position, number, pieces
            moving.extend((*own, *stretch) for stretch in _stretches(cubics))
            coefficients.append(cubics)
            pieces += len(cubics)
    knots = [travel.table.knots for travel in system.travels]
    starts = np.cumsum([0, *(len(one) for one in knots)])
    flat = np.ascontiguousarray(np.concatenate(coefficients))
    return np.concatenate(knots), starts, flat, np.array(moving, dtype=np.int64).reshape(-1, 5)


def _stretches(cubics: Array) -> list[tuple[int, int]]:
    """From which to before which entries a row (num_pieces, 4, num_modes) changes."""
    reach = np.abs(cubics[:, 1:]).max(axis=(0, 1)) + np.ptp(cubics[:, 0], axis=0)
    (entries,) = np.nonzero(reach > _CONSTANT * np.abs(cubics).max(initial=0.0))
    apart = np.split(entries, np.flatnonzero(np.diff(entries) > _NEAR) + 1)
    return [(int(some[0]), int(some[-1]) + 1) for some in apart if some.size]


@njit(**SUMS)
def knot_before(knots: Array, low: int, high: int, way: float) -> int:
    """The last of the knots from ``low`` to before ``high`` that a way in m has passed."""
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle] <= way:
            low = middle
        else:
            high = middle
    return low


@njit(**SUMS)
def place_rows(ways: Array, tables: Tables, rows: Array) -> None:
    """Set those of all rows that move to where travels have come, ``ways`` (num_travels,) in m."""
    knots, starts, coefficients, moving = tables
    found, low, u = -1, 0, 0.0
    for m in range(moving.shape[0]):
        row, travel, first, begin, end = moving[m]
        if travel != found:
            found = travel
            low = knot_before(knots, starts[travel], starts[travel + 1] - 1, ways[travel])
            u = (ways[travel] - knots[low]) / (knots[low + 1] - knots[low])
        piece = first + low - starts[travel]
        for i in range(np.uint64(begin), np.uint64(end)):
            bent = coefficients[piece, 2, i] + u * coefficients[piece, 3, i]
            straight = coefficients[piece, 1, i] + u * bent
            rows[row, i] = coefficients[piece, 0, i] + u * straight


@njit(**SUMS)
def carry(
    now: Array, then: Array, moving: Indices, first: int, last: int, a: Array, time: float,
    rates: Array,
) -> None:  # fmt: skip
    """Fill in the convective rates ΔB a/τ in m/s of the rows from ``first`` to before ``last``."""
    for j in range(first, last):
        rates[j] = 0.0
    for m in range(moving.shape[0]):
        j = moving[m, 0]
        if not first <= j < last:
            continue
        total = 0.0
        for i in range(np.uint64(moving[m, 3]), np.uint64(moving[m, 4])):
            total += (then[j, i] - now[j, i]) * a[i]
        rates[j] += total / time


@njit(**SUMS)
def average(now: Array, then: Array, moving: Indices, first: int, middle: Array) -> None:
    """Fill in the rows from ``first`` on that move as they are in the mean."""
    for m in range(moving.shape[0]):
        j = moving[m, 0]
        if j < first:
            continue
        for i in range(np.uint64(moving[m, 3]), np.uint64(moving[m, 4])):
            middle[j, i] = 0.5 * (now[j, i] + then[j, i])


@njit(**SUMS)
def arrive(now: Array, then: Array, moving: Indices) -> None:
    """Set the rows that move to where they come."""
    for m in range(moving.shape[0]):
        j = moving[m, 0]
        for i in range(np.uint64(moving[m, 3]), np.uint64(moving[m, 4])):
            now[j, i] = then[j, i]


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
