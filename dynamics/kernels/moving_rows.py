# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows of a gap system that travels move, in the time loop.

Between the ends of a step a row changes its displacement by B₁ a₁ − B₀ a₀ = B̄ (a₁ − a₀) +
(B₁ − B₀)(a₀ + a₁)/2. Forces push with the mean row B̄ on the modes; the second part times the force
is the work of the drive, so that the energy balances exactly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.drive.travel import KINDS
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import SUMS


class Moving(NamedTuple):
    """The rows that travels move, as cubics between knots.

    Args:
        knots: of all travels in m, and
        starts: (num_travels + 1,) where those of each begin.
        cubics: (num_pieces of all rows, 4, num_modes) coefficients of the part of a piece passed.
        rows: (num_moving, 3) the position of each among all rows, its travel, and the first of its
            pieces.
    """

    knots: Array
    starts: Indices
    cubics: Array
    rows: Indices


def stacked_rows(system: GapSystem) -> Array:
    """Return all rows (num_rows, num_modes) at t = 0: contacts, friction rows, dashpots."""
    return np.concatenate([getattr(system, kind) for kind in KINDS])


def moving_rows(system: GapSystem) -> Moving:
    """Return the rows of a system that travels move."""
    firsts = np.cumsum([0, *(len(getattr(system, kind)) for kind in KINDS)])
    first_of = dict(zip(KINDS, firsts[:-1].tolist(), strict=True))
    cubics, pieces = [np.zeros((0, 4, system.num_modes))], 0
    rows: list[tuple[int, int, int]] = []
    for number, travel in enumerate(system.travels):
        for row, (kind, position) in enumerate(travel.moving):
            rows.append((first_of[kind] + position, number, pieces))
            cubics.append(travel.table.coefficients[:, :, row])
            pieces += len(travel.table.coefficients)
    knots = [travel.table.knots for travel in system.travels]
    return Moving(
        np.concatenate([np.zeros(0), *knots]),
        np.cumsum([0, *(len(one) for one in knots)]),
        np.ascontiguousarray(np.concatenate(cubics)),
        np.array(rows, dtype=np.int64).reshape(-1, 3),
    )


@njit(**SUMS)
def knot_before(knots: Array, low: int, high: int, way: float) -> int:
    """Return the last knot from ``low`` to before ``high`` that is not beyond a way in m."""
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle] <= way:
            low = middle
        else:
            high = middle
    return low


@njit(**SUMS)
def move_rows(ways: Array, moving: Moving, before: Array, after: Array, mean: Array) -> None:
    """Set the rows (num_rows, num_modes) that move to those at ways (num_travels,) in m.

    Args:
        ways: at the end of a step.
        moving: the rows that move.
        before: at the start of the step.
        after: B₁, is set.
        mean: B̄, is set.
    """
    for m in range(moving.rows.shape[0]):
        row, travel, first = moving.rows[m]
        start = moving.starts[travel]
        low = knot_before(moving.knots, start, moving.starts[travel + 1] - 1, ways[travel])
        u = (ways[travel] - moving.knots[low]) / (moving.knots[low + 1] - moving.knots[low])
        cubic = moving.cubics[first + low - start]
        for i in range(after.shape[1]):
            bent = cubic[2, i] + u * cubic[3, i]
            after[row, i] = cubic[0, i] + u * (cubic[1, i] + u * bent)
            mean[row, i] = 0.5 * (before[row, i] + after[row, i])
