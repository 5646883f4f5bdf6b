# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ensembles: runs of one system with slightly changed data.

If impacts make a motion chaotic, a single run is a sample. Only what all members of an ensemble
have in common is a property of the system.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import xarray as xr

from dynamics.arrays import Array
from dynamics.integrator import AdaptiveStep, Integrator
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory

Vary = Literal["load", "clearance", "velocity"]

# Stored variables of each member. Whole trajectories would need too much memory.
MEMBER_VARIABLES = ("tip", "head", "contact_force")


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
    runs = list[xr.Dataset]()
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
