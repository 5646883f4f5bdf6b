# SPDX-License-Identifier: LGPL-3.0-or-later
"""Meshes of segments: uniform, graded, of polygons."""

import re
import resource
import signal
from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import pairwise, product
from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from protractile.geometry.arrays import Array, Indices
from protractile.geometry.boom import Boom, Collar, Diaphragm, Pad
from protractile.geometry.box import BoxSection
from protractile.geometry.grading import graded_mesh
from protractile.geometry.mesh import SegmentMesh, collar_breaks, diaphragm_breaks, mesh_segment
from protractile.geometry.plating import add_thickness, plain_thickness
from protractile.geometry.refinement import RefinementZone, refinement_zones
from protractile.geometry.section import COMPONENT, Section
from tests.geometry.test_section import ALL, regular
from tests.shell_model.booms import box_segment

WALLS = ("bottom", "right", "top", "left")
BOX = BoxSection(height=0.4945, width=0.3027, flange=0.00664, web=0.00664)

SECTIONS = ALL | {
    "regular": regular(6, 0.25, 0.006),
    "box": BOX,
    "unequal box": BoxSection(0.60, 0.40, flange=0.04, web=0.01, bottom_flange=0.02),
}
PLATE_BREAKS = {"start": 0.0, "plate": 1.0, "station": 2.0, "end": 2.0}
CLOSED = ("plate", "end")
GRADED = BoxSection(height=0.4, width=0.3, flange=0.006, web=0.005)
GRADED_BREAKS = {"start": 0.0, "middle": 2.0, "end": 5.0}
CORNER = RefinementZone((2.0, 0.15, 0.2), (2.1, 0.15, 0.2), 0.02, 0.5)
PAD = RefinementZone((4.9, 0.05, 0.2), (5.0, 0.11, 0.2), 0.015, 0.3)

Lines = Mapping[str, tuple[float, int]]


@cache
def made(name: str, kind: str) -> tuple[Section, SegmentMesh, Lines]:
    """Return a section, a mesh that is uniform, or graded towards a diaphragm or the contacts of a
    box, and for each line its x in m and the number of triangles that meet at its edges.
    """
    if kind == "of contacts":
        mesh = graded_mesh(GRADED, GRADED_BREAKS, 0.1, [CORNER, PAD], closed=("middle",))
        return GRADED, mesh, {"start": (0.0, 1), "middle": (2.0, 3), "end": (5.0, 1)}
    section = SECTIONS[name]
    if kind == "uniform":
        mesh = mesh_segment(section, PLATE_BREAKS, 0.06, closed=CLOSED)
    else:
        zone = RefinementZone((1.0, 0.0, -1.0), (1.0, 1.0, 1.0), 0.03, 0.5)
        mesh = graded_mesh(section, PLATE_BREAKS, 0.2, [zone], closed=CLOSED)
    meeting = {"start": 1, "plate": 3, "station": 2, "end": 2}
    return section, mesh, {line: (x, meeting[line]) for line, x in PLATE_BREAKS.items()}


MESHES = pytest.mark.parametrize(
    ("name", "kind"), [*product(SECTIONS, ("uniform", "graded")), ("box", "of contacts")]
)


def edge_counts(triangles: Indices) -> Counter[tuple[int, int]]:
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return Counter(map(tuple, np.sort(sides, axis=1).tolist()))


def areas(mesh: SegmentMesh) -> Array:
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def line_length(mesh: SegmentMesh, edges: Indices) -> float:
    return float(np.linalg.norm(np.diff(mesh.points[edges], axis=1), axis=2).sum())


