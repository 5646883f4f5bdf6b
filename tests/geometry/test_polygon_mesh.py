# SPDX-License-Identifier: LGPL-3.0-or-later
"""Meshes of polygons: plates in their places, mirror images to round-off, closed by diaphragms."""

from collections import Counter

import numpy as np
import pytest
from scipy.spatial import cKDTree

from geometry.arrays import Array
from geometry.grading import graded_mesh
from geometry.mesh import SegmentMesh, mesh_segment
from geometry.plating import plain_thickness
from geometry.refinement import RefinementZone
from geometry.section import COMPONENT, Section
from tests.geometry.test_polygon import ALL, regular

SECTIONS = ALL | {"regular": regular(6, 0.25, 0.006)}
BREAKS = {"start": 0.0, "plate": 1.0, "end": 2.0}


def areas(mesh: SegmentMesh) -> Array:
    corners = mesh.points[mesh.triangles]
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.asarray(0.5 * np.linalg.norm(sides, axis=1))


def meshes(section: Section) -> list[SegmentMesh]:
    """Even, and graded towards the diaphragm."""
    zone = RefinementZone((1.0, 0.0, -1.0), (1.0, 1.0, 1.0), 0.03, 0.5)
    return [
        mesh_segment(section, BREAKS, 0.06, closed=("plate",)),
        graded_mesh(section, BREAKS, 0.2, [zone], closed=("plate",)),
    ]


@pytest.mark.parametrize("name", SECTIONS)
def test_each_plate_has_its_place_area_and_thickness(name: str) -> None:
    """Reference: analytic. The diaphragm fills the outline, and shares its edges with the walls."""
    section = SECTIONS[name]
    for mesh in meshes(section):
        found, thickness = areas(mesh), plain_thickness(section, mesh)
        for number, plate in enumerate(section.plates):
            mine = mesh.walls == number
            places = mesh.points[mesh.triangles[mine]].reshape(-1, 3)[:, 1:]
            assert plate.distance(places).max() < 1e-12
            assert found[mine].sum() == pytest.approx(2.0 * plate.length, rel=1e-12)
            assert (thickness[mine] == plate.thickness).all()
        assert found[~mesh.on_walls].sum() == pytest.approx(section.enclosed_area, rel=1e-12)
        assert found.min() > 1e-3 * found.mean()
        edges = np.sort(np.stack([mesh.triangles, np.roll(mesh.triangles, 1, axis=1)], axis=2))
        shared = Counter(map(tuple, edges.reshape(-1, 2).tolist()))
        ends = [edge for edge, count in shared.items() if count == 1]
        assert set(mesh.points[np.unique(ends), 0]) == {0.0, 2.0}
        welded = np.unique([edge for edge, count in shared.items() if count == 3])
        assert mesh.points[welded, 0] == pytest.approx(np.ones(welded.size))


@pytest.mark.parametrize("name", SECTIONS)
def test_meshes_are_their_own_images(name: str) -> None:
    """Reference: symmetry. Corners and triangles, in each mirror of the section."""
    section = SECTIONS[name]
    for mesh in meshes(section):
        for axis in section.mirrors:
            mirror = np.ones(3)
            mirror[COMPONENT[axis]] = -1.0
            distance, image = cKDTree(mesh.points).query(mesh.points * mirror)
            assert distance.max() < 1e-12
            across = np.abs(mesh.points[:, COMPONENT[axis]])
            assert across[across < 1e-9].max() == 0.0
            assert set(map(tuple, np.sort(image[mesh.triangles], axis=1).tolist())) == set(
                map(tuple, np.sort(mesh.triangles, axis=1).tolist())
            )
