# SPDX-License-Identifier: LGPL-3.0-or-later
"""Gap systems and motions of the models of a case."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import block_diag

from protractile.analysis.equilibria import instants
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.hanging_load import HangingLoad
from protractile.dynamics.line import Line
from protractile.dynamics.motion import Motion, build_motion
from protractile.dynamics.reduction import restrict
from protractile.dynamics.trajectory import Trajectory
from protractile.dynamics.travel import ChangingAxialForce, RowTable, Travel
from protractile.geometry.boom import Boom
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext, BuiltModel, ModelBoom, ModelTable
from protractile.runs.case.motions import hanging_load, with_elastic_drives, with_hanging_load
from protractile.runs.case.schema import Case, Model
from protractile.runs.process.terminal import NOTICES, shorten

if TYPE_CHECKING:
    from protractile.dynamics.integrator import AdaptiveStep, FixedStep

# Minimum stiffness of a coordinate, as a fraction of the smallest stiffness of an elastic mode.
_LEAST_STIFFNESS = 1.0e-6

# Maximum number of steps: more would take days, and are an input error.
MOST_STEPS = 1.0e10


def build(case: Case, boom: Boom, model: Model, context: BuildContext | None = None) -> BuiltModel:
    """Build a model of a case. Collective for a meshed model.

    A meshed model needs a context.

    Raises:
        BoomError: the boom lacks what the model needs.
    """
    return build_on(model.model_boom(boom), case, model, context)


def build_on(
    model_boom: ModelBoom, case: Case, model: ModelTable, context: BuildContext | None = None
) -> BuiltModel:
    """Build a model like :func:`build`, from a boom that has its contact laws already."""
    built = model.build(model_boom, context)
    boom = model_boom.boom.bonded if model.bonded else model_boom.boom
    alone = context is None or context.comm.rank == 0
    lines = model.lines(boom, built) if boom.axial_changes and alone else ()
    system = complete_system(built.system, case, boom, lines)
    if context is not None and boom.axial_changes:
        system = replace(system, travels=context.comm.bcast(system.travels))
    if built.shell is not None and boom.compressed:
        factor = _factor_at_rest(built, system, model_boom.boom, case.time.duration)
        return replace(built, system=system, critical_factor=factor)
    return replace(built, system=system)


def _factor_at_rest(
    built: BuiltModel, system: GapSystem, boom: Boom, duration: float
) -> float | None:
    """Return the buckling factor of a shell with the contacts that are closed at rest.

    The states are that at t = 0, and those of extreme loads if axial forces change. The factor is
    at most that of bonded joints. Without an equilibrium, and if the boom telescopes, it is also at
    most that of the built model.

    Raises:
        NumericsError: the factor is 1 or less: the boom buckles.
    """
    from protractile.shell_model.reduced_shell import refuse_buckling

    assert built.shell is not None
    loaded, own = system.gather_loads(), [built.shell.critical_factor]
    changing = boom.axial_changes and not boom.telescopes
    try:
        for time in instants(loaded, duration) if changing else [0.0]:
            at_time = loaded.at_time(time)
            own.append(built.shell.critical_factor_at(at_time, loaded.load_at(time)))
    except NumericsError:
        own.append(built.critical_factor)
    if boom.telescopes:
        own.append(built.critical_factor)
    factor = None if None in own else min(f for f in own if f is not None)
    refuse_buckling(factor)
    return factor


def complete_system(system: GapSystem, case: Case, boom: Boom, lines: Sequence[Line]) -> GapSystem:
    """Return a system, completed by elastic drives, changes of axial forces and a hoisted load.

    ``lines`` are the lines along the segments, which changes of axial forces need.
    """
    if boom.telescopes:
        system = with_elastic_drives(system, case, boom)
    if boom.axial_changes:
        system = replace(system, travels=[*system.travels, *axial_travels(system, boom, lines)])
    return with_hanging_load(system, case, boom)


def axial_travels(system: GapSystem, boom: Boom, lines: Sequence[Line]) -> Iterator[Travel]:
    """Yield a :class:`Travel` without moving contacts for each change of axial forces."""
    if not lines:
        return
    deflections = [dict(line.deflections) for line in lines]
    # Contacts count as stiff as the softest segment, so that no direction lacks stiffness.
    least = min(system.omega2[system.omega2 > 0.0], default=1.0)
    stiffness = np.diag(np.maximum(system.omega2, _LEAST_STIFFNESS * least))
    stiffness += least * (system.rows.T * system.row_masses) @ system.rows
    no_rows = RowTable(np.array([0.0, 1.0]), np.zeros((1, 4, 0, system.num_modes)))
    for change in boom.axial_changes:
        geometric = change.geometric_stiffness(deflections)
        force = ChangingAxialForce.of(geometric, stiffness, change.history.peak)
        if force.factors.size:
            yield Travel(change.history, no_rows, (), axial_forces=[force])


def initial_motion(system: GapSystem, case: Case) -> Motion:
    """Return the motion of a system before integration, from initial state and times of a case.

    Raises:
        NumericsError: there is no equilibrium to start from.
    """
    time, damping = case.time, case.damping
    return build_motion(
        system,
        time.duration,
        time.output_step,
        case.start.at_rest,
        damping.modal,
        (damping.mass, damping.stiffness),
    )


@dataclass(frozen=True, slots=True)
class MotionPlan:
    """Motion of a model of a case, and its integrator."""

    motion: Motion  #: motion of the system under the loads from t = 0 on
    #: integrator with the step of the model or the case, or with error control
    integrator: FixedStep | AdaptiveStep
    load: HangingLoad | None  #: hoisted load; None for none

    @classmethod
    def of(cls, system: GapSystem, case: Case, model: ModelTable) -> MotionPlan:
        """Return the motion of a model, its integrator, and the hoisted load if any.

        Raises:
            NumericsError: there is no equilibrium to start from, or the motion needs too many
                steps.
        """
        from protractile.dynamics.integrator import AdaptiveStep, FixedStep

        motion, time = initial_motion(system, case), case.time
        load = None if case.hoist is None else hanging_load(case, build_boom(case))
        step = model.step or time.step
        if step is None:
            return cls(motion, AdaptiveStep(time.tolerance), load)
        if time.duration / step > MOST_STEPS:
            raise NumericsError(
                f"a step of {step:.3g} s makes {time.duration / step:.3g} steps; make it longer"
            )
        return cls(motion, FixedStep(step), load)

    def warm(self) -> None:
        """Compile the time loop by a run to the first output; wall times exclude this compilation.

        All motions of a process share the compiled loop.
        """
        from protractile.dynamics.kernels.compiled import compilation_lock
        from protractile.dynamics.kernels.march import march

        folder = march.stats.cache_path
        with compilation_lock(folder):
            if not march.signatures:
                if not any(Path(folder).glob("march.march-*.nbc")):
                    NOTICES.warning(
                        "compiling the time loop (half a minute), for later runs too, into %s",
                        shorten(folder),
                    )
                self.integrator(replace(self.motion, duration=self.motion.output_step))

    def trajectory(self, progress: Callable[[float], None] | None = None) -> Trajectory:
        """Return the integrated motion."""
        trajectory = self.integrator(self.motion, progress)
        return trajectory if self.load is None else self.load.separate_rope(trajectory)

    def step_error(self, trajectory: Trajectory, progress: Callable[[float], None]) -> float:
        """Return the largest change of the tip by a doubled step, as a fraction of its range."""
        from protractile.dynamics.integrator import FixedStep

        coarser = FixedStep(2.0 * trajectory.data.attrs["step"])
        return _change_of_tip(trajectory, coarser(self.motion, progress))


def reduction_error(
    built: BuiltModel,
    case: Case,
    model: ModelTable,
    trajectory: Trajectory,
    progress: Callable[[float], None],
) -> float | None:
    """Return the largest change of a shell's tip on a coarser basis, as a fraction of its range.

    The coarser basis is part of that of the reduction, and its motion has the same time steps. The
    result is None if the shell has no coarser basis.
    """
    shell, system = built.shell, built.system
    if shell is None or shell.coarser.shape[0] == shell.coarser.shape[1]:
        return None
    # A hoisted load has coordinates of its own.
    basis = block_diag(shell.coarser, np.eye(system.num_modes - len(shell.coarser)))
    plan = MotionPlan.of(restrict(system, basis), case, model)
    motion = plan.integrator.like(trajectory)(plan.motion, progress)
    return _change_of_tip(trajectory, motion)


def _change_of_tip(trajectory: Trajectory, other: Trajectory) -> float:
    """Return the largest difference of the tip, as a fraction of its range in ``trajectory``."""
    tips = [np.asarray(run.data["tip"].values) for run in (trajectory, other)]
    span = float(np.ptp(tips[0]))
    return float(np.abs(tips[0] - tips[1]).max() / span) if span else 0.0
