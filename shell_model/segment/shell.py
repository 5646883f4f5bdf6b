# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shell model of plates: distributed mass, stiffness, supports, and attached springs and masses.

A spring k on a displacement of a section with the row r, such as its mean deflection, adds k r rᵀ
to the stiffness. The row distributes the force over the section; other motions of the section stay
free.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple

import numpy as np
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc
from scipy.linalg import block_diag, null_space, qr

from protractile.geometry.arrays import Array, Indices, Mask
from protractile.geometry.boom import Direction
from protractile.geometry.plating import PlatedMesh
from protractile.geometry.section import COMPONENT
from protractile.geometry.segment import Segment
from protractile.shell_model import compat
from protractile.shell_model.segment.cross_section import Row, SectionNodes, on_outline
from protractile.shell_model.segment.forms import ShellForms

# Distance in m below which a node is on a mesh line.
ON_LINE = 1.0e-7

# Condition of a support: 0 (displacement) or 1 (rotation), component, and a function that returns
# the mask of points (num_places, 3) in m.
_Condition = tuple[int, int, Callable[[Array], Mask]]

# Stiffness of a rigid rotational restraint, relative to G J_t / L or E J / L of its segment.
RIGID_TURN = 1.0e5


class Attachments(NamedTuple):
    """Attached springs or masses, each with the row of its displacement."""

    rows: Array  #: this rank's parts (num_owned, num_attached) of the rows
    factors: Array  #: stiffnesses (num_attached,) in N/m or N·m, or masses in kg

    @classmethod
    def from_rows(
        cls, rows: Sequence[Array], factors: Sequence[float], num_owned: int
    ) -> Attachments:
        """Return the attachments with these rows (num_owned,) and factors."""
        return cls(np.array(rows).reshape(-1, num_owned).T, np.array(factors, dtype=np.float64))

    def add_to(self, comm: MPI.Comm, matrix: PETSc.Mat) -> None:
        """Add factor · r rᵀ for each row r to a matrix that is distributed by rows. Collective."""
        first, _ = matrix.getOwnershipRange()
        for local, factor in zip(self.rows.T, self.factors.tolist(), strict=True):
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


def springs(segment: Segment) -> Iterator[tuple[float, Callable[[SectionNodes], Row], float]]:
    """Yield (x in m, function that returns the row, stiffness) of the springs of supports."""
    for support in segment.supports:
        section = segment.section_at(support.x)
        torsion = segment.material.shear_modulus * section.torsion_constant
        bending: Mapping[Direction, float] = {
            "z": segment.material.youngs_modulus * section.second_moment_of_area,
            "y": segment.material.youngs_modulus * section.lateral_second_moment_of_area,
        }
        if support.stiffness is not None:
            yield support.x, partial(SectionNodes.wall_deflection, direction="z"), support.stiffness
            yield support.x, partial(SectionNodes.wall_deflection, direction="y"), support.stiffness
            yield support.x, SectionNodes.twist, RIGID_TURN * torsion / segment.length
        for direction, stiffness in bending.items():
            turn = partial(SectionNodes.rotation, direction=direction)
            if support.holds_slope(direction) and support.kind != "clamped":
                yield support.x, turn, RIGID_TURN * stiffness / segment.length
            elif support.rotation_stiffness is not None:
                yield support.x, turn, support.rotation_stiffness


def masses(segment: Segment) -> Iterator[tuple[float, Callable[[SectionNodes], Row], float]]:
    """Yield (x in m, function that returns the row, mass in kg) of point masses."""
    for mass in segment.masses:
        yield mass.x, partial(SectionNodes.mean_displacement, component=0), mass.mass
        yield mass.x, partial(SectionNodes.wall_deflection, direction="y"), mass.mass
        yield mass.x, partial(SectionNodes.wall_deflection, direction="z"), mass.mass


