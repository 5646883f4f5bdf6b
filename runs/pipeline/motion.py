# SPDX-License-Identifier: LGPL-3.0-or-later
"""How a model of a case moves: once, with a finer step, many times with data a little changed."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem
from dynamics.motion import Motion, begin
from dynamics.trajectory import Trajectory
from runs.case.kinds.model import ModelTable
from runs.case.schema import Case, EnsembleTable

if TYPE_CHECKING:
    import xarray as xr

    from dynamics.integrator import AdaptiveStep, FixedStep
    from runs.pipeline.summary import Predictability

Progress = Callable[[float], None]

# Days of computing: what asks for more is a slip of the pen.
MOST_STEPS = 1.0e10

# Relative changes whose growth tells the horizon and its rate.
CHANGES = (1.0e-12, 1.0e-10, 1.0e-8, 1.0e-6)


@dataclass(frozen=True, slots=True)
class Plan:
    """The motion that a case asks of one of its models, and how it is integrated.

    Args:
        motion: of the system under the loads from t = 0 on.
        integrator: with the step of the model or the case, else by the tolerance.
    """

    motion: Motion
    integrator: FixedStep | AdaptiveStep

    @classmethod
    def of(cls, system: GapSystem, case: Case, model: ModelTable) -> Plan:
        """Return the plan of a model of a case.

        Raises:
            NumericsError: there is no equilibrium to start from, or it would take days.
        """
        from dynamics.integrator import AdaptiveStep, FixedStep

        motion, time = begun(system, case), case.time
        step = model.step or time.step
        if step is None:
            return cls(motion, AdaptiveStep(time.tolerance))
        if time.duration / step > MOST_STEPS:
            raise NumericsError(
                f"a step of {step:.3g} s makes {time.duration / step:.3g} steps; make it longer"
            )
        return cls(motion, FixedStep(step))

    def warm(self) -> None:
        """Compile the time loop by one output, so that a wall time is the motion's own."""
        self.integrator(replace(self.motion, duration=self.motion.output_step))

    def trajectory(self, progress: Progress | None = None) -> Trajectory:
        """Return the motion."""
        return self.integrator(self.motion, progress)

    def step_error(self, trajectory: Trajectory, progress: Progress) -> float:
        """Return the change of the tip by twice a fixed step, as a part of its range."""
        from dynamics.integrator import FixedStep

        coarser = FixedStep(2.0 * trajectory.data.attrs["step"])
        longer = coarser(self.motion, progress)
        tips = [np.asarray(run.data["tip"].values) for run in (trajectory, longer)]
        span = float(np.ptp(tips[0]))
        return float(np.abs(tips[0] - tips[1]).max() / span) if span else 0.0

    def ensemble(
        self,
        table: EnsembleTable,
        trajectory: Trajectory,
        executor: Executor | None,
        progress: Progress,
    ) -> xr.Dataset:
        """All members, see :func:`dynamics.predictability.ensemble.integrate_ensemble`."""
        from dynamics.predictability.ensemble import integrate_ensemble

        return integrate_ensemble(
            self.motion,
            table.members,
            table.relative,
            table.seed,
            table.vary,
            self.integrator,
            executor,
            progress,
            trajectory,
        )

    def horizons(
        self,
        table: EnsembleTable,
        trajectory: Trajectory,
        executor: Executor | None,
        progress: Progress,
    ) -> Predictability:
        """When changes of several sizes have grown, at what rate, and whether steps are to blame.

        NaN stands for what does not happen within the run.
        """
        from dynamics.predictability.horizon import measure_horizons
        from runs.pipeline.summary import Predictability

        found = measure_horizons(
            self.motion,
            CHANGES,
            table.vary,
            integrator=self.integrator,
            executor=executor,
            progress=progress,
            unchanged=trajectory,
        )
        return Predictability(
            relatives=found.relatives.tolist(),
            shares=found.shares.tolist(),
            times=found.times.tolist(),
            of_step=found.of_step.tolist(),
            rate=[growth.rate for growth in found.growth],
            step_change=found.step_change,
            limits=list(found.limits),
        )


def begun(system: GapSystem, case: Case) -> Motion:
    """The motion that a case asks of a system.

    Raises:
        NumericsError: there is no equilibrium to start from.
    """
    time, damping = case.time, case.damping
    return begin(
        system,
        time.duration,
        time.output_step,
        case.start.at_rest,
        damping.modal,
        (damping.mass, damping.stiffness),
    )
