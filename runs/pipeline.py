# SPDX-License-Identifier: LGPL-3.0-or-later
"""From a case to results: every model becomes a gap system, moves, and is summed up."""

from __future__ import annotations

import math
import platform
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from beam_model.finite_element import finite_element_segment
from beam_model.kantorovich import kantorovich_segment
from beam_model.segment_model import gap_system, tied_system
from dynamics.ensemble import integrate_ensemble
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem
from dynamics.splitting import integrate
from dynamics.step import contact_step
from dynamics.trajectory import Trajectory
from geometry.boom import Boom
from runs import members, toml
from runs.build import build_boom, contact_laws
from runs.results import Results, label
from runs.schema import (
    Case,
    EnsembleTable,
    FiniteElementTable,
    KantorovichTable,
    Model,
    ShellTable,
    TimeTable,
)
from runs.verdicts import judge

if TYPE_CHECKING:
    from mpi4py import MPI

    from geometry.mesh import SegmentMesh
    from shell_model.boom_shell import ReducedShell

# Called with the model's name, the stage, and the part of it that is done.
Progress = Callable[[str, str, float], None]

# Days of computing: what asks for more is a slip of the pen.
MOST_STEPS = 1.0e10


@dataclass(frozen=True, slots=True)
class ShellOutput:
    """What a shell leaves besides its trajectory.

    Args:
        fields: points, triangles, segment and modes of the mesh, and ``state`` (time, mode).
        meshes: name of the segment → its mesh.
    """

    fields: xr.Dataset
    meshes: dict[str, SegmentMesh]


@dataclass(frozen=True, slots=True)
class Outcome:
    """What one model leaves; ``ensemble`` and ``shell`` where it has one."""

    trajectory: Trajectory
    summary: dict[str, Any]
    ensemble: xr.Dataset | None
    shell: ShellOutput | None


@dataclass(frozen=True, slots=True)
class Run:
    """Results, and by the model's name what each shell leaves."""

    results: Results
    shells: dict[str, ShellOutput]


def run_case(
    case: Case, file: str, comm: MPI.Comm | None, mesh_folder: Path, progress: Progress
) -> Run | None:
    """Run all models of a case. Collective; None but on rank 0.

    Args:
        case: a checked one.
        file: how messages call it.
        comm: the ranks that share the shells; only a case with a shell needs it.
        mesh_folder: where gmsh's files go, ``MODEL/SEGMENT.msh``.
        progress: told about every stage.

    Raises:
        NumericsError: a model cannot be computed.
    """
    boom = build_boom(case)
    first_rank = comm is None or comm.rank == 0
    outcomes: dict[str, Outcome] = {}
    for number, model in enumerate(case.models, start=1):
        if not (first_rank or isinstance(model, ShellTable)):
            continue
        try:
            # What overflows is found where it matters, and said there.
            with np.errstate(all="ignore"):
                outcome = _run_model(boom, model, case, comm, mesh_folder / model.name, progress)
        except NumericsError as error:
            raise NumericsError(f"{file}: model[{number}]: {error}") from error
        except (ArithmeticError, np.linalg.LinAlgError, ValueError) as error:
            raise NumericsError(
                f"{file}: model[{number}]: cannot be computed ({error}); look for a number of the "
                "case that is out of proportion, in another unit say"
            ) from error
        if outcome is not None:
            outcomes[model.name] = outcome
    if not first_rank:
        return None
    summary: dict[str, Any] = {
        "title": case.title,
        "case_hash": toml.digest(case),
        "versions": _versions(),
        "models": {name: outcome.summary for name, outcome in outcomes.items()},
    }
    ensembles = members.gather(
        {name: out.ensemble for name, out in outcomes.items() if out.ensemble is not None}
    )
    if ensembles is not None and case.ensemble is not None:
        cutoff = members.slow_below(boom, case.time)
        for name, out in outcomes.items():
            if out.ensemble is not None:
                summary["models"][name]["ensemble"] = members.sum_up(out.ensemble, cutoff)
        summary["ensemble"] = {**case.ensemble.model_dump(), "slow_below": cutoff}
        ensembles = ensembles.assign_attrs(case_hash=summary["case_hash"])
    # Every file says which case it is of, so that a folder cannot mix two runs unnoticed.
    trajectories = {name: outcome.trajectory for name, outcome in outcomes.items()}
    data = label(boom, trajectories).assign_attrs(case_hash=summary["case_hash"])
    verdicts = judge(data, summary, case, ensembles)
    shells = {name: out.shell for name, out in outcomes.items() if out.shell is not None}
    return Run(Results(case, data, summary, verdicts, ensembles), shells)


def _run_model(
    boom: Boom,
    model: Model,
    case: Case,
    comm: MPI.Comm | None,
    mesh_folder: Path,
    progress: Progress,
) -> Outcome | None:
    """What a model leaves, on rank 0; None elsewhere."""

    def tell(stage: str, part: float) -> None:
        progress(model.name, stage, part)

    reduced = None
    if isinstance(model, ShellTable):
        assert comm is not None
        reduced = _reduce(boom, model, comm, mesh_folder, tell)
        system, seconds, num_dofs = reduced.system, dict(reduced.seconds), reduced.num_dofs
        if comm.rank != 0:
            return None
    else:
        start = perf_counter()
        system = _beam_system(boom, model)
        seconds, num_dofs = {"build": perf_counter() - start}, system.num_modes
    trajectory = _move(system, model, case.time, seconds, tell)
    ensemble = None
    if case.ensemble is not None and system.laws:
        step = trajectory.data.attrs["step"]
        ensemble = _move_members(system, case.ensemble, case.time, step, seconds, tell)
    summary = _summary(model, system, trajectory, num_dofs, seconds)
    if reduced is None:
        return Outcome(trajectory, summary, ensemble, None)
    summary["reduction_errors"] = reduced.errors
    shell = _shell_output(boom, model.name, reduced, trajectory)
    return Outcome(trajectory, summary, ensemble, shell)


