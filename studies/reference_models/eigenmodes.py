# SPDX-License-Identifier: LGPL-3.0-or-later
"""Natural frequencies of the unreduced shell, by SLEPc.

They judge a mesh and the reduction; the motion itself does not need them.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc
from slepc4py import SLEPc

from dynamics.failure import NumericsError
from geometry.arrays import Array
from shell_model.segment.shell import Shell


def natural_frequencies(shell: Shell, count: int) -> Array:
    """The lowest natural frequencies in Hz, rising, rigid motions included. Collective.

    Shift-and-invert at a negative shift: K − σ M is then positive definite also for a free
    segment, and held degrees of freedom, at infinite frequency, stay out of the way.

    Args:
        shell: the full model.
        count: how many.

    Raises:
        NumericsError: fewer converged.
    """
    shift = -((2.0 * np.pi * 5.0) ** 2)
    solver = SLEPc.EPS().create(shell.comm)
    solver.setOperators(shell.stiffness, shell.mass)
    solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    solver.setTarget(shift)
    solver.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    solver.setDimensions(count)
    solver.setTolerances(tol=1.0e-12)
    transform = solver.getST()
    transform.setType(SLEPc.ST.Type.SINVERT)
    transform.setShift(shift)
    factor = transform.getKSP().getPC()
    transform.getKSP().setType(PETSc.KSP.Type.PREONLY)
    factor.setType(PETSc.PC.Type.CHOLESKY)
    factor.setFactorSolverType("mumps")
    solver.solve()
    found = solver.getConverged()
    values = np.sort([solver.getEigenvalue(i).real for i in range(found)])[:count]
    solver.destroy()
    if found < count:
        raise NumericsError(f"{found} of {count} natural frequencies converged; refine the mesh")
    return np.asarray(np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi))
