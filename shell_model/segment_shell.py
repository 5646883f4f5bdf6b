# SPDX-License-Identifier: LGPL-3.0-or-later
"""One segment as a shell: distributed matrices, supports, and the nodes of its outlines."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc
from scipy.linalg import null_space

from geometry.boom import Direction, Segment, Support
from geometry.mesh import WALLS, SegmentMesh
from geometry.section import BoxSection
from shell_model import compat
from shell_model.attachments import add_outer_product
from shell_model.forms import ShellForms, shell_forms
from shell_model.outline import COMPONENT, Outline, Row

Array = npt.NDArray[np.float64]

# Nodes closer than this (m) to a place lie on it; mesh lines are exact to round-off.
ON_LINE = 1.0e-7

# What holds the twist of an elastic support, over G J_t / L of its segment: no segment can tell
# it from a rigid hold.
RIGID_TWIST = 1.0e5


@dataclass(frozen=True, slots=True)
class SegmentShell:
    """K u = f and M ü of one segment, distributed by rows.

    Args:
        comm: the ranks that share it.
        stiffness: (num_dofs, num_dofs), 1 on the diagonal of held rows.
        mass: (num_dofs, num_dofs), 0 on the diagonal of held rows, which puts these degrees of
            freedom at infinite frequency.
        unit_loads: direction → (num_owned,) a uniform load of 1 N/m along it, zero in held rows.
        free: (num_owned,) False in held rows.
        springs: (num_owned, num_springs) what each spring of the supports reads.
        nodes: (num_owned_nodes, 3) places of the displacement nodes in m.
        node_dofs: (num_owned_nodes, 3) global rows of their displacements.
        rotation_nodes: (num_owned_rotation_nodes, 3) places of the rotation nodes in m.
        rotation_dofs: (num_owned_rotation_nodes, 3) global rows of their rotations.
        section: the plates.
        space: the function space, which owns the communicator that the matrices live on.
    """

    comm: MPI.Comm
    stiffness: PETSc.Mat
    mass: PETSc.Mat
    unit_loads: Mapping[Direction, Array]
    free: npt.NDArray[np.bool_]
    springs: Array
    nodes: Array
    node_dofs: npt.NDArray[np.int64]
    rotation_nodes: Array
    rotation_dofs: npt.NDArray[np.int64]
    section: BoxSection
    space: Any

    @property
    def num_dofs(self) -> int:
        """Number of degrees of freedom over all ranks."""
        return int(self.stiffness.getSize()[0])

    @property
    def owned(self) -> tuple[int, int]:
        """First and past-the-last global row of this rank."""
        first, last = self.stiffness.getOwnershipRange()
        return int(first), int(last)

    def outline(self, x: float) -> Outline:
        """The nodes at x, the same on every rank. Collective."""
        return _outline(self.comm, self.nodes, self.node_dofs, self.section, x)

    def row(self, weights: Row) -> Array:
        """(num_owned,) this rank's part of a row given as global dof → weight."""
        return _local_row(self.owned[0], self.free, weights)

    def rigid_motions(self) -> Array:
        """(num_owned, num_free) rigid motions that the supports leave, six for a free segment.

        Displacement nodes get ω × (x − middle), rotation nodes ω itself; combinations that
        move a held row or stretch a spring drop out. Collective.
        """
        first, _ = self.owned
        motions = np.zeros((self.free.size, 6))
        ends = self.comm.allgather((self.nodes[:, 0].min(), self.nodes[:, 0].max()))
        middle = 0.5 * (min(low for low, _ in ends) + max(high for _, high in ends))
        arms = self.nodes - [middle, 0.0, 0.0]
        for i, axis in enumerate(np.eye(3)):
            motions[self.node_dofs - first, i] = axis
            motions[self.node_dofs - first, 3 + i] = np.cross(axis, arms)
            motions[self.rotation_dofs - first, 3 + i] = axis
        held = np.concatenate(self.comm.allgather(motions[~self.free]))
        held = np.concatenate([held, self.comm.allreduce(self.springs.T @ motions)])
        # One rank decides on the basis of what is left, for all.
        free = self.comm.bcast(null_space(held) if held.size else np.eye(6))
        return np.asarray(motions @ free)


