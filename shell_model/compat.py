# SPDX-License-Identifier: LGPL-3.0-or-later
"""The one place that knows that DOLFINx has versions (0.5.2 to 0.11).

Everything else in this room is written to today's interface.
"""

from __future__ import annotations

import inspect
from typing import Any

import dolfinx.fem.petsc as fem_petsc
import numpy as np
import numpy.typing as npt
import ufl
from dolfinx import fem, mesh
from mpi4py import MPI
from petsc4py import PETSc

try:
    import basix.ufl

    _HAS_BASIX_UFL = hasattr(basix.ufl, "mixed_element")
except ImportError:
    _HAS_BASIX_UFL = False

_ASSEMBLE_DIAGONAL = (
    "diag" if "diag" in inspect.signature(fem_petsc.assemble_matrix).parameters else "diagonal"
)


def create_triangle_mesh(
    comm: MPI.Comm, points: npt.NDArray[np.float64], triangles: npt.NDArray[np.int64]
) -> Any:
    """A distributed mesh of flat triangles in space.

    Args:
        comm: the ranks that share the mesh.
        points: (num_points, 3) on rank 0, (0, 3) elsewhere, in m.
        triangles: (num_triangles, 3) on rank 0, (0, 3) elsewhere.
    """
    if _HAS_BASIX_UFL:
        element = basix.ufl.element("Lagrange", "triangle", 1, shape=(3,))
        return mesh.create_mesh(comm, cells=triangles, x=points, e=ufl.Mesh(element))
    cell = ufl.Cell("triangle", geometric_dimension=3)
    domain = ufl.Mesh(ufl.VectorElement("Lagrange", cell, 1))
    return mesh.create_mesh(comm, triangles, points, domain)


def shell_space(domain: Any) -> Any:
    """Quadratic displacements and Crouzeix-Raviart rotations, both with three components."""
    if _HAS_BASIX_UFL:
        displacement = basix.ufl.element("Lagrange", "triangle", 2, shape=(3,))
        rotation = basix.ufl.element("CR", "triangle", 1, shape=(3,))
        return fem.functionspace(domain, basix.ufl.mixed_element([displacement, rotation]))
    cell = domain.ufl_cell()
    displacement = ufl.VectorElement("Lagrange", cell, 2, dim=3)
    rotation = ufl.VectorElement("CR", cell, 1, dim=3)
    return fem.FunctionSpace(domain, ufl.MixedElement([displacement, rotation]))


def cellwise_function(domain: Any, values: npt.NDArray[np.float64]) -> Any:
    """A function that is constant on each cell.

    Args:
        domain: the mesh.
        values: (num_cells,) in the order in which the cells were given to
            :func:`create_triangle_mesh`, the same on every rank.
    """
    space = getattr(fem, "functionspace", fem.FunctionSpace)(domain, ("DG", 0))
    function = fem.Function(space)
    function.x.array[:] = values[domain.topology.original_cell_index]
    return function


def assemble_matrix(form: Any, bcs: list[Any], diagonal: float) -> PETSc.Mat:
    """Assembled matrix with ``diagonal`` in the rows of held degrees of freedom."""
    matrix = fem_petsc.assemble_matrix(form, bcs, **{_ASSEMBLE_DIAGONAL: diagonal})
    matrix.assemble()
    return matrix


def assemble_vector(form: Any) -> npt.NDArray[np.float64]:
    """This rank's rows of an assembled vector, the other ranks' parts added."""
    vector = fem_petsc.assemble_vector(form)
    vector.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
    rows = vector.array.copy()
    vector.destroy()
    return np.asarray(rows)
