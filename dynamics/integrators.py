# SPDX-License-Identifier: LGPL-3.0-or-later
"""The ways to move a system, as values: to be chosen, refined, and sent to other processes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from dynamics.event_driven import TOLERANCE, integrate_events, what_hinders
from dynamics.gap_system import GapSystem
from dynamics.splitting import integrate
from dynamics.step import contact_step, initial_speeds
from dynamics.trajectory import Trajectory

Array = npt.NDArray[np.float64]

# Up to so many modes jumps and series take less time than steps, whatever the exponent, for an
# energy residual smaller by some 1e5 (series of 4 to 48 terms under the paper's load).
FEW_MODES = 20


class Integrator(Protocol):
    """Moves a system for ``duration`` in s from its initial state, see :func:`integrate`."""

    def __call__(
        self,
        system: GapSystem,
        duration: float,
        output_step: float,
        position: Array | None = None,
        velocity: Array | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory: ...

    def finer(self) -> Integrator:
        """The same way with smaller errors, to see what they change."""
        ...


@dataclass(frozen=True, slots=True)
class Splitting:
    """:func:`dynamics.splitting.integrate` at a step in s."""

    step: float

    def __call__(
        self,
        system: GapSystem,
        duration: float,
        output_step: float,
        position: Array | None = None,
        velocity: Array | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        return integrate(
            system, duration, output_step, self.step, position, velocity, progress=progress
        )

    def finer(self) -> Splitting:
        """Half the step, a quarter of the error."""
        return Splitting(0.5 * self.step)


@dataclass(frozen=True, slots=True)
class Events:
    """:func:`dynamics.event_driven.integrate_events` at a tolerance."""

    tolerance: float = TOLERANCE

    def __call__(
        self,
        system: GapSystem,
        duration: float,
        output_step: float,
        position: Array | None = None,
        velocity: Array | None = None,
        progress: Callable[[float], None] | None = None,
    ) -> Trajectory:
        run = integrate_events(system, duration, output_step, self.tolerance, position, velocity)
        if progress is not None:
            progress(1.0)
        return run

    def finer(self) -> Events:
        """A hundredth of the tolerance."""
        return Events(0.01 * self.tolerance)


def by_splitting(
    system: GapSystem,
    output_step: float,
    step: float | None = None,
    position: Array | None = None,
    velocity: Array | None = None,
) -> Splitting:
    """At ``step``, or at the one that :func:`contact_step` finds for the initial state."""
    if step is None:
        at_rest = np.zeros(system.num_modes)
        speeds = initial_speeds(
            system,
            at_rest if position is None else position,
            at_rest if velocity is None else velocity,
        )
        step = contact_step(system, output_step, speeds)
    return Splitting(step)


def suited(system: GapSystem, step: float) -> Splitting | Events:
    """From contact to contact where that is possible and modes are few, else by steps.

    Args:
        system: to be moved.
        step: of the splitting in s, as :func:`dynamics.step.contact_step` gives it.
    """
    if what_hinders(system) is None and system.num_modes <= FEW_MODES:
        return Events()
    return Splitting(step)
