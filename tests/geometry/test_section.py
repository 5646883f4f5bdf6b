# SPDX-License-Identifier: LGPL-3.0-or-later
"""Boxes and polygons of plates, with sharp corners or bends: properties, plates, shear flow."""

import re
from collections.abc import Callable
from dataclasses import replace
from math import cos, hypot, inf, nan, pi, sin, sqrt, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from protractile.geometry.arrays import Array
from protractile.geometry.box import BoxSection, infer_inner_section, infer_outer_section
from protractile.geometry.polygon import PolygonSection, bent, closed_polygon
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import Direction, Section, SectionError
from protractile.geometry.taper import check_alike, interpolate_section
from protractile.geometry.walls import free_room, trapezoids
from studies.reference_models.statics import shear_centre

TRAPEZOID = PolygonSection(
    ((-0.1, -0.3), (0.1, -0.3), (0.2, 0.3), (-0.2, 0.3)), (0.010, 0.006, 0.008, 0.006)
)
HEXAGON = hexagon(0.50, 0.45, 0.25, top=0.006, bottom=0.008, web=0.005)
OCTAGON = octagon(0.50, 0.40, 0.10, top=0.006, bottom=0.006, web=0.005)
# The plates of a U, without the circle of its bends.
U = replace(u_section(0.50, 0.35, 0.15, 3, top=0.008, bottom=0.006, web=0.005), radii=())
ALL = {"trapezoid": TRAPEZOID, "hexagon": HEXAGON, "octagon": OCTAGON, "u": U}
# Outside 0.41 m wide, from -0.31 to 0.32 m; hole 0.39 m wide, from -0.29 to 0.28 m.
UNEQUAL = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01, bottom_flange=0.02)
ASKEW = BoxSection(0.4889, 0.3259, flange=0.010, web=0.0065, bottom_flange=0.005, left_web=0.004)
PROPERTIES = (
    "area", "second_moment_of_area", "lateral_second_moment_of_area", "torsion_constant"
)  # fmt: skip
WALL, RADIUS = 0.008, 0.025


def numbers(section: Section, *names: str) -> list[float]:
    return [getattr(section, name) for name in names]


def regular(sides: int, side: float, wall: float) -> PolygonSection:
    turns = 2.0 * np.pi * np.arange(sides) / sides
    radius = 0.5 * side / np.sin(np.pi / sides)
    places = radius * np.column_stack([np.cos(turns), np.sin(turns)])
    return PolygonSection(tuple((y, z) for y, z in places.tolist()), (wall,) * sides)


def offset_corners(section: Section, outwards: Array) -> Array:
    """Return where the plates meet (num_plates, 2) if each moves outwards by a distance in m."""
    tangents = np.array([plate.tangent for plate in section.plates])
    normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
    levels = (normals * [plate.start for plate in section.plates]).sum(axis=1) + outwards
    pairs = [[k - 1, k] for k in range(levels.size)]
    return np.array([np.linalg.solve(normals[pair], levels[pair]) for pair in pairs])


def moments(corners: Array) -> tuple[float, Array, Array]:
    """Return the area, ∫ r dA (2,) and ∫ r² dA (2,) of a polygon (Green 1828)."""
    after = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]
    squares = corners**2 + corners * after + after**2
    return 0.5 * cross.sum(), cross @ (corners + after) / 6.0, cross @ squares / 12.0


