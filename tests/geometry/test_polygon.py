# SPDX-License-Identifier: LGPL-3.0-or-later
"""Polygons of plates: properties, plates, faces, mirrors, and invalid polygons."""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from protractile.geometry.arrays import Array
from protractile.geometry.box import BoxSection
from protractile.geometry.polygon import PolygonSection, closed_polygon
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import Section
from protractile.geometry.taper import check_alike, interpolate_section

TRAPEZOID = PolygonSection(
    ((-0.1, -0.3), (0.1, -0.3), (0.2, 0.3), (-0.2, 0.3)), (0.010, 0.006, 0.008, 0.006)
)
HEXAGON = hexagon(0.50, 0.45, 0.25, top=0.006, bottom=0.008, web=0.005)
OCTAGON = octagon(0.50, 0.40, 0.10, top=0.006, bottom=0.006, web=0.005)
# The plates of a U, without the circle of its bends.
U = replace(u_section(0.50, 0.35, 0.15, 3, top=0.008, bottom=0.006, web=0.005), radii=())
ALL = {"trapezoid": TRAPEZOID, "hexagon": HEXAGON, "octagon": OCTAGON, "u": U}


def rectangle(
    top: float, bottom: float, right: float, left: float, at: float = 0.0
) -> PolygonSection:
    """Return a rectangle 0.6 m high and 0.4 m wide with given thicknesses."""
    corners = ((at - 0.2, -0.3), (at + 0.2, -0.3), (at + 0.2, 0.3), (at - 0.2, 0.3))
    return PolygonSection(corners, (bottom, right, top, left))


def regular(sides: int, side: float, wall: float) -> PolygonSection:
    turns = 2.0 * np.pi * np.arange(sides) / sides
    radius = 0.5 * side / np.sin(np.pi / sides)
    places = radius * np.column_stack([np.cos(turns), np.sin(turns)])
    return PolygonSection(tuple((y, z) for y, z in places.tolist()), (wall,) * sides)


@pytest.mark.parametrize("walls", [(0.04, 0.02, 0.01, 0.01), (0.02, 0.02, 0.01, 0.012)])
def test_a_rectangle_has_the_numbers_of_a_box(walls: tuple[float, float, float, float]) -> None:
    """Reference: other code, the formulas of the box, for any origin of the corners."""
    polygon, box = (
        rectangle(*walls, at=0.7),
        BoxSection(0.6, 0.4, *(walls[i] for i in (0, 2, 1, 3))),
    )
    for name in (
        "area", "second_moment_of_area", "lateral_second_moment_of_area", "torsion_constant",
        "polar_second_moment_of_area", "enclosed_area", "perimeter",
    ):  # fmt: skip
        assert getattr(polygon, name) == pytest.approx(getattr(box, name), rel=1e-12), name
    assert polygon.centroid == pytest.approx((box.centroid[0] + 0.7, box.centroid[1]), abs=1e-15)
    assert polygon.mirrors == box.mirrors
    for mine, its in zip(polygon.plates, box.plates, strict=True):
        assert (mine.name, mine.thickness) == (its.name, its.thickness)
        assert mine.start == pytest.approx(its.start, abs=1e-15)
    for face, one in zip(polygon.faces, box.faces, strict=True):
        assert face[:3] == one[:3]
        assert face[3:] == pytest.approx(one[3:], abs=1e-15)
    assert str(closed_polygon(polygon.corners, polygon.thicknesses)) == str(box)


def test_taper_does_not_depend_on_the_first_corner() -> None:
    """Reference: by hand. A taper between equal sections is constant for any corner order."""
    corners = ((-0.1, -0.25), (0.1, -0.25), (0.2, 0.0), (0.1, 0.25), (-0.1, 0.25), (-0.2, 0.0))
    thick = (0.008, 0.006, 0.006, 0.009, 0.006, 0.006)
    tail = closed_polygon(corners, thick)
    for head in (
        closed_polygon(corners[1:] + corners[:1], thick[1:] + thick[:1]),
        closed_polygon(corners[::-1], (*thick[-2::-1], thick[-1])),
    ):
        check_alike(tail, head)
        for part in (0.0, 0.3, 1.0):
            assert interpolate_section(tail, head, part).plates == tail.plates


