# SPDX-License-Identifier: LGPL-3.0-or-later
"""Series of the motion in contact have the coefficients of known motions, and find exits."""

from __future__ import annotations

import math

import numpy as np
import pytest
from dynamics.kernels.contact_series import (
    ORDER,
    Series,
    evaluate,
    exit_time,
    expand,
    farthest,
    gap_after,
    impulse,
    reach,
)

from dynamics.arrays import Array
from dynamics.contact import PowerContact, contact_terms


def series_of(
    a: Array, v: Array, omega2: Array, load: Array, rows: Array, law: PowerContact, pressed: Array
) -> Series:
    """The series of rows that have the same law."""
    terms = contact_terms([law] * len(rows))
    series = Series.room(a.size, len(rows), terms)
    expand(series, a, v, (omega2, load, rows), terms, pressed)
    return series


def pressed_mass(exponent: float, speed: float = 2.0) -> Series:
    """1 kg at a stop of 9 N/mⁿ and ±0.5 m, just touching it from below."""
    law = PowerContact(stiffness=9.0, exponent=exponent, clearance=0.5)
    one = np.ones(1)
    return series_of(0.5 * one, speed * one, 0.0 * one, 0.0 * one, np.eye(1), law, one)


def test_linear_stop_gives_the_series_of_a_sine() -> None:
    """Reference: analytic, y − Δ = (v/ω) sin ωt, and F = k (y − Δ)."""
    series = pressed_mass(1.0)
    k = np.arange(ORDER + 1)
    expected = np.array([2.0 / 3.0 * 3.0**i * (0.0, 1.0, 0.0, -1.0)[i % 4] for i in k])
    expected /= np.array([math.factorial(i) for i in k], dtype=float)
    expected[0] = 0.5
    np.testing.assert_allclose(series.gap[0], expected, rtol=1e-14, atol=1e-30)
    np.testing.assert_allclose(series.force[0, 1:], 9.0 * expected[1 : ORDER - 1], rtol=1e-14)


@pytest.mark.parametrize("exponent", [2.0, 3.0, 4.0])
def test_powers_satisfy_the_equation_of_motion(exponent: float) -> None:
    """Reference: analytic. ÿ = −k pⁿ, with the powers of the polynomial by NumPy."""
    series = pressed_mass(exponent)
    depth = np.polynomial.Polynomial(series.gap[0]) - 0.5
    force = (9.0 * depth ** int(exponent)).coef[: ORDER - 1]
    k = np.arange(2, ORDER + 1)
    np.testing.assert_allclose(series.force[0], force, rtol=1e-13)
    np.testing.assert_allclose(-k * (k - 1) * series.gap[0, 2:], force, rtol=1e-13)


def test_modes_under_two_pressed_rows_and_an_open_one() -> None:
    """Reference: other code, central differences of the state; a mode of each kind, rows on both
    sides."""
    omega2, load = np.array([0.0, 30.0, 400.0]), np.array([1.0, -2.0, 3.0])
    rows = np.array([[1.0, 0.5, 0.2], [-0.3, 1.0, 0.4], [0.2, 0.1, 1.0]])
    law = PowerContact(stiffness=50.0, exponent=2.0, clearance=0.1, stiffness_below=80.0)
    a, v = np.array([0.3, -0.2, 0.05]), np.array([0.4, 0.3, -0.2])
    pressed = np.where(np.abs(rows @ a) > 0.1, np.sign(rows @ a), 0.0)
    assert pressed.tolist() == [1.0, -1.0, 0.0]
    series = series_of(a, v, omega2, load, rows, law, pressed)
    h = 1e-3
    (before, v_before), (after, v_after) = (moved(series, t) for t in (-h, h))
    np.testing.assert_allclose((after - before) / (2.0 * h), v, rtol=1e-4)
    forces = np.array([law.force(y) for y in rows @ a])
    np.testing.assert_allclose(
        (v_after - v_before) / (2.0 * h), load - omega2 * a - forces @ rows, rtol=1e-4
    )
    ahead, velocity = moved(series, h)
    for gap, row in zip(series.gap, rows, strict=True):
        assert gap_after(gap, h) == pytest.approx((row @ ahead, row @ velocity), rel=1e-12)


def moved(series: Series, time: float) -> tuple[Array, Array]:
    a, v = np.zeros(len(series.state)), np.zeros(len(series.state))
    evaluate(series, time, a, v)
    return a, v


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0])
def test_truncation_is_what_reach_allows(exponent: float) -> None:
    """Reference: analytic, the energy ½ v² + k pⁿ⁺¹/(n + 1), which the state must keep to the
    tolerance: not worse by ten, and no step so short that it would be better by 1e4."""
    series = pressed_mass(exponent)
    errors = []
    for tolerance in (1e-4, 1e-8):
        time = reach(series.state, np.zeros(1), int(exponent), tolerance)
        a, v = moved(series, time)
        energy = 0.5 * v[0] ** 2 + 9.0 * (a[0] - 0.5) ** (exponent + 1.0) / (exponent + 1.0)
        errors.append(abs(energy / 2.0 - 1.0) / tolerance)
    assert max(errors) < 10.0
    assert min(errors) > 1e-4


def test_exit_of_a_linear_press() -> None:
    """Reference: analytic: after half a period π/ω the mass is back at the stop; until 2/3 of it
    nothing leaves."""
    gap = pressed_mass(1.0).gap[0]
    time, side = exit_time(gap, 0.5, np.inf, 1e-14, 1.1)
    assert (time, side) == (pytest.approx(np.pi / 3.0, rel=1e-9), -1)
    assert exit_time(gap, 0.5, np.inf, 1e-14, 0.7) == (0.7, 0)


def test_exit_is_the_first_of_two() -> None:
    """Reference: analytic. 4 t (1 − t) passes 0.99 at 0.45 and comes back at 0.55: a trial at the
    end alone would miss both."""
    gap = np.zeros(ORDER + 1)
    gap[1:3] = 4.0, -4.0
    time, side = exit_time(gap, -0.5, 0.99, 1e-14, 1.0)
    assert (time, side) == (pytest.approx(0.45, rel=1e-9), 1)
    assert exit_time(gap, -0.5, 1.01, 1e-14, 1.0) == (1.0, 0)


def test_impulse_and_peak_of_a_linear_press() -> None:
    """Reference: analytic. Half a sine of ω = 3 gives twice the momentum, in two parts together;
    its peak v/ω lies within the first."""
    series = pressed_mass(1.0)
    half = np.pi / 3.0
    parts = [impulse(series.force[0], 0.0, 0.6), impulse(series.force[0], 0.6, half)]
    assert sum(parts) == pytest.approx(4.0, rel=1e-8)
    assert parts[0] == pytest.approx(2.0 * (1.0 - np.cos(1.8)), rel=1e-10)
    assert farthest(series.gap[0], 1.0, 0.0, 0.6) == pytest.approx(0.5 + 2.0 / 3.0, rel=1e-4)
    rising = 0.5 + 2.0 / 3.0 * np.sin(1.2)
    assert farthest(series.gap[0], 1.0, 0.1, 0.4) == pytest.approx(rising, rel=1e-12)
