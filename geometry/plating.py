# SPDX-License-Identifier: LGPL-3.0-or-later
"""Meshes with the plate thickness of each triangle, and meshes of tapered segments."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.mesh import SegmentMesh
from protractile.geometry.section import Section
from protractile.geometry.segment import Segment

# Tolerance for x as a fraction of a segment's length: below any triangle, above round-off.
_DIGITS = 9


@dataclass(frozen=True, slots=True)
class PlatedMesh(SegmentMesh):
    """Mesh with the thickness of each triangle."""

    thickness: Array  #: thickness (num_triangles,) in m
    plain: Array  #: thickness (num_triangles,) in m without collars, 0 on diaphragms
    #: weight (num_triangles,) in m that distributes a uniform line load over the walls: ``plain``
    #: times the mean area of the segment over that of its plates here
    load_weight: Array

    @property
    def refined(self) -> PlatedMesh:
        """The mesh with each triangle divided into four, without lines.

        It begins with the points of this mesh. Triangles 4k to 4k + 3 replace triangle k.
        """
        corners = self.triangles
        edges = np.sort(corners[:, [[1, 2], [2, 0], [0, 1]]], axis=2).reshape(-1, 2)
        ends, number = np.unique(edges, axis=0, return_inverse=True)
        (a, b, c), (of_a, of_b, of_c) = (
            each.T for each in (corners, len(self.points) + number.reshape(-1, 3))
        )
        parts = [[a, of_c, of_b], [of_c, b, of_a], [of_b, of_a, c], [of_a, of_b, of_c]]
        return replace(
            self,
            points=np.concatenate([self.points, self.points[ends].mean(axis=1)]),
            triangles=np.array(parts).transpose(2, 0, 1).reshape(-1, 3),
            walls=np.repeat(self.walls, 4),
            lines={},
            thickness=np.repeat(self.thickness, 4),
            plain=np.repeat(self.plain, 4),
            load_weight=np.repeat(self.load_weight, 4),
        )


def add_thickness(segment: Segment, mesh: SegmentMesh) -> PlatedMesh:
    """Return a mesh with the plate thickness of its segment.

    Args:
        segment: segment with a section.
        mesh: mesh of the segment, with lines at the ends of collars, and diaphragms in the order of
            the segment.
    """
    assert segment.section is not None
    x, plain = mesh.along, plain_thickness(segment.section, mesh)
    # Meshes have no bends.
    plates = [segment.section_at(place).plates for place in np.linspace(*segment.ends, 3).tolist()]
    areas = [sum(plate.length * plate.thickness for plate in each) for each in plates]
    even = plain * (segment.area / areas[0])
    if segment.head_section is not None:
        # Rounding gives mirror images exactly the same thickness.
        part = np.round((x - segment.start) / segment.length, _DIGITS)
        plain = plain + part * (plain_thickness(segment.head_section, mesh) - plain)
        even = plain * segment.area / np.polyval(np.polyfit([0.0, 0.5, 1.0], areas, 2), part)
    thickness = plain.copy()
    for collar in segment.collars:
        start, end = collar.span
        within = (x > start) & (x < end)
        for wall, low, high in collar.strips(segment.widest):
            plate = segment.widest.plates[wall]
            beside = np.abs((mesh.centroids[:, 1:] - plate.midpoint) @ plate.tangent)
            covered = within & (mesh.walls == wall) & (beside > low) & (beside < high)
            thickness[covered] += collar.thickness
    for number, diaphragm in enumerate(segment.diaphragms, start=len(mesh.plates)):
        thickness[mesh.walls == number] = diaphragm.thickness
    return PlatedMesh(
        mesh.points, mesh.triangles, mesh.plates, mesh.walls, mesh.lines, thickness, plain, even
    )


def plain_thickness(section: Section, mesh: SegmentMesh) -> Array:
    """Return the wall thickness (num_triangles,) in m, without collars; 0 on diaphragms."""
    of_wall = [plate.thickness for plate in section.plates]
    return np.asarray(np.array([*of_wall, 0.0])[np.minimum(mesh.walls, len(of_wall))])


# Fraction of a mesh's extent below which coordinates, and their differences, are 0.
_ROUND_OFF = 1.0e-12


def tapered_mesh(segment: Segment, mesh: PlatedMesh) -> PlatedMesh:
    """Return a tapered mesh: each point moves to the wall of the section at its x.

    Triangles between the centre and each plate divide a section. A point keeps its relative
    position in its triangle. Walls are flat between mesh lines.

    Args:
        segment: tapered segment.
        mesh: mesh of the prismatic segment with the section ``segment.widest``.
    """
    # Triangle of each point, and two barycentric coordinates.
    starts, middle = _fan(segment.widest)
    sides = np.stack([starts, np.roll(starts, -1, axis=0)], axis=2) - middle[:, None]
    parts = np.einsum("kij,nj->nki", np.linalg.inv(sides), mesh.points[:, 1:] - middle)
    number = parts.min(axis=2).argmax(axis=1)
    first, last = parts[np.arange(len(parts)), number].T
    points = mesh.points.copy()
    near = _ROUND_OFF * float(np.ptp(points[:, 0]))
    places, at = np.unique(np.round(points[:, 0] / near), return_inverse=True)
    for k, x in enumerate((near * places).tolist()):
        (here,) = np.nonzero(at == k)
        starts, middle = _fan(segment.section_at(x))
        ends = np.roll(starts, -1, axis=0)
        arms = (starts - middle)[number[here]], (ends - middle)[number[here]]
        points[here, 1:] = middle + first[here, None] * arms[0] + last[here, None] * arms[1]
    # Coordinates of points in a mirror plane are exactly 0.
    points[np.abs(points) < near] = 0.0
    return replace(mesh, points=points)


def _fan(section: Section) -> tuple[Array, Array]:
    """Return the starts (num_plates, 2) of the plates and the centre (2,) of a section in m."""
    return np.array([plate.start for plate in section.plates]), np.mean(section.bounds, axis=0)
