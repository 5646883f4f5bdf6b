# SPDX-License-Identifier: LGPL-3.0-or-later
"""How a model of a case moves: once, with a finer step, many times with data a little changed."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from dynamics.failure import NumericsError, StepTooLong
from dynamics.gap_system import GapSystem
from dynamics.integrators.step import contact_step
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory
from runs.case import actions
from runs.case.kinds.model import ModelTable
from runs.case.schema import Case, EnsembleTable, Model
from runs.pipeline.models import damped

if TYPE_CHECKING:
    import xarray as xr

    from dynamics.integrators.integrator import Events, Splitting
    from runs.pipeline.summary import Predictability

Progress = Callable[[float], None]
_Found = TypeVar("_Found")

# How often a step that leaves energy unaccounted for is halved.
HALVINGS = 2

# Days of computing: what asks for more is a slip of the pen.
MOST_STEPS = 1.0e10

# Relative changes whose growth tells the horizon and its rate.
CHANGES = (1.0e-12, 1.0e-10, 1.0e-8, 1.0e-6)


@dataclass(frozen=True, slots=True)
class Plan:
    """The motion that a case asks of one of its models, and how it is integrated.

    Args:
        motion: of the system under the loads from t = 0 on.
        integrator: by steps, or from contact to contact.
    """

    motion: Motion
    integrator: Splitting | Events

    @classmethod
    def of(cls, system: GapSystem, case: Case, model: Model) -> Plan:
        """Of a model of a case; raises what :func:`asked` raises."""
        from dynamics.integrators.integrator import Splitting, suited

        motion, step = asked(system, case, model)
        given = model.step or case.time.step
        return cls(motion, Splitting(step) if given else suited(motion))

    def finer(self) -> Plan:
        """The same in half the step."""
        return replace(self, integrator=self.integrator.finer())

    def halved(self, compute: Callable[[Plan], _Found]) -> tuple[_Found, list[str]]:
        """What is computed of it; where energy leaves its bound, in half the step, and a quarter.

        Returns:
            It, and why steps were refused.

        Raises:
            StepTooLong: a quarter of the step is too long, too.
        """
        plan, refused = self, list[str]()
        while True:
            try:
                return compute(plan), refused
            except StepTooLong as error:
                if len(refused) == HALVINGS:
                    raise
                refused.append(str(error))
                plan = plan.finer()

    def moved(self) -> Trajectory:
        """The motion, in steps as short as it needs."""
        return self.halved(lambda plan: plan.integrator(plan.motion))[0]

    def warm(self) -> None:
        """One output compiles the time loop, so that a wall time is the motion's own."""
        self.integrator(replace(self.motion, duration=self.motion.output_step))

    def trajectory(self, progress: Progress) -> Trajectory:
        """The motion itself."""
        return self.integrator(self.motion, progress)

    def change_by_longer_steps(self, trajectory: Trajectory, progress: Progress) -> float | None:
        """What twice the step changes at the tip, as a part of its range; None if too long."""
        try:
            longer = replace(self, integrator=self.integrator.coarser()).trajectory(progress)
        except StepTooLong:
            return None
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


def asked(system: GapSystem, case: Case, model: Model) -> tuple[Motion, float]:
    """The motion that a case asks of one of its models, and the step that would do.

    Raises:
        NumericsError: there is no equilibrium to start from, or it would take days.
    """
    motion = begun(system, case)
    return motion, step_of(motion, case, model)


def begun(system: GapSystem, case: Case) -> Motion:
    """The motion that a case asks of a system.

    Raises:
        NumericsError: there is no equilibrium to start from.
    """
    system, position, velocity = actions.start(system, case)
    time = case.time
    moving = damped(system, case, actions.rest_of(system, case, position))
    return Motion(moving, time.duration, time.output_step, position, velocity)


def step_of(motion: Motion, case: Case, model: ModelTable) -> float:
    """The step that would do, in s.

    Raises:
        NumericsError: it would take days.
    """
    time = case.time
    step = (
        model.step
        or time.step
        or contact_step(motion.system, time.output_step, motion.initial_speeds)
    )
    if time.duration / step > MOST_STEPS:
        raise NumericsError(
            f"a step of {step:.3g} s makes {time.duration / step:.3g} steps; make the contact "
            "softer or the step longer"
        )
    return step
