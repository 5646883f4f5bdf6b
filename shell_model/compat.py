# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compatibility layer for DOLFINx 0.5.2 to 0.11.

All other modules of this package use the current interface.
"""

from __future__ import annotations

import errno
import fcntl
import inspect
import os
from collections.abc import Callable
from contextlib import ExitStack, suppress
from functools import wraps
from pathlib import Path
from typing import Any

import dolfinx.fem.petsc as fem_petsc
import numpy as np
import ufl
from dolfinx import cpp, fem, jit, mesh
from mpi4py import MPI
from petsc4py import PETSc

from protractile.geometry.arrays import Array, Indices

try:
    import basix.ufl

    _HAS_BASIX_UFL = hasattr(basix.ufl, "mixed_element")
except ImportError:
    _HAS_BASIX_UFL = False

# DOLFINx calls its form compiler by this name everywhere.
_JIT_OPTIONS = getattr(jit, "get_options", None) or jit.get_parameters
_JIT_DEFAULTS = getattr(jit, "DOLFINX_DEFAULT_JIT_OPTIONS", None) or (
    jit.DOLFINX_DEFAULT_JIT_PARAMETERS
)
_FORMS, *_MEANING = _JIT_DEFAULTS["cache_dir"]
_JIT_DEFAULTS["cache_dir"] = (Path(_FORMS) / "protractile", *_MEANING)

_NO_COMPILER = (
    "the forms of a shell are compiled once, which needs a C compiler and Python's headers: "
    "apt install gcc python3-dev, or dnf install gcc python3-devel"
)


def _compile_one_at_a_time(compile_form: Callable[..., Any]) -> Callable[..., Any]:
    """Return a compiler that waits until no other process compiles. Collective.

    FFCx marks a form that it compiles. Another process that needs the form waits for at most ten
    seconds, and then fails, for example if the first process was killed. So the forms of this
    program have their own folder, in which only one process compiles at a time. An unfinished form
    there belongs to a killed process and is removed.

    Raises:
        OSError: a form is not in the folder, and cannot be compiled.
    """

    @wraps(compile_form)
    def compiled(comm: MPI.Comm, *arguments: Any, **options: Any) -> Any:
        folder = Path(_JIT_OPTIONS()["cache_dir"])
        if comm.rank != 0 or folder.name != "protractile":
            return compile_form(comm, *arguments, **options)
        folder.mkdir(parents=True, exist_ok=True)
        with ExitStack() as stack:
            # A lock file might be a pipe, which blocks.
            lock = os.open(folder, os.O_RDONLY)
            stack.callback(os.close, lock)
            # Some file systems of clusters have no locks.
            with suppress(OSError):
                fcntl.flock(lock, fcntl.LOCK_EX)
            names = {*os.listdir(folder)}
            for source in names:
                if source.endswith(".c") and f"{source}.cached" not in names:
                    (folder / source).unlink()
            try:
                return compile_form(comm, *arguments, **options)
            except Exception as error:
                # The class of the error depends on the number of ranks.
                if "CompileError: " not in str(error):
                    raise
                reason = str(error).partition("CompileError: ")[2]
                raise OSError(errno.ENOENT, f"{reason}; {_NO_COMPILER}", "CC") from None

    return compiled


jit.ffcx_jit = _compile_one_at_a_time(jit.ffcx_jit)

# Two walls and a diaphragm meet on an edge.
_CELLS_OF_AN_EDGE = 3
_CREATE_MESH = inspect.signature(mesh.create_mesh).parameters

_ASSEMBLE_DIAGONAL = (
    "diag" if "diag" in inspect.signature(fem_petsc.assemble_matrix).parameters else "diagonal"
)


def create_mesh(comm: MPI.Comm, points: Array, cells: Indices) -> Any:
    """Return a distributed mesh in three dimensions. Collective.

    Args:
        comm: the ranks that share the mesh.
        points: (num_points, 3) on rank 0, (0, 3) elsewhere, in m.
        cells: (num_cells, 3) flat triangles, up to three on an edge, or (num_cells, 8) hexahedra
            with straight edges, whose points are ordered along the first axis, then the second,
            then the third; on rank 0, none elsewhere.
    """
    triangles = cells.shape[1] == 3
    kind = "triangle" if triangles else "hexahedron"
    if _HAS_BASIX_UFL:
        element = basix.ufl.element("Lagrange", kind, 1, shape=(3,))
        joined = _edge_arguments(comm, points, cells) if triangles else {}
        return mesh.create_mesh(comm, cells=cells, x=points, e=ufl.Mesh(element), **joined)
    cell = ufl.Cell(kind, geometric_dimension=3)
    domain = ufl.Mesh(ufl.VectorElement("Lagrange" if triangles else "Q", cell, 1))
    # Version 0.5 gives each rank all cells across its edges, and does not accept arrays.
    connected = cpp.graph.AdjacencyList_int64(cells.astype(np.int64))
    return mesh.create_mesh(comm, connected, points, domain)


def _edge_arguments(comm: MPI.Comm, points: Array, triangles: Indices) -> dict[str, Any]:
    """Return arguments of ``create_mesh`` that let three cells of different ranks share an edge."""
    if "max_facet_to_cell_links" in _CREATE_MESH:
        joined: dict[str, Any] = {"max_facet_to_cell_links": _CELLS_OF_AN_EDGE}
        if comm.size > 1:
            joined["partitioner"] = mesh.create_cell_partitioner(
                mesh.GhostMode.none, _CELLS_OF_AN_EDGE
            )
        return joined
    if comm.size == 1:
        return {}
    # Cells (num_edges, 3) on each edge with three cells.
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges = sides[:, 0] * (triangles.max(initial=0) + 1) + sides[:, 1]
    by_edge = np.argsort(edges, kind="stable")
    _, first, count = np.unique(edges[by_edge], return_index=True, return_counts=True)
    begins = first[count == _CELLS_OF_AN_EDGE]
    on_one_rank = by_edge[begins[:, None] + np.arange(_CELLS_OF_AN_EDGE)] // 3
    if not comm.bcast(on_one_rank.size):
        return {}
    # Without ``max_facet_to_cell_links``, an edge with two cells on one rank is not shared with
    # other ranks (FEniCS/dolfinx issue 3063), so that all its cells must be on one rank. Each rank
    # gets the same number of cells, in the order of x.
    midpoints = points[triangles].mean(axis=1)
    place = np.empty(len(triangles), dtype=np.int64)
    place[np.lexsort(midpoints.T[::-1])] = np.arange(len(triangles))
    ranks = (comm.size * place // max(1, len(triangles))).astype(np.int32)
    ranks[on_one_rank] = ranks[on_one_rank[:, :1]]
    destinations = cpp.graph.AdjacencyList_int32(ranks[:, None])
    return {"partitioner": lambda *_: destinations}


def solid_space(domain: Any) -> Any:
    """Return the space of quadratic displacements with three components."""
    if _HAS_BASIX_UFL:
        return fem.functionspace(domain, ("Lagrange", 2, (3,)))
    return fem.VectorFunctionSpace(domain, ("Lagrange", 2))


def shell_space(domain: Any) -> Any:
    """Return the space of quadratic displacements and Crouzeix-Raviart rotations in 3D."""
    if _HAS_BASIX_UFL:
        displacement = basix.ufl.element("Lagrange", "triangle", 2, shape=(3,))
        rotation = basix.ufl.element("CR", "triangle", 1, shape=(3,))
        return fem.functionspace(domain, basix.ufl.mixed_element([displacement, rotation]))
    cell = domain.ufl_cell()
    displacement = ufl.VectorElement("Lagrange", cell, 2, dim=3)
    rotation = ufl.VectorElement("CR", cell, 1, dim=3)
    return fem.FunctionSpace(domain, ufl.MixedElement([displacement, rotation]))


def cellwise_space(domain: Any) -> Any:
    """Return the space of functions that are constant on each cell."""
    return getattr(fem, "functionspace", fem.FunctionSpace)(domain, ("DG", 0))


def cellwise_function(domain: Any, values: Array) -> Any:
    """Return a function that is constant on each cell of a mesh.

    ``values`` (num_cells,) are in the order of the cells in :func:`create_mesh`, and the
    same on every rank.
    """
    function = fem.Function(cellwise_space(domain))
    function.x.array[:] = values[domain.topology.original_cell_index]
    return function


def assemble_matrix(form: Any, bcs: list[Any], diagonal: float) -> PETSc.Mat:
    """Return the matrix of a form, with ``diagonal`` on the diagonal of constrained rows."""
    matrix = fem_petsc.assemble_matrix(form, bcs, **{_ASSEMBLE_DIAGONAL: diagonal})
    matrix.assemble()
    return matrix


def assemble_vector(form: Any) -> Array:
    """Return this rank's rows (num_owned,) of the vector of a form, summed over all ranks."""
    vector = fem_petsc.assemble_vector(form)
    vector.ghostUpdate(addv=PETSc.InsertMode.ADD, mode=PETSc.ScatterMode.REVERSE)
    rows = vector.array.copy()
    vector.destroy()
    return np.asarray(rows)


