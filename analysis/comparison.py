# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison of two models of a boom at three levels: instants, peaks, distributions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from protractile.analysis.low_pass import Number, Numbers, SlowPeaks
from protractile.dynamics.arrays import Array
from protractile.dynamics.predictability import ensemble_horizons
from protractile.dynamics.trajectory import PointwiseDifferences

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True, slots=True)
class PeakDifferences:
    """Differences (num_peaks,) between the peaks of two slow motions, second minus first.

    A combined spread is the sum of the spreads of both ensembles. A difference above it shows that
    no member of one model has the peak of a member of the other.
    """

    scope: ClassVar[str] = (
        "Shows which common peaks of the slow motion differ by more than the ensembles scatter; it "
        "does not show differences of fast vibration, or of peaks that only some members have."
    )

    time: Numbers  #: differences of the times in s
    time_spread: Numbers  #: combined spreads of the times in s
    height: Numbers  #: differences of the heights, in the unit of the signal
    height_spread: Numbers  #: combined spreads of the heights, in the unit of the signal
    explained: list[bool]  #: true where neither difference exceeds its combined spread

    @classmethod
    def of(cls, one: SlowPeaks, other: SlowPeaks) -> PeakDifferences:
        """Return the differences of peaks with the same number, as far as both models have them."""
        common = slice(min(one.time.size, other.time.size))
        time = other.time[common] - one.time[common]
        height = other.height[common] - one.height[common]
        time_spread = one.time_spread[common] + other.time_spread[common]
        height_spread = one.height_spread[common] + other.height_spread[common]
        explained = (np.abs(time) <= time_spread) & (np.abs(height) <= height_spread)
        return cls(time, time_spread, height, height_spread, explained.tolist())


@dataclass(frozen=True, slots=True)
class Distributions:
    """Distributions of the values of two ensembles after both horizons.

    All statistics are NaN if one of the models stays predictable.
    """

    scope: ClassVar[str] = (
        "Shows whether the models have the same distribution of values after the horizons; it "
        "does not show differences of time and order."
    )

    since: Number  #: later of both horizons of the largest differences, in s
    range: tuple[Number, Number]  #: range of each model, in the unit of the signal
    mean: tuple[Number, Number]  #: mean of each model, in the unit of the signal
    deviation: tuple[Number, Number]  #: standard deviation of each model, in the unit of the signal
    #: Kolmogorov-Smirnov distance, the largest difference of the cumulative distributions, 0 to 1.
    #: It is no test of significance, since successive values are correlated.
    distance: Number

    @classmethod
    def of(cls, one: Array, other: Array, time: Array, since: float) -> Distributions:
        """Return the statistics of two ensembles after the time ``since`` in s.

        Values are (num_members, num_times). ``since`` is NaN if a model stays predictable.
        """
        # Imported here, since most runs have no ensemble and the import takes half a second.
        from scipy.stats import ks_2samp

        both = [members[:, time >= since].ravel() for members in (one, other)]
        if both[0].size == 0:
            none = (np.nan, np.nan)
            return cls(since, none, none, none, np.nan)
        return cls(
            since,
            (float(np.ptp(both[0])), float(np.ptp(both[1]))),
            (float(both[0].mean()), float(both[1].mean())),
            (float(both[0].std()), float(both[1].std())),
            float(ks_2samp(*both, method="asymp").statistic),
        )


@dataclass(frozen=True, slots=True)
class Comparison:
    """Comparison of two models at three levels."""

    pointwise: PointwiseDifferences
    peaks: PeakDifferences
    distributions: Distributions


def compare(one: xr.Dataset, other: xr.Dataset, cutoff: float) -> Comparison:
    """Compare the tips of the ensembles of two models.

    Ensembles are those of :func:`.dynamics.predictability.integrate_ensemble`; the cut-off of the
    slow motion is in Hz.

    Raises:
        ValueError: the times differ.
    """
    time = one["time"].values
    if not np.array_equal(time, other["time"].values):
        raise ValueError("the ensembles must have the same times")
    members = one["tip"].values, other["tip"].values
    horizons = np.array([ensemble_horizons(ensemble) for ensemble in (one, other)])
    until = float(np.nan_to_num(horizons[:, 0], nan=time[-1]).min())
    # A horizon is NaN if the model is predictable to the end; then the maximum is NaN, too.
    since = float(horizons[:, -1].max())
    return Comparison(
        PointwiseDifferences.from_curves(members[0][0], members[1][0], time, until),
        PeakDifferences.of(*(SlowPeaks.of(m, time, cutoff) for m in members)),
        Distributions.of(*members, time, since),
    )
