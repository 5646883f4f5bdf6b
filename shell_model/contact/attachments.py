# SPDX-License-Identifier: LGPL-3.0-or-later
"""Springs and masses that act on a reading of the section, such as its mean deflection.

With the row r of the reading, a spring k adds k r rᵀ to the stiffness: its force is spread as r
reads, and every other motion of the section stays as free as it was.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from geometry.arrays import Array


class Attached(NamedTuple):
    """Springs, or masses, and what they act on.

    Args:
        rows: (num_owned, num_attached) this rank's part of what each reads.
        factors: (num_attached,) stiffness in N/m or N·m, or mass in kg.
    """

    rows: Array
    factors: Array

    @classmethod
    def of(cls, rows: Sequence[Array], factors: Sequence[float], num_owned: int) -> Attached:
        """One column for each of the rows (num_owned,)."""
        return cls(np.array(rows).reshape(-1, num_owned).T, np.array(factors, dtype=np.float64))

    def add_to(self, comm: MPI.Comm, matrix: PETSc.Mat) -> None:
        """Add factor · r rᵀ of each to a matrix that is distributed by rows. Collective."""
        for row, factor in zip(self.rows.T, self.factors, strict=True):
            _add_outer_product(comm, matrix, row, float(factor))


def _add_outer_product(comm: MPI.Comm, matrix: PETSc.Mat, local: Array, factor: float) -> None:
    first, _ = matrix.getOwnershipRange()
    mine = np.flatnonzero(local)
    columns = np.concatenate(comm.allgather(mine + first))
    values = np.concatenate(comm.allgather(local[mine]))
    counts = np.zeros(local.size + 1, dtype=PETSc.IntType)
    counts[mine + 1] = columns.size
    product = PETSc.Mat().createAIJ(
        matrix.getSizes(),
        csr=(
            np.cumsum(counts, dtype=PETSc.IntType),
            np.tile(columns, mine.size).astype(PETSc.IntType),
            factor * np.outer(local[mine], values).ravel(),
        ),
        comm=comm,
    )
    matrix.axpy(1.0, product, structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    product.destroy()
