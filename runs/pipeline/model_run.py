# SPDX-License-Identifier: LGPL-3.0-or-later
"""The run of one model: context, construction, motion and summary."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import BrokenExecutor, Executor
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from protractile.analysis.low_pass import SlowPeaks
from protractile.analysis.wall_buckling import WallBuckling, buckle_shell, farthest_state
from protractile.beam_model.calibration import Calibration, Stiffness
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.failure import NUMERICAL_ERRORS, NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.predictability import (
    SHARES,
    ensemble_horizons,
    integrate_ensemble,
    measure_horizons,
)
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.boom import Boom, Segment
from protractile.runs.case import toml
from protractile.runs.case.kinds.model import BuildContext, BuiltModel
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case, Model
from protractile.runs.folder.cache import Cache, key
from protractile.runs.pipeline import members
from protractile.runs.pipeline.model_output import ShellOutput
from protractile.runs.pipeline.models import MotionPlan, build, reduction_error
from protractile.runs.pipeline.summary import (
    BeamStiffness,
    CalibrationCard,
    EnsembleSummary,
    FirstPeak,
    ModelSummary,
    Predictability,
    StationSpring,
)
from protractile.runs.process.terminal import Progress, ignore_progress
from protractile.shell_model.stages import Stages

if TYPE_CHECKING:
    from mpi4py import MPI

# Relative changes of the data; their growth determines horizons and growth rates.
CHANGES = (1.0e-12, 1.0e-10, 1.0e-8, 1.0e-6)

# Loaded wall of the outer segment, by direction and sign of the force of the inner segment.
_WALLS = {("z", 1): "top", ("z", -1): "bottom", ("y", 1): "right", ("y", -1): "left"}


@dataclass(frozen=True, slots=True)
class RunContext:
    """Ranks, progress reporter, caches and helper process of a run."""

    #: ranks that share the shells and the ensembles; None for a case without shells
    comm: MPI.Intracomm | None = None
    #: callback that receives model, stage and completed fraction
    progress: Progress = ignore_progress
    cache: Cache | None = None  #: cache of reduced shells
    motions: Cache | None = None  #: cache of completed motions
    #: second process for shells and pictures if there is only one rank
    helper: Executor | None = None
    #: modules for pictures, which the helper imports after it has reduced a shell
    renderers: Sequence[str] = ()
    #: modules that the thread of the beams imports after them, while a shell is built
    writers: Sequence[str] = ()

    @property
    def first_rank(self) -> bool:
        """True for the first rank, which writes files and integrates reduced models."""
        return self.comm is None or self.comm.rank == 0

    @property
    def alone(self) -> bool:
        """True if no other rank waits for this one."""
        return self.comm is None or self.comm.size == 1


class SharedFailure(Exception):
    """Failure of a model on one rank, while other ranks may wait for this rank."""


@dataclass(frozen=True, slots=True)
class CompletedMotion:
    """A completed motion, with an ensemble if the case has one."""

    trajectory: Trajectory
    summary: ModelSummary
    ensemble: xr.Dataset | None


@dataclass(frozen=True, slots=True)
class ModelRun:
    """A built model with its motion, the output of a shell, and wall times."""

    model: Model
    built: BuiltModel
    motion: CompletedMotion
    shell: ShellOutput | None
    buckling: list[WallBuckling]  #: buckling of the walls of each segment; empty if not requested
    stages: Stages


def failure_reason(error: Exception) -> str:
    """Return the reason why a model failed."""
    if isinstance(error, NumericsError):
        return str(error)
    return (
        f"cannot be computed ({error}); look for an extreme number of the case, for example in "
        f"another unit"
    )


def run_model(
    boom: Boom, model: Model, case: Case, cutoff: float | None, context: RunContext
) -> ModelRun | None:
    """Build, integrate and summarise a model; return None except on rank 0. Collective.

    A motion of an earlier run is read from the cache of motions. A new motion is cached at once.
    The cut-off of the slow motion is in Hz, and None if it cannot be determined.

    Raises:
        NumericsError: the model cannot be computed.
        SharedFailure: the model cannot be computed, and several ranks share it.
    """
    begin, comm = perf_counter(), context.comm
    stages = Stages(partial(context.progress, model.name))
    if model.needs_shell or context.first_rank:
        helper = context.helper if context.alone else None
        tools = None
        if comm is not None and model.needs_shell:
            tools = BuildContext(comm, stages.progress, context.cache, helper)
        try:
            built = build(case, boom, model, tools)
        except NUMERICAL_ERRORS as error:
            if context.alone or not model.needs_shell:
                raise
            raise SharedFailure(failure_reason(error)) from error
        stages.seconds |= built.seconds
        if helper is not None and model.meshed:
            for name in context.renderers:
                # A broken helper is reported when it is to draw.
                with suppress(BrokenExecutor):
                    helper.submit(import_module, name)
    buckling: list[WallBuckling] = []
    if case.buckling is not None and isinstance(model, Shell):
        assert comm is not None
        with stages.stage("buckling"):
            joined, reduced_shell = model.model_boom(boom).boom, built.shell
            assert reduced_shell is not None
            state = None
            if comm.rank == 0 and reduced_shell.fields is not None:
                loaded, duration = built.system.gather_loads(), case.time.duration
                state = farthest_state(joined, loaded, reduced_shell.fields, duration)
            count, meshes = case.buckling.modes, reduced_shell.meshes
            buckling = buckle_shell(joined, meshes, state, model.options(), count, comm)
    with members.rank_executor(comm if case.ensemble else None) as executor:
        if not context.first_rank:
            return None
        single_case = case.without_client_keys().model_copy(
            update={"models": (model,), "title": ""}
        )
        system, store = built.system, context.motions
        content = toml.digest(single_case), system.omega2, system.load, system.rows, cutoff
        name = key([*content])
        motion = store.load(name, CompletedMotion) if store else None
        if motion is None:
            motion_stages = Stages(stages.progress)
            motion = _integrate(built, model, case, cutoff, executor, motion_stages)
            # The first model of a process compiles the time loop for the others.
            begin += motion_stages.seconds["compilation"]
            if store is not None:
                store.try_to_store(name, motion)
    summary, reduced = motion.summary, built.shell
    if boom.compressed:
        summary.critical_factor = built.critical_factor
    if built.calibration is not None:
        summary.calibration = calibration_card(boom, system, built.calibration)
    # A cached motion keeps the wall times of its computation.
    stages.seconds |= summary.seconds
    shell = None
    if reduced is not None:
        summary.reduction_errors = dict(reduced.errors)
        summary.local_compliance = list(reduced.local_compliance)
        summary.mesh_error = reduced.mesh_error
        with stages.stage("stress"):
            shell = ShellOutput.of(boom, model.name, reduced, motion.trajectory)
        summary.stress = shell.largest
    summary.seconds, summary.wall_time = stages.seconds, perf_counter() - begin
    return ModelRun(model, built, motion, shell, buckling, stages)


def _integrate(
    built: BuiltModel,
    model: Model,
    case: Case,
    cutoff: float | None,
    executor: Executor | None,
    stages: Stages,
) -> CompletedMotion:
    """Integrate a model; add step error, ensemble and horizons if the case requests them."""
    plan, table = MotionPlan.of(built.system, case, model), case.ensemble
    motion, system = plan.motion, plan.motion.system
    with stages.stage("compilation"):
        plan.warm()
    with stages.stage("motion") as report_progress:
        trajectory = plan.trajectory(report_progress)
    summary = summarise_motion(model, system, trajectory, built.num_dofs, static_tip(system))
    if summary.step_error is None and system.frictions and case.regular:
        with stages.stage("twice the step") as report_progress:
            summary.step_error = plan.step_error(trajectory, report_progress)
    if system.frictions:
        with stages.stage("coarser basis") as report_progress:
            summary.reduction_error = reduction_error(
                built, case, model, trajectory, report_progress
            )
    ensemble = None
    if table is not None and system.laws:
        with stages.stage("ensemble") as report_progress:
            ensemble = integrate_ensemble(
                motion,
                table.members,
                table.relative,
                table.seed,
                table.vary,
                plan.integrator,
                executor,
                report_progress,
                trajectory,
            )
        tips, time = ensemble["tip"].values, ensemble["time"].values
        peaks = None if cutoff is None else SlowPeaks.of(tips, time, cutoff)
        shares = zip(SHARES, ensemble_horizons(ensemble), strict=True)
        summary.ensemble = EnsembleSummary(
            horizons={f"{share:g}": time for share, time in shares},
            energy_residual=float(ensemble["energy_residual"].max()),
            slow_peaks=peaks,
        )
        with stages.stage("horizons") as report_progress:
            horizons = measure_horizons(
                motion,
                CHANGES,
                table.vary,
                integrator=plan.integrator,
                executor=executor,
                progress=report_progress,
                unchanged=trajectory,
            )
            summary.horizons = Predictability.of(horizons)
        if cutoff is not None and peaks is not None and motion.from_rest:
            with stages.stage("step counts"):
                summary.steps_for_peaks = members.steps_for_peaks(motion, peaks, cutoff)
    summary.seconds = stages.seconds
    return CompletedMotion(trajectory, summary, ensemble)


def static_tip(system: GapSystem) -> float:
    """Return the static tip deflection in m at t = 0; NaN without an equilibrium.

    The system has all loads.
    """
    try:
        return float(system.observers["tip"].row @ equilibrium(system, system.load_at(0.0)))
    except NumericsError:
        return float("nan")


def summarise_motion(
    model: Model, system: GapSystem, trajectory: Trajectory, num_dofs: int, static_tip: float
) -> ModelSummary:
    """Return the summary of a model's motion.

    The ``load`` of the system includes all constant loads. ``num_dofs`` is the number of degrees of
    freedom before any reduction, ``static_tip`` the static tip deflection in m.
    """
    attributes = trajectory.data.attrs
    peaks = np.abs(trajectory.data["contact_force_peak"].values)
    summary = ModelSummary(
        kind=model.kind,
        degrees_of_freedom=num_dofs,
        modes=system.num_modes,
        frequencies=system.frequencies[:6].tolist(),
        seconds={},
        step=attributes["step"],
        steps=attributes["steps"],
        first_contact=trajectory.first_contact,
        contact_changes=attributes["contact_changes"],
        energy_residual=attributes["energy_residual"],
        first_peak={
            name: FirstPeak(*trajectory.first_peak(name))
            for name in ("tip", "head", "tip_lateral")
            if name in trajectory.data
        },
        peak_contact_force=float(peaks.max()) if peaks.size else None,
        step_error=attributes["step_error"],
        resolving_step=attributes["resolving_step"],
        static_tip=static_tip,
    )
    if stick_slip := attributes.get("stick_slip"):
        summary.stick_slip = stick_slip
    return summary


def calibration_card(boom: Boom, system: GapSystem, calibration: Calibration) -> CalibrationCard:
    """Return the stiffness of a calibrated beam and the springs of its stations.

    The system has the contacts of the calibration.
    """
    return CalibrationCard(
        segments=[
            _beam_stiffness(segment, stiffness)
            for segment, stiffness in zip(boom.segments, calibration.segments, strict=True)
        ],
        springs=[
            StationSpring(
                x=system.stations[station],
                side=_WALLS[system.station_directions[station], int(law.terms[0].side)],
                stiffness=calibration.spring(row),
            )
            for row, (law, station) in enumerate(
                zip(system.laws, system.station_of_row.tolist(), strict=True)
            )
        ],
    )


def _beam_stiffness(segment: Segment, stiffness: Stiffness) -> BeamStiffness:
    planes = [segment]
    if segment.lateral and len(stiffness.bending) > 1:
        planes.append(segment.turned())
    bending = [plane.bending_stiffness for plane in planes]
    shear = [plane.prismatic_at(0.5 * sum(plane.ends)).shear_stiffness or 0.0 for plane in planes]
    torsion = None
    if stiffness.torsion is not None and segment.lateral is not None:
        section_torsion = segment.material.shear_modulus * segment.lateral.torsion_constant
        torsion = stiffness.torsion / section_torsion
    return BeamStiffness(
        segment=segment.name,
        bending=list(stiffness.bending),
        shear=list(stiffness.shear),
        torsion=stiffness.torsion,
        bending_part=(np.array(stiffness.bending) / bending).tolist(),
        shear_part=(np.array(stiffness.shear) / shear).tolist(),
        torsion_part=torsion,
    )
