# SPDX-License-Identifier: LGPL-3.0-or-later
"""Impulses between bounds meet the optimality conditions, whatever the rank of their matrix."""

from __future__ import annotations

import numpy as np
import pytest
from dynamics.kernels.bounded_impulses import (
    FREE,
    HIGH,
    IMPULSE,
    LOW,
    NOISE,
    bounded_impulses,
    problem_for,
)

from dynamics.arrays import Array


def solve(matrix: Array, free: Array, bound: Array, guess: Array) -> Array:
    problem = problem_for(free.size)
    problem[FREE], problem[LOW], problem[HIGH], problem[IMPULSE] = free, -bound, bound, guess
    problem[NOISE] = 1e-15 * np.sqrt(np.diag(matrix)) * np.abs(free).max()
    assert bounded_impulses(matrix, problem)
    return problem[IMPULSE]


def violation(matrix: Array, free: Array, bound: Array, impulse: Array) -> float:
    """Largest slip that Coulomb's law does not allow, as a part of what could be."""
    slip = free + matrix @ impulse
    wrong = np.where(impulse >= bound, slip, np.where(impulse <= -bound, -slip, np.abs(slip))).clip(
        0.0
    )
    return float((wrong[bound > 0.0] / (np.abs(free) + np.abs(matrix) @ bound)[bound > 0.0]).max())


@pytest.mark.parametrize("rank", [1, 2, 5, 31, 32])
@pytest.mark.parametrize("spread", [0.0, 2.0])
def test_coulombs_law_is_met(rank: int, spread: float) -> None:
    """Reference: analytic, the Karush-Kuhn-Tucker conditions, from cold and from a near guess."""
    generator = np.random.default_rng(rank)
    for _ in range(10):
        rows = generator.normal(size=(32, rank)) * 10.0 ** generator.uniform(0.0, spread, (32, 1))
        matrix, free = rows @ rows.T, rows @ generator.normal(size=rank)
        bound = generator.uniform(0.0, 0.3, 32) * (generator.random(32) > 0.2)
        cold = solve(matrix, free, bound, np.zeros(32))
        warm = solve(matrix, free, bound, cold + 0.1 * bound * generator.normal(size=32))
        for impulse in (cold, warm):
            assert (np.abs(impulse) <= bound).all()
            assert violation(matrix, free, bound, impulse) < 1e-12
        # Impulses may be shared in many ways; the slip is one.
        size = np.abs(matrix) @ bound + np.abs(free)
        np.testing.assert_allclose(matrix @ (warm - cold) / size, 0.0, atol=1e-10)


def test_one_row_by_hand() -> None:
    """Reference: analytic. Stopped if the bound is enough, slowed by it if not."""
    for free, expected in ((3.0, -1.5), (-1.0, 0.5), (10.0, -2.0), (0.0, 0.0)):
        found = solve(np.array([[2.0]]), np.array([free]), np.array([2.0]), np.zeros(1))
        assert found == pytest.approx([expected], abs=1e-15)


def test_a_row_that_nothing_presses_does_not_take_part() -> None:
    matrix = np.array([[2.0, 1.0], [1.0, 2.0]])
    found = solve(matrix, np.array([1.0, 5.0]), np.array([3.0, 0.0]), np.zeros(2))
    assert found.tolist() == [-0.5, 0.0]
