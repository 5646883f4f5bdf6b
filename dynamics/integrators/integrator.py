# SPDX-License-Identifier: LGPL-3.0-or-later
"""The ways to move a system, as values: to be chosen, refined, and sent to other processes."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from dynamics.gap_system import GapSystem
from dynamics.integrators.event_driven import TOLERANCE, integrate_events, what_hinders
from dynamics.integrators.splitting import integrate
from dynamics.integrators.step import contact_step
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory

# Up to so many modes jumps and series take less time than steps, whatever the exponent, for an
# energy residual smaller by some 1e5 (series of 4 to 48 terms under the paper's load).
FEW_MODES = 20


class Integrator(Protocol):
    """A way to compute a motion; one of one's own needs these two methods."""

    def __call__(
        self, motion: Motion, progress: Callable[[float], None] | None = None
    ) -> Trajectory:
        """Move the system; ``progress`` is called with the part done, 0 to 1."""
        ...

    def finer(self) -> Integrator:
        """The same way with smaller errors, to see what they change."""
        ...


@dataclass(frozen=True, slots=True)
class Splitting:
    """:func:`dynamics.integrators.splitting.integrate` at a step in s.

    >>> motion = pt.Splitting(step=1e-5)(pt.Motion(ball, duration=1.0, position=[0.5]))
    >>> motion.energy_residual < 1e-4
    True
    """

    step: float

    def __call__(
        self, motion: Motion, progress: Callable[[float], None] | None = None
    ) -> Trajectory:
        return integrate(motion, self.step, progress=progress)

    def finer(self) -> Splitting:
        """Half the step, a quarter of the error."""
        return Splitting(0.5 * self.step)

    def coarser(self) -> Splitting:
        """Twice the step."""
        return Splitting(2.0 * self.step)


@dataclass(frozen=True, slots=True)
class Events:
    """:func:`dynamics.integrators.event_driven.integrate_events` at a tolerance.

    >>> motion = pt.Events()(pt.Motion(ball, duration=1.0, position=[0.5]))
    >>> motion.energy_residual < 1e-9
    True
    """

    tolerance: float = TOLERANCE

    def __call__(
        self, motion: Motion, progress: Callable[[float], None] | None = None
    ) -> Trajectory:
        run = integrate_events(motion, self.tolerance)
        if progress is not None:
            progress(1.0)
        return run

    def finer(self) -> Events:
        """A hundredth of the tolerance."""
        return Events(0.01 * self.tolerance)

    def coarser(self) -> Events:
        """A hundred times the tolerance."""
        return Events(100.0 * self.tolerance)


def by_splitting(motion: Motion) -> Splitting:
    """At the :func:`dynamics.integrators.step.contact_step` of the initial state."""
    return Splitting(contact_step(motion.system, motion.output_step, motion.initial_speeds))


def suited(motion: Motion) -> Splitting | Events:
    """From contact to contact where that is possible and modes are few, else by steps."""
    system = motion.system
    # What is bent at the start may press for long, which series do not make shorter.
    bent = bool(motion.position.any())
    if bent or system.num_modes > FEW_MODES or what_hinders(system) is not None:
        return by_splitting(motion)
    return Events()


def simulate(
    system: GapSystem,
    duration: float,
    output_step: float = 1.0e-3,
    position: npt.ArrayLike = (),
    velocity: npt.ArrayLike = (),
    integrator: Integrator | None = None,
) -> Trajectory:
    """Move a system from its initial state, by default in the way that suits it.

    >>> motion = pt.simulate(ball, duration=1.0, position=[0.5])
    >>> print(f"{motion.first_contact:.3f} s")
    0.319 s

    Args:
        system, duration, output_step, position, velocity: of the :class:`Motion`.
        integrator: :func:`suited` unless given.

    Raises:
        ValueError: the motion lacks something.
        NumericsError: it cannot be computed as finely as it should be.
    """
    a, v = (np.asarray(state, dtype=np.float64) for state in (position, velocity))
    motion = Motion(system, duration, output_step, a, v)
    return (integrator or suited(motion))(motion)
