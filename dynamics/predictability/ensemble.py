# SPDX-License-Identifier: LGPL-3.0-or-later
"""Many runs of one system, each with data changed a little.

Where impacts make a motion chaotic, one run is a sample. What all members of an ensemble
share is what the system says; what they do not share, no run can know.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import Executor, ThreadPoolExecutor, as_completed
from contextlib import nullcontext
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import numpy.typing as npt
import xarray as xr

from dynamics.gap_system import GapSystem
from dynamics.integrators import Integrator, by_splitting

Array = npt.NDArray[np.float64]

Vary = Literal["load", "clearance", "velocity"]

# What is kept of each member; whole trajectories would fill the memory.
KEPT = ("tip", "head", "contact_force")


@dataclass(frozen=True, slots=True)
class Member:
    """One run, as it is sent to where it is made.

    Args:
        system: unchanged.
        vary: what is changed.
        change: relative change.
        integrator: how it moves.
        duration, output_step: in s.
        position, velocity: (num_modes,) initial a and ȧ, unchanged; zero unless given.
        kept: outputs that come back.
    """

    system: GapSystem
    vary: Vary
    change: float
    integrator: Integrator
    duration: float
    output_step: float
    position: Array | None = None
    velocity: Array | None = None
    kept: Sequence[str] = KEPT


def perturbations(members: int, relative: float, seed: int) -> Array:
    """(members,) relative changes: none for member 0, the others uniform within ±relative."""
    changes = np.random.default_rng(seed).uniform(-relative, relative, members)
    changes[0] = 0.0
    return changes


def changed(
    system: GapSystem, velocity: Array | None, vary: Vary, factor: float
) -> tuple[GapSystem, Array | None]:
    """System and initial velocity, all of what is varied times ``factor``."""
    if vary == "load":
        excitations = [replace(x, load=factor * x.load) for x in system.excitations]
        return replace(system, load=factor * system.load, excitations=excitations), velocity
    if vary == "clearance":
        laws = [law.behind(factor * law.clearance) for law in system.laws]
        return replace(system, laws=laws), velocity
    return system, None if velocity is None else factor * velocity


def check_varied(system: GapSystem, velocity: Array | None, vary: Vary) -> None:
    """Stop where no relative change moves anything.

    Raises:
        ValueError: what is to vary is zero.
    """
    loads = [system.load, *(x.load for x in system.excitations)]
    varied: dict[Vary, bool] = {
        "load": any(load.any() for load in loads),
        "clearance": any(law.clearance > 0.0 for law in system.laws),
        "velocity": velocity is not None and bool(velocity.any()),
    }
    if not varied[vary]:
        raise ValueError(f"the {vary} is zero, so that no relative change moves it")


def run_members(
    members: Sequence[Member],
    executor: Executor | None = None,
    progress: Callable[[float], None] | None = None,
) -> list[xr.Dataset]:
    """What is kept of each member and its ``energy_residual``, in their order.

    The result does not depend on who makes the runs.

    Args:
        members: to be run.
        executor: makes them, in other processes if it likes; as many threads as there are cores
            unless given.
        progress: called with the part done, 0 to 1.

    Raises:
        NumericsError: a member cannot be computed.
    """
    threads = ThreadPoolExecutor(len(os.sched_getaffinity(0)))
    with threads if executor is None else nullcontext(executor) as pool:
        runs = [pool.submit(_run, member) for member in members]
        try:
            for done, run in enumerate(as_completed(runs), start=1):
                run.result()
                if progress is not None:
                    progress(done / len(runs))
        except BaseException:
            for run in runs:
                run.cancel()
            raise
    return [run.result() for run in runs]


def _run(member: Member) -> xr.Dataset:
    system, velocity = changed(member.system, member.velocity, member.vary, 1.0 + member.change)
    run = member.integrator(system, member.duration, member.output_step, member.position, velocity)
    kept = run.data[[name for name in member.kept if name in run.data]]
    return kept.assign(energy_residual=((), run.energy_residual, {"units": "1"}))


def integrate_ensemble(
    system: GapSystem,
    members: int,
    relative: float,
    seed: int,
    vary: Vary,
    duration: float,
    output_step: float = 1.0e-3,
    step: float | None = None,
    velocity: Array | None = None,
    progress: Callable[[float], None] | None = None,
    position: Array | None = None,
    integrator: Integrator | None = None,
    executor: Executor | None = None,
) -> xr.Dataset:
    """Move all members of an ensemble, as many at a time as there are cores.

    Args:
        system: of member 0, which is not changed.
        members: how many, at least two.
        relative: largest relative change, positive.
        seed: of the changes; the same one gives the same members wherever they are run.
        vary: what is changed, all of it by one factor: the loads, all clearances, or the initial
            velocity.
        duration: in s.
        output_step: in s.
        step: of the splitting in s, the same for all members; from
            :func:`dynamics.step.contact_step` unless given.
        velocity: (num_modes,) initial ȧ in √kg·m/s, zero unless given.
        progress: called with the part done, 0 to 1.
        position: (num_modes,) initial a in √kg·m, zero unless given.
        integrator: how members move; by splitting at ``step`` unless given.
        executor: see :func:`run_members`; for MPI, the pool of ``mpi4py.futures``.

    Returns:
        Dims ``member``, ``time``, ``station``: of ``KEPT`` what the system observes, and
        ``energy_residual`` (member); coordinate ``change`` (member), relative. Attributes:
        ``vary``, ``relative``, ``seed``, ``integrator``, and ``step`` in s of member 0.

    Raises:
        ValueError: an argument is out of its range, or what is to vary is zero.
        NumericsError: a member cannot be computed.
    """
    if members < 2:
        raise ValueError(f"an ensemble must have at least 2 members, got {members}")
    if not 0.0 < relative < 1.0:
        raise ValueError(f"relative must be between 0 and 1, got {relative:g}")
    check_varied(system, velocity, vary)
    if integrator is None:
        integrator = by_splitting(system, output_step, step, position, velocity)
    changes = perturbations(members, relative, seed)
    one = Member(system, vary, 0.0, integrator, duration, output_step, position, velocity)
    runs = run_members([replace(one, change=change) for change in changes], executor, progress)
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
