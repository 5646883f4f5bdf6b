# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison of ensembles by levels, distances of peaks, and the low-pass filter."""

import re

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm

from dynamics.motion import Motion
from dynamics.predictability.ensemble import integrate_ensemble
from dynamics.trajectory import PointwiseDifferences
from runs.paper.run_query import final_differences, peak_distances
from runs.pipeline.comparison import Comparison, Distributions, PeakDifferences, compare
from runs.pipeline.low_pass import SlowPeaks, filter_low_pass, slow_peaks
from tests.dynamics.two_stops import CHAOTIC

TIME = np.arange(10_001) * 1e-3
CUTOFF = 1.7


def ensemble(delay: float = 0.0, height: float = 1.0, growth: float = 0.0) -> xr.Dataset:
    """Return vibrations of period 1 s; phases of members differ by ±1e-4 exp(growth t) in s."""
    parting = np.linspace(-1e-4, 1e-4, 9)[:, None] * np.exp(growth * TIME)
    parting = np.clip(np.vstack([np.zeros(TIME.size), parting]), -0.2, 0.2)
    tip = swing(delay + parting, height)
    return xr.Dataset({"tip": (("member", "time"), tip)}, coords={"time": TIME})


def test_pointwise_differences_by_hand() -> None:
    """Reference: analytic. The difference 0.02 sin²(πt) up to 0.5 s is 1/51 of the larger range."""
    one, other = (ensemble(height=height)["tip"].values[0] for height in (1.0, 1.02))
    found = PointwiseDifferences.from_curves(one, other, TIME, 0.5)
    assert found.largest == pytest.approx(0.02 / 1.02, rel=1e-6)
    assert found.rms == pytest.approx(0.02 / 1.02 * np.sqrt(3.0 / 8.0), rel=2e-3)
    other[501:] += 1.0  # too late to count
    assert PointwiseDifferences.from_curves(one, other, TIME, 0.5) == found


def test_divergence_levels_of_two_models() -> None:
    """Reference: analytic, a spread of π·1e-4·exp(t), and sin(0.05 π) by a delay of 50 ms."""
    found = compare(ensemble(growth=1.0), ensemble(delay=0.05, growth=1.0), CUTOFF)
    assert found.pointwise.until == pytest.approx(np.log(100.0 / np.pi), abs=0.25)
    assert found.pointwise.largest == pytest.approx(np.sin(0.05 * np.pi), rel=1e-2)
    np.testing.assert_allclose(found.peaks.time[1:5], 0.05, atol=2e-3)
    explained = found.peaks.explained
    # Both phases are uncertain by 1e-4 exp(t) s: the delay is explained from 5.5 s on.
    assert explained[:4] == [False] * 4
    assert all(explained[6:])
    assert found.distributions.since == pytest.approx(np.log(2000.0 / np.pi), abs=0.3)
    assert found.distributions.distance < 0.05


def test_peaks_beyond_the_spread_are_differences_of_the_models() -> None:
    one = SlowPeaks.of(ensemble()["tip"].values, TIME, CUTOFF)
    higher = SlowPeaks.of(ensemble(height=1.1)["tip"].values, TIME, CUTOFF)
    found = PeakDifferences.of(one, higher)
    np.testing.assert_allclose(found.height[1:-1], 0.1, rtol=0.01)
    assert not any(found.explained)
    assert all(PeakDifferences.of(one, one).explained)


def test_distance_of_shifted_distributions() -> None:
    """Reference: analytic. Normal distributions with a shift s have the distance 2 Φ(s/2) − 1."""
    generator = np.random.default_rng(0)
    values = generator.normal(size=(10, TIME.size))
    for shift in (0.0, 0.5, 2.0):
        other = generator.normal(shift, 1.0, size=values.shape)
        found = Distributions.of(values, other, TIME, 1.0)
        assert found.distance == pytest.approx(2.0 * norm.cdf(0.5 * shift) - 1.0, abs=0.01)
        assert found.mean[1] - found.mean[0] == pytest.approx(shift, abs=0.02)
        assert found.deviation == pytest.approx((1.0, 1.0), abs=0.02)