def test_a_box_of_unequal_flanges() -> None:
    """Reference: analytic, outer rectangle less inner one, with the parallel axis theorem."""
    parts = (0.41, -0.31, 0.32), (0.39, -0.29, 0.28)
    areas = [width * (top - bottom) for width, bottom, top in parts]
    middles = [0.5 * (bottom + top) for _, bottom, top in parts]
    area, z = areas[0] - areas[1], (areas[0] * middles[0] - areas[1] * middles[1])
    z /= area
    upright, hole = (
        w * (top - bottom) ** 3 / 12.0 + w * (top - bottom) * (0.5 * (top + bottom) - z) ** 2
        for w, bottom, top in parts
    )
    aside = (0.63 * 0.41**3 - 0.57 * 0.39**3) / 12.0
    # 4 (0.24 m²)² over 2 · 0.6/0.01 + 0.4/0.04 + 0.4/0.02 = 150
    assert numbers(
        UNEQUAL, *PROPERTIES, "polar_second_moment_of_area", "shear_area", "lateral_shear_area",
        "perimeter", "enclosed_area",
    ) == pytest.approx(
        [area, upright - hole, aside, 0.2304 / 150.0, upright - hole + aside, 0.012, 0.024, 2.0,
         0.24], rel=1e-12,
    )  # fmt: skip
    assert UNEQUAL.centroid == pytest.approx((0.0, z), rel=1e-12, abs=1e-15)
    top, bottom = UNEQUAL.face("z", 1), UNEQUAL.face("z", -1)
    found = top.outside, bottom.outside, top.inside, bottom.inside
    assert found == pytest.approx((0.32 - z, -0.31 - z, 0.28 - z, -0.29 - z), rel=1e-12)
    assert free_room(UNEQUAL, BoxSection(0.53, 0.30, 0.02, 0.02))[0] == pytest.approx(0.02)
    plain = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01)
    assert BoxSection(0.60, 0.40, 0.04, 0.01, bottom_flange=0.04, left_web=0.01) == plain
    assert (str(plain), str(UNEQUAL)) == ("600 x 400 x 40 / 10", "600 x 400 x 40 / 20 / 10 / 10")
    walls = trapezoids(plain.plates)
    for corners, y, up in ((walls[:, 0], 0.205, 0.32), (walls[:, 3], 0.195, 0.28)):
        expected = np.array([(-y, -up), (y, -up), (y, up), (-y, up)])
        assert corners == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("ratio", "outer_mm", "inner_mm"),
    [
        (494.5 / 302.7, (494.5, 302.7, 6.64), (469.0, 251.2, 4.87)),
        (472.3 / 409.5, (472.3, 409.5, 6.01), (447.8, 339.1, 4.46)),
    ],
)
def test_boxes_of_the_paper(
    ratio: float, outer_mm: tuple[float, ...], inner_mm: tuple[float, ...]
) -> None:
    """Reference: other code, to its four digits. 2Δ is exact to round-off."""
    areas, second_moments = (83.16 / 7850.0, 55.07 / 7850.0), (3.7986e-4, 2.1829e-4)
    outer = infer_outer_section(areas[0], second_moments[0], ratio)
    inner = infer_inner_section(areas[1], second_moments[1], outer, 7.0e-3)
    for box, printed in ((outer, outer_mm), (inner, inner_mm)):
        assert (1e3 * box.height, 1e3 * box.width) == pytest.approx(printed[:2], abs=0.1)
        assert 1e3 * box.flange == pytest.approx(printed[2], abs=0.006)
        assert box.web == box.flange
    assert free_room(outer, inner)[0] == pytest.approx(14.0e-3, rel=1e-12, abs=0.0)


@settings(max_examples=20)
@given(
    st.floats(0.05, 2.0), st.floats(0.3, 3.0), st.floats(0.003, 0.15), st.floats(0.002, 0.03),
    st.floats(1e-5, 0.03), st.floats(0.002, 0.05),
)  # fmt: skip
def test_boxes_are_found_again(
    height: float, ratio: float, wall: float, clearance: float, side_room: float, around: float
) -> None:
    """Reference: analytic. The A, J and ratio of a box, or the box around it, give the same box."""
    wall *= min(height, height / ratio)
    box = BoxSection(height, height / ratio, wall, wall)
    room = height + wall + 2.0 * clearance + around, box.width + wall + side_room + around
    given_numbers = box.area, box.second_moment_of_area
    for found in (
        infer_outer_section(*given_numbers, ratio),
        infer_inner_section(*given_numbers, BoxSection(*room, around, around), clearance),
    ):
        assert found.web == found.flange == pytest.approx(wall, rel=1e-7)
        assert (found.height, found.width) == pytest.approx((height, box.width), rel=1e-7)


