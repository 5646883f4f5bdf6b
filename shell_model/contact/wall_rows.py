# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows of displacements of a shell along the corners of a section, and at points of walls.

The compliance under a point force at a fold diverges with the logarithm of the edge length. The
compliance under a force along an interval of the fold is finite. Its row is exact for any mesh. The
row of a point on a wall has the six shape functions of the triangle that contains the point. So the
meshes of two segments need not match.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from protractile.geometry.arrays import Array, Indices
from protractile.geometry.contact_places import ContactInterval
from protractile.geometry.section import COMPONENT, Direction, distance_from_line
from protractile.geometry.segment import Segment
from protractile.shell_model import compat
from protractile.shell_model.segment.cross_section import Row, quadratic
from protractile.shell_model.segment.segment_shell import SegmentShell

# Tolerance as a fraction of the height. It exceeds the distance between a tapered section and the
# mesh, whose walls are flat between mesh lines.
_OFF_TAPER = 1.0e-4


class WallsAlong:
    """Mid-lines of the sections of a segment at several x.

    Args:
        segment: segment with a section.
        x: (num_places,) in m.

    Attributes:
        near: distance in m below which a point is on a mid-line.
    """

    def __init__(self, segment: Segment, x: Array) -> None:
        self.near, sections, at = segment.widest.near, [segment.widest], np.zeros(x.size, dtype=int)
        if segment.head_section is not None:
            self.near = _OFF_TAPER * min(segment.section_at(e).size("z") for e in segment.ends)
            places, at = np.unique(x, return_inverse=True)
            sections = [segment.section_at(place) for place in places.tolist()]
        self._at = at
        self._starts = np.array([[plate.start for plate in section.plates] for section in sections])

    def starts(self, plate: int) -> Array:
        """Return the points (y, z) (num_places, 2) in m at which a plate starts."""
        return np.asarray(self._starts[self._at, plate])

    def distance(self, plate: int, places: Array) -> Array:
        """Return distances (num_places,) in m of points (num_places, 2) from a plate.

        Point i is at the x of index i.
        """
        start, end = self.starts(plate), self.starts((plate + 1) % self._starts.shape[1])
        return distance_from_line(start, end, places)


class _CornerLine(NamedTuple):
    """Displacement nodes along a corner, alternately ends and midpoints of edges."""

    x: Array  #: (num_nodes,) x in m, ascending
    dofs: Indices  #: (num_nodes, 3) global rows of the displacement components

    def mean(self, stretch: ContactInterval, direction: Direction) -> Row:
        """Return the row of the mean displacement, weighted by the line load of the interval."""
        left, right = self.x[:-2:2], self.x[2::2]
        low, high = np.maximum(left, stretch.start), np.minimum(right, stretch.end)
        (edges,) = np.nonzero(low < high)
        left, right, low, high = (ends[edges, None] for ends in (left, right, low, high))
        places = low + (high - low) * [0.0, 0.5, 1.0]
        forces = (high - low) * [1 / 6, 4 / 6, 1 / 6] * stretch.line_load(places)
        weights = np.einsum("ep,epn->en", forces, quadratic((places - left) / (right - left)))
        nodes = 2 * edges[:, None] + np.arange(3)
        return Row.from_weights(self.dofs[nodes, COMPONENT[direction]].ravel(), weights.ravel())


class CornerLines:
    """Corner lines of a segment's section. Collective."""

    def __init__(self, shell: SegmentShell) -> None:
        self._segment = shell.segment
        self._lines: list[_CornerLine] = []
        along = WallsAlong(shell.segment, shell.nodes[:, 0])
        for number in range(len(shell.segment.widest.plates)):
            off = np.abs(shell.nodes[:, 1:] - along.starts(number)).max(axis=1)
            on = off < along.near
            x = np.concatenate(shell.comm.allgather(shell.nodes[on, 0]))
            dofs = np.concatenate(shell.comm.allgather(shell.node_dofs[on]))
            order = np.argsort(x)
            self._lines.append(_CornerLine(x[order], dofs[order]))

    def deflection(self, stretch: ContactInterval, direction: Direction, y: float, z: float) -> Row:
        """Return the row of u_z or u_y of a face, linear between both corners of the face.

        A force on the row acts on the corners in static equilibrium, and bends no plate. The row is
        exact for a rotation of the section.

        Args:
            stretch: interval of x on the corners.
            direction: component of the displacement.
            y, z: offsets from the axis in m. The sign of ``z`` selects the upper or lower face; the
                sign of ``y`` selects the right or left face.
        """
        side, across = (z, y) if direction == "z" else (y, z)
        section = self._segment.section_at(stretch.station)
        face = section.face(direction, side)
        plate, after = section.plates[face.plate], (face.plate + 1) % len(section.plates)
        first, last = face.plate, after
        if plate.end < plate.start:
            first, last = last, first
        middle, half = 0.5 * (face.low + face.high), 0.5 * face.width
        along = (across - middle) / half
        low, high = (self._lines[end].mean(stretch, direction) for end in (first, last))
        return 0.5 * (1.0 - along) * low + 0.5 * (1.0 + along) * high


# Tolerance, in barycentric coordinates, for points on the edge of a triangle.
_ON_EDGE = 1.0e-8


