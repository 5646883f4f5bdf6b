# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows of a gap system that travels move, in the time loop.

Between the ends of a step a row changes its displacement by B₁ a₁ − B₀ a₀ = B̄ (a₁ − a₀) +
(B₁ − B₀)(a₀ + a₁)/2. Forces push with the mean row B̄ on the modes; the second part times the force
is the work of the drive, so that the energy balances exactly.

Unsigned integers count the entries of a stretch: with signed ones numba checks for negative
positions and does not vectorise the loop.
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
        stretches: (num_stretches, 5) for each stretch of entries in which a row changes: its
            position among all rows, its travel, the first of its pieces, the first entry and the
            one after the last.
    """

    knots: Array
    starts: Indices
    cubics: Array
    stretches: Indices


# An entry that changes by a smaller part of the largest is constant but for round-off.
_CONSTANT = 1.0e-13

# Stretches with fewer constant entries between them are one.
_NEAR = 8


def stacked_rows(system: GapSystem) -> Array:
    """Return all rows (num_rows, num_modes) at t = 0: contacts, friction rows, dashpots."""
    return np.concatenate([getattr(system, kind) for kind in KINDS])


def moving_rows(system: GapSystem) -> Moving:
    """Return the rows of a system that travels move."""
    firsts = np.cumsum([0, *(len(getattr(system, kind)) for kind in KINDS)])
    first_of = dict(zip(KINDS, firsts[:-1].tolist(), strict=True))
    cubics, pieces = [np.zeros((0, 4, system.num_modes))], 0
    found: list[tuple[int, ...]] = []
    for number, travel in enumerate(system.travels):
        for row, (kind, position) in enumerate(travel.moving):
            own = travel.table.coefficients[:, :, row]
            first = first_of[kind] + position, number, pieces
            found.extend((*first, *stretch) for stretch in _stretches(own))
            cubics.append(own)
            pieces += len(own)
    knots = [travel.table.knots for travel in system.travels]
    return Moving(
        np.concatenate([np.zeros(0), *knots]),
        np.cumsum([0, *(len(one) for one in knots)]),
        np.ascontiguousarray(np.concatenate(cubics)),
        np.array(found, dtype=np.int64).reshape(-1, 5),
    )


def _stretches(cubics: Array) -> list[tuple[int, int]]:
    """Return the first entry and the one after the last of each stretch in which a row changes."""
    reach = np.abs(cubics[:, 1:]).max(axis=(0, 1)) + np.ptp(cubics[:, 0], axis=0)
    (entries,) = np.nonzero(reach > _CONSTANT * np.abs(cubics).max(initial=0.0))
    apart = np.split(entries, np.flatnonzero(np.diff(entries) > _NEAR) + 1)
    return [(int(some[0]), int(some[-1]) + 1) for some in apart if some.size]


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
def place_rows(ways: Array, moving: Moving, rows: Array) -> None:
    """Set the rows (num_rows, num_modes) that move to those at ways (num_travels,) in m."""
    found, low, u = -1, 0, 0.0
    for m in range(moving.stretches.shape[0]):
        row, travel, first, begin, end = moving.stretches[m]
        if travel != found:
            found = travel
            last = moving.starts[travel + 1] - 1
            low = knot_before(moving.knots, moving.starts[travel], last, ways[travel])
            u = (ways[travel] - moving.knots[low]) / (moving.knots[low + 1] - moving.knots[low])
        cubic = moving.cubics[first + low - moving.starts[travel]]
        for i in range(np.uint64(begin), np.uint64(end)):
            bent = cubic[2, i] + u * cubic[3, i]
            rows[row, i] = cubic[0, i] + u * (cubic[1, i] + u * bent)


@njit(**SUMS)
def average_rows(before: Array, after: Array, moving: Moving, mean: Array) -> None:
    """Set the rows (num_rows, num_modes) that move to the mean of two positions."""
    for m in range(moving.stretches.shape[0]):
        j = moving.stretches[m, 0]
        for i in range(np.uint64(moving.stretches[m, 3]), np.uint64(moving.stretches[m, 4])):
            mean[j, i] = 0.5 * (before[j, i] + after[j, i])


@njit(**SUMS)
def copy_rows(after: Array, moving: Moving, before: Array) -> None:
    """Set the rows (num_rows, num_modes) that move to others."""
    for m in range(moving.stretches.shape[0]):
        j = moving.stretches[m, 0]
        for i in range(np.uint64(moving.stretches[m, 3]), np.uint64(moving.stretches[m, 4])):
            before[j, i] = after[j, i]
