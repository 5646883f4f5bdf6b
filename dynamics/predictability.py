# SPDX-License-Identifier: LGPL-3.0-or-later
"""Predictability: ensembles of runs with slightly changed data, and horizons.

If impacts make a motion chaotic, a single run is a sample. Only what all members of an ensemble
have in common is a property of the system.

A horizon is the time for which a motion can be predicted. A small relative change ε of the data
makes two runs diverge as ε exp(λ t). They reach a given distance at T(ε) = T(1) − ln(ε)/λ, so that
data a thousand times more accurate extend the horizon only by ln(1000)/λ (Lorenz 1963,
*Deterministic nonperiodic flow*). This holds for small distances. So the growth rate λ is
determined at a small fraction of the range; larger fractions may be reached at about the same time
for any ε. In a linear system the distance stays proportional to ε.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

from protractile.dynamics.arrays import Array
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory

if TYPE_CHECKING:
    import xarray as xr

    from protractile.dynamics.integrator import Integrator

Vary = Literal["load", "clearance", "velocity"]

# Stored variables of each member. Whole trajectories would need too much memory.
MEMBER_VARIABLES = ("tip", "head", "contact_force")

# Fractions of the range at which two curves become distinguishable, and at which they are
# independent.
SHARES = (0.01, 0.20)
# Fraction of the range up to which the distance is proportional to ε.
EARLY = 1.0e-4

# Fractions of the duration that are run in turn; most runs diverge within the first one.
_PARTS = 0.25, 1.0
# Share of the progress of each fraction, for the large changes and again for the small ones.
_STAGE = 0.5 / len(_PARTS)


@dataclass(frozen=True, slots=True)
class EnsembleMember:
    """One run of an ensemble."""

    motion: Motion  #: motion without changes
    vary: Vary  #: name of the changed data
    change: float  #: relative change
    integrator: Integrator  #: integrator of the motion
    variables: Sequence[str] = MEMBER_VARIABLES  #: names of the variables to store

    def shorten(self, part: float) -> EnsembleMember:
        """Return the member with a fraction of its duration, in whole output steps."""
        outputs = max(1, round(part * self.motion.outputs))
        return replace(
            self, motion=replace(self.motion, duration=outputs * self.motion.output_step)
        )


def perturbations(members: int, relative: float, seed: int) -> Array:
    """Return relative changes (members,): 0 for member 0, others uniform within ±relative."""
    changes = np.random.default_rng(seed).uniform(-relative, relative, members)
    changes[0] = 0.0
    return changes


def vary_motion(motion: Motion, vary: Vary, factor: float) -> Motion:
    """Return the motion with the varied data multiplied by ``factor``."""
    system = motion.system
    if vary == "load":
        excitations = [replace(x, load=factor * x.load) for x in system.excitations]
        load = factor * system.load
        return replace(motion, system=replace(system, load=load, excitations=excitations))
    if vary == "clearance":
        laws = [law.scale_clearances(factor) for law in system.laws]
        return replace(motion, system=replace(system, laws=laws))
    return replace(motion, velocity=factor * motion.velocity)


def check_varied(motion: Motion, vary: Vary) -> None:
    """Check that the varied data are not all zero.

    Raises:
        ValueError: all varied data are zero.
    """
    system = motion.system
    loads = [system.load, *(x.load for x in system.excitations)]
    varied: dict[Vary, bool] = {
        "load": any(load.any() for load in loads),
        "clearance": any(law.scale_clearances(2.0) != law for law in system.laws),
        "velocity": bool(motion.velocity.any()),
    }
    if not varied[vary]:
        raise ValueError(f"the {vary} is zero, so that no relative change moves it")


def run_members(
    members: Sequence[EnsembleMember],
    executor: Executor | None = None,
    progress: Callable[[float], None] | None = None,
) -> list[xr.Dataset]:
    """Return the stored variables and ``energy_residual`` of each member, computed in parallel.

    The result does not depend on the executor.

    Args:
        executor: executor of threads or processes; one thread per core unless given.
        progress: callback that receives the completed fraction, 0 to 1.

    Raises:
        NumericsError: a member cannot be computed.
    """
    threads = ThreadPoolExecutor(len(os.sched_getaffinity(0)))
    runs: list[xr.Dataset] = []
    with threads if executor is None else nullcontext(executor) as pool:
        # If an error ends the loop, the iterator cancels the remaining members.
        for run in pool.map(_run, members):
            runs.append(run)
            if progress is not None:
                progress(len(runs) / len(members))
    return runs


def _run(member: EnsembleMember) -> xr.Dataset:
    run = member.integrator(vary_motion(member.motion, member.vary, 1.0 + member.change))
    return _select_variables(run, member.variables)


def _select_variables(run: Trajectory, names: Sequence[str]) -> xr.Dataset:
    kept = run.data[[name for name in names if name in run.data]]
    return kept.assign(energy_residual=((), run.energy_residual, {"units": "1"}))


def integrate_ensemble(
    motion: Motion,
    members: int,
    relative: float,
    seed: int,
    vary: Vary,
    integrator: Integrator | None = None,
    executor: Executor | None = None,
    progress: Callable[[float], None] | None = None,
    unchanged: Trajectory | None = None,
) -> xr.Dataset:
    """Return the motions of an ensemble, computed on all cores.

    >>> kicked = Motion(ball, duration=1.0, velocity=[3.0])
    >>> ensemble = integrate_ensemble(kicked, members=3, relative=1e-3, seed=1, vary="velocity")
    >>> dict(ensemble.sizes)
    {'member': 3, 'time': 1001, 'station': 1}

    Args:
        motion: motion of member 0, without changes.
        members: number of members, at least two.
        relative: largest relative change, positive.
        seed: seed of the changes; the same seed gives the same members on every machine.
        vary: changed data, all by the same factor: the loads, all clearances, or the initial
            velocity.
        integrator: integrator of member 0, :class:`AdaptiveStep` unless given; the other members
            use its steps.
        executor: executor as in :func:`run_members`; for MPI, the pool of ``mpi4py.futures``.
        progress: callback that receives the completed fraction, 0 to 1.
        unchanged: trajectory of member 0, if it is available.

    Returns:
        A dataset with dims ``member``, ``time``, ``station``: ``tip``, ``head`` and
        ``contact_force`` if available, and ``energy_residual`` (member); coordinate ``change``
        (member), relative. Attributes: ``vary``, ``relative``, ``seed``, ``integrator``, and
        ``step`` in s of member 0.

    Raises:
        ValueError: an argument is out of its range, or the varied data are zero.
        NumericsError: a member cannot be computed.
    """
    import xarray as xr

    from protractile.dynamics.integrator import AdaptiveStep

    if members < 2:
        raise ValueError(f"an ensemble must have at least 2 members, got {members}")
    if not 0.0 < relative < 1.0:
        raise ValueError(f"relative must be between 0 and 1, got {relative:g}")
    check_varied(motion, vary)
    integrator = integrator or AdaptiveStep()
    changes = perturbations(members, relative, seed)
    unchanged = integrator(motion) if unchanged is None else unchanged
    same = integrator.like(unchanged)
    others = [EnsembleMember(motion, vary, change, same) for change in changes[1:]]
    first = _select_variables(unchanged, MEMBER_VARIABLES)
    # The stations of a load on a rope, which are the last ones, are left out.
    stations = slice(first.sizes.get("station"))
    runs = [first]
    runs += [
        one.isel(station=stations, missing_dims="ignore")
        for one in run_members(others, executor, progress)
    ]
    ensemble = xr.concat(runs, "member", combine_attrs="drop_conflicts")
    ensemble.attrs = {
        "vary": vary,
        "relative": relative,
        "seed": seed,
        "integrator": str(integrator),
        "step": runs[0].attrs["step"],
    }
    return ensemble.assign_coords(
        member=np.arange(members), change=("member", changes, {"units": "1"})
    )


def horizon(members: Array, time: Array, share: float) -> float:
    """Return the time in s at which members (num_members, num_times) diverge; NaN if they do not.

    Members diverge when their spread exceeds the fraction ``share`` of the range of member 0. The
    spread is half the distance between the largest and the smallest value, which is the error of
    the best single prediction. A standard deviation would be smaller while most members agree.
    """
    spread = 0.5 * np.ptp(members, axis=0)
    beyond = np.flatnonzero(spread > share * np.ptp(members[0]))
    return float(time[beyond[0]]) if beyond.size else float("nan")


@dataclass(frozen=True, slots=True)
class Growth:
    """Straight line of measured horizons T over ln ε, with the growth rate λ."""

    #: λ in 1/s; NaN with fewer than two horizons, or if the increase of horizons with smaller ε is
    #: within the scatter
    rate: float
    start: float  #: T(1) in s; NaN like ``rate``
    scatter: float  #: root mean square distance of the horizons from the line in s

    @classmethod
    def fit(cls, relatives: Array, times: Array) -> Growth:
        """Return the least-squares line of the finite horizons (num_relatives,) in s over ln ε."""
        finite = np.isfinite(times)
        if finite.sum() < 2:
            return cls(np.nan, np.nan, np.nan)
        logs = np.log(relatives[finite])
        slope, start = np.polyfit(logs, times[finite], 1)
        scatter = float(np.sqrt(np.mean((times[finite] - slope * logs - start) ** 2)))
        # A slope within twice its standard error may result from scatter by chance.
        if not slope < -2.0 * scatter / (np.sqrt(finite.sum()) * np.std(logs)):
            return cls(np.nan, np.nan, scatter)
        return cls(float(-1.0 / slope), float(start), scatter)

    def change(self, time: float) -> float:
        """Return the relative change ε of the data that has the horizon ``time`` in s."""
        return float(np.exp(self.rate * (self.start - time)))


@dataclass(frozen=True, slots=True)
class Horizons:
    """Horizons of predictability of one system, one for each size of a change of its data."""

    relatives: Array  #: ε (num_relatives,), ascending
    shares: Array  #: fractions (num_shares,) of the range, ascending
    #: horizons (num_relatives, num_shares) in s; NaN if the spread stays below the share
    times: Array
    of_step: Array  #: horizons (num_shares,) in s of a run with a finer step or tolerance
    growth: Sequence[Growth]  #: line through ``times`` for each share
    #: ε that has the same horizon at the first share as the finer step, by ``growth``; 0 if the run
    #: with the finer step does not diverge, NaN without a line
    step_change: float

    @property
    def limits(self) -> list[Literal["step", "physics", "nothing"]]:
        """The cause that limits predictability at each share (num_shares,).

        ``step``: the finer step has a larger effect than the largest change of the data, so that a
        finer step extends the horizon. ``physics``: the change of the data has the larger effect.
        ``nothing``: runs do not diverge to this share within the duration. If the growth rate is
        known, ``step_change`` decides for all shares, since horizons at large shares are random.
        """
        largest = self.relatives[-1]
        limits: list[Literal["step", "physics", "nothing"]] = []
        for of_step, of_data in zip(self.of_step, self.times[-1], strict=True):
            sooner = of_step < np.nan_to_num(of_data, nan=np.inf)
            has_growth = np.isfinite(self.step_change)
            if np.isnan(of_step) and np.isnan(of_data):
                limits.append("nothing")
            elif self.step_change > largest if has_growth else sooner:
                limits.append("step")
            else:
                limits.append("physics")
        return limits


def measure_horizons(
    motion: Motion,
    relatives: Sequence[float],
    vary: Vary,
    partners: int = 3,
    integrator: Integrator | None = None,
    executor: Executor | None = None,
    observer: str = "tip",
    progress: Callable[[float], None] = lambda part: None,
    unchanged: Trajectory | None = None,
) -> Horizons:
    """Return the horizons of a motion for a finer step and for changes of each size.

    The shares are ``EARLY`` and the first of ``SHARES``. If runs with the largest change do not
    diverge to the first share, smaller changes are not run. Runs that diverge to both end early.
    Few partners suffice for the growth rate at a small share, whose error ``scatter`` measures.
    Horizons at large shares are random, and become earlier with more partners.

    >>> kicked = Motion(ball, duration=1.0, velocity=[3.0])
    >>> horizons = measure_horizons(kicked, [1e-9, 1e-6], "velocity", observer="height")
    >>> horizons.times.shape
    (2, 2)

    Args:
        motion: motion without changes.
        relatives: ε, each between 0 and 1.
        vary: changed data, see :func:`.dynamics.predictability.integrate_ensemble`.
        partners: number of runs for each size, with changes between ε/2 and ε of either sign; the
            first change is ε.
        integrator: integrator of the unchanged run, :class:`AdaptiveStep` unless given. The other
            runs use its steps; the run with a finer step uses half of each.
        executor: executor as in :func:`.dynamics.predictability.run_members`.
        observer: name of the compared output.
        progress: callback that receives the completed fraction, 0 to 1.
        unchanged: trajectory of the motion, if it is available.

    Raises:
        ValueError: the varied data are zero.
        NumericsError: a run cannot be computed.
    """
    from protractile.dynamics.integrator import AdaptiveStep

    check_varied(motion, vary)
    shares = (EARLY, SHARES[0])
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

    def measure(groups: Sequence[Sequence[EnsembleMember]], done: float) -> Array:
        def run(members: Sequence[EnsembleMember], stage: int) -> Iterator[Array]:
            before = done + stage * _STAGE
            runs = run_members(members, executor, lambda part: progress(before + _STAGE * part))
            return (one[observer].values for one in runs)

        return _horizons_of(groups, shares, whole, time, run)

    # The run with the finer step is the longest. It starts first so that all cores end together.
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


def _horizons_of(
    groups: Sequence[Sequence[EnsembleMember]],
    shares: Sequence[float],
    whole: Array,
    time: Array,
    run: Callable[[Sequence[EnsembleMember], int], Iterator[Array]],
) -> Array:
    """Return the horizons (num_groups, num_shares) in s of groups of members.

    Args:
        whole: output (num_times,) of the unchanged run at the times ``time`` in s.
        run: function that returns the output of members, for the number of a fraction of the
            duration.
    """
    of_groups = np.full((len(groups), len(shares)), np.nan)
    for number, part in enumerate(_PARTS):
        left = [g for g in range(len(groups)) if np.isnan(of_groups[g]).any()]
        outputs = run([member.shorten(part) for g in left for member in groups[g]], number)
        for g in left:
            tips = [next(outputs) for _ in groups[g]]
            near = [np.append(tip, whole[tip.size :]) for tip in tips]
            of_groups[g] = [horizon(np.array([whole, *near]), time, share) for share in shares]
    return of_groups


def ensemble_horizons(
    ensemble: xr.Dataset, shares: Sequence[float] = SHARES, observer: str = "tip"
) -> list[float]:
    """Return the horizons (num_shares,) of an ensemble in s; NaN if a share is not reached."""
    members, time = ensemble[observer].values, ensemble["time"].values
    return [horizon(members, time, share) for share in shares]
