# SPDX-License-Identifier: LGPL-3.0-or-later
"""Step-by-step integration of modal equations by schemes of the 1990s.

Newmark's average acceleration (1959), Wilson's θ (1973) and central differences are one family
(Hilber and Hughes 1978). The equation of motion holds θ steps ahead, and the acceleration is linear
up to this time. Contact and friction forces are modal loads. They have the values of the previous
step (lagged), or they are iterated until they agree with the end of the step. The energy is not
checked.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numba import njit

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import Terms, contact_terms
from protractile.dynamics.energy import ENERGIES
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.kernels.compiled import LOOP
from protractile.dynamics.kernels.row_forces import contact_energy, term_force, term_slope
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Output, Trajectory

# Maximum numbers of iterations in a step: of gaps with friction, and of gaps alone.
ROUNDS, NEWTON = 8, 30
# Tolerance of penetrations in m.
TOLERANCE = 1.0e-13
# Modal coordinates in √kg·m above which a motion counts as divergent.
DIVERGED = 1.0e5


class Scheme(NamedTuple):
    """Parameters of a scheme of the family."""

    name: str  #: name in the literature
    beta: float  #: Newmark's parameter β of the displacement (1959); γ is ½
    theta: float = 1.0  #: time, in steps, at which the equation of motion holds


NEWMARK = Scheme("Newmark", 0.25)
WILSON = Scheme("Wilson θ = 1.4", 1.0 / 6.0, 1.4)
CENTRAL = Scheme("central differences", 0.0)


class SchemeRun(NamedTuple):
    """Motion by one of these schemes."""

    trajectory: Trajectory  #: an output for each step, NaN after the last finite one
    finite_steps: int  #: steps until the motion is not finite
    #: (num_steps,) steps without convergence of friction and gaps.
    unconverged: Array


def lowest(system: GapSystem, modes: int) -> GapSystem:
    """Return the system with only its lowest modes, as in the modal technique."""
    kept = np.argsort(system.omega2, kind="stable")[:modes]
    return replace(
        system,
        omega2=system.omega2[kept],
        load=system.load[kept],
        rows=system.rows[:, kept],
        friction_rows=system.friction_rows[:, kept],
        observers={name: o._replace(row=o.row[kept]) for name, o in system.observers.items()},
        **{
            name: getattr(system, name)[kept]
            for name in ("damping", "released_load", "initial_impulse")
        },
        dashpots=system.dashpots[:, kept],
    )


def integrate(motion: Motion, scheme: Scheme, iterated: bool) -> SchemeRun:
    """Integrate a system under constant loads without damping, in one step for each output.

    Iterated forces are those at the end of the step, others those of the previous step.
    """
    system = motion.system
    n, h = motion.outputs, motion.output_step
    states, speeds = np.full((2, n + 1, system.num_modes), np.nan)
    losses, unconverged = np.zeros(n + 1), np.zeros(n, dtype=bool)
    states[0], speeds[0] = motion.position, motion.velocity
    terms = contact_terms(system.laws)
    drag = np.array([f.coefficient * f.normal_force for f in system.frictions])
    rows, slides = (np.ascontiguousarray(part) for part in (system.rows, system.friction_rows))
    arrays = system.omega2, system.load, rows, terms, slides, drag
    finite_steps = _fill_motion(
        arrays, h, scheme.beta, scheme.theta, iterated, states, speeds, losses, unconverged
    )
    gaps = states @ system.rows.T
    forces, energies = np.zeros(gaps.shape), np.zeros((n + 1, len(ENERGIES)))
    _fill_contact(gaps[: finite_steps + 1], terms, forces, energies[:, 2])
    energies[:, 0] = 0.5 * (speeds**2).sum(axis=1)
    energies[:, 1] = 0.5 * states**2 @ system.omega2
    energies[:, 3] = (states - states[0]) @ system.load
    energies[:, 5] = losses
    pressed = forces != 0.0
    frictional = -np.sign(speeds @ system.friction_rows.T) * drag
    trajectory = Trajectory.record(
        system,
        h * np.arange(n + 1),
        Output(
            states, speeds, energies, gaps, forces, np.abs(forces), frictional, np.zeros((n + 1, 0))
        ),
        {
            "step": h,
            "steps": finite_steps,
            "first_contact": h * int(np.argmax(pressed.any(axis=1))) if pressed.any() else np.nan,
            "contact_changes": int(np.count_nonzero(np.diff(pressed, axis=0))),
        },
    )
    return SchemeRun(trajectory, finite_steps, unconverged)


@njit(**LOOP)
def contact_forces(y: Array, terms: Terms, force: Array) -> None:
    """Set ``force`` (num_rows,) in N to the elastic forces at the gaps y (num_rows,) in m."""
    force[:] = 0.0
    for t in range(terms.size):
        force[terms[t]["row"]] += term_force(terms[t], y[terms[t]["row"]])


@njit(**LOOP)
def _fill_contact(gaps: Array, terms: Terms, forces: Array, energy: Array) -> None:
    """Store contact and friction forces of a run at gaps (num_times, num_rows)."""
    for k in range(len(gaps)):
        contact_forces(gaps[k], terms, forces[k])
        energy[k] = contact_energy(gaps[k], terms)


@njit(**LOOP)
def _solve_gaps(free: Array, cross: Array, terms: Terms, y: Array, force: Array) -> bool:
    """Solve y + ``cross`` F(y) = ``free`` for gaps (num_rows,) by Newton's method."""
    for _ in range(NEWTON):
        contact_forces(y, terms, force)
        excess = y + cross @ force - free
        if (excess**2).sum() < TOLERANCE**2:
            return True
        slopes = np.eye(y.size)
        for t in range(terms.size):
            j = terms[t]["row"]
            slopes[:, j] += cross[:, j] * term_slope(terms[t], y[j])
        y -= np.linalg.solve(slopes, excess)
    contact_forces(y, terms, force)
    return False


