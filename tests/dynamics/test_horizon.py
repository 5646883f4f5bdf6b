# SPDX-License-Identifier: LGPL-3.0-or-later
"""Impacts end the predictability of a motion; a linear system has no horizon."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.ensemble import integrate_ensemble
from dynamics.horizon import Growth, horizon, horizons_of, measure_horizons, spread
from tests.dynamics.two_stops import CHAOTIC, LINEAR

pytestmark = pytest.mark.quick


def test_spread_of_a_linear_system_is_in_proportion_to_the_change() -> None:
    """Reference: analytic. All outputs of a linear system from rest scale with the load."""
    for relative in (1e-9, 1e-6, 1e-3):
        ensemble = integrate_ensemble(LINEAR, 8, relative, 2, "load", 30.0, 1e-2)
        tip, changes = ensemble["tip"].values, ensemble["change"].values
        expected = 0.5 * np.ptp(changes) * np.abs(tip[0])
        np.testing.assert_allclose(
            spread(tip), expected, rtol=1e-4, atol=1e-14 + 1e-9 * expected.max()
        )
        assert np.isnan(horizons_of(ensemble)).all()


def test_a_linear_system_has_no_horizon() -> None:
    found = measure_horizons(LINEAR, [1e-12, 1e-6], 4, 1, "load", 30.0, 1e-2)
    assert np.isnan(found.times).all()
    assert np.isnan([growth.rate for growth in found.growth]).all()
    assert found.limits == ["nothing", "nothing"]


def test_horizon_of_a_known_growth() -> None:
    """Reference: analytic. ±1e-6 exp(2t) passes 1 % of the range of 2 at ln(2e4)/2, and 20 % at
    ln(4e5)/2."""
    time = np.linspace(0.0, 10.0, 10_001)
    apart = 1e-6 * np.exp(2.0 * time)
    members = np.sin(10.0 * time) + np.array([0.0, 1.0, -1.0, 0.3])[:, None] * apart
    assert horizon(members, time, 0.01) == pytest.approx(0.5 * np.log(2e4), abs=2e-3)
    assert horizon(members, time, 0.20) == pytest.approx(0.5 * np.log(4e5), abs=2e-3)
    assert np.isnan(horizon(members[:, :4000], time[:4000], 0.01))


def test_growth_of_known_horizons() -> None:
    """Reference: analytic, the line itself; a horizon that is not known does not count."""
    relatives = np.array([1e-12, 1e-10, 1e-8, 1e-6, 1e-4])
    times = (np.log(0.02) - np.log(relatives * 0.7)) / 3.0
    times[0] = np.nan
    growth = Growth.fit(relatives, times, 0.02)
    assert growth.rate == pytest.approx(3.0, rel=1e-9)
    assert growth.response == pytest.approx(0.7, rel=1e-9)
    assert growth.scatter < 1e-12
    # A horizon that a smaller change does not put off is no growth; one alone is no line.
    assert np.isnan(Growth.fit(relatives, np.arange(5.0), 0.02).rate)
    assert np.isnan(Growth.fit(relatives[:2], times[:2], 0.02).rate)


def test_smaller_changes_put_off_the_horizon_of_a_chaotic_system() -> None:
    """Reference: analytic in kind. T falls with ln ε, and λ is what the line says."""
    found = measure_horizons(CHAOTIC, [1e-6, 1e-12, 1e-8, 1e-10], 8, 1, "load", 40.0, 1e-2)
    assert found.relatives.tolist() == [1e-12, 1e-10, 1e-8, 1e-6]
    times = found.times[:, 0]
    assert (np.diff(times) < -1.0).all()
    growth = found.growth[0]
    assert growth.rate > 0.0
    assert times[0] - times[-1] == pytest.approx(np.log(1e6) / growth.rate, rel=0.15)
    assert growth.scatter < 0.1 * (times[0] - times[-1])


def test_says_whether_step_or_physics_limits() -> None:
    """The step's error changes a run more than 1e-12 of the load does, and less than 1e-2."""
    for relative, expected in ((1e-12, "step"), (1e-2, "physics")):
        found = measure_horizons(CHAOTIC, [relative], 8, 1, "load", 20.0, 1e-2)
        assert found.limits[0] == expected
        assert (found.of_step[0] < found.times[0, 0]) == (expected == "step")
