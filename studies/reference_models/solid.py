# SPDX-License-Identifier: LGPL-3.0-or-later
"""Solid model of a symmetry class of a segment's motions, the reference of the shell.

It has the interface of a symmetry class of a shell. A displacement of the mid-surface corresponds
to the mean over the thickness of the solid wall; at a corner, to the mean over the square common to
two walls. A force is distributed in the same way.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import ufl
from dolfinx import fem
from mpi4py import MPI
from petsc4py import PETSc
from scipy.sparse import csr_matrix, diags, vstack

from protractile.geometry.arrays import Array, Indices, Mask
from protractile.geometry.boom import Material, Segment
from protractile.geometry.box import BoxSection
from protractile.shell_model import compat
from protractile.shell_model.reduction.mirror import SymmetryClass, on_plane
from protractile.shell_model.segment.cross_section import Row, SectionNodes
from protractile.shell_model.segment.shell import ON_LINE, Attachments, Plates, ShellMatrices

# Length ratios of successive edges along x and around; effects decay more slowly along x.
_GROWTH_ALONG = 3.0
_GROWTH_AROUND = 4.0


@dataclass(frozen=True, slots=True)
class SolidMesh:
    """Hexahedra of a quarter of one segment, on a lattice of planes."""

    points: Array  #: (num_points, 3) in m, x along the boom, the axis at y = z = 0
    hexahedra: Indices  #: (num_hexahedra, 8) points, in each cell along x first, then y, then z
    planes: tuple[Array, Array, Array]  #: ascending coordinates in m of planes normal to x, y, z
    layers: int  #: layers of hexahedra through each wall, an even number


def mesh_quarter(
    section: BoxSection,
    places: Sequence[float],
    along: tuple[float, float],
    around: float,
    splits: int = 1,
    layers: int = 2,
) -> SolidMesh:
    """Mesh the walls of a box where y and z are positive.

    Args:
        section: mid-lines and thicknesses.
        places: x in m at which there must be mesh planes; the smallest and the largest are the
            ends of the segment.
        along: approximate edge lengths in m along x, near forces and supports and far from them.
        around: approximate largest edge length in m around the section. At corners the edge length
            is the wall thickness.
        splits: number of parts of each edge around the section, to refine the mesh evenly.
        layers: layers of hexahedra through a wall, an even number.
    """
    ends = np.unique(places)
    spans = []
    for length in np.diff(ends):
        half = _growing(0.5 * length, *along, _GROWTH_ALONG)
        spans += [half, half[::-1]]
    planes = (
        ends[0] + np.concatenate([[0.0], np.cumsum(np.concatenate(spans))]),
        _across(section.width, section.web, around, splits, layers),
        _across(section.height, section.flange, around, splits, layers),
    )
    points, hexahedra = _walls(planes, layers)
    return SolidMesh(points, hexahedra, planes, layers)


def _growing(length: float, smallest: float, largest: float, growth: float) -> Array:
    """Return edge lengths in m over a length, which grow from the smallest up to the largest."""
    edges = [min(smallest, largest)]
    while sum(edges) < length:
        edges.append(min(growth * edges[-1], largest))
    return np.array(edges) * (length / sum(edges))


def _across(distance: float, wall: float, size: float, splits: int, layers: int) -> Array:
    """Return the mesh planes in m from the middle of the box to the outer face of a wall."""
    clear = _growing(0.5 * (distance - wall), wall, size, _GROWTH_AROUND)[::-1]
    edges = [np.repeat(clear / splits, splits), np.full(layers, wall / layers)]
    return np.concatenate([[0.0], np.cumsum(np.concatenate(edges))])


def _walls(planes: tuple[Array, Array, Array], layers: int) -> tuple[Array, Indices]:
    """Return the points and cells of a lattice in the walls, which are its outermost layers."""
    shape = tuple(plane.size for plane in planes)
    number = np.arange(np.prod(shape)).reshape(shape)
    j, k = np.indices((shape[1] - 1, shape[2] - 1))
    filled = (j >= shape[1] - 1 - layers) | (k >= shape[2] - 1 - layers)
    j, k = j[filled], k[filled]
    corners = [
        number[dx : shape[0] - 1 + dx, j + dy, k + dz].ravel()
        for dz in (0, 1)
        for dy in (0, 1)
        for dx in (0, 1)
    ]
    lattice = np.stack(np.meshgrid(*planes, indexing="ij"), axis=-1).reshape(-1, 3)
    used, hexahedra = np.unique(np.column_stack(corners), return_inverse=True)
    return lattice[used], hexahedra.reshape(-1, 8)


class _SolidPlates(Plates):
    """Function space and forms of a solid on one process; a solid has no rotations."""

    @cached_property
    def nodes(self) -> Sequence[tuple[Array, Indices]]:
        """Places in m and rows of the nodes of the displacement."""
        places = self.space.tabulate_dof_coordinates()
        none = np.zeros((0, 3))
        return [(places, np.arange(places.size).reshape(-1, 3)), (none, none.astype(np.int64))]


@dataclass(frozen=True)
class SolidFamily(ShellMatrices):
    """Solid model of a quarter of a segment: stiffness and mass, on one process.

    Energies are those of the whole segment. A solid has no rotations.
    """

    fixed: Indices  #: (num_fixed,) constrained degrees of freedom
    section: BoxSection
    midpoints: Array  #: positions (num_midpoints, 3) on the mid-surfaces of the whole segment in m
    means: csr_matrix  #: rows (3 num_midpoints, num_dofs) of the mean displacements there

    @cached_property
    def free(self) -> Mask:
        """Mask (num_dofs,), False in fixed rows."""
        free = np.ones(self.nodes.size, dtype=bool)
        free[self.fixed] = False
        return free

    def _assemble(self, form: Any, diagonal: float, attached: Attachments) -> PETSc.Mat:
        matrix = super()._assemble(form, diagonal, attached)
        matrix.zeroRowsColumns(self.fixed.astype(PETSc.IntType), diagonal)
        return matrix

    @property
    def num_dofs(self) -> int:
        """Number of degrees of freedom."""
        return int(self.free.size)

    @property
    def owned(self) -> tuple[int, int]:
        """Range of all rows."""
        return 0, self.num_dofs

    def outline(self, x: float) -> SectionNodes:
        """Return the means at a mesh plane x in m; :meth:`row` accepts their operators."""
        at = np.flatnonzero(np.abs(self.midpoints[:, 0] - x) < ON_LINE)
        return SectionNodes(x, self.midpoints[at], 3 * at[:, None] + np.arange(3), self.section)

    def row(self, weights: Row) -> Array:
        """Return the row (num_dofs,) of an operator on means, for motions of the symmetry class."""
        of_means = np.zeros(self.means.shape[0])
        of_means[list(weights)] = list(weights.values())
        of_means = self.means.T @ of_means
        return np.where(self.free, of_means, 0.0)


class SolidForms(NamedTuple):
    """Compiled bilinear forms."""

    stiffness: Any
    mass: Any


def solid_forms(space: Any, material: Material) -> SolidForms:
    """Return forms of linear elasticity (Navier 1821), isotropic, on a ``solid_space``."""
    domain = space.mesh
    shear, nu = material.shear_modulus, material.poissons_ratio
    mu, lame, density = (
        # With constants in place of numbers, one compiled form serves every material.
        fem.Constant(domain, PETSc.ScalarType(value))
        for value in (shear, 2.0 * shear * nu / (1.0 - 2.0 * nu), material.density)
    )
    u, v = ufl.TrialFunction(space), ufl.TestFunction(space)
    strain, virtual = ufl.sym(ufl.grad(u)), ufl.sym(ufl.grad(v))
    energy = 2.0 * mu * ufl.inner(strain, virtual) + lame * ufl.tr(strain) * ufl.tr(virtual)
    dx = ufl.dx(degree=4, domain=domain)  # exact on bricks
    return SolidForms(fem.form(energy * dx), fem.form(density * ufl.inner(u, v) * dx))


def assemble_solid(segment: Segment, mesh: SolidMesh, family: SymmetryClass) -> SolidFamily:
    """Assemble one symmetry class of a segment's motions on this process.

    A pinned support fixes the whole section along y and z, so that it can still rotate. A clamped
    support fixes all displacements of the section.

    Args:
        segment: segment with a box section on rigid supports.
        mesh: mesh of a quarter, with planes at supports and outlines.
        family: the symmetry class.

    Raises:
        ValueError: the solid does not model a feature of the segment.
    """
    section = segment.section
    assert isinstance(section, BoxSection)
    if segment.masses or segment.collars or segment.diaphragms:
        raise ValueError(f"{segment.name!r} as a solid has plain walls and carries no masses")
    if any(
        support.stiffness is not None
        or support.rotation_stiffness is not None
        or support.kind == "hinged"
        for support in segment.supports
    ):
        raise ValueError(f"{segment.name!r} as a solid takes rigid supports alone")
    comm = MPI.COMM_SELF
    space = compat.solid_space(compat.create_mesh(comm, mesh.points, mesh.hexahedra))
    plates = _SolidPlates(space, solid_forms(space, segment.material), [], copies=4.0)
    nodes, _ = plates.nodes[0]
    free = np.ones(nodes.shape, dtype=bool)
    for axis in (1, 2):
        for part, component in family.fixed_components(axis):
            if part == 0:
                free[on_plane(nodes, axis), component] = False
    for support in segment.supports:
        fixed = slice(0 if support.kind == "clamped" else 1, None)
        free[np.abs(nodes[:, 0] - support.x) < ON_LINE, fixed] = False
    midpoints, means = _means(mesh, nodes, family)
    nothing = Attachments.from_rows([], [], free.size)
    held = np.flatnonzero(~free)
    return SolidFamily(comm, plates, [], nothing, nothing, held, section, midpoints, means)


def _means(mesh: SolidMesh, nodes: Array, family: SymmetryClass) -> tuple[Array, csr_matrix]:
    """Return positions on mid-surfaces of the whole segment, and the rows of the means there."""
    places, quarter = _quarter_means(mesh, nodes)
    parts: list[tuple[Array, csr_matrix]] = []
    for signs, sides in zip(family.signs[:, :3], _SIDES, strict=True):
        # A point in a plane of symmetry counts once.
        mine = ~((on_plane(places, 1) & (sides[1] < 0)) | (on_plane(places, 2) & (sides[2] < 0)))
        image = diags(np.tile(signs, len(places))) @ quarter
        parts.append((places[mine] * sides, image[np.repeat(mine, 3)]))
    return np.concatenate([at for at, _ in parts]), csr_matrix(vstack([rows for _, rows in parts]))


# Signs of y and z in the quarters, in the order of ``SymmetryClass.signs``.
_SIDES = np.array([(1, 1, 1), (1, -1, 1), (1, 1, -1), (1, -1, -1)])


def _quarter_means(mesh: SolidMesh, nodes: Array) -> tuple[Array, csr_matrix]:
    lines = [np.sort(np.r_[plane, 0.5 * (plane[1:] + plane[:-1])]) for plane in mesh.planes]
    number = np.full([line.size for line in lines], -1)
    between = (0.5 * (line[1:] + line[:-1]) for line in lines)
    at = tuple(np.searchsorted(*pair) for pair in zip(between, nodes.T, strict=True))
    number[at] = np.arange(len(nodes))

    stencils = list(_stencils(number.shape[1], number.shape[2], mesh.layers))
    stencil = np.repeat(np.arange(len(stencils)), [weights.size for *_, weights in stencils])
    j, k, weights = (np.concatenate(part) for part in zip(*stencils, strict=True))
    # Outlines are available only at mesh planes.
    taken = number[::2, j, k]
    places = np.empty((len(taken), len(stencils), 3))
    places[:, :, 0] = mesh.planes[0][:, None]
    places[:, :, 1] = np.bincount(stencil, weights * lines[1][j])
    places[:, :, 2] = np.bincount(stencil, weights * lines[2][k])

    means = stencil + len(stencils) * np.arange(len(taken))[:, None]
    rows, columns = ((3 * one[..., None] + np.arange(3)).ravel() for one in (means, taken))
    values = np.tile(np.repeat(weights, 3), len(taken))
    matrix = csr_matrix((values, (rows, columns)), shape=(places.size, nodes.size))
    return places.reshape(-1, 3), matrix


def _stencils(num_y: int, num_z: int, layers: int) -> Iterator[tuple[Indices, Indices, Array]]:
    """Return the positions along y and z and the weights of the nodes of each mean.

    There are ``layers`` of cells through a wall.
    """
    # Simpson's rule is exact for the quadratic displacement of a cell.
    simpson = np.zeros(2 * layers + 1)
    for cell in range(layers):
        simpson[2 * cell : 2 * cell + 3] += np.array([1.0, 4.0, 1.0]) / (6.0 * layers)
    web, flange = (num - 1 - 2 * layers + np.arange(2 * layers + 1) for num in (num_y, num_z))
    for j in range(num_y - 1 - layers):
        yield np.full_like(flange, j), flange, simpson
    for k in range(num_z - 1 - layers):
        yield web, np.full_like(web, k), simpson
    square = np.outer(simpson, simpson).ravel()
    yield np.repeat(web, flange.size), np.tile(flange, web.size), square
