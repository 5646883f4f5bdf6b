# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motions of the paper's example with friction.

These motions are regular, so that two runs can be compared pointwise.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

import numpy as np

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.boom import Boom
from protractile.geometry.joint import Pad
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext, BuiltModel, select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case, Model
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.models import MotionPlan, build

CASE = CASES / "friction-walk.toml"

OUTPUT_STEP = 1.0e-3
# Time step in s; half of it changes a shell's tip by at most 0.02 % of its range in 5 s.
STEP = 2.0e-5

_Task = TypeVar("_Task")
_Found = TypeVar("_Found")


def friction_case() -> Case:
    """Return the paper's example with friction, with series, beam elements and a shell."""
    return case_file.load(str(CASE))


def scale_loads(case: Case, times: float) -> Case:
    """Return the case with its segments' loads multiplied by a factor."""
    segments = tuple(
        segment.model_copy(update={"load": times * segment.load}) for segment in case.segments
    )
    return case.model_copy(update={"segments": segments})


def set_duration(case: Case, duration: float) -> Case:
    """Return the case with another duration in s."""
    time = case.time.model_copy(update={"duration": duration})
    return case.model_copy(update={"time": time})


def with_pads(case: Case, length: float, width: float) -> Case:
    """Return the case with pads of a length and a width in m at all joints."""
    pad = Pad(length, width)
    joints = tuple(replace(joint, pad=pad) for joint in case.joints)
    return case.model_copy(update={"joints": joints})


def model_of(case: Case, name: str) -> Model:
    """Return a model by its name."""
    return next(model for model in case.models if model.name == name)


def shell_of(case: Case) -> Shell:
    """Return the shell of a case, whose name is ``shell``."""
    (shell,) = select_kind(Shell, [model_of(case, "shell")])
    return shell


def gap_system(case: Case, boom: Boom, model: Model) -> GapSystem:
    """Return the gap system of a model; a shell is reduced in this process only."""
    from mpi4py import MPI

    return build(case, boom, model, BuildContext(MPI.COMM_SELF)).system


def build_all(case: Case, models: Mapping[str, Model]) -> dict[str, BuiltModel]:
    """Return several built models of a case by name; each shell is reduced once."""
    from mpi4py import MPI

    boom = build_boom(case)
    with TemporaryDirectory(prefix="protractile-") as scratch:
        tools = BuildContext(MPI.COMM_SELF, cache=Cache(Path(scratch)))
        return {name: build(case, boom, model, tools) for name, model in models.items()}


def scale_mesh(shell: Shell, part: float) -> Shell:
    """Return the shell with all edge lengths multiplied by a factor."""
    tolerance = shell.contact_tolerance
    if tolerance != "any":
        tolerance *= part**2
    sizes = {"mesh_size": part * shell.mesh_size, "contact_tolerance": tolerance}
    return shell.model_copy(update=sizes)


def trajectories(case: Case) -> list[Trajectory]:
    """Return the motions of all models of a case, in its order, computed in parallel."""
    boom = build_boom(case)
    plans = [MotionPlan.of(gap_system(case, boom, m), case, m) for m in case.models]
    return run_parallel(lambda plan: plan.trajectory(lambda part: None), plans)


def run_parallel(move: Callable[[_Task], _Found], tasks: Iterable[_Task]) -> list[_Found]:
    """Return ``move`` of each task; the tasks run in parallel on all cores."""
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        return list(pool.map(move, tasks))


def without_friction(system: GapSystem) -> GapSystem:
    """Return the system without friction rows."""
    return replace(system, friction_rows=np.zeros((0, system.num_modes)), frictions=())


def move(system: GapSystem, duration: float, step: float = STEP) -> Trajectory:
    """Return the motion from rest with a duration and a step in s."""
    return FixedStep(step)(Motion(system, duration, OUTPUT_STEP))
