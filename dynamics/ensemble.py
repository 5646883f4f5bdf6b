# SPDX-License-Identifier: LGPL-3.0-or-later
"""Many runs of one system, each with data changed a little.

Where impacts make a motion chaotic, one run is a sample. What all members of an ensemble
share is what the system says; what they do not share, no run can know.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import replace
from typing import Literal

import numpy as np
import numpy.typing as npt
import xarray as xr

from dynamics.gap_system import GapSystem
from dynamics.splitting import integrate
from dynamics.step import contact_step, initial_speeds

Array = npt.NDArray[np.float64]

Vary = Literal["load", "clearance", "velocity"]

# What is kept of each member; whole trajectories would fill the memory.
KEPT = ("tip", "head", "contact_force")


def perturbations(members: int, relative: float, seed: int) -> Array:
    """(members,) relative changes: none for member 0, the others uniform within ±relative."""
    changes = np.random.default_rng(seed).uniform(-relative, relative, members)
    changes[0] = 0.0
    return changes


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
) -> xr.Dataset:
    """Move all members of an ensemble, as many at a time as there are cores.

    Args:
        system: of member 0, which is not changed.
        members: how many, at least two.
        relative: largest relative change, positive.
        seed: of the changes; the same one gives the same members on any number of cores.
        vary: what is changed, all of it by one factor: the load, all clearances, or the initial
            velocity.
        duration: in s.
        output_step: in s.
        step: of the integrator in s, the same for all members; from
            :func:`dynamics.step.contact_step` unless given.
        velocity: (num_modes,) initial ȧ in √kg·m/s, zero unless given.
        progress: called with the part done, 0 to 1.

    Returns:
        Dims ``member``, ``time``, ``station``: of ``KEPT`` what the system observes, and
        ``energy_residual`` (member); coordinate ``change`` (member), relative. Attributes:
        ``vary``, ``relative``, ``seed``, ``step`` in s.

    Raises:
        ValueError: an argument is out of its range, or what is to vary is zero.
        NumericsError: a member cannot be computed.
    """
    if members < 2:
        raise ValueError(f"an ensemble must have at least 2 members, got {members}")
    if not 0.0 < relative < 1.0:
        raise ValueError(f"relative must be between 0 and 1, got {relative:g}")
    start = np.zeros(system.num_modes) if velocity is None else velocity
    scale = {
        "load": np.abs(system.load).sum(),
        "clearance": sum(law.clearance for law in system.laws),
        "velocity": np.abs(start).sum(),
    }
    if scale[vary] == 0.0:
        raise ValueError(f"the {vary} is zero, so that no relative change moves it")
    if step is None:
        initial = initial_speeds(system, np.zeros(system.num_modes), start)
        step = contact_step(system, output_step, initial)
    changes = perturbations(members, relative, seed)

    def move(change: float) -> xr.Dataset:
        member, thrown = _changed(system, start, vary, 1.0 + change)
        run = integrate(member, duration, output_step, step, velocity=thrown)
        kept = run.data[[name for name in KEPT if name in run.data]]
        return kept.assign(energy_residual=((), run.energy_residual, {"units": "1"}))

    with ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        runs = [pool.submit(move, change) for change in changes]
        try:
            for done, run in enumerate(as_completed(runs), start=1):
                run.result()
                if progress is not None:
                    progress(done / members)
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
    ensemble = xr.concat([run.result() for run in runs], "member", combine_attrs="drop_conflicts")
    ensemble.attrs = {"vary": vary, "relative": relative, "seed": seed, "step": step}
    return ensemble.assign_coords(
        member=np.arange(members), change=("member", changes, {"units": "1"})
    )


def _changed(
    system: GapSystem, velocity: Array, vary: Vary, factor: float
) -> tuple[GapSystem, Array]:
    """System and initial velocity of one member."""
    if vary == "load":
        return replace(system, load=factor * system.load), velocity
    if vary == "clearance":
        laws = [replace(law, clearance=factor * law.clearance) for law in system.laws]
        return replace(system, laws=laws), velocity
    return system, factor * velocity
