# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows that read a section of the shell: its mean deflection, rotation, distortion, points.

An outline is a mesh line around the box; displacement is quadratic along each of its edges,
so Simpson's rule and quadratic interpolation on the edges' nodes are exact.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.section import BoxSection

Array = npt.NDArray[np.float64]
Row = Mapping[int, float]

_ON_WALL = 1.0e-7
_X, _Z = 0, 2


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

    def mean_deflection(self) -> Row:
        """u_z averaged over the section's area: the deflection of its neutral axis, in m."""
        nodes, areas = self._area_weights()
        return _row(self.dofs[nodes, _Z], areas / areas.sum())

    def rotation(self) -> Row:
        """Slope w′ of the plane that fits u_x = −w′ z best over the section's area, in rad."""
        nodes, areas = self._area_weights()
        z = self.places[nodes, 2]
        return _row(self.dofs[nodes, _X], -areas * z / (areas @ z**2))

    def distortion(self) -> Row:
        """How much taller the section has become: mean u_z of the top less the bottom, in m."""
        row: Counter[int] = Counter()
        for side in (1.0, -1.0):
            nodes, lengths = self.simpson("y", 0.5 * self.section.height * side)
            row.update(_row(self.dofs[nodes, _Z], side * lengths / lengths.sum()))
        return row

    def flange_deflection(self, side: float, y: float) -> Row:
        """u_z of a flange, averaged over the two points ±y, in m.

        Args:
            side: 1 for the top flange, −1 for the bottom one.
            y: distance from the middle in m.
        """
        row: Counter[int] = Counter()
        nodes = self._along("y", 0.5 * self.section.height * side)
        along = self.places[nodes, 1]
        for place in (y, -y):
            # Nodes 2k, 2k+1, 2k+2 are the ends and the middle of edge k.
            edge = int(np.clip(np.searchsorted(along[::2], place) - 1, 0, nodes.size // 2 - 1))
            ends = nodes[2 * edge : 2 * edge + 3]
            left, _, right = self.places[ends, 1]
            s = (place - left) / (right - left)
            shapes = np.array([(1 - s) * (1 - 2 * s), 4 * s * (1 - s), s * (2 * s - 1)])
            row.update(_row(self.dofs[ends, _Z], 0.5 * shapes))
        return row

    def _along(self, axis: str, offset: float) -> npt.NDArray[np.int64]:
        """Nodes of one wall's line, rising along the axis, ends and middles in turn."""
        direction, normal = (1, 2) if axis == "y" else (2, 1)
        on_wall = np.flatnonzero(np.abs(self.places[:, normal] - offset) < _ON_WALL)
        return on_wall[np.argsort(self.places[on_wall, direction])]

    def simpson(self, axis: str, offset: float) -> tuple[npt.NDArray[np.int64], Array]:
        """Nodes of one wall's line and their weights in m."""
        nodes = self._along(axis, offset)
        along = self.places[nodes, 1 if axis == "y" else 2]
        lengths = along[2::2] - along[:-2:2]
        weights = np.zeros(nodes.size)
        weights[:-2:2] += lengths / 6.0
        weights[1::2] += 4.0 * lengths / 6.0
        weights[2::2] += lengths / 6.0
        return nodes, weights

    def _area_weights(self) -> tuple[npt.NDArray[np.int64], Array]:
        """Nodes of all four walls (corners twice) and the areas in m² that they stand for."""
        section = self.section
        parts = [
            (*self.simpson(axis, side * half), wall)
            for axis, half, wall in (
                ("y", 0.5 * section.height, section.flange),
                ("z", 0.5 * section.width, section.web),
            )
            for side in (1.0, -1.0)
        ]
        return (
            np.concatenate([nodes for nodes, _, _ in parts]),
            np.concatenate([wall * weights for _, weights, wall in parts]),
        )


def _row(dofs: npt.NDArray[np.int64], weights: Array) -> Counter[int]:
    row: Counter[int] = Counter()
    for dof, weight in zip(dofs.tolist(), weights.tolist(), strict=True):
        row[dof] += weight
    return row