@pytest.mark.parametrize("section", [*ALL.values(), ASKEW], ids=[*ALL, "box of four walls"])
@pytest.mark.parametrize("direction", ["z", "y"])
def test_carriers_hold_a_force_through_the_axis(section: Section, direction: Direction) -> None:
    """Reference: analytic. Of rigid motions, the forces do work on the translation alone."""
    found = section.shear_plates(direction)
    forces = sum(force * section.plates[n].tangent for n, force in found)
    assert forces == pytest.approx([1.0, 0.0] if direction == "y" else [0.0, 1.0], abs=1e-12)
    turning = sum(
        force * np.linalg.det([section.plates[n].midpoint, section.plates[n].tangent])
        for n, force in found
    )
    assert turning == pytest.approx(0.0, abs=1e-15)


def _by_small_steps(section: Section, direction: Direction) -> tuple[float, float]:
    """Return the shear area in m² and the lever arm in m by sums over 20 000 pieces of mid-line."""
    count = 20_000 // len(section.plates)
    parts = (np.arange(count) + 0.5) / count
    places = np.concatenate(
        [np.outer(1 - parts, p.start) + np.outer(parts, p.end) for p in section.plates]
    )
    thickness = np.repeat([plate.thickness for plate in section.plates], count)
    length = np.repeat([plate.length / count for plate in section.plates], count)
    tangents = np.repeat([plate.tangent for plate in section.plates], count, axis=0)
    area = thickness * length
    centre = area @ places / area.sum()
    coordinate = (places - centre)[:, 0 if direction == "y" else 1]
    statical = np.cumsum(area * coordinate) - 0.5 * area * coordinate
    flow = -statical / (area @ coordinate**2)
    flow -= (flow @ (length / thickness)) / (length / thickness).sum()
    arms = places[:, 0] * tangents[:, 1] - places[:, 1] * tangents[:, 0]
    return 1.0 / (flow**2 @ (length / thickness)), arms @ (flow * length)


@pytest.mark.parametrize("section", ALL.values(), ids=ALL)
def test_shear_areas_and_centre_against_small_steps(section: PolygonSection) -> None:
    """Reference: other code, sums over 20 000 pieces."""
    found = {d: _by_small_steps(section, d) for d in ("z", "y")}
    assert section.shear_area == pytest.approx(found["z"][0], rel=1e-6)
    assert section.lateral_shear_area == pytest.approx(found["y"][0], rel=1e-6)
    centre = found["z"][1], -found["y"][1]
    assert shear_centre(section.plates) == pytest.approx(centre, abs=1e-7)


def test_a_rectangle_has_the_numbers_of_a_box() -> None:
    """Reference: other code, the formulas of the box, for any origin of the corners."""
    corners = ((0.5, -0.3), (0.9, -0.3), (0.9, 0.3), (0.5, 0.3))
    polygon = PolygonSection(corners, (0.02, 0.01, 0.04, 0.012))
    box = BoxSection(0.6, 0.4, 0.04, 0.01, bottom_flange=0.02, left_web=0.012)
    names = *PROPERTIES, "polar_second_moment_of_area", "enclosed_area", "perimeter"
    assert numbers(polygon, *names) == pytest.approx(numbers(box, *names), rel=1e-12)
    assert polygon.centroid == pytest.approx((box.centroid[0] + 0.7, box.centroid[1]), abs=1e-15)
    assert polygon.mirrors == box.mirrors
    for mine, its in zip(polygon.plates, box.plates, strict=True):
        assert (mine.name, mine.thickness) == (its.name, its.thickness)
        assert mine.start == pytest.approx(its.start, abs=1e-15)
    for face, one in zip(polygon.faces, box.faces, strict=True):
        assert face[:3] == one[:3]
        assert face[3:] == pytest.approx(one[3:], abs=1e-15)
    assert str(closed_polygon(polygon.corners, polygon.thicknesses)) == str(box)


def test_many_plates_are_a_tube() -> None:
    """Reference: analytic, a thin tube: J = π r³ t, torsion 2 π r³ t, shear area π r t, to 1e-4."""
    radius, wall = 0.2, 1.0e-4
    tube = regular(240, 2.0 * radius * np.sin(np.pi / 240), wall)
    expected = pi * radius * wall * np.array([radius**2, 2.0 * radius**2, 1.0])
    found = numbers(tube, "second_moment_of_area", "torsion_constant", "shear_area")
    assert found == pytest.approx(expected.tolist(), rel=5e-4)