def assemble_segment(comm: MPI.Comm, segment: Segment, mesh: SegmentMesh | None) -> SegmentShell:
    """Assemble a segment's shell. Collective.

    A rigid support holds the section's outline against y and z, which leaves it free to tilt; a
    clamped one holds every displacement and rotation of it. An elastic support is a spring on
    the mean deflection of the walls, along z and along y, with the twist held. Point masses move
    with the same means. Nothing holds the segment along x, and nothing pushes it there.

    Args:
        comm: the ranks that share it.
        segment: with a box section.
        mesh: of its walls, on rank 0, with mesh lines at supports and masses; None elsewhere.
    """
    section = segment.section
    assert section is not None
    if mesh is not None:
        points, triangles = mesh.points, mesh.triangles
        wall_thickness = np.array(
            [section.flange if wall in ("bottom", "top") else section.web for wall in WALLS]
        )[mesh.walls]
    else:
        points, triangles = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
        wall_thickness = None
    domain = compat.create_triangle_mesh(comm, points, triangles)
    thickness = compat.cellwise_function(domain, comm.bcast(wall_thickness))
    space = compat.shell_space(domain)
    forms = shell_forms(space, thickness, segment.material)
    bcs = _holds(space, segment)
    stiffness = compat.assemble_matrix(forms.stiffness, bcs, diagonal=1.0)
    mass = compat.assemble_matrix(forms.mass, bcs, diagonal=0.0)

    first, last = stiffness.getOwnershipRange()
    free = np.ones(last - first, dtype=bool)
    for bc in bcs:
        held, _ = bc.dof_indices()
        free[held[held < free.size]] = False
    nodes, node_dofs = _owned_nodes(space, 0)
    rotation_nodes, rotation_dofs = _owned_nodes(space, 1)

    def local(row: Row) -> Array:
        return _local_row(first, free, row)

    springs = []
    for support in segment.supports:
        if support.stiffness is None:
            continue
        outline = _outline(comm, nodes, node_dofs, section, support.x)
        for row, spring in _spring_rows(outline, segment, support.stiffness):
            springs.append(local(row))
            add_outer_product(comm, stiffness, springs[-1], spring)
    for point_mass in segment.masses:
        outline = _outline(comm, nodes, node_dofs, section, point_mass.x)
        for row in (
            outline.mean_displacement(0),
            outline.wall_deflection("y"),
            outline.wall_deflection("z"),
        ):
            add_outer_product(comm, mass, local(row), point_mass.mass)
    return SegmentShell(
        comm=comm,
        stiffness=stiffness,
        mass=mass,
        unit_loads={d: _unit_load(forms, d) / section.area * free for d in COMPONENT},
        free=free,
        springs=np.array(springs).reshape(-1, free.size).T,
        nodes=nodes,
        node_dofs=node_dofs,
        rotation_nodes=rotation_nodes,
        rotation_dofs=rotation_dofs,
        section=section,
        space=space,
    )


def _outline(
    comm: MPI.Comm,
    nodes: Array,
    node_dofs: npt.NDArray[np.int64],
    section: BoxSection,
    x: float,
) -> Outline:
    at = np.abs(nodes[:, 0] - x) < ON_LINE
    places = np.concatenate(comm.allgather(nodes[at]))
    dofs = np.concatenate(comm.allgather(node_dofs[at]))
    return Outline(x, places, dofs, section)


def _local_row(first: int, free: npt.NDArray[np.bool_], weights: Row) -> Array:
    local = np.zeros(free.size)
    for dof, weight in weights.items():
        if first <= dof < first + free.size and free[dof - first]:
            local[dof - first] += weight
    return local


def _unit_load(forms: ShellForms, direction: Direction) -> Array:
    forms.load_direction.value[:] = np.eye(3)[COMPONENT[direction]]
    return compat.assemble_vector(forms.unit_load)


def _spring_rows(
    outline: Outline, segment: Segment, stiffness: float
) -> Iterator[tuple[Row, float]]:
    """What an elastic support pulls at, and how stiffly."""
    section = outline.section
    torsion = segment.material.shear_modulus * section.torsion_constant / segment.length
    yield outline.wall_deflection("z"), stiffness
    yield outline.wall_deflection("y"), stiffness
    yield outline.twist(), RIGID_TWIST * torsion


def _holds(space: Any, segment: Segment) -> list[Any]:
    """Dirichlet conditions of the rigid supports."""
    return [
        _hold(space.sub(part).sub(component), support.x)
        for support in segment.supports
        if support.stiffness is None
        for part, component in _held_components(support)
    ]


def _held_components(support: Support) -> list[tuple[int, int]]:
    """Components that a rigid support holds: (0, i) of displacement, (1, i) of rotation."""
    if support.kind == "clamped":
        return [(part, component) for part in (0, 1) for component in (0, 1, 2)]
    return [(0, COMPONENT["y"]), (0, COMPONENT["z"])]


def _hold(component: Any, x: float) -> Any:
    """Zero on the outline at x."""
    collapsed, _ = component.collapse()

    def on_outline(points: Array) -> npt.NDArray[np.bool_]:
        return np.asarray(np.abs(points[0] - x) < ON_LINE)

    dofs = fem.locate_dofs_geometrical((component, collapsed), on_outline)
    function = fem.Function(collapsed)
    function.x.array[:] = PETSc.ScalarType(0.0)
    return fem.dirichletbc(function, dofs, component)


def _owned_nodes(space: Any, part: int) -> tuple[Array, npt.NDArray[np.int64]]:
    """Places of a vector part's nodes on this rank, and the global rows of their components."""
    collapsed, to_parent = space.sub(part).collapse()
    index_map = space.dofmap.index_map
    local = np.asarray(to_parent, dtype=np.int32).reshape(-1, 3)
    places = collapsed.tabulate_dof_coordinates()[: len(local)]
    owned = local[:, 0] < index_map.size_local
    return places[owned], index_map.local_range[0] + local[owned].astype(np.int64)
