# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is to be computed: a system, where it starts from, for how long."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dynamics.arrays import Array
from dynamics.gap_system import GapSystem

# Output intervals that are made at once; later a hundredth of those that have been made.
_AT_ONCE = 100

# Arrays of them take some MB, and between them a run can be stopped.
_STEPS_AT_ONCE = 2**17


@dataclass(frozen=True, slots=True)
class Motion:
    """The motion of a gap system from its initial state; what every integrator takes.

    >>> motion = pt.Motion(ball, duration=1.0, position=[0.5])
    >>> motion.outputs, motion.from_rest
    (1000, False)

    Args:
        system: what moves.
        duration: in s; a whole number of output steps is made, at least one.
        output_step: in s.
        position: (num_modes,) initial a in √kg·m, zero unless given.
        velocity: (num_modes,) initial ȧ in √kg·m/s, zero unless given.

    Raises:
        ValueError: a time is not positive, a shape does not agree, a number is not finite, or the
            system is not in its own modes.
    """

    system: GapSystem
    duration: float
    output_step: float = 1.0e-3
    position: Array = field(default_factory=lambda: np.zeros(0))
    velocity: Array = field(default_factory=lambda: np.zeros(0))

    def __post_init__(self) -> None:
        for name in ("duration", "output_step"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be finite and positive, got {getattr(self, name)} s")
        if self.system.softening.size:
            raise ValueError("what is softened besides moves in_own_modes")
        n = self.system.num_modes
        for name in ("position", "velocity"):
            state = np.asarray(getattr(self, name), dtype=np.float64)
            state = state if state.size else np.zeros(n)
            if state.shape != (n,):
                raise ValueError(f"{name} must have the shape {(n,)}, got {state.shape}")
            if not np.isfinite(state).all():
                raise ValueError(f"{name} must be finite")
            object.__setattr__(self, name, state)

    @property
    def outputs(self) -> int:
        """How many output steps are made."""
        return max(1, round(self.duration / self.output_step))

    def until(self, done: int, substeps: int) -> int:
        """How many output steps are made before a motion that has ``done`` of them is looked at.

        Whatever its duration, so that a short motion is the beginning of a longer one.
        ``substeps`` make an output step.
        """
        most = min(max(_AT_ONCE, done // _AT_ONCE), max(1, _STEPS_AT_ONCE // substeps))
        return min(self.outputs, done + most)

    def checks(self, first: int, done: int) -> list[int]:
        """Up to which output steps its energy is held against that put in, from ``first`` on.

        A hundredth of all apart, and at ``done``: what is lost early is little of the whole.
        """
        apart = max(1, self.outputs // 100)
        return [*range(first + apart, done, apart), done]

    @property
    def from_rest(self) -> bool:
        """Whether nothing moves or is bent at t = 0."""
        return not (self.position.any() or self.velocity.any())

    @property
    def initial_speeds(self) -> Array:
        """(num_modes,) √(v² + ω² a²), the speed that each mode reaches from its initial state."""
        strained = np.maximum(self.system.omega2, 0.0) * self.position**2
        return np.asarray(np.sqrt(self.velocity**2 + strained))
