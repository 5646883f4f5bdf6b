# SPDX-License-Identifier: LGPL-3.0-or-later
"""Structured triangle meshes of segments by gmsh.

Each plate of the section is a wall of transfinite patches, two across its width. So mesh lines are
exactly at supports, stations and contact points, and the mesh does not depend on gmsh's version.
The mesh has the symmetries of the section, so that a load in the plane of bending causes lateral
motion only by round-off. A rotated box has the rotated mesh. A diaphragm has a patch in each corner
of the section, and shares the nodes of its outline with the walls.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import gmsh
import meshio
import numpy as np
import numpy.typing as npt

from protractile.geometry.arrays import Array, Indices, Mask
from protractile.geometry.boom import SAME_PLACE, Segment
from protractile.geometry.section import Offset, Plate, Section

# Fraction of a mesh's extent below which a coordinate is 0.
_ROUND_OFF = 1.0e-12


@dataclass(frozen=True, slots=True)
class SegmentMesh:
    """Mid-surface mesh of one segment."""

    #: positions (num_points, 3) in m, with x along the boom and the axis at y = z = 0
    points: Array
    triangles: Indices  #: point numbers (num_triangles, 3)
    plates: tuple[str, ...]  #: names of the section's plates
    #: index (num_triangles,) of each triangle's wall in ``plates``; ``len(plates)`` + k for
    #: diaphragm k
    walls: npt.NDArray[np.int32]
    lines: Mapping[str, Indices]  #: point numbers (num_edges, 2) of the edges of outlines, by name

    @property
    def on_walls(self) -> Mask:
        """The mask (num_triangles,) of triangles on walls, not on diaphragms."""
        return np.asarray(self.walls < len(self.plates))

    @property
    def along(self) -> Array:
        """The x (num_triangles,) in m of the centroids of triangles."""
        return np.asarray(self.centroids[:, 0])

    @property
    def centroids(self) -> Array:
        """The centroids (num_triangles, 3) of triangles in m."""
        return np.asarray(self.points[self.triangles].mean(axis=1))

    def write(self, path: Path) -> None:
        """Write the mesh for ParaView (``.vtu``), with the wall of each triangle as a field."""
        meshio.Mesh(
            self.points, [("triangle", self.triangles)], cell_data={"wall": [self.walls]}
        ).write(path)

    def write_gmsh(self, path: Path) -> None:
        """Write the mesh in gmsh's format, with physical groups of plates, diaphragms and lines.

        Raises:
            OSError: the file cannot be written completely; the error names it.
        """
        count = int(self.walls.max()) + 1 - len(self.plates)
        names = [*self.plates, *(f"diaphragm-{k}" for k in range(1, count + 1))]
        groups = {name: np.array([k, 2]) for k, name in enumerate(names, start=1)}
        first = len(groups) + 1
        groups |= {name: np.array([k, 1]) for k, name in enumerate(self.lines, start=first)}
        of_edges = np.repeat(
            np.arange(first, first + len(self.lines)), [len(line) for line in self.lines.values()]
        )
        tags = [self.walls + 1, of_edges]
        mesh = meshio.Mesh(
            self.points,
            [("triangle", self.triangles), ("line", np.concatenate(list(self.lines.values())))],
            cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
            field_data=groups,
        )
        try:
            mesh.write(path, file_format="gmsh22", binary=False)
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(path)) from None


def mesh_segment(
    section: Section,
    breaks: Mapping[str, float],
    size: float,
    closed: Sequence[str] = (),
    along: Mapping[float, float] | None = None,
    across: Mapping[int, Sequence[float]] | None = None,
) -> SegmentMesh:
    """Return the mesh of a segment: the plates of its section, and diaphragms.

    Args:
        section: section whose mid-lines are meshed.
        breaks: x in m of required mesh lines around the section, by name. The smallest and the
            largest x are the ends of the segment. Two breaks may have the same x.
        size: target edge length in m; each patch has the nearest whole number of edges.
        closed: names of the breaks with a diaphragm, in order.
        along: target edge lengths in m along the boom, by the x in m from which each applies;
            ``size`` before the first x.
        across: distances in m from the middle of a plate, by the plate's index. At each distance
            a mesh line runs along the boom on both sides of the middle.

    Raises:
        ValueError: the size is not a positive number, or there are no two distinct breaks.
        OSError: gmsh's file cannot be written.
    """
    if not (np.isfinite(size) and size > 0.0):
        raise ValueError(f"mesh size must be a positive number of m, got {size}")
    if len(_merge_places(breaks.values())) < 2:
        raise ValueError("a segment needs breaks at two places at least, its ends")
    zones = {-np.inf: size} | dict(along or {})
    outlines = _merge_places([*breaks.values(), *(along or {})])
    lengths = [zones[max(start for start in zones if start <= x)] for x in outlines[:-1]]
    at = {name: int(np.abs(np.array(outlines) - x).argmin()) for name, x in breaks.items()}
    with _gmsh_model():
        halves = _half_plates(section.plates, across or {})
        surfaces, rings = _build_patches(outlines, halves, size, lengths)
        surfaces += [
            _close(outlines[at[name]], rings[at[name]], section, halves, size) for name in closed
        ]
        gmsh.model.geo.synchronize()
        for name in breaks:
            ring = rings[at[name]].curves
            for number, plate in enumerate(section.plates):
                curves = [*ring[2 * number], *ring[2 * number + 1]]
                gmsh.model.addPhysicalGroup(1, curves, name=f"{name}:{plate.name}")
        gmsh.model.mesh.generate(2)
        return _extract(surfaces, tuple(plate.name for plate in section.plates))


def collar_breaks(segment: Segment) -> dict[str, float]:
    """Return the x in m of both ends of each collar of a segment, by name."""
    breaks: dict[str, float] = {}
    for k, collar in enumerate(segment.collars, start=1):
        breaks |= dict(zip((f"collar-{k}-start", f"collar-{k}-end"), collar.span, strict=True))
    return breaks


def diaphragm_breaks(segment: Segment) -> dict[str, float]:
    """Return the x in m of a segment's diaphragms, by name, in order."""
    return {f"diaphragm-{k}": plate.x for k, plate in enumerate(segment.diaphragms, start=1)}


