# SPDX-License-Identifier: LGPL-3.0-or-later
"""Order, limit and index of three grids."""

from __future__ import annotations

import math

import pytest

from runs.studies.grid_convergence import GridConvergence


def test_the_published_example() -> None:
    """Reference: external, NPARC Alliance's tutorial on spatial convergence: pressure recoveries
    0.96178, 0.96854, 0.97050 on grids that halve.
    """
    found = GridConvergence.of([0.96178, 0.96854, 0.97050], ratio=2.0)
    assert found.order == pytest.approx(1.7862, abs=1.0e-4)
    assert found.limit == pytest.approx(0.97130, abs=1.0e-5)
    assert 100.0 * found.index == pytest.approx(0.1031, abs=1.0e-4)
    assert 100.0 * found.coarser_index == pytest.approx(0.3562, abs=1.0e-4)


def test_a_power_law_is_told_exactly() -> None:
    """Reference: analytic, 2 + 3 h^1.5 at h = 0.9, 0.3, 0.1."""
    found = GridConvergence.of([2.0 + 3.0 * h**1.5 for h in (2.7, 0.9, 0.3, 0.1)], ratio=3.0)
    assert found.order == pytest.approx(1.5, rel=1.0e-12)
    assert found.limit == pytest.approx(2.0, rel=1.0e-12)
    assert found.index == pytest.approx(1.25 * 3.0 * 0.1**1.5 / (2.0 + 3.0 * 0.1**1.5))


@pytest.mark.parametrize("values", [(1.0, 2.0, 1.5), (1.0, 1.1, 1.3), (1.0, 1.0, 1.0)])
def test_no_order_without_convergence(values: tuple[float, ...]) -> None:
    """Values that go back and forth, part, or stand still have no order, and so no limit."""
    found = GridConvergence.of(values, ratio=2.0)
    assert math.isnan(found.order)
    assert math.isnan(found.limit)
    assert math.isnan(found.index)