@pytest.mark.parametrize("name", ["trapezoid", "hexagon", "u"])
def test_properties_are_those_of_the_outline_less_the_hole(name: str) -> None:
    """Reference: analytic, moments of the polygons of the walls' outer and inner surfaces."""
    section = ALL[name]
    half = 0.5 * np.array([plate.thickness for plate in section.plates])
    outer, hole = (moments(offset_corners(section, side * half)) for side in (1.0, -1.0))
    assert section.area == pytest.approx(outer[0] - hole[0], rel=1e-12)
    assert outer[1] - hole[1] == pytest.approx(0.0, abs=1e-15)
    found = numbers(section, "lateral_second_moment_of_area", "second_moment_of_area")
    assert found == pytest.approx((outer[2] - hole[2]).tolist(), rel=1e-12)


@pytest.mark.parametrize("section", [*ALL.values(), UNEQUAL], ids=str)
def test_on_its_side_and_wherever_its_corners_begin(section: Section) -> None:
    """Reference: analytic, y and z exchanged; other first corners and origins change nothing."""
    side = section.turned()
    names = "shear_area", "area", "torsion_constant", "polar_second_moment_of_area"
    others = "lateral_shear_area", *names[1:]
    assert numbers(side, *names, *PROPERTIES[1:3]) == pytest.approx(
        numbers(section, *others, *PROPERTIES[2:0:-1]), rel=1e-14
    )
    assert {*side.mirrors} == {{"y": "z", "z": "y"}[axis] for axis in section.mirrors}
    assert side.centroid == pytest.approx(section.centroid[::-1], rel=1e-12, abs=1e-15)
    assert side.turned() == section
    if isinstance(section, BoxSection):
        return
    corners = tuple((y + 0.3, z - 0.2) for y, z in (*section.corners[2:], *section.corners[:2]))
    shifted = PolygonSection(corners, (*section.thicknesses[2:], *section.thicknesses[:2]))
    walls = *shifted.thicknesses[-2::-1], shifted.thicknesses[-1]
    for same in (shifted, PolygonSection(corners[::-1], walls)):
        assert same.mirrors == section.mirrors
        for mine, its in zip(same.plates, section.plates, strict=True):
            assert (mine.name, mine.thickness) == (its.name, its.thickness)
            assert (*mine.start, *mine.end) == pytest.approx((*its.start, *its.end), abs=1e-15)


def test_plates_faces_mirrors_and_sizes() -> None:
    """Reference: analytic, known shapes. The facets of the U are tangent to circles."""
    assert [plate.name for plate in HEXAGON.plates] == [
        "bottom", "right-1", "right-2", "top", "left-2", "left-1",
    ]  # fmt: skip
    faces = {name: [face[1:3] for face in section.faces] for name, section in ALL.items()}
    assert faces["hexagon"] == faces["trapezoid"] == [("z", -1), ("z", 1)]
    assert faces["octagon"] == faces["u"] == [("z", -1), ("y", 1), ("z", 1), ("y", -1)]
    assert [HEXAGON.face("z", side).width for side in (1, -1)] == pytest.approx([0.25, 0.25])
    assert OCTAGON.face("z", 1).width == pytest.approx(0.20, rel=1e-12)
    mirrors = [section.mirrors for section in ALL.values()]
    assert mirrors == [("y",), ("y",), ("y", "z"), ("y",)]
    for section in ALL.values():
        places = {plate.start for plate in section.plates}
        assert places == {(-y, z) for y, z in places}
    assert PolygonSection(TRAPEZOID.corners, (0.010, 0.006, 0.008, 0.007)).mirrors == ()
    sizes = [(section.size("z"), section.size("y")) for section in (HEXAGON, OCTAGON, U)]
    assert np.array(sizes) == pytest.approx(np.array([(0.5, 0.45), (0.5, 0.40), (0.5, 0.35)]))
    middle = np.array([0.5 * 0.35 - 0.15, U.reach("z")[0] + 0.15])
    touching = [plate.distance(middle[None])[0] for plate in U.plates[:5]]
    assert touching == pytest.approx([0.15] * 5, rel=1e-9)