def cell_nodes(space: Any) -> Indices:
    """Return the node numbers (num_cells, num_nodes) of this rank's cells."""
    nodes = space.dofmap.list
    return np.asarray(getattr(nodes, "array", nodes), dtype=np.int64).reshape(
        -1, space.dofmap.dof_layout.num_dofs
    )


def node_places(space: Any) -> Array:
    """Return the positions (num_nodes, 3) of this rank's quadratic or Crouzeix-Raviart nodes in m.

    The position of a mid-side node is the mean of both corners, so that it is the same to the last
    bit on every rank. DOLFINx would compute it in one of the cells with this node.
    """
    geometry = space.mesh.geometry
    corners = geometry.dofmaps[0] if hasattr(geometry, "dofmaps") else geometry.dofmap
    corners = np.asarray(getattr(corners, "array", corners)).reshape(-1, 3)
    ends = geometry.x[corners]
    midpoints = 0.5 * (ends[:, [1, 0, 0]] + ends[:, [2, 2, 1]])
    nodes, index_map = cell_nodes(space), space.dofmap.index_map
    places = np.empty((index_map.size_local + index_map.num_ghosts, 3))
    places[nodes] = midpoints if nodes.shape[1] == 3 else np.concatenate([ends, midpoints], axis=1)
    return places
