# SPDX-License-Identifier: LGPL-3.0-or-later
"""Meshes of segments: uniform, graded, of polygons."""

import re
import resource
import signal
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import meshio
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from geometry.arrays import Array, Indices
from geometry.boom import Boom, Collar, Diaphragm, PadSize
from geometry.contact_places import pads
from geometry.grading import graded_mesh
from geometry.mesh import (
    SegmentMesh,
    collar_breaks,
    diaphragm_breaks,
    mesh_segment,
)
from geometry.plating import add_thickness, plain_thickness
from geometry.refinement import RefinementZone, refinement_zones
from geometry.section import COMPONENT, BoxSection, Section
from tests.geometry.test_polygon import ALL, regular
from tests.shell_model.booms import box_segment

WALLS = ("bottom", "right", "top", "left")
BOX = BoxSection(height=0.4945, width=0.3027, flange=0.00664, web=0.00664)
BREAKS = {"tail": 0.0, "support-2": 2.0, "station-9": 9.0, "station-10": 10.0, "head": 10.0}


CLOSED = ("station-9", "head")


@pytest.fixture(scope="module")
def mesh() -> SegmentMesh:
    return mesh_segment(BOX, BREAKS, 0.2)


@pytest.fixture(scope="module")
def closed_mesh() -> SegmentMesh:
    """Return the mesh of BOX with a diaphragm at 9 m and an end plate at the head."""
    return mesh_segment(BOX, BREAKS, 0.1, closed=CLOSED)


def edge_counts(triangles: Indices) -> Counter[tuple[int, int]]:
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    return Counter(map(tuple, np.sort(sides, axis=1).tolist()))


def areas(mesh: SegmentMesh) -> Array:
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)


def line_length(mesh: SegmentMesh, edges: Indices) -> float:
    return float(np.linalg.norm(np.diff(mesh.points[edges], axis=1), axis=2).sum())


def test_tube_is_closed_between_its_ends(mesh: SegmentMesh) -> None:
    """Each edge has two triangles except at both end outlines; no node is unused."""
    open_edges = [edge for edge, count in edge_counts(mesh.triangles).items() if count != 2]
    assert all(edge_counts(mesh.triangles)[edge] == 1 for edge in open_edges)
    x = mesh.points[np.array(open_edges), 0]
    assert (x[:, 0] == x[:, 1]).all()
    assert set(np.unique(x)) == {0.0, 10.0}
    ends = [mesh.lines[f"{name}:{wall}"] for name in ("tail", "head") for wall in WALLS]
    assert set(open_edges) == {tuple(sorted(edge)) for end in ends for edge in end.tolist()}
    assert set(np.unique(mesh.triangles)) == set(range(len(mesh.points)))
    # A tube: V − E + F = 0.
    assert len(mesh.points) - len(edge_counts(mesh.triangles)) + len(mesh.triangles) == 0


def test_no_two_points_coincide(mesh: SegmentMesh) -> None:
    assert len(np.unique(np.round(mesh.points, 9), axis=0)) == len(mesh.points)


def test_area_is_the_perimeter_times_the_length(mesh: SegmentMesh) -> None:
    """Reference: analytic, the area of the whole mesh and of each wall."""
    assert areas(mesh).sum() == pytest.approx(2.0 * (0.4945 + 0.3027) * 10.0, rel=1e-12)
    for number, wall in enumerate(WALLS):
        side = BOX.width if wall in ("bottom", "top") else BOX.height
        assert areas(mesh)[mesh.walls == number].sum() == pytest.approx(10.0 * side, rel=1e-12)


def test_walls_lie_on_the_mid_lines(mesh: SegmentMesh) -> None:
    planes = {
        "bottom": (2, -0.5 * BOX.height),
        "right": (1, 0.5 * BOX.width),
        "top": (2, 0.5 * BOX.height),
        "left": (1, -0.5 * BOX.width),
    }
    for number, wall in enumerate(WALLS):
        axis, value = planes[wall]
        corners = mesh.points[mesh.triangles[mesh.walls == number]]
        assert np.abs(corners[..., axis] - value).max() < 1e-14


