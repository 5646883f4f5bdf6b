# SPDX-License-Identifier: LGPL-3.0-or-later
"""Symmetry classes of motions of a section with mirror planes in y, in z, or in both.

Mirrored motions stay mirrored: bending along z, bending along y, twisting, and breathing with
stretching do not couple within a segment that has both mirrors; with that of y alone, bending
along z couples with breathing and stretching, and bending along y with twist. The motion
of a symmetry class follows from the part of the section on the positive side of its mirrors, a
quarter or a half: it is that of this part with symmetry conditions on its cut edges, and its mirror
images.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Final, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from dynamics.failure import NumericsError
from geometry.arrays import Array, Indices, Mask
from geometry.plating import PlatedMesh
from geometry.section import COMPONENT, Direction

# Nodes closer than this part of a mesh's extent to a place lie on it; meshes are exact to
# round-off.
_ON_PLACE = 1.0e-8


class SymmetryClass(NamedTuple):
    """Symmetry class: 1 for a motion that equals its mirror image, −1 for its opposite.

    There is a number for each mirror, 0 if the section does not have it.
    """

    y: int
    z: int

    @property
    def signs(self) -> Array:
        """Factors (4, 6) of the components in each image relative to the cell.

        Rows are the images (see :func:`image_of`), columns the components of the displacement,
        which mirrors as an arrow, then those of the rotation, which mirrors as an axis.
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
        """Return the components that are zero in a mirror.

        They are (0, i) of the displacement and (1, i) of the rotation.
        """
        signs = self.signs[1 if axis == 1 else 2]
        return [(int(i) // 3, int(i) % 3) for i in np.flatnonzero(signs < 0.0)]


# Images at negative y, and at negative z.
_BEYOND: Final = {1: [1, 3], 2: [2, 3]}

BREATHING, ALONG_Z, ALONG_Y, TWISTING = (
    SymmetryClass(1, 1),
    SymmetryClass(1, -1),
    SymmetryClass(-1, 1),
    SymmetryClass(-1, -1),
)


def symmetry_classes(mirrors: Sequence[Direction]) -> list[SymmetryClass]:
    """Return the symmetry classes of a section with these mirrors."""
    parities = ((1, -1) if axis in mirrors else (0,) for axis in COMPONENT)
    return [SymmetryClass(*parity) for parity in product(*parities)]


def image_of(places: Array, mirrors: Sequence[Direction]) -> Indices:
    """Return the image (num_places,): 1 at negative y, 2 at negative z, 3 at both, 0 at neither.

    Of the mirrors' axes alone: without that of z there are the halves 0 and 1.
    """
    beyond = [COMPONENT[axis] * (places[:, COMPONENT[axis]] < -_near(places)) for axis in mirrors]
    return np.asarray(sum(beyond, np.zeros(len(places))), dtype=np.int64)


def to_cell(places: Array, mirrors: Sequence[Direction]) -> Array:
    """Return the images of places (num_places, 3) on the positive side of the mirrors."""
    images = places.copy()
    for axis in mirrors:
        images[:, COMPONENT[axis]] = np.abs(images[:, COMPONENT[axis]])
    return images


def on_plane(places: Array, axis: int) -> Mask:
    """Return which (num_places,) of places (num_places, 3) lie in the mirror of an axis."""
    return np.asarray(np.abs(places[:, axis]) <= _near(places))


def matches(places: Array, among: Array) -> Indices | None:
    """Return the numbers (num_places,) of the same places in a list; None if one has no match."""
    distance, number = cKDTree(among).query(places)
    if distance.max(initial=0.0) > _near(among):
        return None
    return np.asarray(number, dtype=np.int64)


def cell_mesh(mesh: PlatedMesh, mirrors: Sequence[Direction]) -> PlatedMesh:
    """Return the part of a segment's mesh on the positive side of its section's mirrors.

    Raises:
        NumericsError: the mesh or its thickness is not its own image.
    """
    ours = _sorted(mesh.triangles, mesh.thickness)
    for axis in mirrors:
        mirror = np.ones(3)
        mirror[COMPONENT[axis]] = -1.0
        partner = matches(mesh.points * mirror, mesh.points)
        if partner is None:
            raise NumericsError(f"a segment's mesh is not its own mirror image in {axis}")
        images = _sorted(partner[mesh.triangles], mesh.thickness)
        if not all(np.array_equal(own, image) for own, image in zip(ours, images, strict=True)):
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
        even=mesh.even[mine],
    )


def _sorted(triangles: Indices, thickness: Array) -> tuple[Indices, Array]:
    """Return triangles and their thickness in an order that is independent of the input's."""
    corners = np.sort(triangles, axis=1)
    order = np.lexsort(corners.T)
    return corners[order], thickness[order]


def _near(places: Array) -> float:
    return _ON_PLACE * float(np.abs(places).max(initial=0.0))
