# SPDX-License-Identifier: LGPL-3.0-or-later
"""Natural modes of the unreduced shell, by SLEPc.

They judge a mesh and the reduction; the motion itself does not need them.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc
from slepc4py import SLEPc

from dynamics.failure import NumericsError
from shell_model.segment_shell import Shell

Array = npt.NDArray[np.float64]


class NaturalModes(NamedTuple):
    """The lowest natural modes, rising, rigid motions included.

    Args:
        frequencies: (num_modes,) in Hz.
        shapes: (num_owned, num_modes) this rank's rows, mass-normalised, in 1/√kg.
    """

    frequencies: Array
    shapes: Array


def natural_modes(shell: Shell, count: int) -> NaturalModes:
    """The lowest natural modes of a shell. Collective.

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
    if found < count:
        solver.destroy()
        raise NumericsError(f"{found} of {count} natural frequencies converged; refine the mesh")
    values = np.array([solver.getEigenvalue(i).real for i in range(found)])
    rising = np.argsort(values)[:count]
    shape = shell.stiffness.createVecLeft()
    shapes = np.empty((shape.getLocalSize(), count), order="F")
    for column, i in enumerate(rising):
        solver.getEigenvector(int(i), shape)
        shapes[:, column] = shape.array
    shape.destroy()
    solver.destroy()
    return NaturalModes(np.sqrt(np.maximum(values[rising], 0.0)) / (2.0 * np.pi), shapes)


def natural_frequencies(shell: Shell, count: int) -> Array:
    """The frequencies of :func:`natural_modes` alone, in Hz. Collective."""
    return natural_modes(shell, count).frequencies
