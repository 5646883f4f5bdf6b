# SPDX-License-Identifier: LGPL-3.0-or-later
"""Displacement and stress fields of the modes of a reduced shell."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
import ufl
import xarray as xr
from dolfinx import fem
from petsc4py import PETSc
from scipy.linalg import block_diag
from scipy.spatial import cKDTree

from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array, Indices
from protractile.geometry.boom import Boom, Segment
from protractile.geometry.ground import force_name
from protractile.geometry.plating import PlatedMesh
from protractile.shell_model import compat
from protractile.shell_model.reduction.coordinates import BoomCoordinates
from protractile.shell_model.reduction.segment import ReducedSegment
from protractile.shell_model.segment.forms import facet_frame, plane_stress, strains
from protractile.shell_model.segment.segment_shell import SegmentShell
from protractile.shell_model.segment.shell import ON_LINE
from protractile.shell_model.segment.solver import times
from protractile.shell_model.stress.stresses import COMPONENTS, Modes, triangle_areas

# Number of triangles whose stresses are computed together, which fit in the cache of the processor.
_TOGETHER = 64


def gather_stress_modes(shell: SegmentShell, shapes: Array) -> Modes | None:
    """Return stresses (num_modes, num_triangles, 6) in Pa on rank 0, None elsewhere. Collective.

    ``shapes`` (num_owned, num_modes) are this rank's rows of the shapes.
    """
    form, component = _stress_form(shell.space, shell.segment)
    matrices = []
    for unit in np.eye(len(COMPONENTS)):
        component.value[:] = unit
        matrices.append(compat.assemble_matrix(form, [], diagonal=0.0))
    of_cells = _CellShapes.gather(shell.space, matrices[0], shapes)
    products = of_cells.times(np.array([matrix.getValuesCSR()[2] for matrix in matrices]))
    for matrix in matrices:
        matrix.destroy()
    domain = shell.space.mesh
    places = np.asarray(domain.topology.original_cell_index)[: len(products)]
    gathered = shell.comm.gather((places, products))
    if gathered is None:
        return None
    mesh = shell.mesh
    assert mesh is not None
    modes = np.zeros((shapes.shape[1], len(mesh.triangles), len(COMPONENTS)), dtype=np.float32)
    for triangles, product in gathered:
        modes[:, triangles, :] = product.transpose(2, 0, 1)
    modes /= triangle_areas(mesh.points, mesh.triangles)[:, None].astype(np.float32)
    # The form gives bending stress per distance from the mid-surface.
    modes[:, :, 3:] *= 0.5 * mesh.thickness[:, None].astype(np.float32)
    return modes


class _CellShapes(NamedTuple):
    """Shapes at the degrees of freedom of each triangle, for sums in the order of the triangle.

    A product of PETSc adds in the order of global numbers, which depends on the number of ranks.
    """

    shapes: Array  #: (num_places, num_modes) at the places that the triangles of this rank use
    places: Indices  #: (num_triangles, num_local) of ``shapes``
    order: Indices  #: (num_triangles, num_local) position in a row of a matrix

    @classmethod
    def gather(cls, space: Any, matrix: PETSc.Mat, shapes: Array) -> _CellShapes:
        """Return the shapes for matrices (triangle, dof) like ``matrix``. Collective."""
        begin, column, _ = matrix.getValuesCSR()
        cells = np.array([space.dofmap.cell_dofs(cell) for cell in range(len(begin) - 1)])
        needed, place = np.unique(column, return_inverse=True)
        numbers = space.dofmap.index_map.local_to_global(cells.ravel().astype(np.int32))
        local = np.asarray(numbers).reshape(cells.shape)
        # Rows of a matrix are sorted by column.
        order = np.argsort(np.argsort(local, axis=1), axis=1)
        selection = PETSc.Mat().createAIJ(
            ((needed.size, None), (matrix.getLocalSize()[1], None)),
            csr=(
                np.arange(needed.size + 1, dtype=PETSc.IntType),
                needed.astype(PETSc.IntType),
                np.ones(needed.size),
            ),
            comm=matrix.comm,
        )
        selected = times(selection, shapes)
        selection.destroy()
        places = np.take_along_axis(place.reshape(cells.shape), order, axis=1)
        return cls(selected, places, order)

    def times(self, values: Array) -> Modes:
        """Return the products (num_triangles, num_matrices, num_modes) of matrices and the shapes.

        ``values`` (num_matrices, num_entries) are those of the matrices.
        """
        order = self.order[:, None]
        weights = values.reshape(len(values), *self.order.shape).swapaxes(0, 1)
        weights = np.take_along_axis(weights, order, axis=2)
        product = np.empty((*weights.shape[:2], self.shapes.shape[1]), dtype=np.float32)
        for begin in range(0, len(order), _TOGETHER):
            some = slice(begin, begin + _TOGETHER)
            product[some] = weights[some] @ self.shapes[self.places[some]]
        return product


def wall_frame(domain: Any) -> tuple[Any, Any, Any]:
    """Return the unit vectors along x and s, and the outward normal, of each triangle."""
    _, _, e3 = facet_frame(domain)
    place = ufl.SpatialCoordinate(domain)
    # A length larger than any section, so that the second term dominates on a diaphragm.
    far = fem.Constant(domain, PETSc.ScalarType(1.0e6))
    side = place[1] * e3[1] + place[2] * e3[2] + far * e3[0]
    outward = ufl.conditional(ufl.gt(side, 0.0), 1.0, -1.0) * e3
    across = ufl.gt(abs(e3[0]), 0.5)
    axis = [ufl.conditional(across, float(i == 1), float(i == 0)) for i in range(3)]
    axis = ufl.as_vector(axis)
    along = axis - ufl.dot(axis, outward) * outward
    along = along / ufl.sqrt(ufl.dot(along, along))
    return along, ufl.cross(outward, along), outward


def _stress_form(space: Any, segment: Segment) -> tuple[Any, Any]:
    """Return the form (cell, dof) of stress times area, and the constant that selects a component.

    Bending stress is per unit of distance from the mid-surface.
    """
    domain = space.mesh
    component = fem.Constant(domain, np.zeros(len(COMPONENTS), dtype=PETSc.ScalarType))
    young, nu = (
        fem.Constant(domain, PETSc.ScalarType(value))
        for value in (segment.material.youngs_modulus, segment.material.poissons_ratio)
    )
    e1, e2, e3 = facet_frame(domain)
    along, around, outward = wall_frame(domain)
    turn = ufl.as_matrix([[ufl.dot(a, e) for e in (e1, e2)] for a in (along, around)])
    u, theta = ufl.split(ufl.TrialFunction(space))
    strain = strains(domain, u, theta)
    membrane = turn * plane_stress(young, nu, strain.membrane) * turn.T
    bending = turn * plane_stress(young, nu, strain.bending) * turn.T
    values = [
        factor * stress[i, j]
        for factor, stress in ((1.0, membrane), (ufl.dot(outward, e3), bending))
        for i, j in ((0, 0), (1, 1), (0, 1))
    ]
    test = ufl.TestFunction(compat.cellwise_space(domain))
    integrand = sum(weight * value for weight, value in zip(component, values, strict=True))
    return fem.form(integrand * test * ufl.dx(degree=1, domain=domain)), component


_Numbers = npt.NDArray[Any]
_Variable = tuple[tuple[str, ...], _Numbers, dict[str, str]]


def gather_fields(
    boom: Boom,
    shells: Sequence[SegmentShell],
    reduced: Sequence[ReducedSegment],
    coordinates: BoomCoordinates,
    system: GapSystem,
) -> xr.Dataset | None:
    """Return displacements and stresses of all modes on rank 0, None elsewhere. Collective.

    Args:
        shells, reduced: shell and reduced coordinates of each segment.
        coordinates: coordinates of the boom, the first coordinates of the system.
        system: gap system, whose observers include the forces of cylinders.

    Returns:
        ``points`` (point, component) in m, ``triangles`` (triangle, corner), ``segment`` and
        ``wall`` (triangle), ``thickness`` (triangle) in m, ``modes`` (mode, point, component) in
        1/√kg: the displacement in m is the sum of the modal coordinates times ``modes``. Segment k,
        from 1 on, has ``coordinates_k`` (own_k, mode), ``stress_k`` (own_k, triangle_k, stress) and
        ``plate_k``. ``coordinates_k`` transforms the modal coordinates to the coordinates of the
        segment, which include the forces of its cylinders. The sum of these coordinates times
        ``stress_k`` is the stress in Pa. ``plate_k`` has the plate names to which ``wall`` refers.
    """
    displacements = [
        vertex_displacements(shell, segment.shapes)
        for shell, segment in zip(shells, reduced, strict=True)
    ]
    stresses = [
        gather_stress_modes(shell, segment.shapes)
        for shell, segment in zip(shells, reduced, strict=True)
    ]
    meshes = [shell.mesh for shell in shells if shell.mesh is not None]
    if not meshes:
        return None
    shapes = [displacement for displacement in displacements if displacement is not None]
    begins = np.cumsum([0, *(len(mesh.points) for mesh in meshes)])
    triangles = [mesh.triangles + begin for mesh, begin in zip(meshes, begins[:-1], strict=True)]
    numbers = np.repeat(np.arange(len(meshes)), [len(mesh.triangles) for mesh in meshes])
    # The last coordinates are springs that move with pads; they have no displacement field.
    count = coordinates.omega2.size
    modes = np.zeros((system.num_modes, begins[-1], 3), dtype=np.float32)
    modes[:count] = coordinates.of_rows(block_diag(*shapes)).T.reshape(count, -1, 3)
    return xr.Dataset(
        {
            "points": (("point", "component"), np.concatenate([m.points for m in meshes])),
            "triangles": (("triangle", "corner"), np.concatenate(triangles).astype(np.int32)),
            "segment": ("triangle", numbers.astype(np.int32)),
            "wall": ("triangle", np.concatenate([m.walls for m in meshes]).astype(np.int32)),
            "thickness": (
                "triangle",
                np.concatenate([m.thickness for m in meshes]),
                {"units": "m"},
            ),
            **_axial_stress(boom, meshes),
            "modes": (("mode", "point", "component"), modes),
            **_segment_stresses(boom, meshes, stresses, coordinates, system),
        },
        coords={
            "stress": list(COMPONENTS),
            **{f"plate_{k}": list(mesh.plates) for k, mesh in enumerate(meshes, start=1)},
        },
    )


def vertex_displacements(shell: SegmentShell, shapes: Array) -> _Numbers | None:
    """Return displacements (3 num_points, num_modes) of mesh points on rank 0. Collective."""
    points = shell.comm.bcast(None if shell.mesh is None else shell.mesh.points)
    distance, vertex = cKDTree(points).query(shell.nodes)
    at_vertex = distance < ON_LINE
    first, _ = shell.owned
    rows = shell.node_dofs[at_vertex] - first
    gathered = shell.comm.gather((vertex[at_vertex], shapes[rows].astype(np.float32)))
    if gathered is None:
        return None
    displacements = np.zeros((*points.shape, shapes.shape[1]), dtype=np.float32)
    for places, parts in gathered:
        displacements[places] = parts
    return displacements.reshape(-1, shapes.shape[1])


def _axial_stress_of(segment: Segment, mesh: PlatedMesh, force: Callable[[Array], Array]) -> Array:
    """Return the axial stress (num_triangles,) in Pa of an axial force in N as a function of x.

    The force acts on the walls, and is distributed over the thickness including collars.
    """
    return force(mesh.along) / segment.area * mesh.load_weight / mesh.thickness


def _axial_stress(boom: Boom, meshes: Sequence[PlatedMesh]) -> dict[str, _Variable]:
    """Return the variable ``axial_stress`` of the fields; empty without axial forces."""
    if not boom.compressed:
        return {}
    stresses = [
        -_axial_stress_of(segment, mesh, segment.compression)
        for segment, mesh in zip(boom.segments, meshes, strict=True)
    ]
    return {"axial_stress": (("triangle",), np.concatenate(stresses), {"units": "Pa"})}


def _segment_stresses(
    boom: Boom,
    meshes: Sequence[PlatedMesh],
    stresses: Sequence[Modes | None],
    coordinates: BoomCoordinates,
    system: GapSystem,
) -> dict[str, _Variable]:
    """Return ``coordinates_k`` and ``stress_k`` of each segment, see :func:`gather_fields`."""
    modes = [stress for stress in stresses if stress is not None]
    sizes = [len(mode) for mode in modes]
    every = coordinates.of_rows(np.eye(sum(sizes)))
    every = np.pad(every, ((0, 0), (0, system.num_modes - every.shape[1])))
    variables: dict[str, _Variable] = {}
    for number, coordinates_of_segment in enumerate(np.split(every, np.cumsum(sizes)[:-1])):
        k, stress = number + 1, modes[number]
        for force, cylinder_stress in _cylinder_stresses(boom, number, meshes[number]):
            coordinates_of_segment = np.concatenate(
                [coordinates_of_segment, system.observers[force].row[None]]
            )
            stress = np.concatenate([stress, cylinder_stress])
        variables[f"coordinates_{k}"] = ((f"own_{k}", "mode"), coordinates_of_segment, {})
        dims = (f"own_{k}", f"triangle_{k}", "stress")
        variables[f"stress_{k}"] = (dims, stress, {"units": "Pa"})
    return variables


def _cylinder_stresses(boom: Boom, number: int, mesh: PlatedMesh) -> Iterator[tuple[str, Modes]]:
    """Yield the names of the cylinder forces on a segment, with the stresses in Pa due to 1 N.

    The stresses (1, num_triangles, 6) are 0 except for the axial membrane stress.
    """
    segment = boom.segments[number]
    for k, cylinder in enumerate(boom.cylinders, start=1):
        if cylinder.segment == number:
            stress = np.zeros((1, len(mesh.triangles), len(COMPONENTS)), dtype=np.float32)
            pull = partial(cylinder.normal_force, foot=segment.foot)
            stress[0, :, COMPONENTS.index("membrane_x")] = _axial_stress_of(segment, mesh, pull)
            yield force_name(k), stress
