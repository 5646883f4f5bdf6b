# SPDX-License-Identifier: LGPL-3.0-or-later
"""Products with blocks of vectors that are distributed by rows."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from geometry.arrays import Array

# Rows whose products are in memory at once.
_AT_ONCE = 1 << 14

# Part of the sizes of its terms below which a sum is round-off.
_CANCELLED = 1.0e-14


def dense(matrix: PETSc.Mat, block: Array) -> PETSc.Mat:
    """A block (num_owned, num_columns) as a matrix that another one is multiplied with."""
    _, rows = matrix.getSizes()
    count = block.shape[1]
    columns = count if matrix.comm.rank == 0 else 0, count
    return PETSc.Mat().createDense((rows, columns), array=block.ravel("F"), comm=matrix.comm)


def times(matrix: PETSc.Mat, block: Array) -> Array:
    """(num_owned, num_columns) matrix times block. Collective."""
    right = dense(matrix, block)
    left = matrix.matMult(right)
    product: Array = left.getDenseArray().copy(order="F")
    right.destroy()
    left.destroy()
    return product


def quadratic_form(matrix: PETSc.Mat, vector: Array) -> float:
    """uᵀ A u of a vector (num_owned,): twice an energy in J, say. Collective."""
    right, left = matrix.createVecs()
    right.array[:] = vector
    matrix.mult(right, left)
    form = float(right.dot(left))
    right.destroy()
    left.destroy()
    return form


def gram(comm: MPI.Comm, left: Array, right: Array) -> Array:
    """(num_left, num_right) products of all columns, the same on every rank. Collective."""
    product = np.ascontiguousarray(left.T @ right)
    comm.Allreduce(MPI.IN_PLACE, product)
    return product


def exact_product(comm: MPI.Comm, left: Array, right: Array) -> Array:
    """(num_columns,) products with all columns, to the same bit on any number of ranks. Collective.

    Sums are carried with twice the digits, so that their order does not show.

    Args:
        comm: the ranks that share the rows.
        left: (num_owned,).
        right: (num_owned, num_columns).
    """
    rows = np.flatnonzero(left)
    parts = [np.zeros((1, right.shape[1]))]
    lost, size = np.zeros((2, right.shape[1]))
    for begin in range(0, rows.size, _AT_ONCE):
        some = rows[begin : begin + _AT_ONCE]
        terms = left[some, None] * right[some]
        part, off = _sum(terms)
        parts.append(part[None, :])
        lost += off
        size += np.abs(terms).sum(axis=0)
    gathered = comm.allgather((np.concatenate(parts), lost, size))
    total, off = _sum(np.concatenate([part for part, _, _ in gathered]))
    total += off + np.sum([lost for _, lost, _ in gathered], axis=0)
    # What cancels but for the last bits of its terms is zero.
    total[np.abs(total) < _CANCELLED * np.sum([size for _, _, size in gathered], axis=0)] = 0.0
    return total


def _sum(terms: Array) -> tuple[Array, Array]:
    """Sums over the first axis and what is lost in them by rounding (Knuth 1969)."""
    lost = np.zeros(terms.shape[1:])
    while len(terms) > 1:
        half = len(terms) // 2
        a, b = terms[:half], terms[half : 2 * half]
        both = a + b
        of_b = both - a
        lost += ((a - (both - of_b)) + (b - of_b)).sum(axis=0)
        terms = np.concatenate([both, terms[2 * half :]])
    return terms[0], lost