def test_diaphragm_fills_the_outline_and_shares_its_nodes(closed_mesh: SegmentMesh) -> None:
    """Reference: analytic, the area. Edges have three triangles, at an end two."""
    for number, x in enumerate((9.0, 10.0), start=len(WALLS)):
        plate = closed_mesh.walls == number
        assert areas(closed_mesh)[plate].sum() == pytest.approx(BOX.height * BOX.width, rel=1e-12)
        assert (closed_mesh.points[closed_mesh.triangles[plate], 0] == x).all()
    counts = edge_counts(closed_mesh.triangles)
    for name, meeting in (("station-9", 3), ("head", 2), ("support-2", 2), ("tail", 1)):
        edges = np.concatenate([closed_mesh.lines[f"{name}:{wall}"] for wall in WALLS])
        assert {counts[a, b] for a, b in np.sort(edges, axis=1).tolist()} == {meeting}
    assert sum(count == 3 for count in counts.values()) == 4 * round(0.3 / 0.1) + 4
    assert len(np.unique(np.round(closed_mesh.points, 9), axis=0)) == len(closed_mesh.points)
    np.testing.assert_array_equal(closed_mesh.on_walls, closed_mesh.walls < 4)


def test_a_diaphragm_leaves_the_walls_as_they_are(closed_mesh: SegmentMesh) -> None:
    """Reference: the mesh without it."""
    plain = mesh_segment(BOX, BREAKS, 0.1)
    walls = closed_mesh.triangles[closed_mesh.on_walls]
    np.testing.assert_array_equal(
        sorted_places(closed_mesh.points[walls].mean(axis=1)),
        sorted_places(plain.points[plain.triangles].mean(axis=1)),
    )


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


@pytest.mark.parametrize("kind", ["mesh", "closed_mesh", "graded"])
@pytest.mark.parametrize("axis", [1, 2], ids=["y", "z"])
def test_mesh_mirrors_itself(kind: str, axis: int, request: pytest.FixtureRequest) -> None:
    """The mirror image has the same triangles, diagonals included."""
    mesh: SegmentMesh = request.getfixturevalue(kind)
    places = {tuple(p): i for i, p in enumerate(np.round(mesh.points, 9) + 0.0)}
    mirrored = np.round(mesh.points, 9)
    mirrored[:, axis] *= -1.0
    image = np.array([places[tuple(p)] for p in mirrored + 0.0])
    triangles = {tuple(t) for t in np.sort(mesh.triangles, axis=1).tolist()}
    assert {tuple(t) for t in np.sort(image[mesh.triangles], axis=1).tolist()} == triangles


def test_mesh_of_a_box_on_its_side_lies_on_its_side(closed_mesh: SegmentMesh) -> None:
    """With y and z exchanged the points are the same, and so are the triangles."""
    mesh, lying = closed_mesh, mesh_segment(BOX.turned(), BREAKS, 0.1, closed=CLOSED)
    places = {tuple(p): i for i, p in enumerate(np.round(mesh.points, 9) + 0.0)}
    turned = np.round(lying.points[:, [0, 2, 1]], 9) + 0.0
    image = np.array([places[tuple(p)] for p in turned])
    triangles = {tuple(t) for t in np.sort(mesh.triangles, axis=1).tolist()}
    assert {tuple(t) for t in np.sort(image[lying.triangles], axis=1).tolist()} == triangles


def test_named_lines_go_once_around_the_section(mesh: SegmentMesh) -> None:
    assert set(mesh.lines) == {f"{name}:{wall}" for name in BREAKS for wall in WALLS}
    edges = edge_counts(mesh.triangles)
    for name, x in BREAKS.items():
        around: Counter[int] = Counter()
        for wall in WALLS:
            line = mesh.lines[f"{name}:{wall}"]
            side = BOX.width if wall in ("bottom", "top") else BOX.height
            assert line_length(mesh, line) == pytest.approx(side, rel=1e-12)
            assert np.abs(mesh.points[line, 0] - x).max() < 1e-12
            assert all(tuple(sorted(edge)) in edges for edge in line.tolist())
            around.update(line.ravel().tolist())
        assert set(around.values()) == {2}
    for wall in WALLS:
        np.testing.assert_array_equal(mesh.lines[f"head:{wall}"], mesh.lines[f"station-10:{wall}"])