@pytest.mark.parametrize("facets", [1, 5])
def test_a_u_has_the_circle_of_its_bends(facets: int) -> None:
    """Reference: analytic, half a ring below three sides of a rectangle, for any facets."""
    radius, web, half = 0.15, 0.35, 0.5 * WALL
    section = u_section(radius + web, 2.0 * radius, radius, facets, WALL, WALL, WALL)
    # Width, height and sign of the outer and the inner rectangle, from the centre of the ring up.
    parts = [(2.0 * (radius + side * half), web + side * half, side) for side in (1.0, -1.0)]
    ring, own = pi * radius * WALL, 0.5 * pi * radius * WALL * (radius**2 + half**2)
    area = ring + sum(sign * width * height for width, height, sign in parts)
    first = -2.0 * WALL * (radius**2 + WALL**2 / 12.0)
    first += sum(sign * width * height**2 / 2.0 for width, height, sign in parts)
    second = own + sum(sign * width * height**3 / 3.0 for width, height, sign in parts)
    lateral = own + sum(sign * height * width**3 / 12.0 for width, height, sign in parts)
    torsion = 4.0 * (0.5 * pi * radius**2 + 2.0 * radius * web) ** 2 * WALL
    torsion /= (pi + 2.0) * radius + 2.0 * web
    assert numbers(section, *PROPERTIES) == pytest.approx(
        [area, second - first**2 / area, lateral, torsion], rel=1e-12
    )
    centre = 0.5 * (web - radius)
    assert section.centroid[1] == pytest.approx(first / area - centre, rel=1e-12)


def outline(sharp: Section, count: int, outwards: float) -> Array:
    """Return corners of the mid-line with arcs of ``count`` chords, moved outwards."""
    corners = []
    for before, after in zip(sharp.plates[-1:] + sharp.plates[:-1], sharp.plates, strict=True):
        first = np.arctan2(-before.tangent[0], before.tangent[1])
        turn = np.arccos(before.tangent @ after.tangent)
        centre = np.array(after.start) + RADIUS * (after.tangent - before.tangent) / sin(turn)
        angles = first + turn * np.arange(count + 1) / count
        arc = np.column_stack([np.cos(angles), np.sin(angles)])
        corners.append(centre + (RADIUS + outwards) * arc)
    return np.concatenate(corners)


@pytest.mark.parametrize(
    "sharp",
    [
        BoxSection(0.40, 0.30, WALL, WALL),
        hexagon(0.5, 0.42, 0.26, WALL, WALL, WALL),
        closed_polygon(((-0.1, -0.2), (0.12, -0.2), (0.2, 0.25), (-0.15, 0.2)), (WALL,) * 4),
    ],
    ids=["box", "hexagon", "quadrangle"],
)
def test_bends_are_the_limit_of_many_chords(sharp: Section) -> None:
    """Reference: other code, polygons of the outer and the inner outline (Green), extrapolated."""

    def by_chords(count: int) -> Array:
        outer, middle, inner = (outline(sharp, count, side * WALL) for side in (0.5, 0.0, -0.5))
        around = np.linalg.norm(np.roll(middle, -1, axis=0) - middle, axis=1).sum()
        area, first, second = (
            one - other for one, other in zip(moments(outer), moments(inner), strict=True)
        )
        lateral, upright = second - first**2 / area
        torsion = 4.0 * moments(middle)[0] ** 2 * WALL / around
        return np.array([area, upright, lateral, torsion])

    coarse, fine = by_chords(200), by_chords(400)
    found = numbers(bent(sharp, RADIUS), *PROPERTIES)
    assert found == pytest.approx(list(fine + (fine - coarse) / 3.0), rel=1e-9)


