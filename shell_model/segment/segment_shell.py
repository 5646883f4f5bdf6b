# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shell of one segment: distributed matrices, supports, and the nodes of its outlines."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from mpi4py import MPI

from protractile.geometry.arrays import Array, Mask
from protractile.geometry.boom import Direction, Segment
from protractile.geometry.plating import PlatedMesh
from protractile.geometry.section import COMPONENT
from protractile.shell_model import compat
from protractile.shell_model.reduction.mirror import match_points
from protractile.shell_model.segment.cross_section import Row, SectionNodes
from protractile.shell_model.segment.shell import (
    Attachments,
    ShellMatrices,
    assemble_plates,
    free_rows,
    masses,
    springs,
)
from protractile.shell_model.segment.solver import times

# Fraction of a load's largest value below which a value is round-off.
_ROUND_OFF = 1.0e-10


@dataclass(frozen=True)
class SegmentShell(ShellMatrices):
    """Shell of one segment, and its load vectors; a :class:`.geometry.load.LoadedSegment`."""

    segment: Segment  #: the segment
    mesh: PlatedMesh | None  #: mesh of the segment, on rank 0

    @cached_property
    def unit_loads(self) -> Mapping[Direction, Array]:
        """The load vectors (num_owned,) of 1 N/m in each direction. All MPI ranks must call it.

        Loads act on the walls, not on collars and diaphragms, and are zero in fixed rows.
        """
        loads = self._loads_on(lambda mesh: mesh.load_weight)
        return {direction: load / self.segment.area for direction, load in loads.items()}

    @cached_property
    def plain_loads(self) -> Mapping[Direction, Array]:
        """The inertia loads (num_owned,) in each direction, with a mean of 1 N/m. Collective.

        They exclude collars and diaphragms.
        """
        loads = self._loads_on(lambda mesh: mesh.plain)
        return {direction: load / self.segment.area for direction, load in loads.items()}

    def outline(self, x: float) -> SectionNodes:
        """Return the outline at x in m, the same on every rank. Collective."""
        section = self.segment.section_at(x)
        return SectionNodes.gather(self.comm, self.nodes, self.node_dofs, section, x)

    def own_load(self, directions: Iterable[Direction]) -> Array:
        """Return the load vector (num_owned,) of the constant uniform loads in N."""
        line_loads = {"z": self.segment.load}
        if self.segment.lateral is not None:
            line_loads["y"] = self.segment.lateral.load
        parts = [line_loads[d] * self.unit_loads[d] for d in directions if d in line_loads]
        return np.asarray(np.sum(parts, axis=0))

    def unit_load_vector(self, x: float, direction: Direction) -> Array:
        """Return the load vector (num_owned,) of 1 N at x in m on the shear-carrying walls."""
        return self.row(self.outline(x).wall_deflection(direction))

    def moment(self, x: float, direction: Direction) -> Array:
        """Return the load vector (num_owned,) of 1 N·m at x in m, distributed as bending stress."""
        return self.row(self.outline(x).rotation(direction))

    def torque(self, x: float) -> Array:
        """Return the load vector (num_owned,) of a torque of 1 N·m at x in m on all walls."""
        return self.row(self.outline(x).twist())

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        """Return the load vector (num_owned,) of 1 N/m; ``span`` has mesh lines. Collective."""
        if span is None:
            return self.unit_loads[direction]
        start, end = span
        loads = self._loads_on(
            lambda mesh: mesh.load_weight * ((mesh.along > start) & (mesh.along < end))
        )
        return loads[direction] / self.segment.area

    def inertia(self, direction: Direction, force: float) -> Array:
        """Return the load vector (num_owned,) of a uniform acceleration. Collective."""
        acceleration = force / self.segment.mass_per_length
        # Collars and diaphragms are separate, since two walls and a diaphragm meet on an edge.
        collars = self._loads_on(lambda mesh: (mesh.thickness - mesh.plain) * (mesh.plain > 0.0))
        diaphragms = self._loads_on(lambda mesh: mesh.thickness * (mesh.plain == 0.0))
        of_stiffeners = collars[direction] + diaphragms[direction]
        added = acceleration * self.segment.added_mass_per_length
        whole = (force - added) * self.plain_loads[direction]
        whole += added * self.unit_loads[direction]
        return whole + acceleration * (self.segment.material.density * of_stiffeners)

    def rotation_load(self, direction: Direction) -> Array:
        """Return the load vector (num_owned,) of 1 rad/s² about x = 0. Collective.

        Rank 0 assembles it on the whole mesh, so that the order of summation is the same on any
        number of ranks.
        """
        of_nodes: list[tuple[Array, Array]] = []
        if self.mesh is not None:
            whole = assemble_segment(MPI.COMM_SELF, self.segment, self.mesh)
            axis = np.cross([1.0, 0.0, 0.0], np.eye(3)[COMPONENT[direction]])
            # The mass couples free degrees of freedom with constrained ones.
            mass = compat.assemble_matrix(whole.plates.forms.mass, [], 0.0)
            inertia = times(mass, whole.turn(axis, 0.0)[:, None])[:, 0] * whole.free
            mass.destroy()
            of_nodes = [(places, inertia[rows]) for places, rows in whole.plates.nodes]
        first, _ = self.owned
        load = np.empty(self.free.size)
        for (nodes, dofs), (places, loads) in zip(
            self.plates.nodes, self.comm.bcast(of_nodes), strict=True
        ):
            load[dofs - first] = loads[match_points(nodes, places)]
        return load

    def _loads_on(self, thickness: Callable[[PlatedMesh], Array]) -> dict[Direction, Array]:
        """Return load vectors (num_owned,) of a body force of 1 N/m³. Collective.

        ``thickness`` returns thicknesses (num_triangles,) in m. Loads are zero in fixed rows, and
        at vertices, where the integrals of quadratic shape functions vanish. Elsewhere at most two
        cells of walls, or of a diaphragm, contribute: the order of summation has no effect.
        """
        of_cells = self.comm.bcast(None if self.mesh is None else thickness(self.mesh))
        forms = self.plates.forms
        forms.loaded.x.array[:] = compat.cellwise_function(self.space.mesh, of_cells).x.array
        loads: dict[Direction, Array] = {}
        for direction, component in COMPONENT.items():
            forms.load_direction.value[:] = np.eye(3)[component]
            load = compat.assemble_vector(forms.unit_load)
            largest = self.comm.allreduce(np.abs(load).max(initial=0.0), MPI.MAX)
            load[np.abs(load) < _ROUND_OFF * largest] = 0.0
            loads[direction] = load * self.free
        return loads

    def row(self, weights: Row) -> Array:
        """Return this rank's part (num_owned,) of a row."""
        return _local_row(self.owned[0], self.free, weights)


