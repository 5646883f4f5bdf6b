# SPDX-License-Identifier: LGPL-3.0-or-later
"""Direct solver for K + σ M of a shell, and products with blocks of columns."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from protractile.geometry.arrays import Array
from protractile.shell_model.segment.shell import ShellMatrices


def dense(matrix: PETSc.Mat, block: Array) -> PETSc.Mat:
    """Return a block (num_owned, num_columns) as a dense matrix for products."""
    _, rows = matrix.getSizes()
    count = block.shape[1]
    columns = count if matrix.comm.rank == 0 else 0, count
    return PETSc.Mat().createDense((rows, columns), array=block.ravel("F"), comm=matrix.comm)


def times(matrix: PETSc.Mat, block: Array) -> Array:
    """Return the product (num_owned, num_columns) of a matrix and a block. Collective."""
    right = dense(matrix, block)
    left = matrix.matMult(right)
    product: Array = left.getDenseArray().copy(order="F")
    right.destroy()
    left.destroy()
    return product


def gram(comm: MPI.Comm, left: Array, right: Array) -> Array:
    """Return leftᵀ right (num_left, num_right), the same on every rank. Collective."""
    product = np.ascontiguousarray(left.T @ right)
    comm.Allreduce(MPI.IN_PLACE, product)
    return product


# Number of rows of a batch, whose products are in memory.
_AT_ONCE = 1 << 14

# Fraction of the sum of absolute terms below which a sum is round-off.
_CANCELLED = 1.0e-14


def exact_product(comm: MPI.Comm, left: Array, right: Array) -> Array:
    """Return leftᵀ right (num_columns,), bitwise equal for any number of ranks. Collective.

    ``left`` is (num_owned,), ``right`` (num_owned, num_columns). Sums have double the usual
    precision, so that their order has no effect.
    """
    rows = np.flatnonzero(left != 0.0)
    parts = [np.zeros((1, right.shape[1]))]
    rounding, size = np.zeros((2, right.shape[1]))
    for begin in range(0, rows.size, _AT_ONCE):
        some = rows[begin : begin + _AT_ONCE]
        terms = left[some, None] * right[some]
        part, off = _sum(terms)
        parts.append(part[None, :])
        rounding += off
        size += np.abs(terms).sum(axis=0)
    gathered = comm.allgather((np.concatenate(parts), rounding, size))
    total, off = _sum(np.concatenate([part for part, _, _ in gathered]))
    total += off + np.sum([rounding for _, rounding, _ in gathered], axis=0)
    # A sum that is only round-off is zero.
    total[np.abs(total) < _CANCELLED * np.sum([size for _, _, size in gathered], axis=0)] = 0.0
    return total


def _sum(terms: Array) -> tuple[Array, Array]:
    """Return the sums over the first axis, and their rounding errors (Knuth 1969)."""
    rounding = np.zeros(terms.shape[1:])
    while len(terms) > 1:
        half = len(terms) // 2
        a, b = terms[:half], terms[half : 2 * half]
        both = a + b
        of_b = both - a
        rounding += ((a - (both - of_b)) + (b - of_b)).sum(axis=0)
        terms = np.concatenate([both, terms[2 * half :]])
    return terms[0], rounding


# ICNTL(7) of MUMPS: approximate minimum fill. For a long and thin boom, this ordering has as little
# fill as nested dissection, and takes half the time. PETSc accepts it only as an option, since it
# loses values that are set before the analysis. The option is removed after use, since PETSc
# reports unused options at the end of a process.
_PREFIX, _ORDERING = "shifted_", "mat_mumps_icntl_7"


def squared(frequency: float) -> float:
    """Return ω² in rad²/s² of a frequency in Hz."""
    return float((2.0 * np.pi * frequency) ** 2)


class ShiftedSolver:
    """Direct solver for K + σ M with the shift σ = (2π f)² of a frequency f in Hz. Collective."""

    def __init__(self, shell: ShellMatrices, frequency: float) -> None:
        self.sigma = squared(frequency)
        self._matrix = shell.stiffness.copy()
        self._matrix.axpy(
            self.sigma,
            shell.mass,
            # Springs and point masses couple nodes that the plates do not couple.
            structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN,
        )
        # Sums of matrices with the same pattern take a tenth of the time.
        self._mass = self._matrix.duplicate()
        self._mass.axpy(1.0, shell.mass, structure=PETSc.Mat.Structure.SUBSET_NONZERO_PATTERN)
        self._matrix.setOption(PETSc.Mat.Option.SPD, True)
        self._factors = PETSc.PC().create(shell.comm)
        self._factors.setOptionsPrefix(_PREFIX)
        self._factors.setOperators(self._matrix)
        self._factors.setType(PETSc.PC.Type.CHOLESKY)
        self._factors.setFactorSolverType("mumps")
        options = PETSc.Options(_PREFIX)
        options[_ORDERING] = 2
        self._factors.setUp()
        options.delValue(_ORDERING)

    def move(self, frequency: float) -> None:
        """Factorise K + σ M at another frequency in Hz, with the same symbolic analysis."""
        sigma = squared(frequency)
        if sigma == self.sigma:
            return
        self._matrix.axpy(
            sigma - self.sigma,
            self._mass,
            structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN,
        )
        self.sigma = sigma
        self._factors.setOperators(self._matrix)
        self._factors.setUp()

    def __call__(self, block: Array) -> Array:
        """Return (K + σ M)⁻¹ ``block`` (num_owned, num_columns)."""
        if block.shape[1] == 0:
            return block
        right, left = dense(self._matrix, block), dense(self._matrix, np.empty_like(block))
        self._factors.getFactorMatrix().matSolve(right, left)
        solution: Array = left.getDenseArray().copy(order="F")
        right.destroy()
        left.destroy()
        return solution

    def destroy(self) -> None:
        """Free the memory of the factors."""
        for thing in (self._factors, self._matrix, self._mass):
            thing.destroy()