@pytest.mark.slow
@settings(max_examples=25)
@given(
    spans=st.lists(st.floats(0.013, 3.7), min_size=1, max_size=4),
    start=st.floats(-5.0, 20.0),
    size=st.floats(0.11, 2.3),
    height=st.floats(0.1, 0.9),
    width=st.floats(0.1, 0.9),
)
def test_lines_lie_at_the_breaks_for_awkward_lengths(
    spans: list[float], start: float, size: float, height: float, width: float
) -> None:
    box = BoxSection(height, width, 0.006, 0.006)
    places = start + np.concatenate([[0.0], np.cumsum(spans)])
    breaks = {f"break-{k}": float(x) for k, x in enumerate(places)}
    mesh = mesh_segment(box, breaks, size)
    length = places[-1] - places[0]
    assert areas(mesh).sum() == pytest.approx(2.0 * (height + width) * length, rel=1e-11)
    for name, x in breaks.items():
        lines = [mesh.lines[f"{name}:{wall}"] for wall in WALLS]
        assert np.abs(mesh.points[np.concatenate(lines), 0] - x).max() < 1e-12
        assert sum(line_length(mesh, line) for line in lines) == pytest.approx(
            2.0 * (height + width), rel=1e-12
        )
    # No triangle reaches across a line, and the edges along x come as near to the size as
    # whole numbers allow.
    corners = mesh.points[mesh.triangles, 0]
    for a, b in pairwise(places):
        inside = (corners.min(axis=1) >= a - 1e-9) & (corners.max(axis=1) <= b + 1e-9)
        assert areas(mesh)[inside].sum() == pytest.approx(
            2.0 * (height + width) * (b - a), rel=1e-9
        )
        steps = len(np.unique(np.round(corners[inside], 9))) - 1
        assert steps == max(1, int((b - a) / size + 0.5))


def test_gmsh_file_names_every_wall_and_line(tmp_path: Path) -> None:
    """Reference: other code, meshio's reader of gmsh's own file."""
    breaks = {"tail": 0.0, "support-2": 2.0, "station-3": 3.0, "head": 3.5}
    mesh = mesh_segment(BOX, breaks, 0.25, closed=("station-3",))
    mesh.write_gmsh(tmp_path / "outer.msh")
    read = meshio.read(tmp_path / "outer.msh")
    plates = (*WALLS, "diaphragm-1")
    expected = {plate: 2 for plate in plates}
    expected |= {f"{name}:{wall}": 1 for name in breaks for wall in WALLS}
    assert {name: int(dim) for name, (_, dim) in read.field_data.items()} == expected
    for number, plate in enumerate(plates):
        corners = grouped(read, "triangle", plate)
        assert len(corners) == (mesh.walls == number).sum()
        np.testing.assert_allclose(
            sorted_places(corners.mean(axis=1)),
            sorted_places(mesh.points[mesh.triangles[mesh.walls == number]].mean(axis=1)),
            atol=1e-12,
        )
    for name, edges in mesh.lines.items():
        ends = grouped(read, "line", name)
        np.testing.assert_allclose(
            sorted_places(ends.mean(axis=1)),
            sorted_places(mesh.points[edges].mean(axis=1)),
            atol=1e-12,
        )


def test_coincident_lines_are_both_in_the_gmsh_file(tmp_path: Path) -> None:
    mesh = mesh_segment(BOX, {"tail": 0.0, "station": 1.0, "head": 1.0}, 0.5)
    mesh.write_gmsh(tmp_path / "m.msh")
    text = (tmp_path / "m.msh").read_text()
    for name in ("station", "head"):
        for wall in WALLS:
            assert f'"{name}:{wall}"' in text


