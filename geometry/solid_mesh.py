# SPDX-License-Identifier: LGPL-3.0-or-later
"""Structured hexahedra of a box segment's walls, corners included: the quarter at positive y and z.

The mid-lines of the section are mesh lines, and each half of a wall has whole layers. The solid is
what the walls fill when they meet in corners of web times flange. Walls that end on one another's
mid-lines, as a shell's do, count the inner quarter of each corner twice and leave its outer
quarter out: the same area, so that both have the same mass, but nearer to the axis.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.section import BoxSection

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SolidMesh:
    """Hexahedra of a quarter of one segment, on a lattice of planes.

    Args:
        points: (num_points, 3) in m, x along the boom, the axis at y = z = 0.
        hexahedra: (num_hexahedra, 8) point numbers; those of a cell run along x first, then along
            y, then along z.
        planes: rising coordinates in m of the lattice's planes across x, y and z.
        layers: of hexahedra through each wall, an even number.
    """

    points: Array
    hexahedra: npt.NDArray[np.int64]
    planes: tuple[Array, Array, Array]
    layers: int


def mesh_quarter(
    section: BoxSection,
    places: Sequence[float],
    along: tuple[float, float],
    edges: int,
    layers: int = 2,
) -> SolidMesh:
    """Mesh the walls of a box where y and z are positive.

    Args:
        section: mid-lines and thicknesses.
        places: x in m at which there must be mesh planes; the smallest and the largest are the
            ends of the segment.
        along: edge lengths in m along x, about: at the places, where forces and supports act, and
            the largest away from them; edges double from one to the other.
        edges: from the middle of each wall to the inside of the corner.
        layers: of hexahedra through a wall, an even number.

    Raises:
        ValueError: the lengths along x are not positive and rising, there is no edge, the layers
            are no even number, there are no two distinct places.
    """
    if not 0.0 < along[0] <= along[1] < np.inf:
        raise ValueError(f"the lengths along x must be positive numbers of m, rising, got {along}")
    if edges < 1:
        raise ValueError(f"there must be an edge or more to a corner, got {edges}")
    if layers < 2 or layers % 2:
        raise ValueError(f"the layers must be an even number from 2 on, got {layers}")
    ends = np.unique(places)
    if ends.size < 2:
        raise ValueError("a segment needs two distinct places at least, its ends")
    spans = [_growing(length, *along) for length in np.diff(ends)]
    planes = (
        ends[0] + np.concatenate([[0.0], np.cumsum(np.concatenate(spans))]),
        _across(section.width, section.web, edges, layers),
        _across(section.height, section.flange, edges, layers),
    )
    points, hexahedra = _walls(planes, layers)
    return SolidMesh(points, hexahedra, planes, layers)


def _growing(length: float, smallest: float, largest: float) -> Array:
    """Edges of a length that are smallest at its ends and largest in its middle."""
    half = [smallest]
    while sum(half) < 0.5 * length:
        half.append(min(2.0 * half[-1], largest))
    edges = np.array([*half, *half[::-1]])
    return np.asarray(edges * (length / edges.sum()))


def _across(distance: float, wall: float, edges: int, layers: int) -> Array:
    """Planes from the middle to the outside of a wall, whose mid-line is at half the distance."""
    inside, middle, outside = 0.5 * (distance - wall), 0.5 * distance, 0.5 * (distance + wall)
    half = layers // 2 + 1
    return np.concatenate(
        [
            np.linspace(0.0, inside, edges + 1),
            np.linspace(inside, middle, half)[1:],
            np.linspace(middle, outside, half)[1:],
        ]
    )


def _walls(planes: tuple[Array, Array, Array], layers: int) -> tuple[Array, npt.NDArray[np.int64]]:
    """Points and cells of a lattice that lie in the outermost layers."""
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
