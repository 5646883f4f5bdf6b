# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of the unreduced shells, the reference for the reduction.

Each segment is integrated by the generalised-α method; its matrix is factorised once. A step has
three parts: a back-substitution for each segment without contact and friction; a small problem with
constant compliance for the forces of contacts and frictions; and the displacements by these forces.
Forces act at the time at which the method satisfies equilibrium. Friction opposes the displacement
over the whole step, and sticking rows do not move, except for round-off.

The generalised-α method (Chung and Hulbert 1993) is

    M a_{n+1−αm} + K d_{n+1−αf} = q − Rᵀ p,    d_{n+1} = d_n + h v_n + h² [(½ − β) a_n + β a_{n+1}],
    v_{n+1} = v_n + h [(1 − γ) a_n + γ a_{n+1}]

with the forces p of contact and friction on the rows R. For the unknown d* = d_{n+1−αf} it is

    (K + σ M) d* = q − Rᵀ p + M (σ x − αm a_n),    σ = (1 − αm)/c,    c = (1 − αf) β h²

where x is d* for a_{n+1} = 0. The matrix is the same in every step.

The energy residual includes the algorithmic dissipation and the error of steps in which a contact
opens or closes. Any number of ranks may share the shells.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy.sparse
from petsc4py import PETSc

from protractile.dynamics.energy import ENERGIES, check_energy, energy_residual
from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array
from protractile.geometry.boom import BoomError
from protractile.shell_model.boom_shell import BoomShell
from protractile.shell_model.segment.cross_section import Operator, Row
from protractile.shell_model.segment.segment_shell import SegmentShell
from protractile.shell_model.segment.solver import ShiftedSolver, gram
from studies.reference_models.resisting_rows import ResistingRows

# Relative residual of the accelerations at the start.
_START = 1.0e-12


class GeneralisedAlpha(NamedTuple):
    """Parameters of one step, (17) and (25) of Chung and Hulbert (1993).

    For ρ∞ = 1 the method is the midpoint rule, which conserves energy.
    """

    step: float  #: h in s
    radius: float  #: ρ∞, amplitude ratio of the fastest modes per step, from 0 to 1

    @property
    def mass_shift(self) -> float:
        """Parameter αm."""
        return (2.0 * self.radius - 1.0) / (self.radius + 1.0)

    @property
    def force_shift(self) -> float:
        """Parameter αf."""
        return self.radius / (self.radius + 1.0)

    @property
    def gamma(self) -> float:
        """Parameter γ, for second-order accuracy."""
        return 0.5 - self.mass_shift + self.force_shift

    @property
    def beta(self) -> float:
        """Parameter β, for large dissipation of fast modes and small dissipation of slow modes."""
        return 0.25 * (1.0 - self.mass_shift + self.force_shift) ** 2

    @property
    def reach(self) -> float:
        """Factor c in s² of the acceleration a_{n+1} in d*."""
        return (1.0 - self.force_shift) * self.beta * self.step**2

    @property
    def shift(self) -> float:
        """Shift σ in 1/s²."""
        return (1.0 - self.mass_shift) / self.reach