def strip_lines(segment: Segment) -> dict[int, list[float]]:
    """Return the distances in m of collar edges from a plate's midpoint, by the plate's index."""
    lines: dict[int, list[float]] = {}
    for strip in (strip for collar in segment.collars for strip in collar.strips(segment.widest)):
        half = 0.5 * segment.widest.plates[strip.wall].length
        inside = [x for x in strip[1:] if SAME_PLACE * half < x < (1.0 - SAME_PLACE) * half]
        lines[strip.wall] = _merge_places([*lines.get(strip.wall, []), *inside])
    return lines


def _half_plates(
    plates: Sequence[Plate], across: Mapping[int, Sequence[float]]
) -> list[list[Offset]]:
    """Return the points (y, z) in m at which patches start, for each half of each plate."""
    halves = []
    for number, plate in enumerate(plates):
        cuts = sorted(across.get(number, ()))
        for near, sides in ((plate.start, [-x for x in reversed(cuts)]), (plate.midpoint, cuts)):
            beyond = np.add(plate.midpoint, np.multiply.outer(sides, plate.tangent)).reshape(-1, 2)
            halves.append([near, *map(tuple, beyond.tolist())])
    return halves


def _merge_places(values: Iterable[float]) -> list[float]:
    ordered = sorted(values)
    near = SAME_PLACE * max((abs(x) for x in ordered), default=0.0)
    places: list[float] = []
    for x in ordered:
        if not places or x - places[-1] > near:
            places.append(x)
    return places


@contextmanager
def _gmsh_model() -> Iterator[None]:
    gmsh.initialize(interruptible=False)
    _restore_signal_handlers()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.model.add("segment")
        yield
    finally:
        gmsh.finalize()


def _restore_signal_handlers() -> None:
    """Restore Python's signal handlers, which PETSc resets when gmsh starts it.

    Without them SIGTERM, or a closed pipe, would kill the process without a message.
    """
    if threading.current_thread() is not threading.main_thread():
        # Python sets handlers in its main thread only.
        return
    for number in signal.valid_signals():
        handler = signal.getsignal(number)
        if handler not in (None, signal.SIG_DFL):
            signal.signal(number, handler)


class _Ring(NamedTuple):
    """Points of gmsh around a section, and the curves of the half plate that begins at each point.

    Points of even index are corners, points of odd index are centres of plates.
    """

    points: Sequence[int]
    curves: Sequence[Sequence[int]]


