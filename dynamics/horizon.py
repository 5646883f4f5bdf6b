# SPDX-License-Identifier: LGPL-3.0-or-later
"""How long a motion can be predicted, and what limits it.

A small relative change ε of the data parts two runs by about ε c exp(λ t), so that they are a
given distance apart at

    T(ε) = (ln distance − ln ε c) / λ

and a thousand times better data buy only ln(1000)/λ more (Lorenz 1963, *Deterministic
nonperiodic flow*). A linear system has no such time: there the distance stays in proportion to ε.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import numpy.typing as npt
import xarray as xr

from dynamics.ensemble import Vary, integrate_ensemble
from dynamics.gap_system import GapSystem
from dynamics.splitting import integrate
from dynamics.step import contact_step

Array = npt.NDArray[np.float64]

# Parts of the range at which two curves can be told apart, and at which one is no longer the other.
SHARES = (0.01, 0.20)


def spread(members: Array) -> Array:
    """(num_times,) half the distance between the largest and the smallest member.

    That is the largest error of the best single prediction. A standard deviation would be
    smaller the more members are still together, and would name a horizon after some have left.

    Args:
        members: (num_members, num_times) of one quantity.
    """
    return np.asarray(0.5 * np.ptp(members, axis=0))


def horizon(members: Array, time: Array, share: float) -> float:
    """When the spread first passes a share of the range of member 0, in s; NaN if never.

    Args:
        members: (num_members, num_times) of one quantity.
        time: (num_times,) in s.
        share: part of the range.
    """
    passed = np.flatnonzero(spread(members) > share * np.ptp(members[0]))
    return float(time[passed[0]]) if passed.size else float("nan")


@dataclass(frozen=True, slots=True)
class Growth:
    """The line T(ε) through measured horizons.

    Args:
        rate: λ in 1/s; NaN where fewer than two horizons are known, or a smaller ε gave no
            later one.
        response: c in m per relative change, NaN as above.
        scatter: root mean square distance of the horizons from the line, in s.
    """

    rate: float
    response: float
    scatter: float

    @classmethod
    def fit(cls, relatives: Array, times: Array, distance: float) -> Growth:
        """Least squares of T over ln ε.

        Args:
            relatives: (num,) ε.
            times: (num,) T in s, NaN where there is none.
            distance: of the runs at T, in m.
        """
        known = np.isfinite(times)
        if known.sum() < 2:
            return cls(np.nan, np.nan, np.nan)
        logs = np.log(relatives[known])
        slope, at_one = np.polyfit(logs, times[known], 1)
        scatter = float(np.sqrt(np.mean((times[known] - slope * logs - at_one) ** 2)))
        if not slope < 0.0:
            return cls(np.nan, np.nan, scatter)
        rate = -1.0 / slope
        return cls(float(rate), float(distance * np.exp(-rate * at_one)), scatter)


@dataclass(frozen=True, slots=True)
class Horizons:
    """Horizons of one system under changes of several sizes.

    Args:
        relatives: (num_relatives,) ε, rising.
        shares: (num_shares,) parts of the range.
        times: (num_relatives, num_shares) in s, NaN where the spread stays below.
        of_step: (num_shares,) when a run with half the step is as far from the one with the
            whole step, in s.
        growth: (num_shares) the lines through ``times``.
    """

    relatives: Array
    shares: Array
    times: Array
    of_step: Array
    growth: Sequence[Growth]

    @property
    def limits(self) -> list[Literal["step", "physics", "nothing"]]:
        """(num_shares) what ends the predictability of a run.

        ``step`` where half the step changes the run sooner than the smallest change of the data
        does: a smaller step would help. ``physics`` where it does not: data are never known
        better. ``nothing`` where neither does within the duration.
        """
        found: list[Literal["step", "physics", "nothing"]] = []
        for of_step, of_data in zip(self.of_step, self.times[0], strict=True):
            if np.isnan(of_step) and np.isnan(of_data):
                found.append("nothing")
            elif of_step < np.nan_to_num(of_data, nan=np.inf):
                found.append("step")
            else:
                found.append("physics")
        return found


def measure_horizons(
    system: GapSystem,
    relatives: Sequence[float],
    members: int,
    seed: int,
    vary: Vary,
    duration: float,
    output_step: float = 1.0e-3,
    step: float | None = None,
    shares: Sequence[float] = SHARES,
    observer: str = "tip",
    progress: Callable[[float], None] | None = None,
) -> Horizons:
    """Run an ensemble for each size of change, and one run with half the step.

    Args:
        system: from rest.
        relatives: ε, each positive.
        members, seed, vary, duration, output_step, step: see
            :func:`dynamics.ensemble.integrate_ensemble`.
        shares: parts of the observer's range.
        observer: which output is watched.
        progress: called with the part done, 0 to 1.
    """
    if step is None:
        step = contact_step(system, output_step)
    sizes = np.sort(np.asarray(relatives, dtype=float))
    times = np.empty((sizes.size, len(shares)))
    for i, relative in enumerate(sizes):
        ensemble = integrate_ensemble(
            system, members, float(relative), seed, vary, duration, output_step, step
        )
        times[i] = horizons_of(ensemble, shares, observer)
        if progress is not None:
            progress((i + 1) / sizes.size)
    whole = ensemble[observer].values[0]
    half = integrate(system, duration, output_step, 0.5 * step).data[observer].values
    of_step = [horizon(np.array([whole, half]), ensemble["time"].values, s) for s in shares]
    distances = np.asarray(shares) * np.ptp(whole)
    return Horizons(
        relatives=sizes,
        shares=np.asarray(shares, dtype=float),
        times=times,
        of_step=np.array(of_step),
        growth=[Growth.fit(sizes, t, float(d)) for t, d in zip(times.T, distances, strict=True)],
    )


def horizons_of(
    ensemble: xr.Dataset, shares: Sequence[float] = SHARES, observer: str = "tip"
) -> list[float]:
    """(num_shares) horizons of one ensemble in s, NaN where its spread stays below."""
    members, time = ensemble[observer].values, ensemble["time"].values
    return [horizon(members, time, share) for share in shares]