class SegmentStepper:
    """Stepper of one segment from rest. Collective; PETSc objects live until ``destroy``.

    Args:
        shell: the segment.
        load: (num_owned,) constant load in N.
        rows: (num_rows, num_owned) this rank's part of the rows that forces act on.
        alpha: the time integration scheme.

    Attributes:
        compliance: (num_rows, num_rows) R (K + σ M)⁻¹ Rᵀ in m/N, the same on every rank.
    """

    def __init__(
        self,
        shell: SegmentShell,
        load: Array,
        rows: scipy.sparse.csr_matrix,
        alpha: GeneralisedAlpha,
    ) -> None:
        self._shell, self._alpha, self._rows = shell, alpha, rows
        self._effective = ShiftedSolver(shell, np.sqrt(alpha.shift) / (2.0 * np.pi))
        self._columns = self._effective(np.asfortranarray(rows.T.toarray()))
        self.compliance = gram(shell.comm, rows.T.toarray(), self._columns)
        self._load, self._scratch = shell.mass.createVecs()
        self._load.array[:] = load
        # d, v and a of the previous step; x and d* of the current one.
        self._d, self._v, self._a, self._x, self._star = (self._load.duplicate() for _ in range(5))
        for vector in (self._d, self._v):
            vector.set(0.0)
        self._start()

    def free_response(self) -> None:
        """Solve for d* without forces on rows, the only solution of a large system in a step."""
        alpha, h = self._alpha, self._alpha.step
        part = (1.0 - alpha.force_shift) * h
        self._d.copy(self._x)
        self._x.axpy(part, self._v)
        self._x.axpy(part * h * (0.5 - alpha.beta), self._a)
        self._x.copy(self._star)
        self._star.axpby(-alpha.mass_shift, alpha.shift, self._a)
        self._shell.mass.multAdd(self._star, self._load, self._scratch)
        self._star.array[:] = self._effective(self._scratch.array[:, None])[:, 0]

    def read(self) -> Array:
        """Return this rank's part (num_rows,) of the row displacements of d* in m."""
        return np.asarray(self._rows @ self._star.array)

    def push(self, forces: Array) -> None:
        """Complete the step under the forces (num_rows,) in N of the rows."""
        alpha, h = self._alpha, self._alpha.step
        self._star.array[:] -= self._columns @ forces
        self._v.axpy(h * (1.0 - alpha.gamma), self._a)
        self._a.waxpy(-1.0, self._x, self._star)
        self._a.scale(1.0 / alpha.reach)
        self._v.axpy(h * alpha.gamma, self._a)
        onward = 1.0 / (1.0 - alpha.force_shift)
        self._d.axpby(onward, 1.0 - onward, self._star)

    def displacement(self) -> Array:
        """Return d (num_owned,) in m."""
        return np.asarray(self._d.array)

    def energies(self) -> tuple[float, float, float]:
        """Return kinetic energy, strain energy and work of the load so far, in J. Collective."""
        self._shell.mass.mult(self._v, self._scratch)
        kinetic = 0.5 * float(self._v.dot(self._scratch))
        self._shell.stiffness.mult(self._d, self._scratch)
        strain = 0.5 * float(self._d.dot(self._scratch))
        return kinetic, strain, float(self._load.dot(self._d))

    def destroy(self) -> None:
        """Free PETSc's memory."""
        vectors = self._load, self._scratch, self._d, self._v, self._a, self._x, self._star
        for thing in (self._effective, *vectors):
            thing.destroy()

    def _start(self) -> None:
        """Solve M a_0 = q for a_0. The mass matrix is well conditioned after diagonal scaling."""
        solver = PETSc.KSP().create(self._shell.comm)
        solver.setOperators(self._shell.mass)
        solver.setType(PETSc.KSP.Type.CG)
        solver.getPC().setType(PETSc.PC.Type.JACOBI)
        solver.setTolerances(rtol=_START)
        solver.solve(self._load, self._a)
        converged = solver.getConvergedReason() > 0
        solver.destroy()
        if not converged:
            raise NumericsError("the accelerations at the start are not found; refine the mesh")


RADIUS = 0.8

# Largest energy residual of a valid result; with long steps the method dissipates energy.
LOSS_BOUND = 1.0e-2

# Number of checks of the energies during a motion.
_CHECKS = 20


class DirectMotion(NamedTuple):
    """Motion of the unreduced shells.

    Forces are means over the output interval that ends at the time. They are positive if the inner
    segment presses upwards, and if friction pushes it along its row.
    """

    time: Array  #: (num_times,) in s
    observed: Mapping[str, Array]  #: outputs (num_times,) by name
    contact_forces: Array  #: (num_times, num_contacts) in N
    friction_forces: Array  #: (num_times, num_frictions) in N
    slides: Array  #: displacements (num_times, num_frictions) of the friction rows in m
    energies: Array  #: (num_times, 7), the columns of ``ENERGIES`` in J
    step: float  #: step in s

    @property
    def energy_residual(self) -> float:
        """Largest error of the energy balance, as a fraction of the input energy."""
        return float(np.abs(energy_residual(self.energies)).max())


