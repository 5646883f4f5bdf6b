# SPDX-License-Identifier: LGPL-3.0-or-later
"""How thick a segment's plates are, triangle by triangle of its mesh."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.mesh import SegmentMesh
from geometry.section import Section
from geometry.segment import Segment
from geometry.taper import areas

# Of a part of a segment's length: below any triangle, above round-off.
_DIGITS = 9


@dataclass(frozen=True, slots=True)
class PlatedMesh(SegmentMesh):
    """A mesh whose triangles know how thick they are.

    Args:
        thickness: (num_triangles,) of all plates in m.
        plain: (num_triangles,) of the walls without collars in m, 0 on diaphragms.
        even: (num_triangles,) in m by which a force per length that is the same at each x is spread
            over the walls: ``plain``, over the section's part of the mean area where it tapers.
    """

    thickness: Array
    plain: Array
    even: Array


def plated(segment: Segment, mesh: SegmentMesh) -> PlatedMesh:
    """A segment's mesh with the thickness of its plates.

    Args:
        segment: its section is known; its diaphragms are those of the mesh, in the same order.
        mesh: with lines at the ends of the collars.
    """
    assert segment.section is not None
    x = mesh.along
    plain = even = plain_thickness(segment.section, mesh)
    if segment.head_section is not None:
        # Mirror images have the same to the last bit.
        part = np.round((x - segment.start) / segment.length, _DIGITS)
        plain = plain + part * (plain_thickness(segment.head_section, mesh) - plain)
        parabola = np.polyfit([0.0, 0.5, 1.0], areas(segment.section, segment.head_section), 2)
        even = plain * segment.area / np.polyval(parabola, part)
    thickness = plain.copy()
    for collar in segment.collars:
        thickness[mesh.on_walls & (x > collar.start) & (x < collar.end)] += collar.thickness
    for number, diaphragm in enumerate(segment.diaphragms, start=len(mesh.plates)):
        thickness[mesh.walls == number] = diaphragm.thickness
    return PlatedMesh(
        mesh.points, mesh.triangles, mesh.plates, mesh.walls, mesh.lines, thickness, plain, even
    )


def plain_thickness(section: Section, mesh: SegmentMesh) -> Array:
    """(num_triangles,) thickness in m of the walls without collars, 0 on diaphragms."""
    of_wall = [plate.thickness for plate in section.plates]
    return np.asarray(np.array([*of_wall, 0.0])[np.minimum(mesh.walls, len(of_wall))])
