# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distributed matrices of a shell: mass, stiffness, supports."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc
from scipy.linalg import block_diag, null_space, qr

from geometry.arrays import Array, Indices, Mask
from geometry.plating import PlatedMesh
from geometry.section import COMPONENT
from geometry.segment import Segment
from shell_model import compat
from shell_model.segment.attachments import Attached
from shell_model.segment.cross_section import on_outline
from shell_model.segment.forms import ShellForms

# Nodes closer than this (m) to a place lie on it; mesh lines are exact to round-off.
ON_LINE = 1.0e-7


# Constraint of a support: 0 of the displacement or 1 of the rotation, component, and a function
# of places (num_places, 3) in m.
Hold = tuple[int, int, Callable[[Array], Mask]]


class Plates(NamedTuple):
    """Plates before assembly: function space, forms, supports.

    ``compressed``: whether they carry an axial force.
    """

    space: Any
    forms: ShellForms
    holds: list[Any]
    compressed: bool = False


class Matrices:
    """Matrices of plates with springs and masses, assembled on first use. Collective.

    Args:
        comm: the ranks that share them.
        plates: their forms.
        holds: Dirichlet conditions.
        springs, masses: attached ones.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        plates: Plates,
        holds: list[Any],
        springs: Attached,
        masses: Attached,
    ) -> None:
        self._comm, self.plates, self._holds = comm, plates, holds
        self._springs, self._masses = springs, masses

    @cached_property
    def stiffness(self) -> PETSc.Mat:
        return self._assembled(self.plates.forms.stiffness, 1.0, self._springs)

    @cached_property
    def mass(self) -> PETSc.Mat:
        return self._assembled(self.plates.forms.mass, 0.0, self._masses)

    @cached_property
    def geometric(self) -> PETSc.Mat | None:
        if not self.plates.compressed:
            return None
        nothing = Attached(self._masses.rows[:, :0], self._masses.factors[:0])
        return self._assembled(self.plates.forms.geometric, 0.0, nothing)

    def _assembled(self, form: Any, diagonal: float, attached: Attached) -> PETSc.Mat:
        matrix = compat.assemble_matrix(form, self._holds, diagonal)
        attached.add_to(self._comm, matrix)
        return matrix


@dataclass(frozen=True, slots=True)
class Shell:
    """Shell model K u = f and M ü, distributed by rows.

    Args:
        comm: the ranks that share it.
        matrices: K and M.
        free: (num_owned,) False in held rows.
        springs: of the supports.
        nodes: (num_owned_nodes, 3) places of the displacement nodes in m.
        node_dofs: (num_owned_nodes, 3) global rows of their displacements.
        rotation_nodes: (num_owned_rotation_nodes, 3) places of the rotation nodes in m.
        rotation_dofs: (num_owned_rotation_nodes, 3) global rows of their rotations.
        space: the function space, which owns the communicator that the matrices live on.
    """

    comm: MPI.Comm
    matrices: Matrices
    free: Mask
    springs: Attached
    nodes: Array
    node_dofs: Indices
    rotation_nodes: Array
    rotation_dofs: Indices
    space: Any

    @property
    def stiffness(self) -> PETSc.Mat:
        """Stiffness (num_dofs, num_dofs), decoupled and positive in fixed rows. Collective."""
        return self.matrices.stiffness

    @property
    def mass(self) -> PETSc.Mat:
        """Mass matrix (num_dofs, num_dofs), with 0 on the diagonal of fixed rows.

        These degrees of freedom are at infinite frequency. Collective.
        """
        return self.matrices.mass

    @property
    def geometric(self) -> PETSc.Mat | None:
        """Matrix K_G (num_dofs, num_dofs), the softening by axial forces; None without any.

        Collective.
        """
        return self.matrices.geometric

    @property
    def num_dofs(self) -> int:
        """Number of degrees of freedom over all ranks."""
        return int(self.space.dofmap.index_map.size_global)

    @property
    def owned(self) -> tuple[int, int]:
        """First and past-the-last global row of this rank."""
        first, last = self.space.dofmap.index_map.local_range
        return int(first), int(last)

    def rigid_motions(self) -> Array:
        """Return the free rigid motions (num_owned, num_free), six for a segment without supports.

        Displacement nodes get ω × (x − middle), rotation nodes ω itself; combinations that
        move a held row or stretch a spring drop out. Collective.
        """
        first, _ = self.owned
        motions = np.zeros((self.free.size, 6))
        ends = self.comm.allgather((self.nodes[:, 0].min(), self.nodes[:, 0].max()))
        middle = 0.5 * (min(low for low, _ in ends) + max(high for _, high in ends))
        for i, axis in enumerate(np.eye(3)):
            motions[self.node_dofs - first, i] = axis
            motions[:, 3 + i] = self.turn(axis, middle)
        held = np.concatenate(self.comm.allgather(motions[~self.free]))
        held = np.concatenate([held, self.comm.allreduce(self.springs.rows.T @ motions)])
        # One rank chooses the basis of the remaining motions for all. Where nothing slides along x
        # the slide comes first and by itself, since nothing pushes it.
        unheld = np.eye(6)
        if held.size:
            slides = 0 if held[:, 0].any() else 1
            others = null_space(qr(held[:, slides:], mode="r")[0][:6])
            unheld = block_diag(np.eye(slides), others)
        return np.asarray(motions @ self.comm.bcast(unheld))

    def turn(self, axis: Array, x: float) -> Array:
        """Return the motion (num_owned,) of a turn by 1 rad about an axis (3,) through x in m."""
        first, _ = self.owned
        motion = np.zeros(self.free.size)
        motion[self.node_dofs - first] = np.cross(axis, self.nodes - [x, 0.0, 0.0])
        motion[self.rotation_dofs - first] = axis
        return motion


def free_rows(space: Any, holds: list[Any]) -> Mask:
    """Return the mask (num_owned,) of the free rows of a space, False in fixed rows."""
    free = np.ones(space.dofmap.index_map.size_local, dtype=bool)
    for bc in holds:
        held, _ = bc.dof_indices()
        free[held[held < free.size]] = False
    return free


def hold(space: Any, part: int, component: int, where: Callable[[Array], Mask]) -> Any:
    """Return a Dirichlet condition: zero displacement (part 0) or rotation (part 1) component.

    ``where`` returns which of places (num_places, 3) in m are fixed.
    """
    held = space.sub(part).sub(component)
    collapsed, _ = held.collapse()
    dofs = fem.locate_dofs_geometrical((held, collapsed), lambda points: where(points.T))
    function = fem.Function(collapsed)
    function.x.array[:] = PETSc.ScalarType(0.0)
    return fem.dirichletbc(function, dofs, held)


def owned_nodes(space: Any, part: int) -> tuple[Array, Indices]:
    """Return places of a vector part's nodes on this rank, and global rows of their components."""
    collapsed, to_parent = space.sub(part).collapse()
    index_map = space.dofmap.index_map
    local = np.asarray(to_parent, dtype=np.int32).reshape(-1, 3)
    places = compat.node_places(collapsed)[: len(local)]
    owned = local[:, 0] < index_map.size_local
    return places[owned], index_map.local_range[0] + local[owned].astype(np.int64)


