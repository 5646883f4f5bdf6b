# SPDX-License-Identifier: LGPL-3.0-or-later
"""Graded meshes: fine at contacts and loads, and coarser elsewhere.

The first step divides walls into pairs of triangles that form rectangles. Rectangles are nearly
square near a refinement zone; far from all zones they are almost seven times as long along the boom
as across. The main error of coarse meshes is the bending of walls across the boom. It is
proportional to the square of the edge length across, and depends little on the length along:
halving both lowers the frequencies of walls by 0.2 to 0.4 %.

The second step is newest-vertex bisection (Mitchell 1989). It divides each triangle from its newest
vertex to the middle of the opposite edge, at first the diagonal of its rectangle. After two
bisections, triangles have the original shape. Neighbours are also divided, so that there are no
hanging nodes. Sizes are compared at rounded coordinates on the positive side of the mirror planes,
so that the mesh stays symmetric.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from protractile.geometry.arrays import Array, Indices, Mask
from protractile.geometry.mesh import SegmentMesh, mesh_segment
from protractile.geometry.refinement import RefinementZone
from protractile.geometry.section import COMPONENT, Direction, Section

# Tolerance of lengths as a fraction of the length of a mesh: below any edge, above round-off.
_ROUNDED = 1.0e-9

# Tie-break between edges of equal length: relative reduction of an edge at the outline, and weights
# of x, y and z in its distance from the axis.
_TIE_BREAK, _TIE_WEIGHTS = 1.0e-6, np.array([0.0, 1.0, 1.6])

# Sides of rectangles as fractions of the mesh size: across the boom, and along the boom at
# increasing distance from zones.
_ACROSS = 0.3
_ALONG = (0.5, 1.0, 2.0)


def graded_mesh(
    section: Section,
    breaks: Mapping[str, float],
    size: float,
    zones: Sequence[RefinementZone],
    closed: Sequence[str] = (),
    across: Mapping[int, Sequence[float]] | None = None,
) -> SegmentMesh:
    """Mesh the walls of a segment as :func:`mesh_segment`, with refinement zones.

    Args:
        section, breaks, closed, across: as in :func:`mesh_segment`.
        size: mesh size in m outside all zones: the square root of the area of a rectangle.

    Raises:
        ValueError: as in :func:`mesh_segment`.
    """
    along = _along(breaks, size, zones)
    mesh = _diagonals_first(mesh_segment(section, breaks, _ACROSS * size, closed, along, across))
    while (cut := _too_large(mesh, section.mirrors, zones)).any():
        mesh = _bisect(mesh, cut)
    return mesh


def _along(
    breaks: Mapping[str, float], size: float, zones: Sequence[RefinementZone]
) -> dict[float, float]:
    """Return the lengths of rectangles in m; a key is the x in m from which its length applies."""
    start, end = min(breaks.values()), max(breaks.values())
    fine, middle, coarse = (part * size for part in _ALONG)
    ends = {x for zone in zones for length in (middle, coarse) for x in zone.reach(length)}
    # Changes of length near a break are omitted, since they would add slender triangles.
    distant = [x for x in ends if min(abs(x - place) for place in breaks.values()) > fine]
    lengths: dict[float, float] = {}
    for x in sorted([start, *(x for x in distant if start < x < end)]):
        if lengths and x - max(lengths) < fine:
            continue
        lengths[x] = coarse
    places = sorted([*lengths, end])
    for x, beyond in pairwise(places):
        here = 0.5 * (x + beyond)
        for length, longer in ((middle, coarse), (fine, middle)):
            if any(low < here < high for low, high in (zone.reach(longer) for zone in zones)):
                lengths[x] = length
    return lengths


def _diagonals_first(mesh: SegmentMesh) -> SegmentMesh:
    """Return the mesh with the longest edge of each triangle first.

    Of two equal edges of a diaphragm, the edge nearer to the axis is first, so that the mesh stays
    symmetric.
    """
    corners = mesh.points[mesh.triangles]
    distance = np.abs(corners + np.roll(corners, -1, axis=1)) @ _TIE_WEIGHTS
    lengths = _edges(corners) * (1.0 - _TIE_BREAK * distance / np.ptp(mesh.points[:, 1:]))
    turn = lengths.argmax(axis=1)[:, None] + np.arange(3)
    return replace(mesh, triangles=np.take_along_axis(mesh.triangles, turn % 3, axis=1))


def _edges(corners: Array) -> Array:
    """Return the lengths (num_triangles, 3) of edges in m, from corners (num_triangles, 3, 3)."""
    return np.asarray(np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2))


def _too_large(
    mesh: SegmentMesh, mirrors: Sequence[Direction], zones: Sequence[RefinementZone]
) -> Mask:
    """Return the mask (num_triangles,) of triangles that are too large for a zone."""
    near = _ROUNDED * float(np.ptp(mesh.points[:, 0]))
    places = mesh.points.copy()
    mirrored = [COMPONENT[axis] for axis in mirrors]
    places[:, mirrored] = np.abs(places[:, mirrored])
    places = near * np.round(places / near)
    allowed = np.min([zone.edge_length(places) for zone in zones], axis=0, initial=np.inf)
    # Legs of the isosceles right triangle with the same longest edge.
    sides = _edges(places[mesh.triangles]).max(axis=1) / np.sqrt(2.0)
    return np.asarray(sides - allowed[mesh.triangles].min(axis=1) > near)


def _bisect(mesh: SegmentMesh, cut: Mask) -> SegmentMesh:
    """Return the mesh with the marked triangles bisected, without hanging nodes."""
    edges = np.sort(np.stack([mesh.triangles, np.roll(mesh.triangles, -1, axis=1)], axis=2), axis=2)
    # Sorting one number per pair of points is ten times as fast as sorting pairs.
    count = np.int64(len(mesh.points))
    numbers, edge_of = np.unique(edges[..., 0] * count + edges[..., 1], return_inverse=True)
    ends, edge_of = np.stack(np.divmod(numbers, count), axis=1), edge_of.reshape(-1, 3)
    halved = np.zeros(len(ends), dtype=bool)
    halved[edge_of[cut, 0]] = True
    while (more := halved[edge_of].any(axis=1) & ~halved[edge_of[:, 0]]).any():
        halved[edge_of[more, 0]] = True
    middle = np.full(len(ends), -1)
    middle[halved] = len(mesh.points) + np.arange(halved.sum())
    points = np.concatenate([mesh.points, mesh.points[ends[halved]].mean(axis=1)])
    triangles, walls, midpoints = mesh.triangles, mesh.walls, middle[edge_of]
    while (split := midpoints[:, 0] >= 0).any():
        a, b, c = triangles[split].T
        new, after, before = midpoints[split].T
        # The edge opposite to the new vertex comes first, since it is bisected next.
        halves = np.column_stack([b, c, new]), np.column_stack([c, a, new])
        whole = np.full(len(new), -1)
        left = np.column_stack([after, whole, whole]), np.column_stack([before, whole, whole])
        triangles = np.concatenate([triangles[~split], *halves])
        midpoints = np.concatenate([midpoints[~split], *left])
        walls = np.concatenate([walls[~split], walls[split], walls[split]])
    midpoints_of = zip(ends[halved].tolist(), middle[halved].tolist(), strict=True)
    new_of = {(a, b): new for (a, b), new in midpoints_of}
    lines = {name: _with_midpoints(line, new_of) for name, line in mesh.lines.items()}
    return replace(mesh, points=points, triangles=triangles, walls=walls, lines=lines)


def _with_midpoints(line: Indices, new_of: Mapping[tuple[int, int], int]) -> Indices:
    """Return the edges (num_edges, 2) of a line, with two halves of each bisected edge."""
    halves: list[tuple[int, int]] = []
    for a, b in line.tolist():
        new = new_of.get((min(a, b), max(a, b)))
        halves += [(a, b)] if new is None else [(a, new), (new, b)]
    return np.array(halves, dtype=np.int64)
