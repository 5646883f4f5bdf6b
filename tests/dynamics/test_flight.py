# SPDX-License-Identifier: LGPL-3.0-or-later
"""Flights are exact, and no gap can do better than its bounds."""

from __future__ import annotations

import numpy as np
import pytest
from dynamics.kernels.flight import jump, pulls, safe_time, stay, tabulate

OMEGA = np.array([0.0, 3.0, 20.0])
LOAD = np.array([0.5, -2.0, 30.0])
ROWS = np.array([[1.0, 0.4, -0.3], [0.2, -1.0, 0.5]])


def flown(a: np.ndarray, v: np.ndarray, time: float) -> tuple[np.ndarray, np.ndarray]:
    flow = np.zeros((5, a.size))
    tabulate(OMEGA, LOAD, time, flow)
    a, v = a.copy(), v.copy()
    jump(a, v, flow)
    return a, v


def test_flow_of_a_rigid_and_two_elastic_modes() -> None:
    """Reference: analytic, a parabola and cosines about the rest position."""
    a, v, t = np.array([0.1, 0.2, 0.3]), np.array([1.0, -1.0, 2.0]), 0.37
    rest = LOAD[1:] / OMEGA[1:] ** 2
    c, s = np.cos(OMEGA[1:] * t), np.sin(OMEGA[1:] * t)
    expected = [0.1 + t + 0.25 * t**2, *(rest + (a[1:] - rest) * c + v[1:] / OMEGA[1:] * s)]
    speeds = [1.0 + 0.5 * t, *(v[1:] * c - OMEGA[1:] * (a[1:] - rest) * s)]
    there, velocity = flown(a, v, t)
    np.testing.assert_allclose(there, expected, rtol=1e-14)
    np.testing.assert_allclose(velocity, speeds, rtol=1e-14)


def test_no_gap_is_pulled_by_more_than_its_bound() -> None:
    """Reference: other code path, the accelerations of the flow itself, up to 0.9 of the bound."""
    a, v = np.array([0.0, 0.4, -0.1]), np.array([0.0, 0.5, 1.0])
    bound = np.zeros(2)
    pulls(a, v, OMEGA, LOAD, ROWS, bound)
    states = [flown(a, v, t)[0] for t in np.linspace(0.0, 40.0, 20_001)]
    seen = np.abs((LOAD - OMEGA**2 * np.array(states)) @ ROWS.T).max(axis=0)
    assert (seen <= bound).all()
    assert (seen > 0.9 * bound).all()


@pytest.mark.parametrize("towards", [3.0, 0.0, -2.0])
def test_stay_is_the_fall_under_the_largest_pull(towards: float) -> None:
    """Reference: analytic. At a constant pull of 4 the bound 0.5 away is reached then."""
    time, side = stay(0.5, towards, 4.0, -9.0, 1.0, 1e-12)
    assert side == 0
    assert towards * time + 2.0 * time**2 == pytest.approx(0.5, rel=1e-12)


def test_who_is_at_the_bound_and_moves_on_leaves() -> None:
    assert stay(1.0, 0.1, 4.0, -1.0, 1.0, 1e-12) == (0.0, 1)
    assert stay(-1.0, -0.1, 4.0, -1.0, 1.0, 1e-12) == (0.0, -1)
    assert stay(1.0, -0.1, 4.0, -np.inf, 1.0, 1e-12) == (pytest.approx(0.05), 0)
    assert stay(1.0, 0.0, 0.0, -np.inf, 1.0, 1e-12) == (np.inf, 0)


def test_the_first_row_counts() -> None:
    """Reference: analytic. The second row comes at 2 m/s from 0.1 m, and nothing pulls."""
    a, v = np.zeros(3), np.array([0.0, -2.0, 0.0])
    free = np.zeros(2), np.full(2, -1.0), np.array([np.inf, 0.1]), np.full(2, 1e-12)
    assert safe_time(a, v, ROWS, *free) == (pytest.approx(0.05), 0)
    at = np.array([0.0, -0.1, 0.0])
    assert safe_time(at, v, ROWS, *free) == (0.0, 2)
