# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far models part, member by member of their ensembles."""

from __future__ import annotations

import numpy as np

from dynamics.predictability.low_pass import slow_peaks
from geometry.arrays import Array, Mask

# Beyond the last peak a motion may end before the next one comes, so many periods of its own.
NEXT_PEAK = 1.5


def apart_at_the_end(one: Array, other: Array, last: Mask) -> Array:
    """(num_members,) largest difference at the last times, as a part of the larger range.

    Args:
        one, other: (num_members, num_times) of one quantity.
        last: (num_times,) which times count.
    """
    scale = np.maximum(np.ptp(one, axis=1), np.ptp(other, axis=1))
    return np.asarray(np.abs(one - other)[:, last].max(axis=1) / scale)


def peaks_apart(curves: Array, time: Array, cutoff: float) -> tuple[Array, Array]:
    """How far the peaks of several slow motions are from one another, peak by peak.

    The k-th peak of one model belongs to the k-th of every other. Their distance is the larger of
    that in time, as a part of the mean period, and that in height, as a part of the highest; it is
    infinite where a model has no such peak and its motion goes on for long enough to have one.

    Args:
        curves: (num_models, num_times), one member of each model.
        time: (num_times,) in s, equal steps.
        cutoff: of the slow motion in Hz.

    Returns:
        (num_peaks,) time in s at which the first model has the peak, and (num_peaks,) distance;
        peaks that only some models have are among them.
    """
    found = [slow_peaks(curve, time, cutoff) for curve in curves]
    many = [np.diff(times) for times, _ in found if times.size > 1]
    period = float(np.concatenate(many).mean()) if many else np.inf
    t, h = np.full((2, len(found), max(times.size for times, _ in found)), np.nan)
    for model, (times, heights) in enumerate(found):
        t[model, : times.size], h[model, : times.size] = times, heights
    first = np.nanmin(t, axis=0)
    shared = np.isfinite(t).all(axis=0)
    late, lower = np.ptp(t, axis=0) / period, np.ptp(h, axis=0) / np.nanmax(np.abs(h), axis=0)
    apart = np.where(shared, np.maximum(late, lower), np.inf)
    counts = shared | (first < time[-1] - NEXT_PEAK * period)
    return first[counts], apart[counts]
