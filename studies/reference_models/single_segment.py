# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static compliance and natural frequencies of a single segment as a shell."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
from slepc4py import SLEPc

from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array
from protractile.geometry.mesh import collar_breaks, diaphragm_breaks, mesh_segment, strip_lines
from protractile.geometry.plating import add_thickness
from protractile.geometry.segment import Segment
from protractile.shell_model.segment.cross_section import Row
from protractile.shell_model.segment.segment_shell import SegmentShell, assemble_segment
from protractile.shell_model.segment.shell import ShellMatrices
from protractile.shell_model.segment.solver import ShiftedSolver, gram

# Frequency in Hz, far below all elastic modes, for the statics of a segment that can move along x.
STATIC = 0.01


def shell_alone(segment: Segment, size: float, places: Sequence[float] = ()) -> SegmentShell:
    """Return the shell of a segment on this process, with an edge length in m.

    It has mesh lines at ends, supports and stiffeners, and at additional x in m.
    """
    assert segment.section is not None
    plates = diaphragm_breaks(segment)
    breaks = {"start": segment.start, "end": segment.end} | plates | collar_breaks(segment)
    lines = [*places, *(support.x for support in segment.supports)]
    breaks |= {f"place-{k}": x for k, x in enumerate(lines, start=1)}
    mesh = mesh_segment(
        segment.section, breaks, size, closed=tuple(plates), across=strip_lines(segment)
    )
    return assemble_segment(MPI.COMM_SELF, segment, add_thickness(segment, mesh))


def at_rest(shell: SegmentShell, forces: Array) -> Array:
    """Return static displacements in m under forces in N, both (num_dofs, num_forces)."""
    solve = ShiftedSolver(shell, STATIC)
    moved = solve(forces)
    solve.destroy()
    return moved


def compliances(shell: SegmentShell, *rows: Row) -> list[float]:
    """Return the compliance (num_rows,) in m/N of each row: its displacement under a unit force."""
    forces = np.column_stack([shell.row(row) for row in rows])
    moved = at_rest(shell, forces)
    return [
        float(gram(shell.comm, force[:, None], way[:, None])[0, 0])
        for force, way in zip(forces.T, moved.T, strict=True)
    ]


def natural_frequencies(shell: ShellMatrices, count: int) -> Array:
    """Return the lowest natural frequencies (count,) in Hz, with rigid motions. Collective.

    The method is shift-and-invert with a negative shift σ, so that K − σ M is positive definite for
    a free segment, too. Fixed degrees of freedom have infinite frequencies.

    Raises:
        NumericsError: fewer frequencies converge.
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
