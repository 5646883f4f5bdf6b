# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sections with bends in place of sharp corners."""

from dataclasses import replace
from math import cos, pi, sin, sqrt, tan

import numpy as np
import pytest

from protractile.geometry.box import BoxSection
from protractile.geometry.polygon import PolygonSection, bent, closed_polygon
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import Section, SectionError
from protractile.geometry.taper import check_alike, interpolate_section

PROPERTIES = (
    "area", "second_moment_of_area", "lateral_second_moment_of_area", "torsion_constant"
)  # fmt: skip
HEIGHT, WIDTH, WALL, RADIUS = 0.40, 0.30, 0.008, 0.025


def rounded_rectangle(height: float, width: float, radius: float) -> tuple[float, float]:
    """Return the area and the second moment of a rectangle with quarter circles at its corners."""
    quarter, lever = 0.25 * pi * radius**2, 4.0 * radius / (3.0 * pi)
    own = pi * radius**4 / 16.0 - quarter * lever**2
    strip = width - 2.0 * radius
    second = width * (height - 2.0 * radius) ** 3 / 12.0 + strip * radius**3 / 6.0
    second += 2.0 * strip * radius * (0.5 * (height - radius)) ** 2
    second += 4.0 * (own + quarter * (0.5 * height - radius + lever) ** 2)
    return height * width - (4.0 - pi) * radius**2, second


def test_a_rectangular_hollow_section() -> None:
    """Reference: analytic, rectangles with quarter circles, and Bredt's formula."""
    section = bent(BoxSection(HEIGHT, WIDTH, WALL, WALL), RADIUS)
    for name, (height, width) in (
        ("second_moment_of_area", (HEIGHT, WIDTH)),
        ("lateral_second_moment_of_area", (WIDTH, HEIGHT)),
    ):
        outer, inner = (
            rounded_rectangle(height + side * WALL, width + side * WALL, RADIUS + 0.5 * side * WALL)
            for side in (1.0, -1.0)
        )
        assert section.area == pytest.approx(outer[0] - inner[0], rel=1e-12)
        assert getattr(section, name) == pytest.approx(outer[1] - inner[1], rel=1e-12)
    around = 2.0 * (HEIGHT + WIDTH) - (8.0 - 2.0 * pi) * RADIUS
    within = HEIGHT * WIDTH - (4.0 - pi) * RADIUS**2
    assert section.torsion_constant == pytest.approx(4.0 * within**2 * WALL / around, rel=1e-12)
    assert str(section) == "400 x 300 x 8, 4 plates, R 25"
    assert section.mass_per_length(7850.0) == pytest.approx(7850.0 * around * WALL, rel=1e-12)


@pytest.mark.parametrize("facets", [1, 2, 5])
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
    assert section.area == pytest.approx(area, rel=1e-12)
    assert section.second_moment_of_area == pytest.approx(second - first**2 / area, rel=1e-12)
    assert section.lateral_second_moment_of_area == pytest.approx(lateral, rel=1e-12)
    centre = 0.5 * (web - radius)
    assert section.centroid[1] == pytest.approx(first / area - centre, rel=1e-12)
    around = (pi + 2.0) * radius + 2.0 * web
    within = 0.5 * pi * radius**2 + 2.0 * radius * web
    assert section.torsion_constant == pytest.approx(4.0 * within**2 * WALL / around, rel=1e-12)


def outline(sharp: Section, count: int, outwards: float) -> np.ndarray:
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


