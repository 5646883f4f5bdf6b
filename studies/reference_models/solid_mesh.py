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

from geometry.arrays import Array, Indices
from geometry.section import BoxSection

# Of an edge over the one before it: what ends at a place fades slower than what ends in a corner.
_GROWTH_ALONG = 3.0
_GROWTH_AROUND = 4.0


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
    hexahedra: Indices
    planes: tuple[Array, Array, Array]
    layers: int


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
        along: edge lengths in m along x, about: at the places, where forces and supports act, and
            the largest away from them.
        around: largest edge length in m around the section, about; edges grow to it from the
            corners, where they are as long as the wall is thick.
        splits: into how many each edge around the section is split, to refine the mesh evenly.
        layers: of hexahedra through a wall, an even number.

    Raises:
        ValueError: the lengths are not positive and rising, edges are not split into whole ones,
            the layers are no even number, there are no two distinct places.
    """
    if not 0.0 < along[0] <= along[1] < np.inf:
        raise ValueError(f"the lengths along x must be positive numbers of m, rising, got {along}")
    if not 0.0 < around < np.inf:
        raise ValueError(f"the length around must be a positive number of m, got {around}")
    if splits < 1:
        raise ValueError(f"an edge must be split into 1 or more, got {splits}")
    if layers < 2 or layers % 2:
        raise ValueError(f"the layers must be an even number from 2 on, got {layers}")
    ends = np.unique(places)
    if ends.size < 2:
        raise ValueError("a segment needs two distinct places at least, its ends")
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
    """Edges of a length, each longer than the one before until they are the largest."""
    edges = [min(smallest, largest)]
    while sum(edges) < length:
        edges.append(min(growth * edges[-1], largest))
    return np.array(edges) * (length / sum(edges))


def _across(distance: float, wall: float, size: float, splits: int, layers: int) -> Array:
    """Planes from the middle to the outside of a wall, whose mid-line is at half the distance."""
    clear = _growing(0.5 * (distance - wall), wall, size, _GROWTH_AROUND)[::-1]
    edges = [np.repeat(clear / splits, splits), np.full(layers, wall / layers)]
    return np.concatenate([[0.0], np.cumsum(np.concatenate(edges))])


def _walls(planes: tuple[Array, Array, Array], layers: int) -> tuple[Array, Indices]:
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