@dataclass(frozen=True)
class Plates:
    """Plates before assembly."""

    space: Any  #: function space, which owns the communicator of the matrices
    forms: Any  #: compiled forms of the mesh, see :class:`ShellForms`
    supports: list[Any]  #: Dirichlet conditions of the rigid supports
    compressed: bool = False  #: True if the plates carry an axial force
    copies: float = 1.0  #: number of congruent parts of the segment, a factor of the forms

    @cached_property
    def nodes(self) -> Sequence[tuple[Array, Indices]]:
        """The positions in m and global rows of this rank's nodes, each (num_owned_nodes, 3).

        The first pair is for nodes of the displacement, the second for nodes of the rotation.
        """
        nodes, index_map = [], self.space.dofmap.index_map
        for part in (0, 1):
            collapsed, to_parent = self.space.sub(part).collapse()
            local = np.asarray(to_parent, dtype=np.int32).reshape(-1, 3)
            places = compat.node_places(collapsed)[: len(local)]
            owned = local[:, 0] < index_map.size_local
            rows = index_map.local_range[0] + local[owned].astype(np.int64)
            nodes.append((places[owned], rows))
        return nodes


@dataclass(frozen=True)
class ShellMatrices:
    """Matrices of a shell, distributed by rows and assembled on first use.

    Args:
        comm: ranks that share the shell.
        plates: plates of the shell.
        conditions: Dirichlet conditions.
        springs, masses: attached springs and masses.
    """

    comm: MPI.Comm
    plates: Plates
    conditions: list[Any]
    springs: Attachments
    masses: Attachments

    @cached_property
    def stiffness(self) -> PETSc.Mat:
        """The stiffness K (num_dofs, num_dofs); fixed rows have a positive diagonal. Collective."""
        return self._assemble(self.plates.forms.stiffness, 1.0, self.springs)

    @cached_property
    def mass(self) -> PETSc.Mat:
        """The mass matrix M (num_dofs, num_dofs), with 0 in fixed rows. Collective.

        So modes of fixed degrees of freedom have infinite frequency.
        """
        return self._assemble(self.plates.forms.mass, 0.0, self.masses)

    @cached_property
    def geometric(self) -> PETSc.Mat | None:
        """The geometric stiffness (num_dofs, num_dofs); None without axial force. Collective."""
        if not self.plates.compressed:
            return None
        return self._assemble(
            self.plates.forms.geometric, 0.0, Attachments.from_rows([], [], self.free.size)
        )

    def _assemble(self, form: Any, diagonal: float, attached: Attachments) -> PETSc.Mat:
        matrix = compat.assemble_matrix(form, self.conditions, diagonal)
        matrix.scale(self.plates.copies)
        attached.add_to(self.comm, matrix)
        return matrix

    @cached_property
    def free(self) -> Mask:
        """The mask (num_owned,) of free rows."""
        return free_rows(self.plates.space, self.conditions)

    @property
    def nodes(self) -> Array:
        """The positions (num_owned_nodes, 3) of the displacement nodes in m."""
        return self.plates.nodes[0][0]

    @property
    def node_dofs(self) -> Indices:
        """The global rows (num_owned_nodes, 3) of the displacement nodes."""
        return self.plates.nodes[0][1]

    @property
    def space(self) -> Any:
        """The function space of displacement and rotation."""
        return self.plates.space

    @property
    def num_dofs(self) -> int:
        """The number of degrees of freedom over all ranks."""
        return int(self.space.dofmap.index_map.size_global)

    @property
    def owned(self) -> tuple[int, int]:
        """The range of global rows of this rank: its first row, and its last row plus one."""
        first, last = self.space.dofmap.index_map.local_range
        return int(first), int(last)

    def rigid_motions(self) -> Array:
        """Return a basis (num_owned, num_free) of the rigid motions that are free. Collective.

        Without supports and springs there are six.
        """
        first, _ = self.owned
        motions = np.zeros((self.free.size, 6))
        ends = self.comm.allgather((self.nodes[:, 0].min(), self.nodes[:, 0].max()))
        middle = 0.5 * (min(low for low, _ in ends) + max(high for _, high in ends))
        for i, axis in enumerate(np.eye(3)):
            motions[self.node_dofs - first, i] = axis
            motions[:, 3 + i] = self.turn(axis, middle)
        fixed = np.concatenate(self.comm.allgather(motions[~self.free]))
        fixed = np.concatenate([fixed, self.comm.allreduce(self.springs.rows.T @ motions)])
        # All ranks use the basis of rank 0. The translation along x is separate, since no force
        # excites it.
        free = np.eye(6)
        if fixed.size:
            slides = 0 if fixed[:, 0].any() else 1
            others = null_space(qr(fixed[:, slides:], mode="r")[0][:6])
            free = block_diag(np.eye(slides), others)
        return np.asarray(motions @ self.comm.bcast(free))

    def turn(self, axis: Array, x: float) -> Array:
        """Return the motion (num_owned,) of a rotation by 1 rad about an axis (3,) at x in m."""
        first, _ = self.owned
        motion = np.zeros(self.free.size)
        motion[self.node_dofs - first] = np.cross(axis, self.nodes - [x, 0.0, 0.0])
        motion[self.plates.nodes[1][1] - first] = axis
        return motion


