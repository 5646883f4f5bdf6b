# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows of displacements of a section of the shell: mean deflection, rotation, distortion, twist.

An outline is a mesh line around the section. Displacements are quadratic along each of its edges,
so that Simpson's rule and quadratic interpolation are exact. A row is also the load vector of a
force that is distributed over the section.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mpi4py import MPI

from protractile.geometry.arrays import Array, Indices, Mask
from protractile.geometry.section import COMPONENT, Direction, Plate, Section

_X = 0


class Row(dict[int, float]):
    """Linear combination of degrees of freedom: weights by the global number of each."""

    @classmethod
    def from_weights(cls, dofs: Indices, weights: Array) -> Row:
        """Return the row with these weights; weights of the same degree of freedom are added."""
        row = cls()
        for dof, weight in zip(dofs.tolist(), weights.tolist(), strict=True):
            row[dof] = row.get(dof, 0.0) + weight
        return row

    def __add__(self, other: Row) -> Row:
        return Row(self | {dof: self.get(dof, 0.0) + weight for dof, weight in other.items()})

    def __rmul__(self, factor: float) -> Row:
        return Row({dof: factor * weight for dof, weight in self.items()})

    def __neg__(self) -> Row:
        return -1.0 * self

    def __sub__(self, other: Row) -> Row:
        return self + -other


class Operator(dict[int, Row]):
    """Displacement operator of a boom: a row for each segment that contributes, by its index."""

    def __add__(self, other: Operator) -> Operator:
        """Return the sum of two displacement operators."""
        both = {number: self.get(number, Row()) + row for number, row in other.items()}
        return Operator(self | both)

    def __rmul__(self, factor: float) -> Operator:
        return Operator({number: factor * row for number, row in self.items()})


def on_outline(places: Array, section: Section, x: float) -> Mask:
    """Return the mask (num_places,) of points (num_places, 3) that are on the walls at x in m."""
    at_x = np.abs(places[:, 0] - x) < section.near
    return np.asarray(section.on_plates(places[:, 1:]) & at_x)


def quadratic(s: Array) -> Array:
    """Return shape functions (..., 3) of first end, midpoint and last end of an edge, 0 ≤ s ≤ 1."""
    return np.stack([(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)], axis=-1)


@dataclass(frozen=True, slots=True)
class SectionNodes:
    """Displacement nodes around the section at one x."""

    x: float  #: x in m
    places: Array  #: (num_nodes, 3) positions in m
    dofs: Indices  #: (num_nodes, 3) global rows of the displacement components
    section: Section  #: section of the plates

    @classmethod
    def gather(
        cls, comm: MPI.Comm, nodes: Array, node_dofs: Indices, section: Section, x: float
    ) -> SectionNodes:
        """Return the outline at x, the same on every rank. Collective.

        Args:
            comm: ranks that share the nodes.
            nodes: positions (num_owned_nodes, 3) in m.
            node_dofs: global rows (num_owned_nodes, 3) of their displacements.
            section, x: section of the plates and position in m.
        """
        at = on_outline(nodes, section, x)
        places = np.concatenate(comm.allgather(nodes[at]))
        dofs = np.concatenate(comm.allgather(node_dofs[at]))
        return cls(x, places, dofs, section)

    def mean_deflection(self, direction: Direction = "z") -> Row:
        """Return the row of the axis deflection in m: the mean of u_z or u_y over the area."""
        return self.mean_displacement(COMPONENT[direction])

    def mean_displacement(self, component: int) -> Row:
        """Return the row of the mean of a displacement component over the area in m."""
        nodes, areas = self._area_weights()
        return Row.from_weights(self.dofs[nodes, component], areas / areas.sum())

    def rotation(self, direction: Direction = "z") -> Row:
        """Return the row of the rotation in rad: w′ of the best fit u_x = −w′ z over the area."""
        nodes, areas = self._area_weights()
        z = self.places[nodes, COMPONENT[direction]]
        z = z - (areas @ z) / areas.sum()
        return Row.from_weights(self.dofs[nodes, _X], -areas * z / (areas @ z**2))

    def distortion(self) -> Row:
        """Return the row of the increase of the section's height in m.

        It is the mean u_z of the plates with the highest midpoints, less that of the lowest ones.
        """
        plates = self.section.plates
        levels = np.array([plate.midpoint[1] for plate in plates])
        top, bottom = (
            np.flatnonzero(np.abs(levels - level) < self.section.near).tolist()
            for level in (levels.max(), levels.min())
        )
        rows = (
            sum((1.0 / len(face) * self._mean(plates[n], "z") for n in face), Row())
            for face in (top, bottom)
        )
        return next(rows) - next(rows)

    def wall_deflection(self, direction: Direction) -> Row:
        """Return the row of the mean u_z or u_y of the shear-carrying plates in m.

        The in-plane displacement of each plate is weighted by the force that the plate carries of a
        unit shear force. So a force on this row bends no plate.
        """
        carriers = self.section.shear_plates(direction)
        plates = self.section.plates
        return sum((force * self._slide(plates[n]) for n, force in carriers), Row())

    def twist(self) -> Row:
        """Return the row of the twist about x in rad.

        It is the circulation of the displacement over twice the enclosed area, exact for a rigid
        rotation (Stokes). The distortion of a box into a parallelogram does not contribute.
        """
        turn = Row()
        for plate in self.section.plates:
            turn += plate.length / (2.0 * self.section.enclosed_area) * self._slide(plate)
        return turn

    def _slide(self, plate: Plate) -> Row:
        """Return the row of the mean displacement along the tangent of a plate in m."""
        slopes = zip(COMPONENT, plate.tangent.tolist(), strict=True)
        parts = (slope * self._mean(plate, axis) for axis, slope in slopes if slope != 0.0)
        return sum(parts, Row())

    def _mean(self, plate: Plate, direction: Direction) -> Row:
        """Return the row of the mean displacement of a plate in a direction in m."""
        nodes, lengths = self._simpson(plate)
        return Row.from_weights(self.dofs[nodes, COMPONENT[direction]], lengths / lengths.sum())

    def along(self, plate: Plate) -> tuple[Indices, Array]:
        """Return the nodes (num_nodes,) of a plate, and their positions along the plate in m.

        Nodes are alternately ends and midpoints of edges, in the order of y, or of z if steep.
        """
        on_plate = np.flatnonzero(plate.distance(self.places[:, 1:]) < self.section.near)
        tangent = plate.tangent
        along = self.places[on_plate, 1:] @ (tangent * np.sign(tangent[np.abs(tangent).argmax()]))
        order = np.argsort(along)
        return on_plate[order], along[order]

    def _simpson(self, plate: Plate) -> tuple[Indices, Array]:
        """Return the nodes (num_nodes,) of a plate, and their weights in m by Simpson's rule."""
        nodes, along = self.along(plate)
        lengths = along[2::2] - along[:-2:2]
        weights = np.zeros(nodes.size)
        weights[:-2:2] += lengths / 6.0
        weights[1::2] += 4.0 * lengths / 6.0
        weights[2::2] += lengths / 6.0
        return nodes, weights

    def _area_weights(self) -> tuple[Indices, Array]:
        """Return the nodes of all plates (corners twice), and their weights in m²."""
        parts = [(*self._simpson(plate), plate.thickness) for plate in self.section.plates]
        return (
            np.concatenate([nodes for nodes, _, _ in parts]),
            np.concatenate([wall * weights for _, weights, wall in parts]),
        )