@njit(**LOOP)
def _fill_motion(
    system: tuple[Array, Array, Array, Terms, Array, Array],
    h: float,
    beta: float,
    theta: float,
    iterated: bool,
    states: Array,
    speeds: Array,
    losses: Array,
    unconverged: Array,
) -> int:
    """Store states, velocities and friction losses of a run; return the number of finite steps."""
    omega2, load, rows, terms, slides, drag = system
    tau = theta * h
    reach = beta * tau**2
    give = 1.0 / (1.0 + omega2 * reach)
    cross = (reach * rows * give) @ rows.T
    a, v = states[0], speeds[0]
    y, force = rows @ a, np.zeros(rows.shape[0])
    contact_forces(y, terms, force)
    sign = np.sign(slides @ v)
    acceleration = load - omega2 * a - force @ rows - (drag * sign) @ slides
    for k in range(unconverged.size):
        ahead = a + tau * v + (0.5 * tau**2 - reach) * acceleration
        if not iterated:
            contact_forces(rows @ a, terms, force)
            sign = np.sign(slides @ v)
        for _ in range(ROUNDS):
            pushed = load - omega2 * ahead - (drag * sign) @ slides
            converged = not iterated or _solve_gaps(
                rows @ (ahead + reach * give * pushed), cross, terms, y, force
            )
            there = give * (pushed - force @ rows)
            after = acceleration + (there - acceleration) / theta
            v1 = v + 0.5 * h * (acceleration + after)
            before, sign = sign, np.sign(slides @ v1)
            if not iterated or (converged and np.array_equal(before, sign)):
                break
        else:
            unconverged[k] = True
        a = a + h * v + h**2 * ((0.5 - beta) * acceleration + beta * after)
        if not np.abs(a).max() < DIVERGED:
            return k
        losses[k + 1] = losses[k] + 0.5 * h * (drag * before) @ (slides @ (v + v1))
        v, acceleration = v1, after
        states[k + 1], speeds[k + 1] = a, v
    return int(unconverged.size)