def test_bends_of_some_corners() -> None:
    """Reference: analytic. Bends at the top of a U leave its circle: two quarter rings instead of
    four ends of plates. Of a hexagon of different plates only the folds at mid-height are bent.
    """
    sharp = u_section(0.632, 0.462, 0.146, 3, WALL, WALL, WALL)
    section = bent(sharp, RADIUS)
    assert section.area == pytest.approx(sharp.area - (4.0 - pi) * RADIUS * WALL, rel=1e-12)
    welded = bent(hexagon(0.5, 0.42, 0.26, 0.006, 0.008, 0.005), RADIUS)
    assert sorted(welded.radii) == [0.0, 0.0, 0.0, 0.0, RADIUS, RADIUS]
    half = 0.5 * pi - np.arctan2(0.25, 0.08)
    saved = 4.0 * RADIUS * 0.005 * (tan(half) - half)
    assert welded.area == pytest.approx(replace(welded, radii=()).area - saved, rel=1e-12)
    assert welded.mirrors == ("y",)


def test_widths_for_buckling() -> None:
    """Reference: by hand, the midpoints of the arcs projected on the plates."""
    sharp = hexagon(0.5, 0.42, 0.26, WALL, WALL, WALL)
    for plate, width in zip(sharp.plates, bent(sharp, RADIUS).buckling_widths, strict=True):
        turns = [np.arctan2(0.25, 0.08), pi - 2.0 * np.arctan2(0.25, 0.08)]
        ends = turns[:1] * 2 if plate.name in ("bottom", "top") else turns
        cut = sum(RADIUS * (1.0 / cos(t / 2.0) - 1.0) * sin(t / 2.0) for t in ends)
        assert width == pytest.approx(plate.length - cut, rel=1e-12)
    assert sharp.buckling_widths == tuple(plate.length for plate in sharp.plates)


def test_outer_sizes_give_the_section_of_its_mid_lines() -> None:
    """Reference: analytic, each wall half a thickness further in; bends become smaller."""
    box = BoxSection(0.408, 0.306, 0.010, 0.006, bottom_flange=0.006).within_outline()
    assert (box.height, box.width) == pytest.approx((0.400, 0.300), rel=1e-15)
    thick = 0.01, 0.006, 0.008, 0.006
    # The inclined side moves by half its thickness along its normal.
    slope = 0.1 / 0.6
    shift = 0.003 * hypot(1.0, slope)
    low, high = -0.3 + 0.005, 0.3 - 0.004
    a, b = 0.15 + slope * 0.005 - shift, 0.25 - slope * 0.004 - shift
    cut = 0.1 + WALL * (0.5 * sqrt(2.0) - 1.0)
    rounded = bent(octagon(0.5, 0.4, 0.1, WALL, WALL, WALL), RADIUS).within_outline()
    for drawn, middle in (
        (closed_polygon(((-0.15, -0.3), (0.15, -0.3), (0.25, 0.3), (-0.25, 0.3)),
                        thick).within_outline(),
         closed_polygon(((-a, low), (a, low), (b, high), (-b, high)), thick)),
        (u_section(0.5, 0.4, 0.15, 3, 0.006, 0.006, 0.006).within_outline(),
         u_section(0.494, 0.394, 0.147, 3, 0.006, 0.006, 0.006)),
        (rounded, bent(octagon(0.492, 0.392, cut, *(WALL,) * 3), RADIUS - 0.5 * WALL)),
    ):  # fmt: skip
        assert numbers(drawn, *PROPERTIES) == pytest.approx(numbers(middle, *PROPERTIES), rel=1e-12)
    assert bent(BoxSection(0.3, 0.2, WALL, WALL), RADIUS).turned().size("y") == pytest.approx(0.3)
    head = bent(octagon(0.3, 0.3, 0.1, WALL, WALL, WALL), 0.5 * RADIUS)
    check_alike(rounded, head)
    assert interpolate_section(rounded, head, 1.0).area == head.area