def assemble_segment(comm: MPI.Comm, segment: Segment, mesh: PlatedMesh | None) -> SegmentShell:
    """Return the shell of a segment. Collective.

    A rigid support fixes the outline of the section along y and z; a clamped support fixes all its
    displacements and rotations. An elastic support is a spring on the mean deflections of the walls
    along z and y, and fixes the twist. Rotational restraints are springs on the rotation of the
    section. Point masses act on the mean deflections of the walls. The segment is free along x.

    Args:
        comm: ranks that share the shell.
        segment: segment with a section.
        mesh: mesh of its walls and diaphragms, on rank 0, with mesh lines at supports, masses and
            the ends of collars; None elsewhere.
    """
    plates = assemble_plates(comm, segment, mesh)
    first = plates.space.dofmap.index_map.local_range[0]
    free = free_rows(plates.space, plates.supports)

    def attached(what: Iterator[tuple[float, Callable[[SectionNodes], Row], float]]) -> Attachments:
        rows, factors = [], []
        for x, row, factor in what:
            outline = SectionNodes.gather(comm, *plates.nodes[0], segment.section_at(x), x)
            rows.append(_local_row(first, free, row(outline)))
            factors.append(factor)
        return Attachments.from_rows(rows, factors, free.size)

    return SegmentShell(
        comm,
        plates,
        plates.supports,
        attached(springs(segment)),
        attached(masses(segment)),
        segment,
        mesh,
    )


def _local_row(first: int, free: Mask, weights: Row) -> Array:
    local = np.zeros(free.size)
    for dof, weight in weights.items():
        if first <= dof < first + free.size and free[dof - first]:
            local[dof - first] += weight
    return local