@contextmanager
def files_of_at_most(size: int) -> Iterator[None]:
    """Limit files to ``size`` bytes, as on a nearly full disk."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


@pytest.mark.parametrize("room", [0, 4_000])
def test_a_full_disk_is_noticed(tmp_path: Path, room: int) -> None:
    mesh = mesh_segment(BOX, {"tail": 0.0, "head": 1.0}, 0.2)
    path = tmp_path / "m.msh"
    mesh.write_gmsh(path)
    assert path.stat().st_size > room
    with files_of_at_most(room), pytest.raises(OSError, match="File too large") as caught:
        mesh.write_gmsh(path)
    assert caught.value.filename == str(path)


def grouped(read: meshio.Mesh, kind: str, name: str) -> Array:
    """Return the corners (num_cells, nodes, 3) of the cells in a physical group."""
    tag = read.field_data[name][0]
    tags = read.cell_data_dict["gmsh:physical"][kind]
    return read.points[read.cells_dict[kind][tags == tag]]


def sorted_places(places: Array) -> Array:
    return places[np.lexsort(np.round(places, 9).T)]


def test_written_mesh_is_read_back(mesh: SegmentMesh, tmp_path: Path) -> None:
    """Reference: other code, meshio's reader."""
    mesh.write(tmp_path / "outer.vtu")
    read = meshio.read(tmp_path / "outer.vtu")
    np.testing.assert_allclose(read.points, mesh.points, atol=1e-15)
    np.testing.assert_array_equal(read.cells_dict["triangle"], mesh.triangles)
    np.testing.assert_array_equal(read.cell_data_dict["wall"]["triangle"], mesh.walls)


def test_the_same_call_gives_the_same_mesh(mesh: SegmentMesh) -> None:
    again = mesh_segment(BOX, BREAKS, 0.2)
    np.testing.assert_array_equal(again.points, mesh.points)
    np.testing.assert_array_equal(again.triangles, mesh.triangles)


@pytest.mark.parametrize("size", [0.0, -0.1, float("nan"), float("inf")])
def test_bad_mesh_sizes_are_refused(size: float) -> None:
    message = f"mesh size must be a positive number of m, got {size}"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        mesh_segment(BOX, BREAKS, size)


@pytest.mark.parametrize("breaks", [{}, {"tail": 1.0}, {"tail": 1.0, "head": 1.0 + 1e-12}])
def test_refuses_a_segment_without_length(breaks: dict[str, float]) -> None:
    message = "a segment needs breaks at two places at least, its ends"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        mesh_segment(BOX, breaks, 0.2)


