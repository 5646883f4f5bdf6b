# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers that describe a signal: features of chaotic motions, frequency, decay."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from protractile.analysis.low_pass import PROMINENCE, filter_low_pass, mean_period
from protractile.dynamics.trajectory import prominent_peaks
from protractile.geometry.arrays import Array

# Factor by which zeros lengthen a signal, so that its spectrum is dense.
_PADDING = 8
# Share of the largest peak below which a peak is noise.
_LEAST_PEAK = 0.1


# Number of features that may be fitted.
STEADY = 8


class Features(NamedTuple):
    """Features of a signal; slightly changed data do not change the first ``STEADY`` ones much."""

    mean: float  #: mean
    low: float  #: tenth percentile
    high: float  #: ninetieth percentile
    slow: float  #: standard deviation of the part below the cut-off
    fast: float  #: standard deviation of the part above it
    peak: float  #: first peak of the slow part
    time_of_peak: float  #: its time in s
    period: float  #: mean time between the peaks of the slow part in s
    frequency: float  #: frequency in Hz with the largest amplitude
    decay: float  #: damping ratio by the heights of the peaks

    @classmethod
    def of(cls, time: Array, values: Array, cutoff: float) -> Features:
        """Return the features of a signal; NaN for those that it does not have.

        Args:
            time: evenly spaced times (num_times,) in s.
            values: signal (num_times,).
            cutoff: cut-off in Hz of the slow part.
        """
        try:
            slow = filter_low_pass(values, float(time[1] - time[0]), cutoff)
        except ValueError:
            slow = values
        off = slow - slow[0]
        side = float(np.sign(off[np.abs(off).argmax()]))
        peaks = prominent_peaks(side * slow, PROMINENCE * float(np.ptp(slow)))
        at, peak = (time[peaks[0]], slow[peaks[0]]) if peaks else (np.nan, np.nan)
        low, high = np.quantile(values, (0.1, 0.9))
        fast = (values - slow).std()
        period, frequency = mean_period(time, slow), main_frequency(time, values)
        vibration = slow.std(), fast, peak, at, period, frequency, decay(time, values)
        return cls(values.mean(), low, high, *vibration)


def even(time: Array, values: Array) -> tuple[Array, Array]:
    """Return a signal (..., num_times) at evenly spaced times, with gaps closed linearly."""
    grid = np.linspace(time[0], time[-1], 1 + round(np.ptp(time) / float(np.median(np.diff(time)))))
    return grid, np.apply_along_axis(lambda row: np.interp(grid, time, row), -1, values)


def main_frequency(time: Array, values: Array) -> float:
    """Return the frequency in Hz with the largest amplitude, at evenly spaced times in s."""
    swing = (values - values.mean()) * np.hanning(values.size)
    size = _PADDING * values.size
    spectrum = np.abs(np.fft.rfft(swing, size))
    return float(np.fft.rfftfreq(size, time[1] - time[0])[spectrum.argmax()])


def decay(time: Array, values: Array) -> float:
    """Return the damping ratio by the heights of the peaks of a signal; NaN without three peaks.

    The logarithms of the heights above the mean of the last half have a straight line.
    """
    swing = values - values[values.size // 2 :].mean()
    peaks = np.array(prominent_peaks(swing, _LEAST_PEAK * float(np.ptp(swing))), dtype=int)
    peaks = peaks[swing[peaks] > _LEAST_PEAK * swing.max()]
    if peaks.size < 3:
        return float("nan")
    rate = -np.polyfit(time[peaks], np.log(swing[peaks]), 1)[0]
    return float(rate * np.diff(time[peaks]).mean() / (2.0 * np.pi))
