# SPDX-License-Identifier: LGPL-3.0-or-later
"""Products with blocks of vectors that are distributed by rows."""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from geometry.arrays import Array


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
