# SPDX-License-Identifier: LGPL-3.0-or-later
"""Impulses within bounds that bring rows to rest, or oppose those that they cannot stop.

Coulomb's law over one step is the optimality condition of a small convex problem: the least
½ p·G p + c·p with low ≤ p ≤ high, G symmetric and positive semidefinite. Where p_j lies between
its bounds the slip c_j + (G p)_j is zero; at a bound the slip opposes p_j.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.kernels.compiled import LOOP

# A pivot below this part of its diagonal: the row depends on those before it.
_DEPENDENT = 1.0e-12

# Slip below this part of what the bounds could cause is round-off.
_ROUND_OFF = 1.0e-13

_ROUNDS = 200

# Rows of a problem (``num_rows`` columns each): the slip c without impulses, bounds low ≤ high, the
# round-off of c, in which rows that depend on one another may contradict themselves, the impulses;
# of friction, directions and speeds at the start of a step, and when rows turned in it; what the
# solution needs besides: changes of impulses, which rows are between their bounds, and from
# ``_FACTOR`` on a Cholesky factor. One array, since each that is handed on costs as much as a sum.
FREE, LOW, HIGH, NOISE, IMPULSE, SLID, SPED, TURN, _CHANGE, _INNER, _FACTOR = range(11)


def problem_for(num_rows: int) -> Array:
    """A problem of so many rows."""
    return np.zeros((_FACTOR + num_rows, num_rows))


@njit(**LOOP)
def bounded_impulses(matrix: Array, problem: Array) -> bool:
    """Improve the impulses, a guess, until they solve the problem; False if they nearly do.

    Rounds of a Gauss-Seidel sweep, which finds the rows that leave their bounds (it needs one round
    where these are the ones of the guess), and exact solutions for the others, in which a row
    that reaches its bound stays there. Both lower the objective, whatever the rank of the matrix G.
    """
    size = matrix.shape[0]
    for j in range(size):
        problem[IMPULSE, j] = min(max(problem[IMPULSE, j], problem[LOW, j]), problem[HIGH, j])
    for _ in range(_ROUNDS):
        for j in range(size):
            if problem[LOW, j] < problem[HIGH, j] and matrix[j, j] > 0.0:
                moved = problem[IMPULSE, j] - slip(matrix, problem, j) / matrix[j, j]
                problem[IMPULSE, j] = min(max(moved, problem[LOW, j]), problem[HIGH, j])
        part = 0.0
        while part < 1.0:
            count = 0
            for j in range(size):
                inside = problem[LOW, j] < problem[IMPULSE, j] < problem[HIGH, j]
                if inside and matrix[j, j] > 0.0:
                    problem[_INNER, count] = j
                    count += 1
            _newton(matrix, problem, count)
            part = _advance(problem, count)
        if _solved(matrix, problem):
            return True
    return False


@njit(**LOOP)
def _advance(problem: Array, count: int) -> float:
    """Change the inner impulses until the first is at its bound; the part of the change made."""
    part = 1.0
    first = -1
    for p in range(count):
        j = int(problem[_INNER, p])
        change = problem[_CHANGE, p]
        if change > 0.0:
            room = problem[HIGH, j] - problem[IMPULSE, j]
        else:
            room = problem[IMPULSE, j] - problem[LOW, j]
        if part * abs(change) > room:
            part, first = room / abs(change), p
    for p in range(count):
        j = int(problem[_INNER, p])
        moved = problem[IMPULSE, j] + part * problem[_CHANGE, p]
        problem[IMPULSE, j] = min(max(moved, problem[LOW, j]), problem[HIGH, j])
    if first >= 0:
        j = int(problem[_INNER, first])
        problem[IMPULSE, j] = problem[HIGH if problem[_CHANGE, first] > 0.0 else LOW, j]
    return part


@njit(**LOOP)
def slip(matrix: Array, problem: Array, j: int) -> float:
    """c_j + (G p)_j."""
    total: float = problem[FREE, j]
    for k in range(matrix.shape[0]):
        total += matrix[j, k] * problem[IMPULSE, k]
    return total


@njit(**LOOP)
def _newton(matrix: Array, problem: Array, count: int) -> None:
    """The change of the inner impulses that takes their slip away, by Cholesky's method.

    A row that depends on those before it keeps its impulse: what stops those stops it.
    """
    for p in range(count):
        i = int(problem[_INNER, p])
        change = -slip(matrix, problem, i)
        for q in range(p + 1):
            total = matrix[i, int(problem[_INNER, q])]
            for k in range(q):
                total -= problem[_FACTOR + p, k] * problem[_FACTOR + q, k]
            if q < p:
                pivot = problem[_FACTOR + q, q]
                problem[_FACTOR + p, q] = total / pivot if pivot > 0.0 else 0.0
            else:
                independent = total > _DEPENDENT * matrix[i, i]
                problem[_FACTOR + p, p] = np.sqrt(total) if independent else 0.0
        for k in range(p):
            change -= problem[_FACTOR + p, k] * problem[_CHANGE, k]
        pivot = problem[_FACTOR + p, p]
        problem[_CHANGE, p] = change / pivot if pivot > 0.0 else 0.0
    for p in range(count - 1, -1, -1):
        change = problem[_CHANGE, p]
        for k in range(p + 1, count):
            change -= problem[_FACTOR + k, p] * problem[_CHANGE, k]
        pivot = problem[_FACTOR + p, p]
        problem[_CHANGE, p] = change / pivot if pivot > 0.0 else 0.0


@njit(**LOOP)
def _solved(matrix: Array, problem: Array) -> bool:
    for j in range(matrix.shape[0]):
        if problem[LOW, j] == problem[HIGH, j]:
            continue
        left: float = problem[FREE, j]
        reach = abs(left)
        for k in range(matrix.shape[0]):
            left += matrix[j, k] * problem[IMPULSE, k]
            reach += abs(matrix[j, k]) * max(-problem[LOW, k], problem[HIGH, k])
        small = problem[NOISE, j] + _ROUND_OFF * reach
        above = left > small and problem[IMPULSE, j] > problem[LOW, j]
        below = left < -small and problem[IMPULSE, j] < problem[HIGH, j]
        if above or below:
            return False
    return True