def test_predictable_models_have_no_distribution() -> None:
    found = compare(ensemble(), ensemble(height=1.1), CUTOFF)
    assert found.pointwise.until == TIME[-1]
    assert np.isnan(found.distributions.since)
    assert np.isnan(found.distributions.distance)


def test_a_chaotic_system_is_like_itself() -> None:
    """Reference: the same system with other changes, up to the horizon and beyond."""
    one, other = (
        integrate_ensemble(Motion(CHAOTIC, 60.0, 1e-2), 16, 1e-6, seed, "load") for seed in (1, 2)
    )
    found = compare(one, other, 2.0)
    assert found.pointwise.largest == 0.0  # of the unchanged members
    assert all(found.peaks.explained)
    assert found.distributions.distance < 0.05
    shifted = other.assign(tip=other["tip"] + 0.5 * np.ptp(other["tip"].values))
    assert compare(one, shifted, 2.0).distributions.distance > 0.5


def test_times_must_agree() -> None:
    with pytest.raises(ValueError, match=r"^the ensembles must have the same times$"):
        compare(ensemble(), ensemble().isel(time=slice(5000)), CUTOFF)


def test_every_level_has_a_description() -> None:
    for level in (PointwiseDifferences, PeakDifferences, Distributions):
        assert level.scope.count(".") == 1
        assert "it does not show" in level.scope
    assert list(Comparison.__slots__) == ["pointwise", "peaks", "distributions"]


def swing(delay: float | np.ndarray = 0.0, height: float = 1.0) -> np.ndarray:
    """Return a vibration with peaks of ``height`` at 0.5, 1.5, … s plus ``delay``."""
    return height * 0.5 * (1.0 - np.cos(2.0 * np.pi * (TIME - delay)))


def test_final_differences_are_relative_to_the_larger_range() -> None:
    """Reference: analytic."""
    one = np.array([TIME, TIME])
    other = np.array([1.25 * TIME, TIME])
    found = final_differences(one, other, TIME >= 9.0)
    assert found == pytest.approx([2.5 / 12.5, 0.0])


@pytest.mark.parametrize(
    ("delay", "height", "expected"), [(0.1, 1.0, 0.1), (0.0, 0.8, 0.2), (-0.15, 0.9, 0.15)]
)
def test_distance_of_peaks(delay: float, height: float, expected: float) -> None:
    """Reference: analytic, the larger of the delay over the period and the difference in height."""
    curves = np.array([swing(), swing(delay, height)])
    first, apart = peak_distances(curves, TIME, CUTOFF)
    assert first[1:-1] == pytest.approx(
        np.arange(1, first.size - 1) + 0.5 + min(delay, 0.0), abs=3e-3
    )
    assert apart[1:-1] == pytest.approx(expected, abs=5e-3)


def test_missing_peaks_have_infinite_distance() -> None:
    still = swing()
    still[TIME > 4.0] = 0.0
    first, apart = peak_distances(np.array([swing(), still]), TIME, CUTOFF)
    missed = np.isinf(apart)
    assert first[missed][:4] == pytest.approx([4.5, 5.5, 6.5, 7.5], abs=3e-3)
    assert (first[~missed] < 4.0).all()


def test_peak_near_the_end_is_not_missing() -> None:
    first, apart = peak_distances(np.array([swing(), swing(0.6)]), TIME, CUTOFF)
    assert np.isfinite(apart).all()
    assert first.size == 9