def assemble_plates(comm: MPI.Comm, segment: Segment, mesh: PlatedMesh | None) -> Plates:
    """Assemble the plates of a mesh, that of a whole segment or a part of it. Collective."""
    held = list(_held(segment))
    points, triangles, of_cells = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), None
    if mesh is not None:
        # The plain walls carry the whole axial force, so that it is the same in each section.
        pressed = segment.compression(mesh.along) / segment.area * mesh.even
        points, triangles, of_cells = mesh.points, mesh.triangles, (mesh.thickness, pressed)
    domain = compat.create_triangle_mesh(comm, points, triangles)
    thickness, compression = (
        compat.cellwise_function(domain, values) for values in comm.bcast(of_cells)
    )
    space = compat.shell_space(domain)
    forms = ShellForms(space, thickness, segment.material, compression=compression)
    return Plates(space, forms, [hold(space, *one) for one in held], bool(segment.compression))


def _held(segment: Segment) -> Iterator[Hold]:
    """Return the conditions of rigid supports: y and z of the outline, all parts if clamped."""
    for support in segment.supports:
        if support.stiffness is not None:
            continue
        outline = partial(on_outline, section=segment.section_at(support.x), x=support.x)
        for part in (0, 1) if support.clamped else (0,):
            for component in (0, 1, 2) if support.clamped else COMPONENT.values():
                yield part, component, outline