def test_a_regular_hexagon() -> None:
    """Reference: analytic, (3√3/2) a² and J = (5√3/16) a⁴ of hexagons of sides a ± t/√3."""
    side, wall = 0.2, 0.02
    section = regular(6, side, wall)
    outer, inner = side + wall / np.sqrt(3.0), side - wall / np.sqrt(3.0)
    area = 1.5 * np.sqrt(3.0) * (outer**2 - inner**2)
    bending = 5.0 * np.sqrt(3.0) / 16.0 * (outer**4 - inner**4)
    assert section.area == pytest.approx(area, rel=1e-12)
    assert section.second_moment_of_area == pytest.approx(bending, rel=1e-12)
    assert section.lateral_second_moment_of_area == pytest.approx(bending, rel=1e-12)
    enclosed = 1.5 * np.sqrt(3.0) * side**2
    assert section.torsion_constant == pytest.approx(
        4.0 * enclosed**2 * wall / (6.0 * side), rel=1e-12
    )
    assert section.shear_area == pytest.approx(section.lateral_shear_area, rel=1e-12)


def test_many_plates_are_a_tube() -> None:
    """Reference: analytic, a thin tube: J = π r³ t, torsion 2 π r³ t, shear area π r t, to 1e-4."""
    radius, wall = 0.2, 1.0e-4
    tube = regular(240, 2.0 * radius * np.sin(np.pi / 240), wall)
    assert tube.second_moment_of_area == pytest.approx(np.pi * radius**3 * wall, rel=5e-4)
    assert tube.torsion_constant == pytest.approx(2.0 * np.pi * radius**3 * wall, rel=5e-4)
    assert tube.shear_area == pytest.approx(np.pi * radius * wall, rel=5e-4)


def offset_corners(section: Section, outwards: Array) -> Array:
    """Return where the plates meet (num_plates, 2) if each moves outwards by a distance in m."""
    tangents = np.array([plate.tangent for plate in section.plates])
    normals = np.column_stack([tangents[:, 1], -tangents[:, 0]])
    levels = (normals * [plate.start for plate in section.plates]).sum(axis=1) + outwards
    pairs = [[k - 1, k] for k in range(levels.size)]
    return np.array([np.linalg.solve(normals[pair], levels[pair]) for pair in pairs])


def _moments(corners: Array) -> Array:
    """Return the area, and its first and second moment about y, of a polygon (Green 1828)."""
    (y, z), (y_next, z_next) = corners.T, np.roll(corners, -1, axis=0).T
    twice = y * z_next - y_next * z
    squares = z**2 + z * z_next + z_next**2
    return np.array([twice.sum() / 2.0, twice @ (z + z_next) / 6.0, twice @ squares / 12.0])


@pytest.mark.parametrize("name", ["trapezoid", "hexagon", "u"])
def test_properties_are_those_of_the_outline_less_the_hole(name: str) -> None:
    """Reference: analytic, moments of the polygons of the walls' outer and inner surfaces."""
    section = ALL[name]
    half = 0.5 * np.array([plate.thickness for plate in section.plates])
    outer, hole = (_moments(offset_corners(section, side * half)) for side in (1.0, -1.0))
    area, first, second = outer - hole
    assert section.area == pytest.approx(area, rel=1e-12)
    assert first == pytest.approx(0.0, abs=1e-15)
    assert section.second_moment_of_area == pytest.approx(second, rel=1e-12)


BOXES = BoxSection(0.60, 0.40, 0.04, 0.01), BoxSection(0.60, 0.40, 0.04, 0.01, 0.02)


@pytest.mark.parametrize("section", [*ALL.values(), *BOXES], ids=str)
def test_on_its_side(section: Section) -> None:
    """Reference: analytic, y and z exchanged."""
    side = section.turned()
    for one, other in (
        ("second_moment_of_area", "lateral_second_moment_of_area"),
        ("shear_area", "lateral_shear_area"),
        ("area", "area"),
        ("torsion_constant", "torsion_constant"),
        ("polar_second_moment_of_area", "polar_second_moment_of_area"),
    ):
        assert getattr(side, one) == pytest.approx(getattr(section, other), rel=1e-14), one
    assert {axis for axis in "yz" if axis not in side.mirrors} == {
        {"y": "z", "z": "y"}[axis] for axis in "yz" if axis not in section.mirrors
    }
    assert side.centroid == pytest.approx(section.centroid[::-1], rel=1e-12, abs=1e-15)
    assert side.turned() == section


@pytest.mark.parametrize("name", ALL)
def test_wherever_its_corners_begin(name: str) -> None:
    """Reference: analytic. Another first corner or order of corners gives the same plates."""
    section = ALL[name]
    corners = (*section.corners[2:], *section.corners[:2])
    shifted = PolygonSection(corners, (*section.thicknesses[2:], *section.thicknesses[:2]))
    backwards = PolygonSection(
        corners[::-1], (*shifted.thicknesses[-2::-1], shifted.thicknesses[-1])
    )
    for same in (shifted, backwards):
        for mine, its in zip(same.plates, section.plates, strict=True):
            assert (mine.name, mine.thickness) == (its.name, its.thickness)
            assert (*mine.start, *mine.end) == pytest.approx((*its.start, *its.end), abs=1e-15)


