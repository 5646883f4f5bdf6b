# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sums that do not show their order."""

from __future__ import annotations

import math

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from shell_model.reduction.coordinates import exact_product


def _terms() -> tuple[np.ndarray, np.ndarray]:
    generator = np.random.default_rng(3)
    sizes = 10.0 ** generator.uniform(-8.0, 8.0, (50_000, 1))
    return generator.standard_normal(50_000), sizes * generator.standard_normal((50_000, 3))


def test_products_are_rounded_once() -> None:
    """Reference: analytic, Python's exact sum of the same terms."""
    left, right = _terms()
    found = exact_product(MPI.COMM_SELF, left, right)
    assert found.tolist() == [math.fsum(left * column) for column in right.T]


def test_the_order_of_rows_does_not_show() -> None:
    left, right = _terms()
    order = np.random.default_rng(4).permutation(left.size)
    found = exact_product(MPI.COMM_SELF, left[order], right[order])
    assert np.array_equal(found, exact_product(MPI.COMM_SELF, left, right))
    assert not np.array_equal(left[order] @ right[order], left @ right)


def test_what_cancels_is_zero() -> None:
    """Reference: analytic. A force against its mirror's, but for the last bit of one term."""
    left, right = _terms()
    mirrored = np.concatenate([right, -right])
    mirrored[0] *= 1.0 + 2.3e-16
    assert not exact_product(MPI.COMM_SELF, np.concatenate([left, left]), mirrored).any()