@MESHES
def test_each_plate_has_its_place_area_and_thickness(name: str, kind: str) -> None:
    """Reference: analytic. Diaphragms fill the outline; points are used, and no two coincide."""
    section, mesh, lines = made(name, kind)
    found, thickness = areas(mesh), plain_thickness(section, mesh)
    for number, plate in enumerate(section.plates):
        mine = mesh.walls == number
        places = mesh.points[mesh.triangles[mine]].reshape(-1, 3)[:, 1:]
        assert plate.distance(places).max() < 1e-14
        assert found[mine].sum() == pytest.approx(lines["end"][0] * plate.length, rel=1e-12)
        assert (thickness[mine] == plate.thickness).all()
    closed = ("middle",) if kind == "of contacts" else CLOSED
    for number, line in enumerate(closed, start=len(section.plates)):
        mine = mesh.walls == number
        assert found[mine].sum() == pytest.approx(section.enclosed_area, rel=1e-12)
        assert (mesh.points[mesh.triangles[mine], 0] == lines[line][0]).all()
    np.testing.assert_array_equal(mesh.on_walls, mesh.walls < len(section.plates))
    assert found.min() > 1e-3 * found.mean()
    assert set(np.unique(mesh.triangles)) == set(range(len(mesh.points)))
    assert len(np.unique(np.round(mesh.points, 9), axis=0)) == len(mesh.points)


@MESHES
def test_walls_are_closed_between_named_lines_around_them(name: str, kind: str) -> None:
    """Reference: analytic, the lengths of lines. Edges have two triangles, at an open end one, at a
    diaphragm between the ends three.
    """
    section, mesh, lines = made(name, kind)
    assert set(mesh.lines) == {f"{line}:{plate.name}" for line in lines for plate in section.plates}
    expected = dict.fromkeys(edge_counts(mesh.triangles), 2)
    for line, (x, meeting) in lines.items():
        sides = [mesh.lines[f"{line}:{plate.name}"] for plate in section.plates]
        for edges, plate in zip(sides, section.plates, strict=True):
            assert line_length(mesh, edges) == pytest.approx(plate.length, rel=1e-12)
        around = np.concatenate(sides)
        assert (mesh.points[around, 0] == x).all()
        assert set(Counter(around.ravel().tolist()).values()) == {2}
        expected |= dict.fromkeys(map(tuple, np.sort(around, axis=1).tolist()), meeting)
    assert edge_counts(mesh.triangles) == expected


@MESHES
def test_meshes_mirror_themselves(name: str, kind: str) -> None:
    """Reference: symmetry of points and triangles about each mirror plane of the section."""
    section, mesh, _ = made(name, kind)
    for axis in section.mirrors:
        mirror = np.ones(3)
        mirror[COMPONENT[axis]] = -1.0
        distance, image = cKDTree(mesh.points).query(mesh.points * mirror)
        assert distance.max() < 1e-12
        found, expected = (
            set(map(tuple, np.sort(triangles, axis=1).tolist()))
            for triangles in (image[mesh.triangles], mesh.triangles)
        )
        assert found == expected
        across = np.abs(mesh.points[:, COMPONENT[axis]])
        assert across[across < 1e-9].max() == 0.0


def test_plates_have_their_thicknesses() -> None:
    """Reference: analytic, the volume of walls, a collar around them and two diaphragms."""
    box = BoxSection(height=0.5, width=0.3, flange=0.008, web=0.006)
    segment = replace(
        box_segment("box", 0.0, 10.0, box),
        collars=(Collar((8.7, 9.1), 0.01),),
        diaphragms=(Diaphragm(9.0, 0.012), Diaphragm(2.0, 0.004)),
    )
    plates = diaphragm_breaks(segment)
    breaks = {"tail": 0.0, "head": 10.0} | plates | collar_breaks(segment)
    assert breaks == {
        "tail": 0.0, "head": 10.0, "diaphragm-1": 9.0, "diaphragm-2": 2.0,
        "collar-1-start": 8.7, "collar-1-end": 9.1,
    }  # fmt: skip
    mesh = add_thickness(segment, mesh_segment(box, breaks, 0.15, closed=tuple(plates)))
    walls = box.area * 10.0
    assert mesh.plain @ areas(mesh) == pytest.approx(walls, rel=1e-12)
    collar, closing = 1.6 * 0.4 * 0.01, 0.15 * (0.012 + 0.004)
    assert mesh.thickness @ areas(mesh) == pytest.approx(walls + collar + closing, rel=1e-12)