def outline_moments(corners: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
    """Return the area, ∫ r dA (2,) and ∫ r² dA (2,) of a polygon."""
    after = np.roll(corners, -1, axis=0)
    cross = corners[:, 0] * after[:, 1] - corners[:, 1] * after[:, 0]
    squares = corners**2 + corners * after + after**2
    return 0.5 * cross.sum(), cross @ (corners + after) / 6.0, cross @ squares / 12.0


@pytest.mark.parametrize(
    "sharp",
    [
        hexagon(0.5, 0.42, 0.26, WALL, WALL, WALL),
        octagon(0.5, 0.4, 0.1, WALL, WALL, WALL),
        closed_polygon(((-0.1, -0.2), (0.12, -0.2), (0.2, 0.25), (-0.15, 0.2)), (WALL,) * 4),
    ],
    ids=["hexagon", "octagon", "quadrangle"],
)
def test_bends_are_the_limit_of_many_chords(sharp: Section) -> None:
    """Reference: other code, polygons of the outer and the inner outline (Green), extrapolated."""

    def by_chords(count: int) -> np.ndarray:
        outer, middle, inner = (outline(sharp, count, side * WALL) for side in (0.5, 0.0, -0.5))
        around = np.linalg.norm(np.roll(middle, -1, axis=0) - middle, axis=1).sum()
        enclosed = outline_moments(middle)[0]
        area, first, second = (
            one - other
            for one, other in zip(outline_moments(outer), outline_moments(inner), strict=True)
        )
        lateral, upright = second - first**2 / area
        return np.array([area, upright, lateral, 4.0 * enclosed**2 * WALL / around])

    coarse, fine = by_chords(200), by_chords(400)
    found = [getattr(bent(sharp, RADIUS), name) for name in PROPERTIES]
    assert found == pytest.approx(list(fine + (fine - coarse) / 3.0), rel=1e-9)


@pytest.mark.parametrize("facets", [1, 3])
def test_bends_at_the_top_of_a_u_leave_its_circle(facets: int) -> None:
    """Reference: analytic, two quarter rings instead of four ends of plates up to the corners."""
    sharp = u_section(0.632, 0.462, 0.146, facets, WALL, WALL, WALL)
    section = bent(sharp, RADIUS)
    saved = (4.0 - pi) * RADIUS * WALL
    assert section.area == pytest.approx(sharp.area - saved, rel=1e-12)
    ring = 0.5 * pi * RADIUS * WALL
    # First moments about the upper mid-line: quarter rings, and the mitred plates in their place.
    down = ring * RADIUS - WALL * (RADIUS**2 + WALL**2 / 12.0)
    sides = 0.5 * WALL * RADIUS**2 - WALL**3 / 8.0
    middle = 0.316 - sharp.centroid[1]
    first = sharp.area * middle + 2.0 * (down - sides)
    assert 0.316 - section.centroid[1] == pytest.approx(first / section.area, rel=1e-12)


def test_sharp_corners_are_the_limit_of_small_bends() -> None:
    """Reference: other input, the sharp section; errors fall with the radius."""
    errors = []
    for radius in (1e-4, 1e-5):
        sharp = hexagon(0.5, 0.42, 0.26, *(radius,) * 3)
        found = [getattr(bent(sharp, radius), n) / getattr(sharp, n) - 1.0 for n in PROPERTIES]
        errors.append(np.abs(found))
    assert errors[0].max() < 2e-4
    assert errors[1] == pytest.approx(0.1 * errors[0], rel=1e-2)


def test_widths_for_buckling() -> None:
    """Reference: by hand, the midpoints of the arcs projected on the plates."""
    sharp = hexagon(0.5, 0.42, 0.26, WALL, WALL, WALL)
    section = bent(sharp, RADIUS)
    for plate, width in zip(sharp.plates, section.buckling_widths, strict=True):
        turns = [np.arctan2(0.25, 0.08), pi - 2.0 * np.arctan2(0.25, 0.08)]
        ends = turns[:1] * 2 if plate.name in ("bottom", "top") else turns
        cut = sum(RADIUS * (1.0 / cos(t / 2.0) - 1.0) * sin(t / 2.0) for t in ends)
        assert width == pytest.approx(plate.length - cut, rel=1e-12)
    assert sharp.buckling_widths == tuple(plate.length for plate in sharp.plates)


def test_corners_between_different_plates_are_welds() -> None:
    """Reference: by hand, only the folds at mid-height are bent."""
    section = bent(hexagon(0.5, 0.42, 0.26, 0.006, 0.008, 0.005), RADIUS)
    assert sorted(section.radii) == [0.0, 0.0, 0.0, 0.0, RADIUS, RADIUS]
    half = 0.5 * pi - np.arctan2(0.25, 0.08)
    saved = 4.0 * RADIUS * 0.005 * (tan(half) - half)
    sharp = replace(section, radii=())
    assert section.area == pytest.approx(sharp.area - saved, rel=1e-12)
    assert section.mirrors == ("y",)


def test_outer_sizes_and_tapers_keep_bends() -> None:
    """Reference: other input, mid-lines; by construction."""
    outline = bent(octagon(0.5, 0.4, 0.1, WALL, WALL, WALL), RADIUS).within_outline()
    cut = 0.1 + WALL * (0.5 * sqrt(2.0) - 1.0)
    middle = bent(octagon(0.492, 0.392, cut, *(WALL,) * 3), RADIUS - 0.5 * WALL)
    for name in PROPERTIES:
        assert getattr(outline, name) == pytest.approx(getattr(middle, name), rel=1e-12)
    assert bent(BoxSection(0.3, 0.2, WALL, WALL), RADIUS).turned().size("y") == pytest.approx(0.3)
    head = bent(octagon(0.3, 0.3, 0.1, WALL, WALL, WALL), 0.5 * RADIUS)
    check_alike(outline, head)
    assert interpolate_section(outline, head, 1.0).area == head.area


@pytest.mark.parametrize(
    ("radius", "message"),
    [
        (0.003, "the mid-line of a bend must have a radius of at least 0.004 m, half of the "
                "thickness on both of its sides, got 0.003 m"),
        (0.12, "bends take 0.24 m of a plate of 0.2 m; their radius must be smaller"),
    ],
)  # fmt: skip
def test_impossible_bends(radius: float, message: str) -> None:
    with pytest.raises(SectionError) as error:
        bent(BoxSection(0.3, 0.2, WALL, WALL), radius)
    assert str(error.value) == message


def test_a_welded_box_has_no_bends() -> None:
    with pytest.raises(SectionError) as error:
        bent(BoxSection(0.3, 0.2, 0.006, WALL), RADIUS)
    line = "no sharp corner has plates of one thickness; leave bend_radius out"
    assert str(error.value) == line
    with pytest.raises(SectionError) as error:
        PolygonSection(((0.0, 0.0), (0.2, 0.0), (0.0, 0.2)), (WALL,) * 3, (0.01,))
    assert str(error.value) == "3 corners have as many radii, got 1"
