# SPDX-License-Identifier: LGPL-3.0-or-later
"""The generalised-α method of Chung and Hulbert (1993), on one segment of unreduced shell.

    M a_{n+1−αm} + K d_{n+1−αf} = q − Rᵀ p,    d_{n+1} = d_n + h v_n + h² [(½ − β) a_n + β a_{n+1}],
    v_{n+1} = v_n + h [(1 − γ) a_n + γ a_{n+1}]

with the forces p of contact and friction on the rows R. In the unknown d* = d_{n+1−αf} it reads

    (K + σ M) d* = q − Rᵀ p + M (σ x − αm a_n),    σ = (1 − αm)/c,    c = (1 − αf) β h²

where x is what d* would be if a_{n+1} were nothing. The matrix is the same in every step.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse
from petsc4py import PETSc

from dynamics.failure import NumericsError
from geometry.arrays import Array
from shell_model.segment.segment_shell import SegmentShell
from shell_model.segment.solver import ShiftedSolver, gram

# Relative residual of the accelerations at the start.
_START = 1.0e-12


@dataclass(frozen=True, slots=True)
class GeneralisedAlpha:
    """The parameters of one step, (17) and (25) of Chung and Hulbert (1993).

    Args:
        step: h in s, positive.
        radius: ρ∞, what a step leaves of the fastest modes, from 0 to 1. At 1 it is the midpoint
            rule, which keeps the energy.

    Raises:
        ValueError: an argument is out of its range.
    """

    step: float
    radius: float

    def __post_init__(self) -> None:
        if not 0.0 < self.step < np.inf:
            raise ValueError(f"step must be finite and positive, got {self.step} s")
        if not 0.0 <= self.radius <= 1.0:
            raise ValueError(f"radius must be from 0 to 1, got {self.radius}")

    @property
    def mass_shift(self) -> float:
        """αm."""
        return (2.0 * self.radius - 1.0) / (self.radius + 1.0)

    @property
    def force_shift(self) -> float:
        """αf."""
        return self.radius / (self.radius + 1.0)

    @property
    def gamma(self) -> float:
        """γ, with which the method is of second order."""
        return 0.5 - self.mass_shift + self.force_shift

    @property
    def beta(self) -> float:
        """β, with which it takes most from the fastest modes and least from the slow ones."""
        return 0.25 * (1.0 - self.mass_shift + self.force_shift) ** 2

    @property
    def reach(self) -> float:
        """c in s²: what an acceleration a_{n+1} adds to d*."""
        return (1.0 - self.force_shift) * self.beta * self.step**2

    @property
    def shift(self) -> float:
        """σ in 1/s²."""
        return (1.0 - self.mass_shift) / self.reach


class SegmentStepper:
    """One segment on its way, from rest. Collective; its PETSc objects live until ``destroy``.

    Args:
        shell: the segment.
        load: (num_owned,) constant load in N.
        rows: (num_rows, num_owned) this rank's part of the rows that forces act on.
        alpha: the step.

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
        # d, v, a of the last step; x and d* of this one.
        self._d, self._v, self._a, self._x, self._star = (self._load.duplicate() for _ in range(5))
        for vector in (self._d, self._v):
            vector.set(0.0)
        self._start()

    def free_response(self) -> None:
        """d* if no row pushed: the only solution of a large system in a step."""
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
        """(num_rows,) this rank's part of what the rows read of d*, in m."""
        return np.asarray(self._rows @ self._star.array)

    def push(self, forces: Array) -> None:
        """End the step under the forces (num_rows,) in N with which the rows resist."""
        alpha, h = self._alpha, self._alpha.step
        self._star.array[:] -= self._columns @ forces
        self._v.axpy(h * (1.0 - alpha.gamma), self._a)
        self._a.waxpy(-1.0, self._x, self._star)
        self._a.scale(1.0 / alpha.reach)
        self._v.axpy(h * alpha.gamma, self._a)
        onward = 1.0 / (1.0 - alpha.force_shift)
        self._d.axpby(onward, 1.0 - onward, self._star)

    def displacement(self) -> Array:
        """(num_owned,) d in m."""
        return np.asarray(self._d.array)

    def energies(self) -> tuple[float, float, float]:
        """Kinetic energy, strain energy and the work of the load so far, in J. Collective."""
        self._shell.mass.mult(self._v, self._scratch)
        kinetic = 0.5 * float(self._v.dot(self._scratch))
        self._shell.stiffness.mult(self._d, self._scratch)
        strain = 0.5 * float(self._d.dot(self._scratch))
        return kinetic, strain, float(self._load.dot(self._d))

    def destroy(self) -> None:
        """Give back PETSc's memory."""
        vectors = self._load, self._scratch, self._d, self._v, self._a, self._x, self._star
        for thing in (self._effective, *vectors):
            thing.destroy()

    def _start(self) -> None:
        """a_0 from M a_0 = q. The mass matrix is well conditioned once scaled by its diagonal."""
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