@settings(max_examples=25)
@given(
    spans=st.lists(st.floats(0.013, 3.7), min_size=1, max_size=4),
    start=st.floats(-5.0, 20.0),
    size=st.floats(0.11, 2.3),
    height=st.floats(0.1, 0.9),
)
def test_lines_lie_at_the_breaks_for_awkward_lengths(
    spans: list[float], start: float, size: float, height: float
) -> None:
    """Reference: analytic. No triangle reaches across a line, and the edges along x come as near to
    the size as whole numbers allow.
    """
    places = start + np.concatenate([[0.0], np.cumsum(spans)])
    breaks = {f"break-{k}": float(x) for k, x in enumerate(places)}
    mesh = mesh_segment(BoxSection(height, 0.3, 0.006, 0.006), breaks, size)
    corners = mesh.points[mesh.triangles, 0]
    for a, b in pairwise(places):
        inside = (corners.min(axis=1) >= a - 1e-9) & (corners.max(axis=1) <= b + 1e-9)
        around = 2.0 * (height + 0.3)
        assert areas(mesh)[inside].sum() == pytest.approx(around * (b - a), rel=1e-9)
        steps = len(np.unique(np.round(corners[inside], 9))) - 1
        assert steps == max(1, int((b - a) / size + 0.5))


def test_files_hold_the_mesh(tmp_path: Path) -> None:
    """Reference: other code, meshio's readers; of coincident lines both are in the file."""
    breaks = {"tail": 0.0, "support-2": 2.0, "station-3": 3.0, "end": 3.5, "head": 3.5}
    mesh = mesh_segment(BOX, breaks, 0.25, closed=("station-3",))
    mesh.write(tmp_path / "outer.vtu")
    read = meshio.read(tmp_path / "outer.vtu")
    np.testing.assert_allclose(read.points, mesh.points, atol=1e-15)
    np.testing.assert_array_equal(read.cells_dict["triangle"], mesh.triangles)
    np.testing.assert_array_equal(read.cell_data_dict["wall"]["triangle"], mesh.walls)
    path = tmp_path / "outer.msh"
    mesh.write_gmsh(path)
    read = meshio.read(path)
    plates = (*WALLS, "diaphragm-1")
    lines = {f"{name}:{wall}": 1 for name in breaks for wall in WALLS}
    assert {name: int(dim) for name, (_, dim) in read.field_data.items()} == lines | dict.fromkeys(
        plates, 2
    )

    def centres(kind: str, name: str) -> Array:
        tags = read.cell_data_dict["gmsh:physical"][kind]
        cells = read.cells_dict[kind][tags == read.field_data[name][0]]
        return np.sort(read.points[cells].mean(axis=1), axis=0)

    for number, plate in enumerate(plates):
        expected = mesh.points[mesh.triangles[mesh.walls == number]].mean(axis=1)
        np.testing.assert_allclose(
            centres("triangle", plate), np.sort(expected, axis=0), atol=1e-12
        )
    for name in ("tail:top", "support-2:left", "station-3:right"):
        expected = np.sort(mesh.points[mesh.lines[name]].mean(axis=1), axis=0)
        np.testing.assert_allclose(centres("line", name), expected, atol=1e-12)
    # As on a nearly full disk.
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4_000, limits[1]))
    try:
        with pytest.raises(OSError, match="File too large") as caught:
            mesh.write_gmsh(path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert caught.value.filename == str(path)


@pytest.mark.parametrize(
    ("breaks", "size", "message"),
    [
        (PLATE_BREAKS, 0.0, "mesh size must be a positive number of m, got 0.0"),
        ({"tail": 1.0, "head": 1.0 + 1e-12}, 0.2,
         "a segment needs breaks at two places at least, its ends"),
    ],
)  # fmt: skip
def test_bad_meshes_are_refused(breaks: dict[str, float], size: float, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        mesh_segment(BOX, breaks, size)


def test_meshing_keeps_signal_handlers() -> None:
    """Reference: the handlers before. gmsh starts PETSc, which resets SIGTERM, SIGPIPE."""

    def signals(name: str) -> int:
        status = Path("/proc/self/status").read_text(encoding="utf-8")
        return int(status.partition(f"\n{name}:")[2].split()[0], 16)

    terminate, pipe = (1 << (number - 1) for number in (signal.SIGTERM, signal.SIGPIPE))
    before = signal.signal(signal.SIGTERM, lambda *_: None)
    try:
        one, again = (mesh_segment(BOX, PLATE_BREAKS, 1.0) for _ in range(2))
        assert signals("SigCgt") & terminate
        assert signals("SigIgn") & pipe
    finally:
        signal.signal(signal.SIGTERM, before)
    np.testing.assert_array_equal(again.points, one.points)
    np.testing.assert_array_equal(again.triangles, one.triangles)


def _longest(mesh: SegmentMesh) -> Array:
    corners = mesh.points[mesh.triangles]
    return np.asarray(np.linalg.norm(np.roll(corners, 1, axis=1) - corners, axis=2).max(axis=1))


def test_graded_mesh_is_fine_in_zones_and_coarse_elsewhere() -> None:
    """Reference: analytic. Edges are within the limit of the nearest zone. At a distance of 1 m
    they are 0.05 m by nearly 0.2 m.
    """
    graded = made("box", "of contacts")[1]
    places = np.column_stack([graded.points[:, 0], np.abs(graded.points[:, 1:])])
    allowed = np.minimum(CORNER.edge_length(places), PAD.edge_length(places))
    sides = _longest(graded) / np.sqrt(2.0)
    assert (sides < 1.000001 * allowed[graded.triangles].min(axis=1)).all()
    x = graded.points[graded.triangles, 0].mean(axis=1)
    far = (x > 0.1) & (x < 0.9) & (np.abs(graded.points[graded.triangles, 1]).max(axis=1) < 0.15)
    assert _longest(graded)[far] == pytest.approx(np.hypot(0.2, 0.05), rel=0.05)
    uniform = mesh_segment(GRADED, GRADED_BREAKS, 0.015, closed=("middle",))
    assert len(graded.triangles) < 0.15 * len(uniform.triangles)


def test_refinement_zones_are_at_loads_supports_and_stiffeners(paper_boom: Boom) -> None:
    """Reference: by hand, with all parts. Four times the tolerance doubles the edge length."""
    outer, inner = paper_boom.segments
    b, h = 0.5 * outer.section.width, 0.5 * outer.section.height
    stiff = replace(outer, collars=(Collar((8.0, 8.5), 0.01),), diaphragms=(Diaphragm(5.0, 0.01),))
    boom = replace(paper_boom, segments=(stiff, inner))
    found = refinement_zones(boom, 0, 0.01, "near webs")
    assert [zone.low[0] for zone in found[:-2]] == [0.0, 2.0, 8.0, 8.5, 5.0]
    assert all(zone.low[1:] == (0.0, 0.0) and zone.high[1:] == (b, h) for zone in found[:-2])
    for zone, start in zip(found[-2:], (8.95, 9.9), strict=True):
        assert zone.low == pytest.approx((start, b, h))
        assert zone.high == pytest.approx((start + 0.1, b, h))
        assert zone.size == pytest.approx(0.02)
    loose = refinement_zones(boom, 0, 0.04, "near webs")
    assert [zone.size for zone in loose] == pytest.approx([2.0 * zone.size for zone in found])
    (joint,) = boom.joints
    padded = replace(boom, joints=(replace(joint, pad=Pad(0.1, 0.06)),))
    near = 0.5 * inner.section.width
    of_pads = refinement_zones(padded, 0, 0.01, "near webs")[-2:]
    for zone, start in zip(of_pads, (9.0, 9.9), strict=True):
        assert zone.low == pytest.approx((start, near - 0.06, h))
        assert zone.high == pytest.approx((start + 0.1, near, h))
