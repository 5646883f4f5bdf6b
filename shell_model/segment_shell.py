# SPDX-License-Identifier: LGPL-3.0-or-later
"""One segment as a shell: distributed matrices, supports, and the nodes of its outlines."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc
from scipy.linalg import null_space

from geometry.boom import Segment
from geometry.mesh import WALLS, SegmentMesh
from geometry.section import BoxSection
from shell_model import compat
from shell_model.forms import shell_forms
from shell_model.outline import Outline

Array = npt.NDArray[np.float64]

# Nodes closer than this (m) to a place lie on it; mesh lines are exact to round-off.
ON_LINE = 1.0e-7


@dataclass(frozen=True, slots=True)
class SegmentShell:
    """K u = f and M ü of one segment, distributed by rows.

    Args:
        comm: the ranks that share it.
        stiffness: (num_dofs, num_dofs), 1 on the diagonal of held rows.
        mass: (num_dofs, num_dofs), 0 on the diagonal of held rows, which puts these degrees of
            freedom at infinite frequency.
        load: (num_owned,) the segment's uniform load, zero in held rows.
        free: (num_owned,) False in held rows.
        nodes: (num_owned_nodes, 3) places of the displacement nodes in m.
        node_dofs: (num_owned_nodes, 3) global rows of their displacements.
        rotation_dofs: (num_owned_rotation_nodes, 3) global rows of the rotations.
        section: the plates.
        space: the function space, which owns the communicator that the matrices live on.
    """

    comm: MPI.Comm
    stiffness: PETSc.Mat
    mass: PETSc.Mat
    load: Array
    free: npt.NDArray[np.bool_]
    nodes: Array
    node_dofs: npt.NDArray[np.int64]
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
        at = np.abs(self.nodes[:, 0] - x) < ON_LINE
        places = np.concatenate(self.comm.allgather(self.nodes[at]))
        dofs = np.concatenate(self.comm.allgather(self.node_dofs[at]))
        return Outline(x, places, dofs, self.section)

    def row(self, weights: Mapping[int, float]) -> Array:
        """(num_owned,) this rank's part of a row given as global dof → weight."""
        first, last = self.owned
        local = np.zeros(last - first)
        for dof, weight in weights.items():
            if first <= dof < last:
                local[dof - first] += weight
        local[~self.free] = 0.0
        return local

    def rigid_motions(self) -> Array:
        """(num_owned, num_free) rigid motions that the supports leave, six for a free segment.

        Displacement nodes get ω × (x − middle), rotation nodes ω itself; combinations that
        move a held row drop out. Collective.
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
        # One rank decides on the basis of what is left, for all.
        free = self.comm.bcast(null_space(held) if held.size else np.eye(6))
        return np.asarray(motions @ free)


def assemble_segment(comm: MPI.Comm, segment: Segment, mesh: SegmentMesh | None) -> SegmentShell:
    """Assemble a segment's shell. Collective.

    Supports hold the section's outline against y and z, and its axis against x at the first
    of them: the two points of the webs on the axis, so that rotation about y stays free.

    Args:
        comm: the ranks that share it.
        segment: with a box section.
        mesh: of its walls, on rank 0; None elsewhere.
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
    bcs = _supports(space, segment)
    stiffness = compat.assemble_matrix(forms.stiffness, bcs, diagonal=1.0)
    mass = compat.assemble_matrix(forms.mass, bcs, diagonal=0.0)

    first, last = stiffness.getOwnershipRange()
    free = np.ones(last - first, dtype=bool)
    for bc in bcs:
        held, _ = bc.dof_indices()
        free[held[held < free.size]] = False
    load = segment.load / section.area * compat.assemble_vector(forms.unit_load) * free
    places, node_dofs = _owned_nodes(space, 0)
    _, rotation_dofs = _owned_nodes(space, 1)
    return SegmentShell(
        comm=comm,
        stiffness=stiffness,
        mass=mass,
        load=load,
        free=free,
        nodes=places,
        node_dofs=node_dofs,
        rotation_dofs=rotation_dofs,
        section=section,
        space=space,
    )


def _supports(space: Any, segment: Segment) -> list[Any]:
    bcs = []
    zero = PETSc.ScalarType(0.0)
    for number, x in enumerate(sorted(segment.supports)):
        held = [1, 2] if number else [1, 2, 0]
        for component in held:
            part = space.sub(0).sub(component)
            collapsed, _ = part.collapse()

            def on_support(
                points: Array, x: float = x, component: int = component
            ) -> npt.NDArray[np.bool_]:
                on_outline = np.abs(points[0] - x) < ON_LINE
                if component == 0:
                    return np.asarray(on_outline & (np.abs(points[2]) < ON_LINE))
                return np.asarray(on_outline)

            dofs = fem.locate_dofs_geometrical((part, collapsed), on_support)
            function = fem.Function(collapsed)
            function.x.array[:] = zero
            bcs.append(fem.dirichletbc(function, dofs, part))
    return bcs


def _owned_nodes(space: Any, part: int) -> tuple[Array, npt.NDArray[np.int64]]:
    """Places of a vector part's nodes on this rank, and the global rows of their components."""
    collapsed, to_parent = space.sub(part).collapse()
    index_map = space.dofmap.index_map
    local = np.asarray(to_parent, dtype=np.int32).reshape(-1, 3)
    places = collapsed.tabulate_dof_coordinates()[: len(local)]
    owned = local[:, 0] < index_map.size_local
    return places[owned], index_map.local_range[0] + local[owned].astype(np.int64)