def integrate_directly(
    full: BoomShell,
    duration: float,
    step: float,
    output_step: float = 1.0e-3,
    radius: float = RADIUS,
    energy_bound: float = LOSS_BOUND,
) -> DirectMotion:
    """Return the motion of the unreduced shells from rest. Collective.

    Args:
        full: a flat boom with constant loads and prescribed normal forces.
        duration: duration in s; it is rounded to a whole number of output steps, at least one.
        step: step in s; it is reduced so that the output step is a multiple.
        output_step: output step in s.
        radius: ρ∞, see :class:`GeneralisedAlpha`.
        energy_bound: largest permitted energy residual.

    Raises:
        BoomError: the direct integration does not support a feature of the boom.
        NumericsError: forces do not converge, numbers are not finite, or the energy residual
            exceeds its bound.
    """
    _check(full)
    outputs = max(1, round(duration / output_step))
    substeps = max(1, int(np.ceil(output_step / step * (1.0 - 1e-12))))
    alpha = GeneralisedAlpha(output_step / substeps, radius)
    steppers = [
        SegmentStepper(shell, load, _rows(full.joint_operators, number, shell), alpha)
        for number, (shell, load) in enumerate(zip(full.shells, full.own_loads, strict=True))
    ]
    try:
        return _march(full, alpha, steppers, outputs, substeps, energy_bound)
    finally:
        for stepper in steppers:
            stepper.destroy()


def _check(full: BoomShell) -> None:
    if full.touching.boom.spatial or full.loads or full.ties:
        raise BoomError(
            "joint",
            "the unreduced shell moves in the plane, under constant loads, without bonded joints",
        )
    if any(contact.law.damping > 0.0 for contact in full.rows.contacts):
        raise BoomError("joint", "the unreduced shell takes contacts without damping")
    if full.rows.dashpots:
        raise BoomError("joint", "the unreduced shell takes joints without dashpots")
    if any(shell.segment.compression for shell in full.shells):
        raise BoomError("axial", "the unreduced shell takes no axial forces")
    if full.lines:
        raise BoomError("cylinder", "the unreduced shell takes neither cylinders nor dashpots")
    if any(friction.law.normal_rows for friction in full.rows.frictions):
        raise BoomError("joint", "the unreduced shell takes friction under normal_forces alone")


def _march(
    full: BoomShell,
    alpha: GeneralisedAlpha,
    steppers: Sequence[SegmentStepper],
    outputs: int,
    substeps: int,
    energy_bound: float,
) -> DirectMotion:
    """Return the motion of all outputs, with ``substeps`` steps for each."""
    rows = ResistingRows(
        [contact.law for contact in full.rows.contacts],
        [friction.law for friction in full.rows.frictions],
        np.sum([stepper.compliance for stepper in steppers], axis=0),
        1.0 / (1.0 - alpha.force_shift),
    )
    operators = [seen.operator for seen in full.observed.values()]
    observers = [_rows(operators, number, shell) for number, shell in enumerate(full.shells)]
    contacts = len(full.rows.contacts)
    observed = np.zeros((outputs + 1, len(operators)))
    means = np.zeros((outputs + 1, contacts + len(full.rows.frictions)))
    slides = np.zeros((outputs + 1, len(full.rows.frictions)))
    energies = np.zeros((outputs + 1, len(ENERGIES)))
    energies[0, 2] = rows.contact_energy
    for k in range(1, outputs + 1):
        for _ in range(substeps):
            for stepper in steppers:
                stepper.free_response()
            read = np.sum([stepper.read() for stepper in steppers], axis=0)
            forces = rows.forces(full.comm.allreduce(read))
            for stepper in steppers:
                stepper.push(forces)
            means[k] += forces / substeps
        parts = zip(observers, steppers, strict=True)
        seen = np.sum([row @ stepper.displacement() for row, stepper in parts], axis=0)
        observed[k] = full.comm.allreduce(seen)
        slides[k] = rows.displacements[contacts:]
        energies[k, [0, 1, 3]] = np.sum([stepper.energies() for stepper in steppers], axis=0)
        energies[k, [2, 5]] = rows.contact_energy, rows.friction_loss
        if k == outputs or k % max(1, outputs // _CHECKS) == 0:
            check_energy(energies[: k + 1], energy_bound)
    return DirectMotion(
        time=substeps * alpha.step * np.arange(outputs + 1),
        observed=dict(zip(full.observed, observed.T, strict=True)),
        contact_forces=means[:, :contacts],
        friction_forces=-means[:, contacts:],
        slides=slides,
        energies=energies,
        step=alpha.step,
    )


def _rows(
    operators: Sequence[Operator], number: int, shell: SegmentShell
) -> scipy.sparse.csr_matrix:
    """Return this rank's part (num_rows, num_owned) of the displacement rows of a segment."""
    parts = [shell.row(operator.get(number, Row())) for operator in operators]
    return scipy.sparse.csr_matrix(np.array(parts).reshape(-1, shell.free.size))
