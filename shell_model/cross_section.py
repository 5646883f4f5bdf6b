# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows that read a section of the shell: its mean deflection, rotation, distortion, points.

An outline is a mesh line around the box; displacement is quadratic along each of its edges,
so Simpson's rule and quadratic interpolation on the edges' nodes are exact. A row read the other
way round is a force that is spread over the section.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.boom import Direction
from geometry.section import BoxSection

Array = npt.NDArray[np.float64]
Row = Mapping[int, float]

# Number of a segment → what is read of it, with its sign.
Reading = Mapping[int, Row]

# Nodes closer than this part of the section's height to a place lie on it; meshes are exact to
# round-off.
ON_WALL = 1.0e-7
_X = 0
COMPONENT: Mapping[Direction, int] = {"y": 1, "z": 2}


def combine(*terms: tuple[float, Row]) -> Row:
    """The sum of rows, each with its factor."""
    total: dict[int, float] = {}
    for factor, row in terms:
        for dof, weight in row.items():
            total[dof] = total.get(dof, 0.0) + factor * weight
    return total


def relative(inner: tuple[int, Row], outer: tuple[int, Row]) -> Reading:
    """u − w of two places, each with the number of its segment."""
    return {inner[0]: inner[1], outer[0]: combine((-1.0, outer[1]))}


def row_of(dofs: npt.NDArray[np.int64], weights: Array) -> Row:
    """The sum of degrees of freedom, each with its weight; one may come twice."""
    return combine(*((w, {d: 1.0}) for d, w in zip(dofs.tolist(), weights.tolist(), strict=True)))


def quadratic(s: Array) -> Array:
    """(..., 3) shape functions of an edge's first end, middle and last end at the parts s of it."""
    return np.stack([(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)], axis=-1)


def combine_readings(terms: Sequence[tuple[float, Reading]]) -> Reading:
    """Readings of the same segments, each with its factor."""
    numbers = terms[0][1]
    return {
        number: combine(*((factor, reading[number]) for factor, reading in terms))
        for number in numbers
    }


@dataclass(frozen=True, slots=True)
class Outline:
    """Displacement nodes around the section at one x.

    Args:
        x: in m.
        places: (num_nodes, 3) in m.
        dofs: (num_nodes, 3) global rows of the displacement components.
        section: the plates.
    """

    x: float
    places: Array
    dofs: npt.NDArray[np.int64]
    section: BoxSection

    def mean_deflection(self, direction: Direction = "z") -> Row:
        """u_z or u_y averaged over the section's area: its neutral axis' deflection, in m."""
        return self.mean_displacement(COMPONENT[direction])

    def mean_displacement(self, component: int) -> Row:
        """One displacement component averaged over the section's area, in m."""
        nodes, areas = self._area_weights()
        return row_of(self.dofs[nodes, component], areas / areas.sum())

    def rotation(self) -> Row:
        """Slope w′ of the plane that fits u_x = −w′ z best over the section's area, in rad."""
        nodes, areas = self._area_weights()
        z = self.places[nodes, 2]
        return row_of(self.dofs[nodes, _X], -areas * z / (areas @ z**2))

    def distortion(self) -> Row:
        """How much taller the section has become: mean u_z of the top less the bottom, in m."""
        top, bottom = (self._wall("y", side, "z") for side in (1.0, -1.0))
        return combine((1.0, top), (-1.0, bottom))

    def wall_deflection(self, direction: Direction) -> Row:
        """u_z averaged over the webs, or u_y over the flanges, in m.

        These walls carry the shear force of the direction in their own plane: a force spread so
        bends no plate.
        """
        return combine(*((0.5, self._wall(direction, side, direction)) for side in (1.0, -1.0)))

    def twist(self) -> Row:
        """Turn about x in rad: the mean of the turns of the pair of webs and that of flanges.

        A distortion into a parallelogram turns the pairs by opposite angles and is not read.
        """
        b, h = self.section.width, self.section.height
        right, left = (self._wall("z", side, "z") for side in (1.0, -1.0))
        top, bottom = (self._wall("y", side, "y") for side in (1.0, -1.0))
        return combine((0.5 / b, right), (-0.5 / b, left), (-0.5 / h, top), (0.5 / h, bottom))

    def flange_deflection(self, side: float, y: float) -> Row:
        """u_z of a flange, averaged over the two points ±y, in m.

        Args:
            side: 1 for the top flange, −1 for the bottom one.
            y: distance from the middle in m.
        """
        nodes = self._along("y", side)
        return combine(*((0.5, self._interpolated(nodes, place, "z")) for place in (y, -y)))

    def _interpolated(self, nodes: npt.NDArray[np.int64], y: float, direction: Direction) -> Row:
        """A displacement at one point of a flange."""
        along = self.places[nodes, 1]
        # Nodes 2k, 2k+1, 2k+2 are the ends and the middle of edge k.
        edge = int(np.clip(np.searchsorted(along[::2], y) - 1, 0, nodes.size // 2 - 1))
        ends = nodes[2 * edge : 2 * edge + 3]
        left, _, right = self.places[ends, 1]
        shapes = quadratic(np.asarray((y - left) / (right - left)))
        return row_of(self.dofs[ends, COMPONENT[direction]], shapes)

    def _wall(self, axis: Direction, side: float, direction: Direction) -> Row:
        """Mean displacement over one wall's line, in m."""
        nodes, lengths = self._simpson(axis, side)
        return row_of(self.dofs[nodes, COMPONENT[direction]], lengths / lengths.sum())

    def _along(self, axis: Direction, side: float) -> npt.NDArray[np.int64]:
        """Nodes of one wall's line, rising along the axis, ends and middles in turn."""
        normal: Direction = "z" if axis == "y" else "y"
        size = self.section.height if axis == "y" else self.section.width
        distance = self.places[:, COMPONENT[normal]] - 0.5 * size * side
        on_wall = np.flatnonzero(np.abs(distance) < ON_WALL * self.section.height)
        return on_wall[np.argsort(self.places[on_wall, COMPONENT[axis]])]

    def _simpson(self, axis: Direction, side: float) -> tuple[npt.NDArray[np.int64], Array]:
        """Nodes of one wall's line and their weights in m."""
        nodes = self._along(axis, side)
        along = self.places[nodes, COMPONENT[axis]]
        lengths = along[2::2] - along[:-2:2]
        weights = np.zeros(nodes.size)
        weights[:-2:2] += lengths / 6.0
        weights[1::2] += 4.0 * lengths / 6.0
        weights[2::2] += lengths / 6.0
        return nodes, weights

    def _area_weights(self) -> tuple[npt.NDArray[np.int64], Array]:
        """Nodes of all four walls (corners twice) and the areas in m² that they stand for."""
        walls: list[tuple[Direction, float]] = [
            ("y", self.section.flange),
            ("z", self.section.web),
        ]
        parts = [(*self._simpson(axis, side), t) for axis, t in walls for side in (1.0, -1.0)]
        return (
            np.concatenate([nodes for nodes, _, _ in parts]),
            np.concatenate([wall * weights for _, weights, wall in parts]),
        )
