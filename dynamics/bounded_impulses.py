# SPDX-License-Identifier: LGPL-3.0-or-later
"""Impulses within bounds that bring rows to rest, or oppose those that they cannot stop.

Coulomb's law over one step is the optimality condition of a small convex problem: the least
½ p·G p + c·p with low ≤ p ≤ high, G symmetric and positive semidefinite. Where p_j lies between
its bounds the slip c_j + (G p)_j is zero; at a bound the slip opposes p_j.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

Array = npt.NDArray[np.float64]

# A pivot below this part of its diagonal: the row depends on those before it.
_DEPENDENT = 1.0e-12

# Slip below this part of what the bounds could cause is round-off.
_ROUND_OFF = 1.0e-13

_ROUNDS = 200

# Scratch: a Cholesky factor (num_rows, num_rows), changes (num_rows,), the rows between their
# bounds (num_rows,).
Scratch = tuple[Array, Array, npt.NDArray[np.int64]]


def scratch(num_rows: int) -> Scratch:
    """Scratch for so many rows."""
    return np.zeros((num_rows, num_rows)), np.zeros(num_rows), np.zeros(num_rows, dtype=np.int64)


@njit(cache=True, nogil=True, error_model="numpy")
def bounded_impulses(
    matrix: Array,
    free: Array,
    low: Array,
    high: Array,
    noise: Array,
    impulse: Array,
    factor: Array,
    change: Array,
    inner: npt.NDArray[np.int64],
) -> bool:
    """Improve ``impulse`` (num_rows,) until it solves the problem; False if it nearly does.

    Rounds of a Gauss-Seidel sweep, which finds the rows that leave their bounds (it needs one round
    where these are the ones of the guess), and exact solutions for the others, in which a row
    that reaches its bound stays there. Both lower the objective, whatever the rank of the matrix.

    Args:
        matrix: (num_rows, num_rows) G.
        free: (num_rows,) c, the slip without impulses.
        low, high: (num_rows,) bounds, low ≤ high.
        noise: (num_rows,) round-off of ``free``, in which rows that depend on one another may
            contradict themselves.
        impulse: (num_rows,) a guess.
        factor, change, inner: :func:`scratch`.
    """
    for j in range(free.size):
        impulse[j] = min(max(impulse[j], low[j]), high[j])
    for _ in range(_ROUNDS):
        for j in range(free.size):
            if low[j] < high[j] and matrix[j, j] > 0.0:
                moved = impulse[j] - slip(matrix, free, impulse, j) / matrix[j, j]
                impulse[j] = min(max(moved, low[j]), high[j])
        part = 0.0
        while part < 1.0:
            count = 0
            for j in range(free.size):
                if low[j] < impulse[j] < high[j] and matrix[j, j] > 0.0:
                    inner[count] = j
                    count += 1
            _newton(matrix, free, impulse, inner, count, factor, change)
            part = _advance(low, high, impulse, inner, count, change)
        if _solved(matrix, free, low, high, noise, impulse):
            return True
    return False


@njit(cache=True, nogil=True, error_model="numpy")
def _advance(
    low: Array,
    high: Array,
    impulse: Array,
    inner: npt.NDArray[np.int64],
    count: int,
    change: Array,
) -> float:
    """Change the inner impulses until the first is at its bound; the part of the change made."""
    part = 1.0
    first = -1
    for p in range(count):
        j = inner[p]
        room = high[j] - impulse[j] if change[p] > 0.0 else impulse[j] - low[j]
        if part * abs(change[p]) > room:
            part, first = room / abs(change[p]), p
    for p in range(count):
        j = inner[p]
        impulse[j] = min(max(impulse[j] + part * change[p], low[j]), high[j])
    if first >= 0:
        impulse[inner[first]] = high[inner[first]] if change[first] > 0.0 else low[inner[first]]
    return part


@njit(cache=True, nogil=True, error_model="numpy")
def slip(matrix: Array, free: Array, impulse: Array, j: int) -> float:
    """c_j + (G p)_j."""
    total: float = free[j]
    for k in range(free.size):
        total += matrix[j, k] * impulse[k]
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def _newton(
    matrix: Array,
    free: Array,
    impulse: Array,
    inner: npt.NDArray[np.int64],
    count: int,
    factor: Array,
    change: Array,
) -> None:
    """The change of the inner impulses that takes their slip away, by Cholesky's method.

    A row that depends on those before it keeps its impulse: what stops those stops it.
    """
    for p in range(count):
        change[p] = -slip(matrix, free, impulse, inner[p])
        for q in range(p + 1):
            total = matrix[inner[p], inner[q]]
            for k in range(q):
                total -= factor[p, k] * factor[q, k]
            if q < p:
                factor[p, q] = total / factor[q, q] if factor[q, q] > 0.0 else 0.0
            else:
                independent = total > _DEPENDENT * matrix[inner[p], inner[p]]
                factor[p, p] = np.sqrt(total) if independent else 0.0
        for k in range(p):
            change[p] -= factor[p, k] * change[k]
        change[p] = change[p] / factor[p, p] if factor[p, p] > 0.0 else 0.0
    for p in range(count - 1, -1, -1):
        for k in range(p + 1, count):
            change[p] -= factor[k, p] * change[k]
        change[p] = change[p] / factor[p, p] if factor[p, p] > 0.0 else 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def _solved(
    matrix: Array, free: Array, low: Array, high: Array, noise: Array, impulse: Array
) -> bool:
    for j in range(free.size):
        if low[j] == high[j]:
            continue
        left: float = free[j]
        reach = abs(free[j])
        for k in range(free.size):
            left += matrix[j, k] * impulse[k]
            reach += abs(matrix[j, k]) * max(-low[k], high[k])
        small = noise[j] + _ROUND_OFF * reach
        if (left > small and impulse[j] > low[j]) or (left < -small and impulse[j] < high[j]):
            return False
    return True