@dataclass(frozen=True, slots=True)
class Wall:
    """Face of a section, on the positive (``side`` 1) or the negative side (−1) of the axis."""

    normal: Direction
    side: int

    @property
    def across(self) -> int:
        """The index of the coordinate across the wall, perpendicular to x."""
        return COMPONENT["y" if self.normal == "z" else "z"]


class _Candidate(NamedTuple):
    """Corners (6,) of a triangle in m, and the row of the displacement at a point in it."""

    corners: tuple[float, ...]
    row: Row


class WallPoints:
    """Triangles of the walls of a segment, and rows at points on walls. Collective.

    Attributes:
        segment: the segment.
    """

    def __init__(self, shell: SegmentShell) -> None:
        self._comm, self.segment = shell.comm, shell.segment
        displacement, to_parent = shell.space.sub(0).collapse()
        local = np.asarray(to_parent, dtype=np.int32).reshape(-1, 3)
        rows = shell.space.dofmap.index_map.local_to_global(local.ravel())
        self._dofs = np.asarray(rows, dtype=np.int64).reshape(-1, 3)
        self._places = compat.node_places(displacement)
        self._cells = compat.cell_nodes(displacement)
        self._along = WallsAlong(shell.segment, self._places[:, 0])

    def rows(self, wall: Wall, places: Array, direction: Direction) -> list[Row]:
        """Return the row of the displacement of each point, the same on every rank. Collective.

        Args:
            wall: wall with the points.
            places: (num_places, 2) x and the coordinate across the wall, in m.
            direction: direction of the displacement.

        Raises:
            ValueError: a point is not on the wall.
        """
        cells = self._near(wall, places[:, 0])
        own_candidates = [self._candidate(cells, wall, place, direction) for place in places]
        on_ranks = self._comm.allgather(own_candidates)
        rows: list[Row] = []
        for place, candidates in zip(places, zip(*on_ranks, strict=True), strict=True):
            found = [candidate for candidate in candidates if candidate is not None]
            if not found:
                raise ValueError(f"no wall is at x = {place[0]:g} m, {place[1]:g} m across")
            rows.append(min(found, key=lambda candidate: candidate.corners).row)
        return rows

    def mean(self, wall: Wall, places: Array, weights: Array, direction: Direction) -> Row:
        """Return the weighted sum of the rows of points. Collective."""
        rows = self.rows(wall, places, direction)
        return sum((w * row for w, row in zip(weights.tolist(), rows, strict=True)), Row())

    def _near(self, wall: Wall, x: Array) -> Indices:
        """Return the nodes (num_cells, 6) of wall triangles that may contain points at ``x``."""
        margin = self._along.near
        plate = self.segment.widest.face(wall.normal, wall.side).plate
        flat = self._along.distance(plate, self._places[:, 1:]) < margin
        along = self._places[self._cells[:, :3], 0]
        close = (along.max(axis=1) >= x.min() - margin) & (along.min(axis=1) <= x.max() + margin)
        return np.asarray(self._cells[flat[self._cells].all(axis=1) & close])

    def _candidate(
        self, cells: Indices, wall: Wall, place: Array, direction: Direction
    ) -> _Candidate | None:
        """Return the row of the first triangle that contains a point; None if no triangle does."""
        if not len(cells):
            return None
        corners = self._places[cells[:, :3]][:, :, [0, wall.across]]
        holding = np.flatnonzero(_barycentric(corners, place).min(axis=1) > -_ON_EDGE)
        if not holding.size:
            return None
        # The order depends only on coordinates, so that round-off does not depend on ranks.
        orders = [np.lexsort(corners[cell].T[::-1]) for cell in holding]
        first = min(
            range(holding.size),
            key=lambda k: corners[holding[k]][orders[k]].ravel().tolist(),
        )
        cell, order = holding[first], orders[first]
        a, b, c = _barycentric(corners[cell][order][None], place)[0]
        # Nodes of Lagrange's quadratic triangle: corners, then mid-sides opposite to them.
        weights = (
            a * (2.0 * a - 1.0), b * (2.0 * b - 1.0), c * (2.0 * c - 1.0),
            4.0 * b * c, 4.0 * a * c, 4.0 * a * b,
        )  # fmt: skip
        nodes = cells[cell][np.concatenate([order, 3 + order])]
        dofs = self._dofs[nodes, COMPONENT[direction]].tolist()
        return _Candidate(
            tuple(corners[cell][order].ravel().tolist()),
            Row(zip(dofs, map(float, weights), strict=True)),
        )


def gauss(start: float, end: float, count: int) -> tuple[Array, Array]:
    """Return Gauss points (count,) on an interval, and weights that sum to one."""
    nodes, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * (start + end) + 0.5 * (end - start) * nodes, 0.5 * weights


def _barycentric(corners: Array, place: Array) -> Array:
    """Return the barycentric coordinates (num_triangles, 3) of a point.

    Corners are (num_triangles, 3, 2).
    """
    sides = corners[:, 1:] - corners[:, :1]
    offset = place - corners[:, 0]
    area = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    second = (offset[:, 0] * sides[:, 1, 1] - offset[:, 1] * sides[:, 1, 0]) / area
    third = (sides[:, 0, 0] * offset[:, 1] - sides[:, 0, 1] * offset[:, 0]) / area
    return np.stack([1.0 - second - third, second, third], axis=1)
