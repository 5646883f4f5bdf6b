# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motions: a gap system with initial state, duration and output step."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from numbers import Real

import numpy as np

from protractile.dynamics.arrays import Array, is_finite
from protractile.dynamics.damping import with_modal_damping
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem

# Maximum number of steps at the default tolerance. In chaotic motion, no step meets a tolerance.
MOST_STEPS = 250_000

# Maximum number of outputs.
MOST_OUTPUTS = 10_000_000


@dataclass(frozen=True, slots=True)
class Motion:
    """Motion of a gap system from its initial state, the input of every integrator.

    >>> motion = Motion(ball, duration=1.0, position=[0.5])
    >>> motion.outputs, motion.from_rest
    (1000, False)

    Args:
        system: the system that moves.
        duration: duration in s; it is rounded to a whole number of output steps, at least one.
        output_step: output step in s.
        position: initial a (num_modes,) in √kg·m, zero unless given.
        velocity: initial ȧ (num_modes,) in √kg·m/s, zero unless given.

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
            time = getattr(self, name)
            if not (is_finite(time) and time > 0.0):
                raise ValueError(f"{name} must be finite and positive, got {time!r} s")
        if self.duration > MOST_OUTPUTS * self.output_step:
            raise ValueError(
                f"{self.duration / self.output_step:.3g} outputs are too many, at most "
                f"{MOST_OUTPUTS} are stored; give a shorter duration or a longer output_step"
            )
        if self.system.geometric_stiffness.size:
            raise ValueError(
                "a system with geometric_stiffness must be transformed by in_own_modes"
            )
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
        """The number of output steps."""
        return max(1, round(self.duration / self.output_step))

    @property
    def from_rest(self) -> bool:
        """True if velocities and deformations are zero at t = 0."""
        return not (self.position.any() or self.velocity.any())


def build_motion(
    system: GapSystem,
    duration: float,
    output_step: float,
    at_rest: bool,
    damping_ratio: float = 0.0,
    rayleigh: tuple[float, float] = (0.0, 0.0),
) -> Motion:
    """Return the motion of a boom's system under its loads from t = 0 on.

    Args:
        system: system of the boom with all loads, including those that end at t = 0.
        duration, output_step: duration and output step of the motion in s.
        at_rest: True if the boom starts in equilibrium with the loads at t = 0, False if it starts
            straight and unloaded.
        damping_ratio: damping ratio ζ of the boom's modes with closed contacts.
        rayleigh: mass-proportional factor in 1/s, and stiffness-proportional factor in s.

    Raises:
        NumericsError: there is no static equilibrium to start from.
        ValueError: an argument is not of its range.
    """
    if at_rest not in (True, False):
        raise ValueError(f"at_rest must be True or False, got {at_rest!r}")
    if not (isinstance(damping_ratio, Real) and 0.0 <= damping_ratio < 1.0):
        raise ValueError(f"damping_ratio must be at least 0 and below 1, got {damping_ratio!r}")
    system, position, velocity = initial_state(system, at_rest)
    rest = constant_load_equilibrium(system, at_rest, position)
    # Rayleigh and modal damping are added to the damping of the segments.
    rates = system.damping + rayleigh[0] + rayleigh[1] * np.maximum(system.omega2, 0.0)
    system = replace(system, damping=rates)
    if damping_ratio:
        system = with_modal_damping(system, damping_ratio, rest)
    return Motion(system, duration, output_step, position, velocity)


def initial_state(system: GapSystem, at_rest: bool) -> tuple[GapSystem, Array, Array]:
    """Return the system from t = 0 on, the initial a in √kg·m and ȧ in √kg·m/s, (num_modes,) each.

    Arguments and errors as in :func:`build_motion`.
    """
    system = system.gather_loads()
    held = _load_before_start(system, at_rest)
    # The boom starts straight even if shims press.
    straight = not at_rest and not held.any()
    position = np.zeros(system.num_modes) if straight else equilibrium(system, held)
    return system, position, system.initial_impulse


def constant_load_equilibrium(system: GapSystem, at_rest: bool, position: Array) -> Array | None:
    """Return the initial a (num_modes,) if it is the equilibrium under constant loads."""
    return (
        position if at_rest and (_load_before_start(system, at_rest) == system.load).all() else None
    )


def _load_before_start(system: GapSystem, at_rest: bool) -> Array:
    """Return the load (num_modes,) in N/√kg that acts before t = 0."""
    return system.load_at(0.0) if at_rest else system.released_load
