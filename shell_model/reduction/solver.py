# SPDX-License-Identifier: LGPL-3.0-or-later
"""Solves with K + σ M."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc

from shell_model.segment_shell import Shell

Array = npt.NDArray[np.float64]

# MUMPS's ICNTL(7). A boom is long and thin: this ordering leaves as little fill as those that cut
# it into parts, and is found in half the time.
_ORDERING, _APPROXIMATE_MINIMUM_FILL = 7, 2


class ShiftedSolver:
    """(K + σ M)⁻¹ with σ = (2π frequency)², factorised for one frequency (Hz) after another.

    Collective.
    """

    def __init__(self, shell: Shell, frequency: float) -> None:
        self._mass = shell.mass
        self.sigma = (2.0 * np.pi * frequency) ** 2
        self._matrix = shell.stiffness.copy()
        self._matrix.axpy(
            self.sigma,
            shell.mass,
            # Springs and point masses couple nodes that the shell does not.
            structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN,
        )
        self._matrix.setOption(PETSc.Mat.Option.SPD, True)
        self._solver = PETSc.KSP().create(shell.comm)
        self._solver.setOperators(self._matrix)
        self._solver.setType(PETSc.KSP.Type.PREONLY)
        factor = self._solver.getPC()
        factor.setType(PETSc.PC.Type.CHOLESKY)
        factor.setFactorSolverType("mumps")
        factor.setFactorSetUpSolverType()
        factor.getFactorMatrix().setMumpsIcntl(_ORDERING, _APPROXIMATE_MINIMUM_FILL)
        self._solver.setUp()
        self._right, self._left = self._matrix.createVecs()

    def move(self, frequency: float) -> None:
        """Go to another frequency; what was analysed of the matrix's structure is kept."""
        sigma = (2.0 * np.pi * frequency) ** 2
        if sigma == self.sigma:
            return
        self._matrix.axpy(
            sigma - self.sigma,
            self._mass,
            structure=PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN,
        )
        self.sigma = sigma
        self._solver.setOperators(self._matrix)
        self._solver.setUp()

    def __call__(self, block: Array) -> Array:
        """(num_owned, num_columns) the solutions for a block."""
        solution = np.empty_like(block)
        for column in range(block.shape[1]):
            self._right.array[:] = block[:, column]
            self._solver.solve(self._right, self._left)
            solution[:, column] = self._left.array
        return solution

    def destroy(self) -> None:
        """Give the memory of the factors back."""
        for thing in (self._right, self._left, self._solver, self._matrix):
            thing.destroy()