def _beam_system(boom: Boom, model: KantorovichTable | FiniteElementTable) -> GapSystem:
    if isinstance(model, KantorovichTable):
        segments = [
            kantorovich_segment(segment, terms, model.base, model.rotary_inertia)
            for segment, terms in zip(boom.segments, model.terms, strict=True)
        ]
        return gap_system(boom, segments, contact_laws(boom, model))
    segments = [
        finite_element_segment(
            segment,
            model.element_length,
            boom.stations_of(number),
            model.theory,
            model.rotary_inertia,
        )
        for number, segment in enumerate(boom.segments)
    ]
    if model.tied:
        return tied_system(boom, segments)
    return gap_system(boom, segments, contact_laws(boom, model))


def _reduce(
    boom: Boom,
    model: ShellTable,
    comm: MPI.Comm,
    mesh_folder: Path,
    tell: Callable[[str, float], None],
) -> ReducedShell:
    from shell_model.boom_shell import ShellOptions, reduce_boom

    if comm.rank == 0:
        mesh_folder.mkdir(parents=True)
    options = ShellOptions(
        mesh_size=model.mesh_size, contact_line=model.contact_line, mesh_folder=mesh_folder
    )
    return reduce_boom(boom, contact_laws(boom, model), options, comm, tell)


def _move(
    system: GapSystem,
    model: Model,
    time: TimeTable,
    seconds: dict[str, float],
    tell: Callable[[str, float], None],
) -> Trajectory:
    step = model.step or time.step or contact_step(system, time.output_step)
    if time.duration / step > MOST_STEPS:
        raise NumericsError(
            f"a step of {step:.3g} s makes {time.duration / step:.3g} steps; make the contact "
            "softer or the step longer"
        )
    # One output compiles the time loop, so that the wall time is the motion's own.
    integrate(system, time.output_step, time.output_step, step)
    start = perf_counter()
    trajectory = integrate(
        system,
        time.duration,
        time.output_step,
        step,
        progress=lambda part: tell("motion", part),
    )
    seconds["motion"] = perf_counter() - start
    return trajectory


def _move_members(
    system: GapSystem,
    table: EnsembleTable,
    time: TimeTable,
    step: float,
    seconds: dict[str, float],
    tell: Callable[[str, float], None],
) -> xr.Dataset:
    start = perf_counter()
    ensemble = integrate_ensemble(
        system,
        table.members,
        table.relative,
        table.seed,
        table.vary,
        time.duration,
        time.output_step,
        step,
        progress=lambda part: tell("ensemble", part),
    )
    seconds["ensemble"] = perf_counter() - start
    return ensemble


def _summary(
    model: Model,
    system: GapSystem,
    trajectory: Trajectory,
    num_dofs: int,
    seconds: dict[str, float],
) -> dict[str, Any]:
    attributes = trajectory.data.attrs
    peaks = np.abs(trajectory.data["contact_force_peak"].values)
    return {
        "kind": model.kind,
        "degrees_of_freedom": num_dofs,
        "modes": system.num_modes,
        "frequencies": system.frequencies[:6].tolist(),
        "seconds": seconds,
        "step": attributes["step"],
        "steps": attributes["steps"],
        "first_contact": _known(trajectory.first_contact),
        "contact_changes": attributes["contact_changes"],
        "energy_residual": attributes["energy_residual"],
        "first_peak": {
            name: [_known(number) for number in trajectory.first_peak(name)]
            for name in ("tip", "head")
            if name in trajectory.data
        },
        "peak_contact_force": float(peaks.max()) if peaks.size else None,
    }


def _shell_output(
    boom: Boom, name: str, reduced: ReducedShell, trajectory: Trajectory
) -> ShellOutput:
    assert reduced.fields is not None
    fields = reduced.fields.assign(
        state=(("time", "mode"), trajectory.states.astype(np.float32)),
        time=("time", trajectory.time, {"units": "s"}),
    ).assign_attrs(model=name)
    names = [segment.name for segment in boom.segments]
    return ShellOutput(fields, dict(zip(names, reduced.meshes, strict=True)))


def _known(number: float) -> float | None:
    return number if math.isfinite(number) else None


def _versions() -> dict[str, str | None]:
    """What computed: a module counts if it has been loaded, which a beam's run spares FEniCSx."""
    modules: Sequence[str] = (
        "numpy", "scipy", "numba", "xarray", "gmsh", "dolfinx", "petsc4py", "mpi4py",
    )  # fmt: skip
    try:
        own = version("protractile")
    except PackageNotFoundError:
        own = None
    return {
        "protractile": own,
        "python": platform.python_version(),
        **{name: getattr(sys.modules.get(name), "__version__", None) for name in modules},
    }