def free_rows(space: Any, conditions: list[Any]) -> Mask:
    """Return the mask (num_owned,) of the rows of a space without Dirichlet conditions."""
    free = np.ones(space.dofmap.index_map.size_local, dtype=bool)
    for condition in conditions:
        fixed, _ = condition.dof_indices()
        free[fixed[fixed < free.size]] = False
    return free


def dirichlet_condition(
    space: Any, part: int, component: int, where: Callable[[Array], Mask]
) -> Any:
    """Return the condition that a component of displacement (part 0) or rotation (part 1) is zero.

    ``where`` returns the mask of fixed points from points (num_places, 3) in m.
    """
    fixed = space.sub(part).sub(component)
    collapsed, _ = fixed.collapse()
    dofs = fem.locate_dofs_geometrical((fixed, collapsed), lambda points: where(points.T))
    function = fem.Function(collapsed)
    function.x.array[:] = PETSc.ScalarType(0.0)
    return fem.dirichletbc(function, dofs, fixed)


def assemble_plates(
    comm: MPI.Comm, segment: Segment, mesh: PlatedMesh | None, copies: float = 1.0
) -> Plates:
    """Return the plates of a segment, or of one of its ``copies`` equal parts. Collective."""
    points, triangles, of_cells = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), None
    if mesh is not None:
        # Collars do not carry the axial force, so that it is the same in all sections.
        membrane_force = segment.compression(mesh.along) / segment.area * mesh.load_weight
        added = segment.added_mass_per_length / (segment.material.density * segment.area)
        points, triangles = mesh.points, mesh.triangles
        of_cells = (mesh.thickness, membrane_force, mesh.thickness + added * mesh.load_weight)
    domain = compat.create_mesh(comm, points, triangles)
    thickness, compression, heavy = (
        compat.cellwise_function(domain, values) for values in comm.bcast(of_cells)
    )
    space = compat.shell_space(domain)
    heavy = heavy if segment.added_mass_per_length else None
    forms = ShellForms(space, thickness, segment.material, compression=compression, heavy=heavy)
    supports = [dirichlet_condition(space, *support) for support in _rigid_supports(segment)]
    return Plates(space, forms, supports, bool(segment.compression), copies)


def _rigid_supports(segment: Segment) -> Iterator[_Condition]:
    """Yield the conditions of rigid supports."""
    for support in segment.supports:
        if support.stiffness is not None:
            continue
        outline = partial(on_outline, section=segment.section_at(support.x), x=support.x)
        clamped = support.kind == "clamped"
        for part in (0, 1) if clamped else (0,):
            for component in (0, 1, 2) if clamped else COMPONENT.values():
                yield part, component, outline