def _signals(name: str) -> int:
    """Return a mask of this process's signals, from Linux."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    (line,) = (line for line in status.splitlines() if line.startswith(f"{name}:"))
    return int(line.split()[1], 16)


def test_meshing_keeps_signal_handlers() -> None:
    """Reference: the handlers before. gmsh starts PETSc, which resets SIGTERM, SIGPIPE."""
    terminate, pipe = (1 << (number - 1) for number in (signal.SIGTERM, signal.SIGPIPE))
    before = signal.signal(signal.SIGTERM, lambda *_: None)
    try:
        mesh_segment(BOX, BREAKS, 1.0)
        assert _signals("SigCgt") & terminate
        assert _signals("SigIgn") & pipe
    finally:
        signal.signal(signal.SIGTERM, before)


SECTIONS = ALL | {"regular": regular(6, 0.25, 0.006)}
PLATE_BREAKS = {"start": 0.0, "plate": 1.0, "end": 2.0}


def meshes(section: Section) -> list[SegmentMesh]:
    """Return a uniform mesh, and a mesh that is graded towards the diaphragm."""
    zone = RefinementZone((1.0, 0.0, -1.0), (1.0, 1.0, 1.0), 0.03, 0.5)
    return [
        mesh_segment(section, PLATE_BREAKS, 0.06, closed=("plate",)),
        graded_mesh(section, PLATE_BREAKS, 0.2, [zone], closed=("plate",)),
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
def test_polygon_meshes_are_symmetric(name: str) -> None:
    """Reference: symmetry of corners and triangles about each mirror plane of the section."""
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


GRADED = BoxSection(height=0.4, width=0.3, flange=0.006, web=0.005)
GRADED_BREAKS = {"start": 0.0, "middle": 2.0, "end": 5.0}
CORNER = RefinementZone((2.0, 0.15, 0.2), (2.1, 0.15, 0.2), 0.02, 0.5)
PAD = RefinementZone((4.9, 0.05, 0.2), (5.0, 0.11, 0.2), 0.015, 0.3)


@pytest.fixture(scope="module", name="graded")
def _mesh() -> SegmentMesh:
    return graded_mesh(GRADED, GRADED_BREAKS, 0.1, [CORNER, PAD], closed=("middle",))


def _longest(mesh: SegmentMesh) -> Array:
    corners = mesh.points[mesh.triangles]
    return np.asarray(np.linalg.norm(np.roll(corners, 1, axis=1) - corners, axis=2).max(axis=1))


def test_graded_mesh_is_conforming_and_complete(graded: SegmentMesh) -> None:
    """Reference: analytic. Edges have two triangles, one at the ends and three at the diaphragm.
    The areas of walls and diaphragm are exact.
    """
    edges = Counter(
        tuple(sorted((t[i], t[i - 1]))) for t in graded.triangles.tolist() for i in range(3)
    )
    at = {edge: graded.points[list(edge), 0] for edge in edges}
    for edge, count in edges.items():
        on_end = np.isin(at[edge], (0.0, 5.0)).all()
        around = np.isclose(np.abs(graded.points[list(edge), 1]), 0.15).all()
        around |= np.isclose(np.abs(graded.points[list(edge), 2]), 0.2).all()
        at_plate = (at[edge] == 2.0).all() and around
        assert count == (1 if on_end else 3 if at_plate else 2)
    found = areas(graded)
    assert found[graded.on_walls].sum() == pytest.approx(2.0 * 0.7 * 5.0, rel=1.0e-12)
    assert found[~graded.on_walls].sum() == pytest.approx(0.3 * 0.4, rel=1.0e-12)


def test_graded_mesh_is_fine_in_zones_and_coarse_elsewhere(graded: SegmentMesh) -> None:
    """Reference: analytic. Edges are within the limit of the nearest zone. At a distance of 1 m
    they are 0.05 m by nearly 0.2 m.
    """
    places = np.column_stack([graded.points[:, 0], np.abs(graded.points[:, 1:])])
    allowed = np.minimum(CORNER.edge_length(places), PAD.edge_length(places))
    sides = _longest(graded) / np.sqrt(2.0)
    assert (sides < 1.000001 * allowed[graded.triangles].min(axis=1)).all()
    x = graded.points[graded.triangles, 0].mean(axis=1)
    far = (x > 0.1) & (x < 0.9) & (np.abs(graded.points[graded.triangles, 1]).max(axis=1) < 0.15)
    assert _longest(graded)[far] == pytest.approx(np.hypot(0.2, 0.05), rel=0.05)
    uniform = mesh_segment(GRADED, GRADED_BREAKS, 0.015, closed=("middle",))
    assert len(graded.triangles) < 0.15 * len(uniform.triangles)


def test_lines_of_a_graded_mesh_are_complete(graded: SegmentMesh) -> None:
    edges = {tuple(sorted((t[i], t[i - 1]))) for t in graded.triangles.tolist() for i in range(3)}
    for name, x in GRADED_BREAKS.items():
        for wall in graded.plates:
            line = graded.lines[f"{name}:{wall}"]
            ends = graded.points[line]
            side = GRADED.width if wall in ("bottom", "top") else GRADED.height
            lengths = np.linalg.norm(ends[:, 0] - ends[:, 1], axis=1)
            assert lengths.sum() == pytest.approx(side, rel=1.0e-12)
            assert (ends[:, :, 0] == x).all()
            assert {tuple(sorted(edge)) for edge in line.tolist()} <= edges


def test_refinement_zones_are_at_loads_supports_and_stiffeners(paper_boom: Boom) -> None:
    """Reference: by hand, with all parts. Four times the tolerance doubles the edge length."""
    outer, inner = paper_boom.segments
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
