# SPDX-License-Identifier: LGPL-3.0-or-later
"""Peaks of a slow motion come out where they are, whatever ripple lies on it."""

import re

import numpy as np
import pytest

from runs.pipeline.low_pass import SlowPeaks, filter_low_pass, slow_peaks

TIME = np.arange(10_001) * 1e-3
CUTOFF = 1.7


def swing(delay: float = 0.0, height: float = 1.0) -> np.ndarray:
    """Peaks at 0.5, 1.5, … s and one ``height`` high, later by ``delay``."""
    return height * 0.5 * (1.0 - np.cos(2.0 * np.pi * (TIME - delay)))


def test_gain_equals_two_filter_passes() -> None:
    """Reference: analytic. 1 / (1 + (f/f_c)⁸) of Butterworth's order 4, squared by two passes."""
    middle = slice(3000, 7000)
    for frequency in (0.5, 1.0, CUTOFF, 2.5, 8.0):
        wave = np.cos(2.0 * np.pi * frequency * TIME)
        found = filter_low_pass(wave, 1e-3, CUTOFF)[middle]
        gain = 1.0 / (1.0 + (frequency / CUTOFF) ** 8)
        np.testing.assert_allclose(found, gain * wave[middle], atol=2e-3)


def test_known_peaks_under_a_ripple() -> None:
    """Reference: analytic. The swing peaks at 0.5, 1.5, … s; a ripple at 7 Hz moves the raw
    signal's peaks by up to 70 ms and lifts them by a tenth."""
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


def test_a_motion_without_peaks_has_no_period() -> None:
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
