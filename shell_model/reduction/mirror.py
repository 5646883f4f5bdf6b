# SPDX-License-Identifier: LGPL-3.0-or-later
"""Symmetry classes of motions of a section with mirror planes in y, in z, or in both.

Symmetric and antisymmetric motions do not couple. In a segment with both mirror planes, vertical
bending, lateral bending, twist, and breathing with stretching are separate classes. With the mirror
plane normal to y only, vertical bending couples with breathing and stretching, and lateral bending
with twist. Motions of a class are computed on the symmetry cell, the quarter or half of the segment
on the positive side of the mirror planes, with symmetry conditions in these planes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array, Indices, Mask
from protractile.geometry.plating import PlatedMesh
from protractile.geometry.section import COMPONENT, Direction

# Distance below which points coincide, as a fraction of the extent of a mesh.
_ON_PLACE = 1.0e-8


class SymmetryClass(NamedTuple):
    """Symmetry class of motions, given by the parity for the mirror planes normal to y and z.

    The parity is 1 for symmetric, −1 for antisymmetric motions, 0 without the mirror plane.
    """

    y: int
    z: int

    @property
    def signs(self) -> Array:
        """The factors (4, 6) of components in each image (:func:`image_of`), relative to the cell.

        The first columns are components of the displacement, a polar vector; the others are
        components of the rotation, an axial vector.
        """
        signs = np.ones((4, 6))
        for axis, parity in ((1, self.y), (2, self.z)):
            if parity == 0:
                continue
            image = np.ones(6)
            image[axis] = image[3:][np.arange(3) != axis] = -1.0
            signs[_BEYOND[axis]] *= parity * image
        return signs

    def fixed_components(self, axis: int) -> list[tuple[int, int]]:
        """Return the components that are zero in the mirror plane normal to an axis (1 y, 2 z).

        They are (0, i) for the displacement and (1, i) for the rotation.
        """
        signs = self.signs[1 if axis == 1 else 2]
        return [(int(i) // 3, int(i) % 3) for i in np.flatnonzero(signs < 0.0)]


# The images at negative y, and those at negative z.
_BEYOND: Final = {1: [1, 3], 2: [2, 3]}

BREATHING, ALONG_Z, ALONG_Y, TWISTING = (
    SymmetryClass(1, 1),
    SymmetryClass(1, -1),
    SymmetryClass(-1, 1),
    SymmetryClass(-1, -1),
)


def symmetry_classes(mirrors: Sequence[Direction]) -> list[SymmetryClass]:
    """Return the symmetry classes of a section; ``mirrors`` are the normals of its planes."""
    parities = ((1, -1) if axis in mirrors else (0,) for axis in COMPONENT)
    return [SymmetryClass(*parity) for parity in product(*parities)]


def image_of(places: Array, mirrors: Sequence[Direction]) -> Indices:
    """Return the image (num_places,) of points: 1 at negative y, 2 at negative z, 3 at both, or 0.

    Only coordinates along ``mirrors`` count.
    """
    beyond = [COMPONENT[axis] * (places[:, COMPONENT[axis]] < -_near(places)) for axis in mirrors]
    return np.asarray(sum(beyond, np.zeros(len(places))), dtype=np.int64)


def mirror_to_cell(places: Array, mirrors: Sequence[Direction]) -> Array:
    """Return points (num_places, 3) mirrored to the positive side of all mirror planes."""
    images = places.copy()
    for axis in mirrors:
        images[:, COMPONENT[axis]] = np.abs(images[:, COMPONENT[axis]])
    return images


def on_plane(places: Array, axis: int) -> Mask:
    """Return the mask (num_places,) of points (num_places, 3) on the plane normal to an axis."""
    return np.asarray(np.abs(places[:, axis]) <= _near(places))


def match_points(places: Array, among: Array) -> Indices | None:
    """Return the index (num_places,) in ``among`` of each point; None if one is missing there."""
    distance, number = cKDTree(among).query(places)
    if distance.max(initial=0.0) > _near(among):
        return None
    return np.asarray(number, dtype=np.int64)


def cell_mesh(mesh: PlatedMesh, mirrors: Sequence[Direction]) -> PlatedMesh:
    """Return the part of a mesh on the positive side of the mirror planes of its section.

    Raises:
        NumericsError: the mesh or its thickness is not symmetric.
    """
    ours = _sorted(mesh.triangles, mesh.thickness)
    for axis in mirrors:
        mirror = np.ones(3)
        mirror[COMPONENT[axis]] = -1.0
        partner = match_points(mesh.points * mirror, mesh.points)
        if partner is None:
            raise NumericsError(f"a segment's mesh is not its own mirror image in {axis}")
        images = _sorted(partner[mesh.triangles], mesh.thickness)
        if not all(np.array_equal(part, image) for part, image in zip(ours, images, strict=True)):
            raise NumericsError(f"a segment's shell is not its own mirror image in {axis}")
    mine = (image_of(mesh.points, mirrors) == 0)[mesh.triangles].all(axis=1)
    if 2 ** len(mirrors) * mine.sum() != mine.size:
        raise NumericsError("a segment's mesh has triangles that cross its mirrors")
    points, triangles = np.unique(mesh.triangles[mine], return_inverse=True)
    return replace(
        mesh,
        points=mesh.points[points],
        triangles=triangles.reshape(-1, 3).astype(np.int64),
        walls=mesh.walls[mine],
        lines={},
        thickness=mesh.thickness[mine],
        plain=mesh.plain[mine],
        load_weight=mesh.load_weight[mine],
    )


def _sorted(triangles: Indices, thickness: Array) -> tuple[Indices, Array]:
    """Sort the points of each triangle, then order triangles and thicknesses by these points."""
    corners = np.sort(triangles, axis=1)
    order = np.lexsort(corners.T)
    return corners[order], thickness[order]


def _near(places: Array) -> float:
    return _ON_PLACE * float(np.abs(places).max(initial=0.0))
