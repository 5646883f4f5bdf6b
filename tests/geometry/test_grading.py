# SPDX-License-Identifier: LGPL-3.0-or-later
"""Graded meshes are closed, exact, mirror images of themselves, and as fine as they are to be."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest

from geometry.arrays import Array
from geometry.boom import Boom, Collar, Diaphragm, PadSize
from geometry.contact_places import pads
from geometry.grading import graded_mesh
from geometry.mesh import SegmentMesh, mesh_segment
from geometry.refinement import RefinementZone, refinement_zones
from geometry.section import BoxSection

BOX = BoxSection(height=0.4, width=0.3, flange=0.006, web=0.005)
BREAKS = {"start": 0.0, "middle": 2.0, "end": 5.0}
CORNER = RefinementZone((2.0, 0.15, 0.2), (2.1, 0.15, 0.2), 0.02, 0.5)
PAD = RefinementZone((4.9, 0.05, 0.2), (5.0, 0.11, 0.2), 0.015, 0.3)


@pytest.fixture(scope="module", name="mesh")
def _mesh() -> SegmentMesh:
    return graded_mesh(BOX, BREAKS, 0.1, [CORNER, PAD], closed=("middle",))


def _areas(mesh: SegmentMesh) -> Array:
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return np.asarray(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))


def _longest(mesh: SegmentMesh) -> Array:
    corners = mesh.points[mesh.triangles]
    return np.asarray(np.linalg.norm(np.roll(corners, 1, axis=1) - corners, axis=2).max(axis=1))


def test_no_node_hangs_and_no_wall_is_lost(mesh: SegmentMesh) -> None:
    """Reference: analytic. Two triangles at every edge, one at the ends, three at the diaphragm;
    areas of walls and plate.
    """
    edges = Counter(
        tuple(sorted((t[i], t[i - 1]))) for t in mesh.triangles.tolist() for i in range(3)
    )
    at = {edge: mesh.points[list(edge), 0] for edge in edges}
    for edge, count in edges.items():
        on_end = np.isin(at[edge], (0.0, 5.0)).all()
        around = np.isclose(np.abs(mesh.points[list(edge), 1]), 0.15).all()
        around |= np.isclose(np.abs(mesh.points[list(edge), 2]), 0.2).all()
        at_plate = (at[edge] == 2.0).all() and around
        assert count == (1 if on_end else 3 if at_plate else 2)
    areas = _areas(mesh)
    assert areas[mesh.on_walls].sum() == pytest.approx(2.0 * 0.7 * 5.0, rel=1.0e-12)
    assert areas[~mesh.on_walls].sum() == pytest.approx(0.3 * 0.4, rel=1.0e-12)


@pytest.mark.parametrize("axis", [1, 2], ids=["y", "z"])
def test_it_mirrors_itself(mesh: SegmentMesh, axis: int) -> None:
    places = {tuple(p): i for i, p in enumerate(np.round(mesh.points, 9) + 0.0)}
    mirrored = np.round(mesh.points, 9)
    mirrored[:, axis] *= -1.0
    image = np.array([places[tuple(p)] for p in mirrored + 0.0])
    triangles = {tuple(t) for t in np.sort(mesh.triangles, axis=1).tolist()}
    assert {tuple(t) for t in np.sort(image[mesh.triangles], axis=1).tolist()} == triangles


def test_it_is_fine_at_its_spots_and_coarse_far_from_them(mesh: SegmentMesh) -> None:
    """Reference: analytic. No triangle is larger than its nearest spot allows; those a metre away
    are rectangles' halves of 0.05 m across, and of 0.2 m along the boom as nearly as whole numbers
    let them be.
    """
    places = np.column_stack([mesh.points[:, 0], np.abs(mesh.points[:, 1:])])
    allowed = np.minimum(CORNER.edge_length(places), PAD.edge_length(places))
    sides = _longest(mesh) / np.sqrt(2.0)
    assert (sides < 1.000001 * allowed[mesh.triangles].min(axis=1)).all()
    x = mesh.points[mesh.triangles, 0].mean(axis=1)
    far = (x > 0.1) & (x < 0.9) & (np.abs(mesh.points[mesh.triangles, 1]).max(axis=1) < 0.15)
    assert _longest(mesh)[far] == pytest.approx(np.hypot(0.2, 0.05), rel=0.05)
    uniform = mesh_segment(BOX, BREAKS, 0.015, closed=("middle",))
    assert len(mesh.triangles) < 0.15 * len(uniform.triangles)


def test_lines_stay_whole(mesh: SegmentMesh) -> None:
    edges = {tuple(sorted((t[i], t[i - 1]))) for t in mesh.triangles.tolist() for i in range(3)}
    for name, x in BREAKS.items():
        for wall in mesh.plates:
            line = mesh.lines[f"{name}:{wall}"]
            ends = mesh.points[line]
            side = BOX.width if wall in ("bottom", "top") else BOX.height
            lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
            assert lengths.sum() == pytest.approx(side, rel=1.0e-12)
            assert (ends[:, :, 0] == x).all()
            assert {tuple(sorted(edge)) for edge in line.tolist()} <= edges


def test_refinement_zones_are_at_loads_supports_and_stiffeners(paper_boom: Boom) -> None:
    """Reference: analytic, by hand, for the paper's outer segment with a collar and a diaphragm:
    supports, stiffeners, the corners at 9 and, moved inwards, at 10 m; pads in their place. Four
    times the tolerance, twice the size.
    """
    outer, inner = paper_boom.segments
    assert outer.section is not None
    assert inner.section is not None
    b, h = 0.5 * outer.section.width, 0.5 * outer.section.height
    stiff = replace(outer, collars=(Collar((8.0, 8.5), 0.01),), diaphragms=(Diaphragm(5.0, 0.01),))
    boom = replace(paper_boom, segments=(stiff, inner))
    found = refinement_zones(boom, 0, 0.01, "near webs", [], pads(boom))
    assert [zone.low[0] for zone in found[:-2]] == [0.0, 2.0, 8.0, 8.5, 5.0]
    assert all(zone.low[1:] == (0.0, 0.0) and zone.high[1:] == (b, h) for zone in found[:-2])
    for zone, start in zip(found[-2:], (8.95, 9.9), strict=True):
        assert zone.low == pytest.approx((start, b, h))
        assert zone.high == pytest.approx((start + 0.1, b, h))
        assert zone.size == pytest.approx(0.02)
    loose = refinement_zones(boom, 0, 0.04, "near webs", [], pads(boom))
    assert [zone.size for zone in loose] == pytest.approx([2.0 * zone.size for zone in found])
    (joint,) = boom.joints
    padded = replace(boom, joints=(replace(joint, pad=PadSize(0.1, 0.06)),))
    near = 0.5 * inner.section.width
    of_pads = refinement_zones(padded, 0, 0.01, "near webs", [], pads(padded))[-2:]
    for zone, start in zip(of_pads, (9.0, 9.9), strict=True):
        assert zone.low == pytest.approx((start, near - 0.06, h))
        assert zone.high == pytest.approx((start + 0.1, near, h))