def _build_patches(
    outlines: Sequence[float],
    halves: Sequence[Sequence[Offset]],
    across: float,
    along: Sequence[float],
) -> tuple[list[list[int]], list[_Ring]]:
    """Build the transfinite patches of walls.

    ``halves`` has the starts of patches in each half plate; ``across`` is the edge length around
    the section, ``along`` the edge length in each interval along the boom.

    Returns:
        Gmsh's numbers of the patches of each wall, and the ring of each outline.
    """
    geo = gmsh.model.geo
    corners = [place for half in halves for place in half]
    half_of = [number for number, half in enumerate(halves) for _ in half]
    first = [half_of.index(number) for number in range(len(halves))]
    n = len(corners)
    points = [[geo.addPoint(x, y, z) for y, z in corners] for x in outlines]
    rings = [[geo.addLine(p[j], p[(j + 1) % n]) for j in range(n)] for p in points]
    rails = [[geo.addLine(a[j], b[j]) for j in range(n)] for a, b in pairwise(points)]
    surfaces: list[list[int]] = [[] for _ in halves[::2]]
    for i, (x0, x1) in enumerate(pairwise(outlines)):
        for j, (y0, z0) in enumerate(corners):
            k = (j + 1) % n
            y1, z1 = corners[k]
            loop = geo.addCurveLoop([rails[i][j], rings[i + 1][j], -rails[i][k], -rings[i][j]])
            surface = geo.addPlaneSurface([loop])
            surfaces[half_of[j] // 2].append(surface)
            # With growing x, diagonals run from the middle of a wall to a corner. So the mesh has
            # the symmetries of the section, and a rotated box has the rotated mesh.
            geo.mesh.setTransfiniteSurface(
                surface,
                "Left" if half_of[j] % 2 == 0 else "Right",
                [points[i][j], points[i + 1][j], points[i + 1][k], points[i][k]],
            )
            for ring in (rings[i][j], rings[i + 1][j]):
                _divide(ring, float(np.hypot(y1 - y0, z1 - z0)), across)
            for rail in (rails[i][j], rails[i][k]):
                _divide(rail, x1 - x0, along[i])
    return surfaces, [
        _Ring([p[j] for j in first], [ring[a:b] for a, b in pairwise([*first, n])])
        for p, ring in zip(points, rings, strict=True)
    ]


def _close(
    x: float, ring: _Ring, section: Section, halves: Sequence[Sequence[Offset]], size: float
) -> list[int]:
    """Build the transfinite patches of a diaphragm, and return gmsh's numbers of them.

    Spokes from the centre divide the diaphragm. If opposite half plates have equal numbers of
    element edges, as in a box, each corner has a quadrilateral patch. Otherwise each half plate has
    a triangular patch.
    """
    low, high = section.bounds
    middle = gmsh.model.geo.addPoint(x, *(0.5 * (a + b) for a, b in zip(low, high, strict=True)))
    counts = [
        sum(
            _edges(float(np.hypot(*np.subtract(b, a))), size) for a, b in pairwise([*start, end[0]])
        )
        for start, end in zip(halves[::2], halves[1::2], strict=True)
    ]
    if all(before == after for before, after in zip(counts, np.roll(counts, -2), strict=True)):
        spokes = dict(zip(range(1, len(ring.points), 2), np.roll(counts, -1), strict=True))
    else:
        across = 0.5 * min(section.size("y"), section.size("z"))
        spokes = dict.fromkeys(range(len(ring.points)), _edges(across, size))
    return _mesh_between_spokes(ring, middle, spokes)


def _mesh_between_spokes(ring: _Ring, middle: int, spokes: Mapping[int, int]) -> list[int]:
    """Build the patches between spokes, and return gmsh's numbers of them.

    Args:
        ring: ring around the patches.
        middle: point of gmsh at the centre.
        spokes: number of edges of each spoke, by the index of its point of the ring.
    """
    geo, count, places = gmsh.model.geo, len(ring.points), list(spokes)
    curves = {j: geo.addLine(ring.points[j], middle) for j in places}
    for j, edges in spokes.items():
        geo.mesh.setTransfiniteCurve(curves[j], edges + 1)
    surfaces = []
    for before, after in zip([places[-1] - count, *places], places, strict=False):
        sides = [curve for j in range(before, after) for curve in ring.curves[j % count]]
        loop = geo.addCurveLoop([*sides, curves[after], -curves[before % count]])
        surfaces.append(geo.addPlaneSurface([loop]))
        ends = [ring.points[j % count] for j in range(before, after + 1)]
        # Diagonals run from the centre to a corner, so that the mesh is symmetric.
        if len(ends) == 2:
            corner_last = ends if after % 2 == 0 else ends[::-1]
            geo.mesh.setTransfiniteSurface(surfaces[-1], "Left", [middle, *corner_last])
        else:
            geo.mesh.setTransfiniteSurface(surfaces[-1], "Left", [*ends, middle])
    return surfaces


def _divide(curve: int, length: float, size: float) -> None:
    gmsh.model.geo.mesh.setTransfiniteCurve(curve, _edges(length, size) + 1)


def _edges(length: float, size: float) -> int:
    return max(1, int(np.floor(length / size + 0.5)))


def _extract(surfaces: Sequence[Sequence[int]], plates: tuple[str, ...]) -> SegmentMesh:
    mesh = gmsh.model.mesh
    tags, coordinates, _ = mesh.getNodes()
    # Coordinates of points in a mirror plane are exactly 0.
    coordinates[np.abs(coordinates) < _ROUND_OFF * np.ptp(coordinates)] = 0.0
    number = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    number[tags] = np.arange(tags.size)
    triangles, walls = [], []
    for wall, of_wall in enumerate(surfaces):
        for surface in of_wall:
            _, nodes = mesh.getElementsByType(2, surface)
            triangles.append(number[nodes].reshape(-1, 3))
            walls.append(np.full(len(triangles[-1]), wall, dtype=np.int32))
    lines = {}
    for dim, group in gmsh.model.getPhysicalGroups(1):
        curves = gmsh.model.getEntitiesForPhysicalGroup(dim, group)
        edges = [number[mesh.getElementsByType(1, curve)[1]].reshape(-1, 2) for curve in curves]
        lines[gmsh.model.getPhysicalName(dim, group)] = np.concatenate(edges)
    return SegmentMesh(
        coordinates.reshape(-1, 3), np.concatenate(triangles), plates, np.concatenate(walls), lines
    )