SQUARE = {"height": 0.6, "width": 0.4, "flange": 0.04, "web": 0.01}
STAR = tuple((np.cos(0.8 * np.pi * k), np.sin(0.8 * np.pi * k)) for k in range(5))
REFUSED: dict[str, Callable[[], object]] = {
    "no uniform-wall box has A = 0.01 m², J = 1e-06 m⁴ and height/width = 1.5; give the section "
    "explicitly": lambda: infer_outer_section(0.01, 1.0e-6, 1.5),
    "a box is inferred within a box alone, and the section around it has inclined plates; give the "
    "section explicitly": lambda: infer_inner_section(0.007, 2.2e-4, HEXAGON, 0.007),
    "width must be a positive number of m, got -0.4":
        lambda: BoxSection(**SQUARE | {"width": -0.4}),
    "walls of 0.04 m and 1.3 m (flange) and 0.01 m (web) leave no room in a box of 0.6 m x 0.4 m; "
    "the walls must be thinner": lambda: BoxSection(**SQUARE, bottom_flange=1.3),
    "walls of 0.04 m (flange) and 0.4 m (web) leave no room in a box of 0.6 m x 0.4 m; the walls "
    "must be thinner": lambda: BoxSection(**SQUARE | {"web": 0.4}),
    "a closed polygon has three corners at least, got 2":
        lambda: closed_polygon(((0, 0), (1, 0)), (0.1, 0.1)),
    "3 corners have as many plates between them, got 2 thicknesses; give one for each plate, the "
    "last one from the last corner to the first":
        lambda: closed_polygon(((0, 0), (1, 0), (0, 1)), (0.01, 0.01)),
    "corners must be numbers of m below 1e+06, got inf":
        lambda: closed_polygon(((0, 0), (1, inf), (0, 1)), (0.01,) * 3),
    "thicknesses must be numbers of m above 0 and below 1e+06, got nan":
        lambda: closed_polygon(((0, 0), (1, 0), (0, 1)), (0.01, nan, 0.01)),
    "corners 4 and 1 are one; give each once":
        lambda: closed_polygon(((0, 0), (1, 0), (0, 1), (0, 0)), (0.01,) * 4),
    "corner 3 turns inwards; plates go once around, every corner outwards":
        lambda: closed_polygon(((0, 0), (1, 0), (0.4, 0.4), (0, 1)), (0.01,) * 4),
    "corner 1 turns back; plates go once around, every corner outwards":
        lambda: closed_polygon(((0, 0), (1, 0), (2, 0)), (0.01,) * 3),
    "the plates go around more than once": lambda: closed_polygon(STAR, (0.01,) * 5),
    "plate 2 of 0.01 m and its neighbours leave no room in the polygon; they must be thinner":
        lambda: closed_polygon(((0, 0), (1, 0), (1, 0.1), (0, 0.1)), (0.12, 0.01, 0.12, 0.01)),
    "flat must be below the width of 0.4 m, got 0.4": lambda: hexagon(0.5, 0.4, 0.4, *(0.01,) * 3),
    "chamfer must be below half the height and half the width, 0.2 m, got 0.2":
        lambda: octagon(0.5, 0.4, 0.2, 0.01, 0.01, 0.01),
    "radius must be above 0 and not above half the width and the height, 0.2 m, got 0.3":
        lambda: u_section(0.5, 0.4, 0.3, 2, 0.01, 0.01, 0.01),
    "a bend has one facet at least, got 0": lambda: u_section(0.5, 0.4, 0.1, 0, 0.01, 0.01, 0.01),
    "the mid-line of a bend must have a radius of at least 0.004 m, half of the thickness on both "
    "of its sides, got 0.003 m": lambda: bent(BoxSection(0.3, 0.2, WALL, WALL), 0.003),
    "bends take 0.24 m of a plate of 0.2 m; their radius must be smaller":
        lambda: bent(BoxSection(0.3, 0.2, WALL, WALL), 0.12),
    "no sharp corner has plates of one thickness; leave bend_radius out":
        lambda: bent(BoxSection(0.3, 0.2, 0.006, WALL), RADIUS),
    "3 corners have as many radii, got 1":
        lambda: PolygonSection(((0.0, 0.0), (0.2, 0.0), (0.0, 0.2)), (WALL,) * 3, (0.01,)),
}  # fmt: skip


@pytest.mark.parametrize("message", REFUSED)
def test_an_impossible_section_is_refused(message: str) -> None:
    with pytest.raises(SectionError, match=f"^{re.escape(message)}$"):
        REFUSED[message]()
