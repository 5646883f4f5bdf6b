# SPDX-License-Identifier: LGPL-3.0-or-later
"""Predictability horizons: how long a motion can be predicted, and what limits it.

A small relative change ε of the data makes two runs diverge as ε exp(λ t), so that they reach a
given distance at

    T(ε) = T(1) − ln(ε)/λ

and data a thousand times better extend the horizon by ln(1000)/λ only (Lorenz 1963, *Deterministic
nonperiodic flow*). That holds while the distance is small: λ is read at a small part of the range,
and larger parts may be reached at about the same time from any ε. A linear system has no such time:
there the distance stays in proportion to ε.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

import numpy as np
import xarray as xr

from dynamics.arrays import Array
from dynamics.integrator import AdaptiveStep, Integrator
from dynamics.motion import Motion
from dynamics.predictability.ensemble import EnsembleMember, Vary, check_varied, run_members
from dynamics.trajectory import Trajectory

# Parts of the range at which two curves are distinguishable, and at which they are unrelated.
SHARES = (0.01, 0.20)
# Part of the range up to which the distance is still in proportion to ε.
EARLY = 1.0e-4

# Parts of the duration that are run in turn; most runs diverge within the first.
_PARTS = 0.25, 1.0
# Part of the progress of each of these, for the large changes and again for the small ones.
_STAGE = 0.5 / len(_PARTS)


def horizon(members: Array, time: Array, share: float) -> float:
    """Return the time in s at which members (num_members, num_times) first diverge; NaN if never.

    Their spread then exceeds a share of the range of member 0: half the distance of the largest
    and smallest member, the largest error of the best single prediction. A standard deviation
    would be smaller while most members are together, and give a later horizon.
    """
    spread = 0.5 * np.ptp(members, axis=0)
    passed = np.flatnonzero(spread > share * np.ptp(members[0]))
    return float(time[passed[0]]) if passed.size else float("nan")


@dataclass(frozen=True, slots=True)
class Growth:
    """The line T(ε) through measured horizons.

    Args:
        rate: λ in 1/s; NaN where fewer than two horizons are known, or smaller ε gave no later
            ones beyond the scatter.
        start: T(1) in s, NaN as above.
        scatter: root mean square distance of the horizons from the line, in s.
    """

    rate: float
    start: float
    scatter: float

    @classmethod
    def fit(cls, relatives: Array, times: Array) -> Growth:
        """Least squares of T (num,) in s, NaN where there is none, over ln ε."""
        known = np.isfinite(times)
        if known.sum() < 2:
            return cls(np.nan, np.nan, np.nan)
        logs = np.log(relatives[known])
        slope, start = np.polyfit(logs, times[known], 1)
        scatter = float(np.sqrt(np.mean((times[known] - slope * logs - start) ** 2)))
        # The slope's own error, twice: what a line through scattered times may have by chance.
        if not slope < -2.0 * scatter / (np.sqrt(known.sum()) * np.std(logs)):
            return cls(np.nan, np.nan, scatter)
        return cls(float(-1.0 / slope), float(start), scatter)

    def change(self, time: float) -> float:
        """Return the ε whose horizon is ``time`` in s."""
        return float(np.exp(self.rate * (self.start - time)))


@dataclass(frozen=True, slots=True)
class Horizons:
    """Horizons of one system under changes of several sizes.

    Args:
        relatives: (num_relatives,) ε, rising.
        shares: (num_shares,) parts of the range, rising.
        times: (num_relatives, num_shares) in s, NaN where the spread stays below.
        of_step: (num_shares,) time in s at which a run with a finer step, or tolerance, has
            diverged as far.
        growth: (num_shares) the lines through ``times``.
        step_change: the ε whose horizon at the first share is that of the finer step, by the first
            line; 0 where the finer step has none, NaN without a line.
    """

    relatives: Array
    shares: Array
    times: Array
    of_step: Array
    growth: Sequence[Growth]
    step_change: float

    @property
    def limits(self) -> list[Literal["step", "physics", "nothing"]]:
        """The limit of predictability at each share (num_shares).

        ``step``: a finer step changes the run more than the largest change of the data, so that it
        would help. ``physics``: it does not; data are not known that well. ``nothing``: neither
        makes two runs diverge so far within the duration.

        Where growth is known, its line decides for all shares, since the order in which two runs
        reach a large share is chance.
        """
        largest = self.relatives[-1]
        found: list[Literal["step", "physics", "nothing"]] = []
        for of_step, of_data in zip(self.of_step, self.times[-1], strict=True):
            sooner = of_step < np.nan_to_num(of_data, nan=np.inf)
            known = np.isfinite(self.step_change)
            if np.isnan(of_step) and np.isnan(of_data):
                found.append("nothing")
            elif self.step_change > largest if known else sooner:
                found.append("step")
            else:
                found.append("physics")
        return found


def measure_horizons(
    motion: Motion,
    relatives: Sequence[float],
    vary: Vary,
    partners: int = 3,
    integrator: Integrator | None = None,
    executor: Executor | None = None,
    shares: Sequence[float] = (EARLY, SHARES[0]),
    observer: str = "tip",
    progress: Callable[[float], None] = lambda part: None,
    unchanged: Trajectory | None = None,
) -> Horizons:
    """Return the horizons of a motion: with a finer step, and with changes of each size.

    Where the runs of the largest change do not diverge to the first share, smaller changes are not
    run; nor is the rest of runs that diverge early to all shares.

    Few partners suffice for the growth at a small share; its scatter is a measure of its error.
    Horizons at large shares are chance, and are the earlier the more partners there are.

    >>> kicked = Motion(ball, duration=1.0, velocity=[3.0])
    >>> found = measure_horizons(kicked, [1e-9, 1e-6], "velocity", observer="height")
    >>> found.times.shape
    (2, 2)

    Args:
        motion: without changes.
        relatives: ε, each between 0 and 1.
        vary: the data that change, see :func:`dynamics.predictability.ensemble.integrate_ensemble`.
        partners: runs for each size, with changes from ε/2 to ε of either sign, the first ε.
        integrator: integrator of the unchanged run, :class:`AdaptiveStep` unless given; the others
            make its steps, and one of them half of each.
        executor: see :func:`dynamics.predictability.ensemble.run_members`.
        shares: parts of the observer's range, rising.
        observer: the output that is compared.
        progress: called with the part done, 0 to 1.
        unchanged: trajectory of the motion, if it is known.

    Raises:
        ValueError: the varied data are zero.
        NumericsError: a run cannot be computed.
    """
    check_varied(motion, vary)
    integrator = integrator or AdaptiveStep()
    unchanged = integrator(motion) if unchanged is None else unchanged
    sizes = np.sort(np.asarray(relatives, dtype=float))
    one = EnsembleMember(motion, vary, 0.0, integrator.like(unchanged), (observer,))
    number = np.arange(partners)
    parts = (-1.0) ** number * (1.0 - 0.5 * number / partners)
    *smaller, largest = [
        [replace(one, change=float(change)) for change in size * parts] for size in sizes
    ]
    finer = [replace(one, integrator=one.integrator.finer())]
    whole, time = unchanged.data[observer].values, unchanged.time

    def report(before: float, part: float) -> None:
        progress(before + _STAGE * part)

    def measure(groups: Sequence[Sequence[EnsembleMember]], done: float) -> Array:
        """Return horizons (num_groups, num_shares) in s; ``done`` is the part done before."""
        found = np.full((len(groups), len(shares)), np.nan)
        for number, part in enumerate(_PARTS):
            left = [g for g in range(len(groups)) if np.isnan(found[g]).any()]
            requested = [member.within(part) for g in left for member in groups[g]]
            runs = iter(run_members(requested, executor, partial(report, done + number * _STAGE)))
            for g in left:
                tips = [next(runs)[observer].values for _ in groups[g]]
                near = [np.append(tip, whole[tip.size :]) for tip in tips]
                found[g] = [horizon(np.array([whole, *near]), time, share) for share in shares]
        return found

    # The longest run first, so that none waits for it in the end.
    of_step, of_largest = measure([finer, largest], 0.0)
    of_smaller = np.full((len(smaller), len(shares)), np.nan)
    if np.isfinite(of_largest[0]):
        of_smaller = measure(smaller, 0.5)
    progress(1.0)
    times = np.array([*of_smaller, of_largest])
    growth = [Growth.fit(sizes, t) for t in times.T]
    return Horizons(
        relatives=sizes,
        shares=np.asarray(shares, dtype=float),
        times=times,
        of_step=of_step,
        growth=growth,
        step_change=growth[0].change(float(np.nan_to_num(of_step[0], nan=np.inf))),
    )


def horizons_of(
    ensemble: xr.Dataset, shares: Sequence[float] = SHARES, observer: str = "tip"
) -> list[float]:
    """Return the horizons (num_shares) of an ensemble in s, NaN where its spread stays below."""
    members, time = ensemble[observer].values, ensemble["time"].values
    return [horizon(members, time, share) for share in shares]
