# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distances of members are those that were put in."""

import numpy as np
import pytest

from runs.paper.run_query import apart_at_the_end, peaks_apart

TIME = np.arange(10_001) / 1000
CUTOFF = 1.7


def swing(delay: float = 0.0, height: float = 1.0) -> np.ndarray:
    """Peaks ``height`` high at 0.5, 1.5, … s, and later by ``delay``."""
    return height * 0.5 * (1.0 - np.cos(2.0 * np.pi * (TIME - delay)))


def test_apart_at_the_end_is_relative_to_the_larger_range() -> None:
    """Reference: analytic."""
    one = np.array([TIME, TIME])
    other = np.array([1.25 * TIME, TIME])
    found = apart_at_the_end(one, other, TIME >= 9.0)
    assert found == pytest.approx([2.5 / 12.5, 0.0])


@pytest.mark.parametrize(
    ("delay", "height", "expected"), [(0.1, 1.0, 0.1), (0.0, 0.8, 0.2), (-0.15, 0.9, 0.15)]
)
def test_distance_of_peaks(delay: float, height: float, expected: float) -> None:
    """Reference: analytic. The larger of the delay over the period and the loss of height."""
    curves = np.array([swing(), swing(delay, height)])
    first, apart = peaks_apart(curves, TIME, CUTOFF)
    assert first[1:-1] == pytest.approx(
        np.arange(1, first.size - 1) + 0.5 + min(delay, 0.0), abs=3e-3
    )
    assert apart[1:-1] == pytest.approx(expected, abs=5e-3)


def test_missing_peaks_have_infinite_distance() -> None:
    """All of them, until a period and a half before the end."""
    still = swing()
    still[TIME > 4.0] = 0.0
    first, apart = peaks_apart(np.array([swing(), still]), TIME, CUTOFF)
    missed = np.isinf(apart)
    assert first[missed][:4] == pytest.approx([4.5, 5.5, 6.5, 7.5], abs=3e-3)
    assert (first[~missed] < 4.0).all()


def test_peak_near_the_end_is_not_missing() -> None:
    first, apart = peaks_apart(np.array([swing(), swing(0.6)]), TIME, CUTOFF)
    assert np.isfinite(apart).all()
    assert first.size == 9


def test_motions_without_peaks_have_no_distance() -> None:
    first, apart = peaks_apart(np.array([TIME, TIME]), TIME, CUTOFF)
    assert (first.size, apart.size) == (0, 0)
