# SPDX-License-Identifier: LGPL-3.0-or-later
"""One segment as a shell: distributed matrices, supports, and the nodes of its outlines."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from mpi4py import MPI

from geometry.arrays import Array, Indices, Mask
from geometry.boom import Direction, Segment, Support
from geometry.mesh import SegmentMesh, part_along, plate_thickness, wall_thickness
from geometry.section import COMPONENT, Section
from geometry.taper import areas
from shell_model import compat
from shell_model.contact.attachments import Attached
from shell_model.cross_section import Outline, Row
from shell_model.forms import ShellForms
from shell_model.reduction.products import times
from shell_model.shell import Matrices, Plates, Shell, free_rows, hold, owned_nodes

# What holds a turn of the section at a support, over G J_t / L or E J / L of its segment: no
# segment can tell it from a rigid hold.
RIGID_TURN = 1.0e5

# Part of the largest value below which a value of a load is round-off.
_ROUND_OFF = 1.0e-10


@dataclass(frozen=True, slots=True)
class SegmentShell(Shell):
    """The shell of one segment, which loads push as they do a :class:`geometry.load.Member`.

    Args:
        unit_loads: direction → (num_owned,) a uniform load of 1 N/m along it, zero in held rows;
            it is spread over the plain section, collars and diaphragms have no part in it.
        plain_loads: direction → (num_owned,) what the plain section feels of an acceleration along
            it, as 1 N/m on average; ``unit_loads`` unless it tapers.
        stiffener_loads: direction → (num_owned,) what collars and diaphragms alone feel of an
            acceleration of 1 m/s² along it, in N, zero in held rows.
        masses: what the segment carries.
        section: the plates.
        segment: what it is made from.
        mesh: on rank 0.
    """

    unit_loads: Mapping[Direction, Array]
    plain_loads: Mapping[Direction, Array]
    stiffener_loads: Mapping[Direction, Array]
    masses: Attached
    section: Section
    segment: Segment
    mesh: SegmentMesh | None

    @property
    def thickness(self) -> Array | None:
        """(num_triangles,) of all plates in m, on rank 0."""
        return None if self.mesh is None else plate_thickness(self.segment, self.mesh)

    @property
    def axial_stress(self) -> Array | None:
        """(num_triangles,) what the axial force adds to the stress along x in Pa, on rank 0."""
        return self.pulled(lambda x: -self.segment.compression(x))

    def pulled(self, force: Callable[[Array], Array]) -> Array | None:
        """(num_triangles,) the stress along x of normal forces in N at x in Pa, on rank 0.

        The plain walls carry them, and hand them on to collars.
        """
        if self.mesh is None:
            return None
        x = self.mesh.points[self.mesh.triangles, 0].mean(axis=1)
        plain = force(x) / self.segment.area
        return plain * _evenly(self.segment, self.mesh) / plate_thickness(self.segment, self.mesh)

    def outline(self, x: float) -> Outline:
        """The nodes at x, the same on every rank. Collective."""
        return _outline(self.comm, self.nodes, self.node_dofs, self.segment.section_at(x), x)

    def own_load(self, directions: Iterable[Direction]) -> Array:
        """(num_owned,) the segment's uniform loads that are applied at t = 0 and kept, in N."""
        kept = {"z": self.segment.load}
        if self.segment.lateral is not None:
            kept["y"] = self.segment.lateral.load
        parts = [kept[d] * self.unit_loads[d] for d in directions if d in kept]
        return np.asarray(np.sum(parts, axis=0))

    def force(self, x: float, direction: Direction) -> Array:
        """(num_owned,) 1 N at x in m, spread over the walls that carry it in their own plane."""
        return self.row(self.outline(x).wall_deflection(direction))

    def moment(self, x: float, direction: Direction) -> Array:
        """(num_owned,) 1 N·m at x in m, spread over all walls as bending stress is."""
        return self.row(self.outline(x).rotation(direction))

    def torque(self, x: float) -> Array:
        """(num_owned,) 1 N·m at x in m about the axis, spread along all walls."""
        return self.row(self.outline(x).twist())

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        """(num_owned,) 1 N/m between mesh lines at two x in m, or along all of it. Collective."""
        if span is None:
            return self.unit_loads[direction]
        start, end = span
        thickness = None
        if self.mesh is not None:
            x = self.mesh.points[self.mesh.triangles, 0].mean(axis=1)
            thickness = _evenly(self.segment, self.mesh) * ((x > start) & (x < end))
        forms = self.matrices.plates.forms
        loaded = compat.cellwise_function(self.space.mesh, self.comm.bcast(thickness))
        forms.loaded.x.array[:] = loaded.x.array
        return _unit_load(self.comm, forms, direction) / self.segment.area * self.free

    def inertia(self, direction: Direction, force: float) -> Array:
        """(num_owned,) an acceleration that the plain segment feels as so many N/m."""
        acceleration = force / self.segment.mass_per_length
        whole = force * self.plain_loads[direction]
        return whole + acceleration * self.stiffener_loads[direction]

    def turning(self, direction: Direction) -> Array:
        """(num_owned,) the inertia of all plates against 1 rad/s² about x = 0. Collective."""
        axis = np.cross([1.0, 0.0, 0.0], np.eye(3)[COMPONENT[direction]])
        # What is held takes part in the motion of what is not.
        mass = compat.assemble_matrix(self.matrices.plates.forms.mass, [], 0.0)
        inertia = times(mass, self.turn(axis, 0.0)[:, None])[:, 0] * self.free
        mass.destroy()
        return np.asarray(inertia)

    def row(self, weights: Row) -> Array:
        """(num_owned,) this rank's part of a row given as global dof → weight."""
        return _local_row(self.owned[0], self.free, weights)


