# SPDX-License-Identifier: LGPL-3.0-or-later
"""Products with blocks of vectors that are distributed by rows."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

Array = npt.NDArray[np.float64]


def times(matrix: PETSc.Mat, block: Array) -> Array:
    """(num_owned, num_columns) matrix times block. Collective."""
    right, left = matrix.createVecs()
    product = np.empty_like(block)
    for column in range(block.shape[1]):
        right.array[:] = block[:, column]
        matrix.mult(right, left)
        product[:, column] = left.array
    right.destroy()
    left.destroy()
    return product


def gram(comm: MPI.Comm, left: Array, right: Array) -> Array:
    """(num_left, num_right) products of all columns, the same on every rank. Collective."""
    product = np.ascontiguousarray(left.T @ right)
    comm.Allreduce(MPI.IN_PLACE, product)
    return product
