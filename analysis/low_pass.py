# SPDX-License-Identifier: LGPL-3.0-or-later
"""The slow motion below a cut-off frequency, its peaks and its period."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from pydantic import BeforeValidator, PlainSerializer, PlainValidator

from protractile.dynamics.arrays import Array
from protractile.dynamics.trajectory import prominent_peaks

# Types of arrays and numbers. In JSON, null replaces NaN and infinity.
Numbers = Annotated[
    Array, PlainValidator(np.asarray), PlainSerializer(lambda values: np.asarray(values).tolist())
]
Number = Annotated[
    float,
    BeforeValidator(lambda value: math.nan if value is None else value),
    PlainSerializer(lambda value: value if math.isfinite(value) else None),
]

# Ratio of the cut-off to the first frequency with closed contacts. The slow motion of a boom with
# play has a lower frequency; vibrations that impacts excite have higher ones.
CUTOFF_SHARE = 0.8
# Order of the filter, which runs forwards and backwards.
ORDER = 4
# Minimum prominence of a peak as a fraction of the range of the signal. It excludes shoulders.
PROMINENCE = 0.2
# Range of the tip as a fraction of its deflection, by round-off, up to which it is at rest.
AT_REST = 1.0e-9


def filter_low_pass(signal: Array, output_step: float, cutoff: float) -> Array:
    """Return the part of a signal below a cut-off, without phase shift.

    A Butterworth filter runs forwards and backwards; its gain at the cut-off is ½. The signal is
    mirrored at its ends, which affects the result within half a period of the cut-off.

    Args:
        signal: (..., num_times).
        output_step: output step in s.
        cutoff: cut-off in Hz, below half the sampling rate.

    Raises:
        ValueError: the cut-off is too high, or the signal is not longer than its period.
    """
    times = signal.shape[-1]
    if not 0.0 < cutoff < 0.5 / output_step:
        raise ValueError(
            f"cutoff must be between 0 and {0.5 / output_step:g} Hz, got {cutoff:g} Hz"
        )
    period = round(1.0 / (cutoff * output_step))
    if times <= period:
        raise ValueError(
            f"the signal must be longer than the period of the cut-off, {1.0 / cutoff:g} s, got "
            f"{(times - 1) * output_step:g} s"
        )
    # Imported here, since only ensembles are filtered and the import takes half a second.
    from scipy.signal import butter, sosfiltfilt

    sections = butter(ORDER, cutoff, fs=1.0 / output_step, output="sos")
    return np.asarray(sosfiltfilt(sections, signal, axis=-1, padlen=period))


def slow_peaks(signal: Array, time: Array, cutoff: float) -> tuple[Array, Array]:
    """Return times in s and heights (num_peaks,) of the peaks of the slow motion.

    Times (num_times,) in s are evenly spaced; the cut-off is in Hz.
    """
    from scipy.signal import find_peaks

    filtered = filter_low_pass(signal, float(time[1] - time[0]), cutoff)
    at, _ = find_peaks(filtered, prominence=PROMINENCE * np.ptp(filtered))
    return time[at], filtered[at]


def mean_period(time: Array, tip: Array) -> float:
    """Return the mean time between the main peaks of the tip in s.

    NaN for fewer than two peaks, and for a tip at rest. Times (num_times,) are in s, tip
    deflections in m.
    """
    if tip.size < 3 or np.ptp(tip) <= AT_REST * np.abs(tip).max():
        return float("nan")
    off = tip - tip[0]
    side = np.sign(off[np.abs(off).argmax()])
    peaks = prominent_peaks(side * tip, PROMINENCE * float(np.ptp(tip)))
    return float(np.diff(time[peaks]).mean()) if len(peaks) > 1 else float("nan")


@dataclass(frozen=True, slots=True)
class SlowPeaks:
    """Peaks of the slow motion that all members of an ensemble have, as means over the members.

    A spread is half the difference between the largest and the smallest member.
    """

    time: Numbers  #: times (num_peaks,) in s
    time_spread: Numbers  #: spreads (num_peaks,) of the times in s
    height: Numbers  #: heights (num_peaks,) in the signal's unit
    height_spread: Numbers  #: spreads (num_peaks,) of the heights in the signal's unit
    period: Number  #: mean time between successive peaks in s; NaN for fewer than two peaks
    period_spread: Number  #: spread of the period in s; NaN for fewer than two peaks

    @classmethod
    def of(cls, members: Array, time: Array, cutoff: float) -> SlowPeaks:
        """Return the common peaks of an ensemble, up to the first peak that a member lacks.

        Peaks of two members count as the same peak if they are less than half a period of the
        cut-off apart. Two peaks of one filtered motion are farther apart. Motions are (num_members,
        num_times), times in s, and the cut-off in Hz.
        """
        peaks = [slow_peaks(member, time, cutoff) for member in members]
        times, heights = [], []
        for at in peaks[0][0]:
            nearest = [int(np.abs(t - at).argmin()) if t.size else -1 for t, _ in peaks]
            if -1 in nearest:
                break
            matched = np.array([t[i] for (t, _), i in zip(peaks, nearest, strict=True)])
            if np.abs(matched - at).max() >= 0.5 / cutoff:
                break
            times.append(matched)
            heights.append([h[i] for (_, h), i in zip(peaks, nearest, strict=True)])
        t = np.array(times).reshape(-1, len(members))
        h = np.array(heights).reshape(-1, len(members))
        periods = np.ptp(t, axis=0) / (len(t) - 1) if len(t) > 1 else np.full(1, np.nan)
        return cls(
            time=t.mean(axis=1),
            time_spread=0.5 * np.ptp(t, axis=1),
            height=h.mean(axis=1),
            height_spread=0.5 * np.ptp(h, axis=1),
            period=float(periods.mean()),
            period_spread=float(0.5 * np.ptp(periods)),
        )