def assemble_segment(comm: MPI.Comm, segment: Segment, mesh: SegmentMesh | None) -> SegmentShell:
    """Assemble a segment's shell. Collective.

    A rigid support holds the section's outline against y and z, which leaves it free to tilt; a
    clamped one holds every displacement and rotation of it. An elastic support is a spring on
    the mean deflection of the walls, along z and along y, with the twist held; what holds one slope
    alone, or gives way to it, is a spring on the rotation of the section. Point masses move with
    the same means. Nothing holds the segment along x, and nothing pushes it there. A diaphragm is
    held, pushed and read through the outline to which it is welded alone.

    Args:
        comm: the ranks that share it.
        segment: whose section is known.
        mesh: of its walls and diaphragms, on rank 0, with mesh lines at supports, masses and the
            ends of collars; None elsewhere.
    """
    section = segment.section
    assert section is not None
    plates = assemble_plates(comm, segment, mesh)
    space, forms = plates.space, plates.forms
    plain_loads = {d: _unit_load(comm, forms, d) / segment.area for d in COMPONENT}
    unit_loads = plain_loads
    forms.loaded.x.array[:] = plates.thickness.x.array - forms.loaded.x.array
    density = segment.material.density
    stiffener_loads = {d: density * _unit_load(comm, forms, d) for d in COMPONENT}
    if segment.head_section is not None:
        even = None if mesh is None else _evenly(segment, mesh)
        spread = compat.cellwise_function(space.mesh, comm.bcast(even))
        forms.loaded.x.array[:] = spread.x.array
        unit_loads = {d: _unit_load(comm, forms, d) / segment.area for d in COMPONENT}
    free = free_rows(space, plates.holds)
    nodes, node_dofs = owned_nodes(space, 0)
    rotation_nodes, rotation_dofs = owned_nodes(space, 1)

    def attached(what: Iterator[tuple[float, Callable[[Outline], Row], float]]) -> Attached:
        rows, factors = [], []
        for x, row, factor in what:
            outline = _outline(comm, nodes, node_dofs, segment.section_at(x), x)
            rows.append(_local_row(space.dofmap.index_map.local_range[0], free, row(outline)))
            factors.append(factor)
        return Attached.of(rows, factors, free.size)

    springs, masses = attached(_springs(segment)), attached(_masses(segment))
    return SegmentShell(
        comm=comm,
        matrices=Matrices(comm, plates, plates.holds, springs, masses),
        unit_loads={d: load * free for d, load in unit_loads.items()},
        plain_loads={d: load * free for d, load in plain_loads.items()},
        stiffener_loads={d: load * free for d, load in stiffener_loads.items()},
        free=free,
        springs=springs,
        masses=masses,
        nodes=nodes,
        node_dofs=node_dofs,
        rotation_nodes=rotation_nodes,
        rotation_dofs=rotation_dofs,
        section=section,
        segment=segment,
        mesh=mesh,
        space=space,
    )


def assemble_plates(comm: MPI.Comm, segment: Segment, mesh: SegmentMesh | None) -> Plates:
    """The plates of a mesh, a segment's whole one or a part of it. Collective."""
    if mesh is not None:
        points, triangles = mesh.points, mesh.triangles
        plain = wall_thickness(segment, mesh)
        # The plain walls carry the whole axial force, so that it is the same in each section.
        force = segment.compression(points[triangles, 0].mean(axis=1))
        pressing = force / segment.area * _evenly(segment, mesh)
        of_cells = plate_thickness(segment, mesh), plain, pressing
    else:
        points, triangles = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
        of_cells = None
    domain = compat.create_triangle_mesh(comm, points, triangles)
    thickness, loaded, pressed = (
        compat.cellwise_function(domain, values) for values in comm.bcast(of_cells)
    )
    space = compat.shell_space(domain)
    forms = ShellForms(space, thickness, segment.material, loaded=loaded, compression=pressed)
    holds = _holds(space, segment)
    return Plates(space, thickness, forms, holds, bool(segment.compression))


