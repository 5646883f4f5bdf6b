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
        at, peak = _vertex(time, slow, peaks[0]) if peaks.size else (np.nan, np.nan)
        low, high = np.quantile(values, (0.1, 0.9))
        frequencies, power = periodogram(values, 1.0 / step, "hann", size, "constant")
        return cls(
            values.mean(), low, high, slow.std(), (values - slow).std(), peak, at,
            mean_period(time, slow), float(frequencies[power.argmax()]), decay(time, values),
        )  # fmt: skip


def _vertex(time: Array, values: Array, peak: int) -> tuple[float, float]:
    """Return the time in s and the value of a peak by the parabola through it and its neighbours.

    The time of the largest value alone would change in steps, which have no derivative. Equal
    values have their middle.
    """
    before, top, after = values[peak - 1 : peak + 2]
    bend = before - 2.0 * top + after
    part = 0.5 * (before - after) / bend if bend else 0.0
    return time[peak] + part * (time[1] - time[0]), top - 0.25 * (before - after) * part


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


def features_of(channel: Channel, curves: Array, cutoff: float) -> list[Features]:
    """Return the features of curves (num_curves, num_times) at the times of a channel."""
    time, rows = even(channel.times, curves)
    return [Features.of(time, row, cutoff) for row in rows]


@dataclass(frozen=True)
class Target:
    """What the model of a channel should meet: its readings, or features of chaotic ones."""

    values: Array  #: values (num_values,); NaN for a feature that the readings do not have
    uncertainty: Array  #: their standard uncertainties (num_values,)
    cutoff: float | None = None  #: cut-off in Hz of the slow part for features; None for readings
    #: orthonormal directions (num_values, num_errors) of the errors that all readings share, and
    #: the part 1/√(1 + λ) of each that is left, with the eigenvalues λ of U Uᵀ; None without errors
    shared: tuple[Array, Array] | None = None

    @classmethod
    def of_readings(cls, channel: Channel) -> Target:
        """Return the readings of a channel."""
        return cls(channel.readings, np.full(channel.readings.size, channel.uncertainty))

    @classmethod
    def of_features(cls, channel: Channel, members: Array, cutoff: float) -> Target:
        """Return the features of the readings without the part of their noise.

        ``members`` (num_motions, num_times) are slightly different motions of the model.
        """
        readings, none = channel.readings, np.zeros(0)
        noise = np.random.default_rng(0).normal(0.0, channel.uncertainty, (NOISES, readings.size))
        noise[0] = 0.0
        several = cls(none, none, cutoff)
        clean, *noisy = several._steady(channel, readings + noise)
        # The noise of the readings changes a feature as much as the same noise once more.
        values = 2.0 * clean - np.mean(noisy, axis=0)
        # Standard deviation of one more motion, by Student's t.
        n = len(members)
        scatter = np.nan_to_num(several._steady(channel, members).std(axis=0, ddof=1))
        scatter *= np.sqrt((1.0 + 1.0 / n) * (n - 1) / (n - 3))
        parts = scatter, np.std(noisy, axis=0, ddof=1), LEAST * np.abs(values)
        return cls(values, np.linalg.norm(parts, axis=0), cutoff)

    def _steady(self, channel: Channel, curves: Array) -> Array:
        """Return the features (num_curves, STEADY) that slightly changed data change little."""
        return np.array(features_of(channel, curves, self.cutoff or np.inf))[:, :STEADY]

    def describe(self, channel: Channel, members: Array) -> Array:
        """Return the values (num_values,) of a model from its motions (num_motions, num_times)."""
        steady = members if self.cutoff is None else self._steady(channel, members)
        return np.asarray(steady[0] if self.cutoff is None else steady.mean(axis=0))

    def residuals(self, channel: Channel, members: Array) -> Array:
        """Return the residuals (num_values,); 0 for features that the readings do not have."""
        off = self.describe(channel, members) - self.values
        if self.cutoff is not None:
            known = np.isfinite(self.values) & (self.uncertainty > 0.0)
            size = np.where(known, self.uncertainty, np.inf)
            return self.reduce(np.where(known, np.nan_to_num(off / size, nan=MISSING), 0.0))
        return self.reduce(off / self.uncertainty)

    def reduce(self, off: Array) -> Array:
        """Return differences (num_values, ...) over uncertainties, less those by shared errors."""
        if self.shared is None:
            return off
        directions, left = self.shared
        return np.asarray(off - ((1.0 - left) * directions) @ (directions.T @ off))

    def with_shared_errors(self, channel: Channel, members: Array) -> Target:
        """Return the target with the errors that its values share near motions of the model."""
        curve = channel.table is not None and self.cutoff is None
        size = self.describe(channel, members)
        errors = [size - size.mean() if channel.relative and curve else size]
        errors += [channel.times * np.gradient(size, channel.times)] if curve else []
        # Some signals lack some features.
        with np.errstate(all="ignore"):
            columns = np.nan_to_num(channel.systematic * np.array(errors) / self.uncertainty)
        directions, sizes, _ = np.linalg.svd(columns.T, full_matrices=False)
        return replace(self, shared=(directions, 1.0 / np.sqrt(1.0 + sizes**2)))