def test_plates_faces_and_mirrors() -> None:
    """Reference: analytic, known shapes. Mirror images are exact to the last bit."""
    assert [plate.name for plate in HEXAGON.plates] == [
        "bottom", "right-1", "right-2", "top", "left-2", "left-1",
    ]  # fmt: skip
    sides = {name: [face[1:3] for face in section.faces] for name, section in ALL.items()}
    assert sides["hexagon"] == sides["trapezoid"] == [("z", -1), ("z", 1)]
    assert sides["octagon"] == sides["u"] == [("z", -1), ("y", 1), ("z", 1), ("y", -1)]
    assert [HEXAGON.face("z", side).width for side in (1, -1)] == pytest.approx([0.25, 0.25])
    mirrors = {name: section.mirrors for name, section in ALL.items()}
    assert mirrors["octagon"] == ("y", "z")
    assert mirrors["hexagon"] == mirrors["trapezoid"] == mirrors["u"] == ("y",)
    for section in ALL.values():
        places = {plate.start for plate in section.plates}
        assert places == {(-y, z) for y, z in places}
    crooked = PolygonSection(TRAPEZOID.corners, (0.010, 0.006, 0.008, 0.007))
    assert crooked.mirrors == ()


def test_sizes_of_the_short_forms() -> None:
    """Reference: analytic. The facets of the U-section are tangent to the circles of its bends."""
    for section in (HEXAGON, OCTAGON, U):
        assert section.size("z") == pytest.approx(0.50, rel=1e-12)
    assert [section.size("y") for section in (HEXAGON, OCTAGON, U)] == pytest.approx(
        [0.45, 0.40, 0.35]
    )
    assert OCTAGON.face("z", 1).width == pytest.approx(0.20, rel=1e-12)
    middle = np.array([0.5 * 0.35 - 0.15, U.reach("z")[0] + 0.15])
    touching = [plate.distance(middle[None])[0] for plate in U.plates[:5]]
    assert touching == pytest.approx([0.15] * 5, rel=1e-9)


@pytest.mark.parametrize(
    ("corners", "thicknesses", "message"),
    [
        (((0, 0), (1, 0)), (0.1, 0.1), "a closed polygon has three corners at least, got 2"),
        (((0, 0), (1, 0), (0, 1)), (0.01, 0.01), "3 corners have as many plates between them, got "
         "2 thicknesses; give one for each plate, the last one from the last corner to the first"),
        (((0, 0), (1, np.inf), (0, 1)), (0.01,) * 3,
         "corners must be numbers of m below 1e+06, got inf"),
        (((0, 0), (1, 0), (0, 1)), (0.01, 0.0, 0.01),
         "thicknesses must be numbers of m above 0 and below 1e+06, got 0.0"),
        (((0, 0), (1, 0), (0, 1), (0, 0)), (0.01,) * 4, "corners 4 and 1 are one; give each once"),
        (((0, 0), (1, 0), (0.4, 0.4), (0, 1)), (0.01,) * 4,
         "corner 3 turns inwards; plates go once around, every corner outwards"),
        (((0, 0), (1, 0), (2, 0)), (0.01,) * 3,
         "corner 1 turns back; plates go once around, every corner outwards"),
        (tuple((np.cos(0.8 * np.pi * k), np.sin(0.8 * np.pi * k)) for k in range(5)), (0.01,) * 5,
         "the plates go around more than once"),
        (((0, 0), (1, 0), (1, 0.1), (0, 0.1)), (0.12, 0.01, 0.12, 0.01),
         "plate 2 of 0.01 m and its neighbours leave no room in the polygon; they must be thinner"),
    ],
)  # fmt: skip
def test_bad_polygons_are_refused(
    corners: Sequence[tuple[float, float]], thicknesses: Sequence[float], message: str
) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        closed_polygon(corners, thicknesses)


def test_bad_short_forms_are_refused() -> None:
    message = "flat must be below the width of 0.4 m, got 0.4"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        hexagon(0.5, 0.4, 0.4, 0.01, 0.01, 0.01)
    message = "chamfer must be below half the height and half the width, 0.2 m, got 0.2"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        octagon(0.5, 0.4, 0.2, 0.01, 0.01, 0.01)
    message = "radius must be above 0 and not above half the width and the height, 0.2 m, got 0.3"
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        u_section(0.5, 0.4, 0.3, 2, 0.01, 0.01, 0.01)
    with pytest.raises(ValueError, match=r"^a bend has one facet at least, got 0$"):
        u_section(0.5, 0.4, 0.1, 0, 0.01, 0.01, 0.01)
