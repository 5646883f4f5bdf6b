# SPDX-License-Identifier: LGPL-3.0-or-later
"""The four families of motions of a box that mirrors itself in y and in z.

Mirrored motions stay mirrored: bending along z, bending along y, twisting, and breathing with
stretching do not know of each other within a segment. A family's motion is known from the quarter
of the box where y and z are positive: it is that of the quarter with what the family does not do
held on its cut edges, and its mirrors.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.spatial import cKDTree

from dynamics.failure import NumericsError
from geometry.mesh import SegmentMesh

Array = npt.NDArray[np.float64]

# Nodes closer than this part of a mesh's extent to a place lie on it; meshes are exact to
# round-off.
_ON_PLACE = 1.0e-8


class Family(NamedTuple):
    """1 where a motion is its own image in the mirror of an axis, −1 where it is its opposite."""

    y: int
    z: int

    @property
    def signs(self) -> Array:
        """(4, 6) what a component of the quarter is times elsewhere.

        Rows are the quarters (see :func:`quarter_of`), columns the components of the displacement,
        which mirrors as an arrow, then those of the rotation, which mirrors as an axis.
        """
        signs = np.ones((4, 6))
        for axis, parity in ((1, self.y), (2, self.z)):
            image = np.ones(6)
            image[axis] = image[3:][np.arange(3) != axis] = -1.0
            signs[_BEYOND[axis]] *= parity * image
        return signs

    def held(self, axis: int) -> list[tuple[int, int]]:
        """What stays at zero in a mirror: (0, i) of the displacement, (1, i) of the rotation."""
        signs = self.signs[1 if axis == 1 else 2]
        return [(int(i) // 3, int(i) % 3) for i in np.flatnonzero(signs < 0.0)]


# Quarters at negative y, and at negative z.
_BEYOND: Final = {1: [1, 3], 2: [2, 3]}

BREATHING, ALONG_Z, ALONG_Y, TWISTING = (
    Family(1, 1),
    Family(1, -1),
    Family(-1, 1),
    Family(-1, -1),
)
FAMILIES: Final = (BREATHING, ALONG_Z, ALONG_Y, TWISTING)


def quarter_of(places: Array) -> npt.NDArray[np.int64]:
    """(num_places,) 1 at negative y, 2 at negative z, 3 at both, 0 at neither."""
    near = _near(places)
    return np.asarray(1 * (places[:, 1] < -near) + 2 * (places[:, 2] < -near), dtype=np.int64)


def on_plane(places: Array, axis: int) -> npt.NDArray[np.bool_]:
    """(num_places,) which places (num_places, 3) lie in the mirror of an axis."""
    return np.asarray(np.abs(places[:, axis]) <= _near(places))


def matches(places: Array, among: Array) -> npt.NDArray[np.int64] | None:
    """(num_places,) numbers of the same places in a list; None where one has no match."""
    distance, number = cKDTree(among).query(places)
    if distance.max(initial=0.0) > _near(among):
        return None
    return np.asarray(number, dtype=np.int64)


def quarter_mesh(mesh: SegmentMesh, thickness: Array) -> SegmentMesh:
    """The part of a mesh at positive y and z.

    Args:
        mesh: of a segment.
        thickness: (num_triangles,) in m.

    Raises:
        NumericsError: the mesh or its thickness is not its own image.
    """
    ours = _sorted(mesh.triangles, thickness)
    for axis in (1, 2):
        mirror = np.ones(3)
        mirror[axis] = -1.0
        partner = matches(mesh.points * mirror, mesh.points)
        if partner is None:
            raise NumericsError("a segment's mesh is not its own mirror image in y and in z")
        images = _sorted(partner[mesh.triangles], thickness)
        if not all(np.array_equal(own, image) for own, image in zip(ours, images, strict=True)):
            raise NumericsError("a segment's shell is not its own mirror image in y and in z")
    mine = (quarter_of(mesh.points) == 0)[mesh.triangles].all(axis=1)
    if 4 * mine.sum() != mine.size:
        raise NumericsError("a segment's mesh has triangles that cross the planes y = 0 or z = 0")
    points, triangles = np.unique(mesh.triangles[mine], return_inverse=True)
    return replace(
        mesh,
        points=mesh.points[points],
        triangles=triangles.reshape(-1, 3).astype(np.int64),
        walls=mesh.walls[mine],
        lines={},
    )


def _sorted(
    triangles: npt.NDArray[np.int64], thickness: Array
) -> tuple[npt.NDArray[np.int64], Array]:
    """Triangles and their thickness in an order that does not depend on how they were given."""
    corners = np.sort(triangles, axis=1)
    order = np.lexsort(corners.T)
    return corners[order], thickness[order]


def _near(places: Array) -> float:
    return _ON_PLACE * float(np.abs(places).max(initial=0.0))
