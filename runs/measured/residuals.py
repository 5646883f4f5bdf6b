# SPDX-License-Identifier: LGPL-3.0-or-later
"""Residuals of all channels: (model − reading)/uncertainty, of curves or of their features.

A channel whose motion is predictable is compared at each reading. If slightly changed loads make
its motion diverge before the last reading, its features are compared instead, as means over an
ensemble. Their uncertainty is that of the readings, from repeated noise, and the scatter of the
ensemble.

An error that all readings of a channel share makes their covariance V = σ² (1 + U Uᵀ), with columns
of U for an error of the size and one of the frequency. The residuals are those of generalised least
squares, V^(−½) (model − reading) (Aitken 1935).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.interpolate import interp1d
from scipy.signal import find_peaks, periodogram

from protractile.analysis.low_pass import CUTOFF_SHARE, PROMINENCE, filter_low_pass, mean_period
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.predictability import SHARES, horizon
from protractile.geometry.arrays import Array
from protractile.runs.measured.experiment import Experiment
from protractile.runs.measured.fit import STEP, Marks
from protractile.runs.measured.keys import Channel
from protractile.runs.sweep.distances import CHANGE

# Relative changes of the loads of an ensemble, and number of repetitions of the noise.
MEMBERS = (0.0, CHANGE, -CHANGE, 0.5 * CHANGE, -0.5 * CHANGE)
NOISES = 20
# Parts of the squared changes of a channel in growing windows of its readings.
WINDOWS = np.array([0.1, 0.3, 0.6, 1.0])
# Step of differences for features, whose scatter hides small changes.
COARSE = 2.0e-2
# Number of features that may be fitted, the first ones.
STEADY = 8
# Factor by which zeros lengthen a signal, so that its spectrum is dense; share of the largest peak
# below which a peak is noise.
_PADDING, _LEAST_PEAK = 8, 0.1
# Least uncertainty of a feature, as a fraction of itself, and residual of a feature that only the
# readings have.
LEAST, MISSING = 1.0e-3, 10.0


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
        step, size = float(time[1] - time[0]), _PADDING * values.size
        try:
            slow = filter_low_pass(values, step, cutoff)
        except ValueError:
            slow = values
        off = slow - slow[0]
        side = float(np.sign(off[np.abs(off).argmax()]))
        peaks, _ = find_peaks(side * slow, prominence=PROMINENCE * np.ptp(slow))
        at, peak = (time[peaks[0]], slow[peaks[0]]) if peaks.size else (np.nan, np.nan)
        low, high = np.quantile(values, (0.1, 0.9))
        frequencies, power = periodogram(values, 1.0 / step, "hann", size, "constant")
        return cls(
            values.mean(), low, high, slow.std(), (values - slow).std(), peak, at,
            mean_period(time, slow), float(frequencies[power.argmax()]), decay(time, values),
        )  # fmt: skip


def decay(time: Array, values: Array) -> float:
    """Return the damping ratio by the heights of the peaks of a signal; NaN without three peaks.

    The logarithms of the heights above the mean of the last half have a straight line.
    """
    swing = values - values[values.size // 2 :].mean()
    least = _LEAST_PEAK * np.array([swing.max(), np.ptp(swing)])
    peaks, _ = find_peaks(swing, height=least[0], prominence=least[1])
    if peaks.size < 3:
        return float("nan")
    rate = -np.polyfit(time[peaks], np.log(swing[peaks]), 1)[0]
    return float(rate * np.diff(time[peaks]).mean() / (2.0 * np.pi))


def even(time: Array, values: Array) -> tuple[Array, Array]:
    """Return a signal (..., num_times) at evenly spaced times, with gaps closed linearly."""
    grid = np.linspace(time[0], time[-1], 1 + round(np.ptp(time) / float(np.median(np.diff(time)))))
    return grid, interp1d(time, values)(grid)


@dataclass(frozen=True)
class Residuals:
    """Residuals of all channels as a function of unknowns."""

    experiment: Experiment
    keys: Sequence[str]  #: keys of the unknowns
    cutoff: float  #: cut-off in Hz of the slow part of a motion
    horizons: Sequence[float]  #: end of predictability in s of each channel; infinite for none
    #: features of the readings and their uncertainties, of chaotic channels; None for others
    features: Sequence[tuple[Array, Array] | None]
    #: directions (num_residuals, num_errors) of the shared errors of each channel, and the part of
    #: each that is left; empty without shared errors
    shared: Sequence[tuple[Array, Array]] = ()

    @classmethod
    def of(cls, experiment: Experiment, keys: Sequence[str], values: Array) -> Residuals:
        """Return the residuals, which curves or features have at these values of the unknowns."""
        settings = dict(zip(keys, map(float, values), strict=True))
        cutoff = CUTOFF_SHARE * experiment.first_frequency(settings)
        several = replace(experiment, perturbations=MEMBERS)
        computed = several.evaluate(settings)
        horizons = [
            np.inf
            if channel.table is None
            else float(np.nan_to_num(horizon(both[:2], channel.times, SHARES[0]), nan=np.inf))
            for channel, both in computed
        ]
        features = [
            None if np.isinf(end) else _noisy_features(channel, members, cutoff)
            for (channel, members), end in zip(computed, horizons, strict=True)
        ]
        chosen = several if any(known is not None for known in features) else experiment
        return cls(chosen, keys, cutoff, horizons, features)

    def with_shared_errors(self, values: Array) -> Residuals:
        """Return the residuals of generalised least squares near these values of the unknowns."""
        evaluated = self.experiment.evaluate(self.settings(values))
        shared = [
            shared_errors(channel, members, known, self.cutoff)
            for (channel, members), known in zip(evaluated, self.features, strict=True)
        ]
        return replace(self, shared=shared)

    def settings(self, values: Array) -> dict[str, float]:
        """Return the values (num_unknowns,) of the unknowns by key."""
        return dict(zip(self.keys, map(float, values), strict=True))

    @property
    def step(self) -> float:
        """The step of differences for a Jacobian, as a fraction of the range of each unknown."""
        return STEP if all(known is None for known in self.features) else COARSE

    @property
    def of_curves(self) -> Residuals:
        """The residuals of the curves of all channels, also of chaotic ones."""
        single = replace(self.experiment, perturbations=(0.0,))
        return replace(self, experiment=single, features=[None] * len(self.features))

    @property
    def windows(self) -> Marks:
        """Growing windows (num_windows, num_readings) of curves up to the end of predictability.

        They end when the sum of the squared changes of a channel has reached a part of the whole.
        Single values are in all of them.
        """
        masks = []
        for channel, end in zip(self.experiment.channels, self.horizons, strict=True):
            readings = channel.readings
            inside = np.full(1, True) if channel.table is None else channel.times <= end
            grown = np.cumsum(inside * (readings - readings[0]) ** 2)
            masks.append(inside & (grown <= WINDOWS[:, None] * grown[-1]))
        return np.hstack(masks)

    def __call__(self, values: Array) -> Array:
        """Return the residuals (num_residuals,) at values (num_unknowns,) of the unknowns."""
        return np.concatenate(self.parts(self.experiment.evaluate(self.settings(values))))

    def parts(self, evaluated: Sequence[tuple[Channel, Array]]) -> list[Array]:
        """Return the residuals of each channel from their values.

        Raises:
            NumericsError: the model has no value of a channel.
        """
        for channel, members in evaluated:
            if np.isnan(members).any():
                what = "no equilibrium at t = 0, too few modes, or a joint that turns freely"
                raise NumericsError(f"the model has no value of {channel.name!r}: {what}")
        plain = [
            (members[0] - channel.readings) / channel.uncertainty
            if known is None
            else _feature_residuals(channel, members, self.cutoff, *known)
            for (channel, members), known in zip(evaluated, self.features, strict=True)
        ]
        if not self.shared:
            return plain
        return [reduce_shared(off, errors) for off, errors in zip(plain, self.shared, strict=True)]


def reduce_shared(off: Array, errors: tuple[Array, Array]) -> Array:
    """Return differences (num_readings, ...) over uncertainties, less those by shared errors.

    ``errors`` are those of :func:`shared_errors`.
    """
    directions, left = errors
    return np.asarray(off - ((1.0 - left) * directions) @ (directions.T @ off))


def shared_errors(
    channel: Channel,
    members: Array,
    known: tuple[Array, Array] | None = None,
    cutoff: float = np.inf,
) -> tuple[Array, Array]:
    """Return orthonormal directions of errors that all readings share, and 1/√(1 + λ) of each.

    λ are the eigenvalues of U Uᵀ.
    """
    if known is not None:
        errors = [_steady_features(channel, members, cutoff).mean(axis=0) / known[1]]
    else:
        zero = members[0].mean() if channel.relative else 0.0
        errors = [(members[0] - zero) / channel.uncertainty]
        if channel.table is not None:
            time = channel.times
            errors.append(time * np.gradient(members[0], time) / channel.uncertainty)
    # Some signals lack some features.
    columns = channel.systematic * np.nan_to_num(np.array(errors).T)
    directions, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return directions, 1.0 / np.sqrt(1.0 + sizes**2)


def features_of(channel: Channel, curves: Array, cutoff: float) -> list[Features]:
    """Return the features of curves (num_curves, num_times) at the times of a channel."""
    time, rows = even(channel.times, curves)
    return [Features.of(time, row, cutoff) for row in rows]


def _steady_features(channel: Channel, curves: Array, cutoff: float) -> Array:
    """Return the features (num_curves, num_features) that slightly changed data change little."""
    return np.array(features_of(channel, curves, cutoff))[:, :STEADY]


def _noisy_features(channel: Channel, members: Array, cutoff: float) -> tuple[Array, Array]:
    """Return features of readings without the part of their noise, and their uncertainties."""
    readings = channel.readings
    noise = np.random.default_rng(0).normal(0.0, channel.uncertainty, (NOISES, readings.size))
    noise[0] = 0.0
    clean, *noisy = _steady_features(channel, readings + noise, cutoff)
    # The noise of the readings changes a feature as much as the same noise once more.
    target = 2.0 * clean - np.mean(noisy, axis=0)
    scatter = _steady_features(channel, members, cutoff).std(axis=0, ddof=1)
    parts = np.nan_to_num(scatter), np.std(noisy, axis=0, ddof=1), LEAST * np.abs(target)
    uncertainty = np.linalg.norm(parts, axis=0)
    return target, np.where(uncertainty > 0.0, uncertainty, np.nan)


def _feature_residuals(
    channel: Channel, members: Array, cutoff: float, target: Array, uncertainty: Array
) -> Array:
    off = (_steady_features(channel, members, cutoff).mean(axis=0) - target) / uncertainty
    known = np.isfinite(target) & np.isfinite(uncertainty)
    return np.where(known, np.nan_to_num(off, nan=MISSING), 0.0)
