# SPDX-License-Identifier: LGPL-3.0-or-later
"""Springs and masses that act on a reading of the section, such as its mean deflection.

With the row r of the reading, a spring k adds k r rᵀ to the stiffness: its force is spread as r
reads, and every other motion of the section stays as free as it was.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc

Array = npt.NDArray[np.float64]


def add_outer_product(comm: MPI.Comm, matrix: PETSc.Mat, local: Array, factor: float) -> None:
    """Add factor · r rᵀ to a matrix that is distributed by rows. Collective.

    Args:
        comm: the ranks that share the matrix.
        matrix: (num_dofs, num_dofs).
        local: (num_owned,) this rank's part of r.
        factor: the spring's stiffness or the mass.
    """
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