@dataclass(frozen=True)
class Residuals:
    """Residuals of all channels as a function of unknowns."""

    experiment: Experiment
    keys: Sequence[str]  #: keys of the unknowns
    cutoff: float  #: cut-off in Hz of the slow part of a motion
    horizons: Sequence[float]  #: end of predictability in s of each channel; infinite for none
    targets: Sequence[Target]  #: what each channel should meet

    @classmethod
    def of(cls, experiment: Experiment, keys: Sequence[str], values: Array) -> Residuals:
        """Return the residuals, which curves or features have at these values of the unknowns."""
        settings = dict(zip(keys, map(float, values), strict=True))
        cutoff = CUTOFF_SHARE * experiment.first_frequency(settings)
        several = replace(experiment, perturbations=MEMBERS)
        horizons, targets = list[float](), list[Target]()
        for channel, members in several.evaluate(settings):
            end = np.nan
            if channel.table is not None:
                end = horizon(members[:2], channel.times, SHARES[0])
            horizons.append(float(np.nan_to_num(end, nan=np.inf)))
            readings = Target.of_readings(channel)
            chaotic = np.isfinite(end)
            targets.append(Target.of_features(channel, members, cutoff) if chaotic else readings)
        chosen = several if np.isfinite(horizons).any() else experiment
        return cls(chosen, keys, cutoff, horizons, targets)

    def with_shared_errors(self, values: Array) -> Residuals:
        """Return the residuals of generalised least squares near these values of the unknowns."""
        pairs = zip(self.targets, self._evaluate(values), strict=True)
        return replace(self, targets=[target.with_shared_errors(*pair) for target, pair in pairs])

    def settings(self, values: Array) -> dict[str, float]:
        """Return the values (num_unknowns,) of the unknowns by key."""
        return dict(zip(self.keys, map(float, values), strict=True))

    @property
    def rough(self) -> bool:
        """Whether some residuals are those of features, which scatter."""
        return any(target.cutoff is not None for target in self.targets)

    @property
    def step(self) -> float:
        """The step of differences for a Jacobian, as a fraction of the range of each unknown."""
        return COARSE if self.rough else STEP

    @property
    def of_curves(self) -> Residuals:
        """The residuals of the curves of all channels, also of chaotic ones."""
        single = replace(self.experiment, perturbations=(0.0,))
        return replace(self, experiment=single, targets=[*map(Target.of_readings, single.channels)])

    @property
    def windows(self) -> list[Marks]:
        """Growing windows (num_readings,) of curves up to the end of predictability.

        They end when the sum of the squared changes of a channel has reached a part of the whole.
        Single values are in all of them.
        """
        masks = []
        for channel, end in zip(self.experiment.channels, self.horizons, strict=True):
            readings = channel.readings
            inside = np.full(1, True) if channel.table is None else channel.times <= end
            grown = np.cumsum(inside * (readings - readings[0]) ** 2)
            masks.append(inside & (grown <= WINDOWS[:, None] * grown[-1]))
        return [*np.hstack(masks)]

    def __call__(self, values: Array) -> Array:
        """Return the residuals (num_residuals,) at values (num_unknowns,) of the unknowns."""
        return np.concatenate(self.parts(self._evaluate(values)))

    def _evaluate(self, values: Array) -> list[tuple[Channel, Array]]:
        """Return the channels with their values.

        Raises:
            NumericsError: the model has no value of a channel.
        """
        evaluated = self.experiment.evaluate(self.settings(values))
        for channel, members in evaluated:
            if np.isnan(members).any():
                what = "no equilibrium at t = 0, too few modes, or a motion that diverges"
                raise NumericsError(f"the model has no value of {channel.name!r}: {what}")
        return evaluated

    def parts(self, evaluated: Sequence[tuple[Channel, Array]]) -> list[Array]:
        """Return the residuals of each channel from their values."""
        pairs = zip(self.targets, evaluated, strict=True)
        return [target.residuals(*pair) for target, pair in pairs]