def test_gain_equals_two_filter_passes() -> None:
    """Reference: analytic, 1 / (1 + (f/f_c)⁸) for two passes of a Butterworth filter of order 4."""
    middle = slice(3000, 7000)
    for frequency in (0.5, 1.0, CUTOFF, 2.5, 8.0):
        wave = np.cos(2.0 * np.pi * frequency * TIME)
        found = filter_low_pass(wave, 1e-3, CUTOFF)[middle]
        gain = 1.0 / (1.0 + (frequency / CUTOFF) ** 8)
        np.testing.assert_allclose(found, gain * wave[middle], atol=2e-3)


def test_known_peaks_under_a_ripple() -> None:
    """Reference: analytic, peaks at 0.5, 1.5, … s; a ripple of 7 Hz moves peaks by up to 70 ms."""
    ripple = 0.1 * np.cos(2.0 * np.pi * 7.0 * TIME + 1.0)
    times, heights = slow_peaks(swing() + ripple, TIME, CUTOFF)
    np.testing.assert_allclose(times[1:-1], np.arange(1, 9) + 0.5, atol=2e-3)
    # Next to the ends the mirrored signal has a part in it.
    np.testing.assert_allclose(times[[0, -1]], [0.5, 9.5], atol=1e-2)
    gain = 1.0 / (1.0 + (1.0 / CUTOFF) ** 8)
    np.testing.assert_allclose(heights[1:-1], 0.5 + 0.5 * gain, atol=2e-3)


def test_spreads_over_members() -> None:
    """Reference: analytic. Delays of −20 … 40 ms, heights of 0.9 … 1.1."""
    members = np.array([swing(), swing(0.04, 0.9), swing(-0.02, 1.1)])
    found = SlowPeaks.of(members, TIME, CUTOFF)
    assert found.time.size == 10
    inner = slice(1, -1)
    np.testing.assert_allclose(found.time[inner], np.arange(1, 9) + 0.5 + 0.02 / 3, atol=2e-3)
    np.testing.assert_allclose(found.time_spread[inner], 0.03, atol=2e-3)
    # A tenth of the heights, which the filter lowers by 0.7 %.
    np.testing.assert_allclose(found.height_spread[inner], 0.1, rtol=0.01)
    assert found.period == pytest.approx(1.0, abs=2e-3)
    assert found.period_spread < 4e-3


def test_peaks_are_counted_up_to_the_first_missing_peak() -> None:
    lost = swing()
    lost[(TIME > 4.0) & (TIME < 5.0)] = 0.0
    assert SlowPeaks.of(np.array([swing(), lost]), TIME, CUTOFF).time.size == 4
    drifting = 0.5 * (1.0 - np.cos(2.0 * np.pi * TIME * 0.95))
    # The k-th peak is late by (k − ½)·0.0526 s; half a period of the cut-off is 0.294 s.
    assert SlowPeaks.of(np.array([swing(), drifting]), TIME, CUTOFF).time.size == 6


def test_a_motion_without_peaks_has_no_distance_and_no_period() -> None:
    assert [one.size for one in peak_distances(np.array([TIME, TIME]), TIME, CUTOFF)] == [0, 0]
    found = SlowPeaks.of(np.array([TIME, 2.0 * TIME]), TIME, CUTOFF)
    assert found.time.size == 0
    assert np.isnan([found.period, found.period_spread]).all()


@pytest.mark.parametrize(
    ("times", "cutoff", "message"),
    [
        (2000, 500.0, "cutoff must be between 0 and 500 Hz, got 500 Hz"),
        (2000, 0.0, "cutoff must be between 0 and 500 Hz, got 0 Hz"),
        (501, 2.0, None),
        (500, 2.0, "the signal must be longer than the period of the cut-off, 0.5 s, got 0.499 s"),
    ],
)
def test_bad_signals_are_refused(times: int, cutoff: float, message: str | None) -> None:
    if message is None:
        assert filter_low_pass(np.ones(times), 1e-3, cutoff) == pytest.approx(1.0)
        return
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        filter_low_pass(np.ones(times), 1e-3, cutoff)