def _evenly(segment: Segment, mesh: SegmentMesh) -> Array:
    """(num_triangles,) thickness in m by which a force per length that is the same at each x is
    spread over the walls: theirs, over the section's part of the mean area where it tapers.
    """
    thickness = wall_thickness(segment, mesh)
    if segment.section is None or segment.head_section is None:
        return thickness
    parabola = np.polyfit([0.0, 0.5, 1.0], areas(segment.section, segment.head_section), 2)
    return np.asarray(thickness * segment.area / np.polyval(parabola, part_along(segment, mesh)))


def _outline(
    comm: MPI.Comm,
    nodes: Array,
    node_dofs: Indices,
    section: Section,
    x: float,
) -> Outline:
    at = _on_outline(nodes, section, x)
    places = np.concatenate(comm.allgather(nodes[at]))
    dofs = np.concatenate(comm.allgather(node_dofs[at]))
    return Outline(x, places, dofs, section)


def _on_outline(places: Array, section: Section, x: float) -> Mask:
    """(num_places,) whether places (num_places, 3) are on the walls at x."""
    at_x = np.abs(places[:, 0] - x) < section.near
    return np.asarray(section.on_plates(places[:, 1:]) & at_x)


def _local_row(first: int, free: Mask, weights: Row) -> Array:
    local = np.zeros(free.size)
    for dof, weight in weights.items():
        if first <= dof < first + free.size and free[dof - first]:
            local[dof - first] += weight
    return local


def _unit_load(comm: MPI.Comm, forms: ShellForms, direction: Direction) -> Array:
    """The assembled load. It has exact zeros at the vertices, where a quadratic function has no
    mean, and at most two cells that carry it elsewhere, so that no order of summation is left in
    that of a plain box.
    """
    forms.load_direction.value[:] = np.eye(3)[COMPONENT[direction]]
    load = compat.assemble_vector(forms.unit_load)
    largest = comm.allreduce(np.abs(load).max(initial=0.0), MPI.MAX)
    load[np.abs(load) < _ROUND_OFF * largest] = 0.0
    return load


def _springs(segment: Segment) -> Iterator[tuple[float, Callable[[Outline], Row], float]]:
    """Where supports pull that are elastic, or hold a turn, at what, and how stiffly."""
    for support in segment.supports:
        section = segment.section_at(support.x)
        torsion = segment.material.shear_modulus * section.torsion_constant
        bending: Mapping[Direction, float] = {
            "z": segment.material.youngs_modulus * section.second_moment_of_area,
            "y": segment.material.youngs_modulus * section.lateral_second_moment_of_area,
        }
        if support.stiffness is not None:
            yield support.x, partial(Outline.wall_deflection, direction="z"), support.stiffness
            yield support.x, partial(Outline.wall_deflection, direction="y"), support.stiffness
            yield support.x, Outline.twist, RIGID_TURN * torsion / segment.length
        for direction, stiffness in bending.items():
            turn = partial(Outline.rotation, direction=direction)
            if support.holds_slope(direction) and not _is_clamped(support):
                yield support.x, turn, RIGID_TURN * stiffness / segment.length
            elif support.rotation_stiffness is not None:
                yield support.x, turn, support.rotation_stiffness


def _masses(segment: Segment) -> Iterator[tuple[float, Callable[[Outline], Row], float]]:
    """Where point masses are, what moves them, and how heavy they are."""
    for mass in segment.masses:
        yield mass.x, partial(Outline.mean_displacement, component=0), mass.mass
        yield mass.x, partial(Outline.wall_deflection, direction="y"), mass.mass
        yield mass.x, partial(Outline.wall_deflection, direction="z"), mass.mass


def _holds(space: Any, segment: Segment) -> list[Any]:
    """Dirichlet conditions of the rigid supports."""

    def at(x: float) -> Callable[[Array], Mask]:
        section = segment.section_at(x)
        return lambda places: _on_outline(places, section, x)

    return [
        hold(space, part, component, at(support.x))
        for support in segment.supports
        if support.stiffness is None
        for part, component in _held_components(support)
    ]


def _held_components(support: Support) -> list[tuple[int, int]]:
    """Components that a rigid support holds: (0, i) of displacement, (1, i) of rotation."""
    if _is_clamped(support):
        return [(part, component) for part in (0, 1) for component in (0, 1, 2)]
    return [(0, COMPONENT["y"]), (0, COMPONENT["z"])]


def _is_clamped(support: Support) -> bool:
    return support.holds_slope("z") and support.holds_slope("y")
