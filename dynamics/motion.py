# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is to be computed: a system, where it starts from, for how long."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from dynamics.arrays import Array
from dynamics.gap_system import GapSystem

# Steps of a motion at the default tolerance at most: chaotic motion has no step that keeps it.
MOST_STEPS = 250_000


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

    @property
    def from_rest(self) -> bool:
        """Whether nothing moves or is bent at t = 0."""
        return not (self.position.any() or self.velocity.any())
