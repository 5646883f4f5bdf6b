# SPDX-License-Identifier: LGPL-3.0-or-later
"""Box sections have the numbers that integration over their plates gives, and can be inferred."""

import re

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from scipy import sparse
from scipy.integrate import dblquad
from scipy.sparse.linalg import spsolve

from geometry.section import BoxSection, SectionError, infer_inner_section, infer_outer_section
from geometry.walls import free_room

PAPER_AREAS = (83.16 / 7850.0, 55.07 / 7850.0)
PAPER_SECOND_MOMENTS = (3.7986e-4, 2.1829e-4)

# One box worked by hand: outside 0.64 m high and 0.41 m wide, hole 0.56 m high and 0.39 m wide.
BOX = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01)


def test_a_box_worked_by_hand() -> None:
    """Reference: analytic, by hand."""
    assert BOX.area == pytest.approx(0.64 * 0.41 - 0.56 * 0.39, rel=1e-14, abs=0.0)
    assert BOX.second_moment_of_area == pytest.approx(
        (0.41 * 0.64**3 - 0.39 * 0.56**3) / 12.0, rel=1e-14
    )
    assert BOX.lateral_second_moment_of_area == pytest.approx(
        (0.64 * 0.41**3 - 0.56 * 0.39**3) / 12.0, rel=1e-14
    )
    # 4 (0.24 m²)² over 2 · 0.6/0.01 + 2 · 0.4/0.04 = 140
    assert BOX.torsion_constant == pytest.approx(0.2304 / 140.0, rel=1e-14, abs=0.0)
    assert BOX.shear_area == pytest.approx(0.012, rel=1e-14, abs=0.0)
    assert BOX.lateral_shear_area == pytest.approx(0.032, rel=1e-14, abs=0.0)
    assert BOX.mass_per_length(7850.0) == pytest.approx(7850.0 * 0.044, rel=1e-14, abs=0.0)


def test_a_box_on_its_side() -> None:
    """Reference: analytic, y and z exchanged; what does not know of the two stays."""
    side = BOX.turned()
    assert side == BoxSection(height=0.40, width=0.60, flange=0.01, web=0.04)
    assert side.second_moment_of_area == BOX.lateral_second_moment_of_area
    assert side.shear_area == BOX.lateral_shear_area
    assert side.torsion_constant == pytest.approx(BOX.torsion_constant, rel=1e-14, abs=0.0)
    assert side.polar_second_moment_of_area == BOX.polar_second_moment_of_area
    assert side.turned() == BOX


def test_area_and_second_moments_against_integration_over_the_plane() -> None:
    """Reference: other code, scipy's adaptive quadrature over the rectangle less its hole."""

    def moment(power_y: int, power_z: int) -> float:
        total = 0.0
        for sign, width, height in ((1.0, 0.41, 0.64), (-1.0, 0.39, 0.56)):
            value, _ = dblquad(
                lambda z, y: y**power_y * z**power_z,
                -0.5 * width, 0.5 * width, -0.5 * height, 0.5 * height,
                epsabs=1e-13, epsrel=1e-13,
            )  # fmt: skip
            total += sign * value
        return total

    assert BOX.area == pytest.approx(moment(0, 0), rel=1e-11, abs=0.0)
    assert BOX.second_moment_of_area == pytest.approx(moment(0, 2), rel=1e-11, abs=0.0)
    assert BOX.lateral_second_moment_of_area == pytest.approx(moment(2, 0), rel=1e-11, abs=0.0)
    polar = moment(0, 2) + moment(2, 0)
    assert BOX.polar_second_moment_of_area == pytest.approx(polar, rel=1e-11, abs=0.0)


def torsion_by_stress_function(height: float, width: float, wall: float, cells: int) -> float:
    """2 ∫ φ dA of Prandtl's stress function on a grid with ``cells`` across the wall.

    −∇²φ = 2 with φ = 0 on the outside; the hole is one unknown.
    """
    d = wall / cells
    shape = round((width + wall) / d) + 1, round((height + wall) / d) + 1
    label = np.full(shape, -1)
    label[1:-1, 1:-1] = 1 + np.arange((shape[0] - 2) * (shape[1] - 2)).reshape(
        shape[0] - 2, shape[1] - 2
    )
    label[cells:-cells, cells:-cells] = 0
    unknown = np.unique(label, return_inverse=True)[1].reshape(shape) - 1
    n = int(unknown.max()) + 1
    along_y = np.stack([unknown[:-1].ravel(), unknown[1:].ravel()])
    along_z = np.stack([unknown[:, :-1].ravel(), unknown[:, 1:].ravel()])
    # Each pair of neighbours adds (φ_i − φ_j)²; the outside (−1) is the last column, cut off.
    pairs = np.concatenate([along_y, along_z], axis=1) % (n + 1)
    edges = pairs.shape[1]
    difference = sparse.coo_matrix(
        (np.repeat([1.0, -1.0], edges), (np.tile(np.arange(edges), 2), pairs.ravel())),
        shape=(edges, n + 1),
    ).tocsc()[:, :n]
    source = 2.0 * d**2 * np.bincount(unknown[unknown >= 0], minlength=n)
    return float(source @ spsolve((difference.T @ difference).tocsc(), source))


def test_torsion_constant_in_the_limit_of_thin_walls() -> None:
    """Reference: other code, finite differences for Prandtl's stress function. Bredt's error halves
    with the wall."""
    errors = []
    for wall in (0.1, 0.05, 0.025):
        exact = torsion_by_stress_function(1.0, 0.6, wall, cells=6)
        errors.append(exact / BoxSection(1.0, 0.6, wall, wall).torsion_constant - 1.0)
    assert 0.0 < errors[-1] < 0.015
    assert errors[1] / errors[0] == pytest.approx(0.5, abs=0.06)
    assert errors[2] / errors[1] == pytest.approx(0.5, abs=0.06)


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
    """Reference: other code, to its four digits; A, J and the room of 2Δ to round-off."""
    outer = infer_outer_section(PAPER_AREAS[0], PAPER_SECOND_MOMENTS[0], ratio)
    inner = infer_inner_section(PAPER_AREAS[1], PAPER_SECOND_MOMENTS[1], outer, 7.0e-3)
    for box, printed in ((outer, outer_mm), (inner, inner_mm)):
        assert (1e3 * box.height, 1e3 * box.width) == pytest.approx(printed[:2], abs=0.1)
        assert 1e3 * box.flange == pytest.approx(printed[2], abs=0.006)
        assert box.web == box.flange
    for box, area, moment in zip((outer, inner), PAPER_AREAS, PAPER_SECOND_MOMENTS, strict=True):
        assert box.area == pytest.approx(area, rel=1e-12, abs=0.0)
        assert box.second_moment_of_area == pytest.approx(moment, rel=1e-12, abs=0.0)
    assert free_room(outer, inner)[0] == pytest.approx(14.0e-3, rel=1e-12, abs=0.0)
    assert free_room(outer, inner)[1] > 0.0


def test_clear_room_by_hand() -> None:
    """Reference: analytic. Hole of 0.56 m x 0.39 m around a box 0.51 m x 0.33 m outside."""
    inner = BoxSection(height=0.49, width=0.30, flange=0.02, web=0.03)
    assert free_room(BOX, inner)[0] == pytest.approx(0.05, rel=1e-12, abs=0.0)
    assert free_room(BOX, inner)[1] == pytest.approx(0.06, rel=1e-12, abs=0.0)


plates = st.tuples(
    st.floats(0.05, 2.0), st.floats(0.3, 3.0), st.floats(0.003, 0.15)
)  # height in m, height to width, wall to the shorter side


def uniform_box(height: float, ratio: float, wall: float) -> BoxSection:
    wall *= min(height, height / ratio)
    return BoxSection(height, height / ratio, wall, wall)


@pytest.mark.slow
@given(plates)
@example((0.5, 1.5, 0.15))
def test_outer_box_round_trip(numbers: tuple[float, float, float]) -> None:
    """Reference: analytic. A box's own A, J and ratio lead back to it."""
    box = uniform_box(*numbers)
    found = infer_outer_section(box.area, box.second_moment_of_area, box.height / box.width)
    assert found.height == pytest.approx(box.height, rel=1e-9)
    assert found.width == pytest.approx(box.width, rel=1e-9)
    assert found.web == found.flange == pytest.approx(box.flange, rel=1e-8)


@pytest.mark.slow
@given(plates, st.floats(0.002, 0.03), st.floats(0.0, 0.03), st.floats(0.002, 0.05))
@example((0.469, 1.867, 0.0194), 0.007, 5.0e-4, 0.0066)
def test_inner_box_round_trip(
    numbers: tuple[float, float, float], clearance: float, side_room: float, outer_wall: float
) -> None:
    """Reference: analytic. An outer box is built around a given one; the room leads back to it."""
    box = uniform_box(*numbers)
    assume(side_room > 1e-6)
    outer = BoxSection(
        height=box.height + box.flange + 2.0 * clearance + outer_wall,
        width=box.width + box.web + side_room + outer_wall,
        flange=outer_wall,
        web=outer_wall,
    )
    found = infer_inner_section(box.area, box.second_moment_of_area, outer, clearance)
    assert found.height == pytest.approx(box.height, rel=1e-8)
    assert found.width == pytest.approx(box.width, rel=1e-7)
    assert found.web == found.flange == pytest.approx(box.flange, rel=1e-7)


def test_no_uniform_box_closes_a_clearance_of_14_mm() -> None:
    outer = infer_outer_section(PAPER_AREAS[0], PAPER_SECOND_MOMENTS[0], 494.5 / 302.7)
    message = (
        "no uniform-wall box with A = 0.00701529 m² and J = 0.00021829 m⁴ closes a clearance of "
        "0.014 m in a room of 0.487833 m x 0.296042 m; give the section explicitly: pads then take "
        "up the difference to the stated clearance"
    )
    with pytest.raises(SectionError, match=f"^{re.escape(message)}$"):
        infer_inner_section(PAPER_AREAS[1], PAPER_SECOND_MOMENTS[1], outer, 14.0e-3)


def test_no_uniform_box_is_as_thick_as_its_room() -> None:
    """Half of the height that a clearance leaves is the thickest wall."""
    message = (
        "no uniform-wall box with A = 0.0005 m² and J = 0.0001 m⁴ closes a clearance of 0.3 m "
    )
    with pytest.raises(SectionError, match=f"^{re.escape(message)}"):
        infer_inner_section(5e-4, 1e-4, infer_outer_section(0.02, 8e-4, 1.5), 0.3)


@pytest.mark.parametrize(
    ("area", "second_moment", "ratio", "numbers"),
    [
        (0.01, 1.0e-6, 1.5, "A = 0.01 m², J = 1e-06 m⁴ and height/width = 1.5"),
        (0.03, 1.01389e-4, 2.0, "A = 0.03 m², J = 0.000101389 m⁴ and height/width = 2"),
    ],
    ids=["no root", "walls that meet"],
)
def test_no_outer_box_so_compact(
    area: float, second_moment: float, ratio: float, numbers: str
) -> None:
    message = f"no uniform-wall box has {numbers}; give the section explicitly"
    with pytest.raises(SectionError, match=f"^{re.escape(message)}$"):
        infer_outer_section(area, second_moment, ratio)


@pytest.mark.parametrize(
    ("dimension", "value", "message"),
    [
        ("height", 0.0, "height must be a positive number of m, got 0.0"),
        ("width", -0.4, "width must be a positive number of m, got -0.4"),
        ("flange", float("nan"), "flange must be a positive number of m, got nan"),
        ("web", float("inf"), "web must be a positive number of m, got inf"),
        ("web", 0.4, "walls of 0.04 m (flange) and 0.4 m (web) leave no room in a box of 0.6 m x "
         "0.4 m; the walls must be thinner"),
        ("bottom_flange", 0.0, "bottom_flange must be a positive number of m, got 0.0"),
        ("bottom_flange", 1.3, "walls of 0.04 m and 1.3 m (flange) and 0.01 m (web) leave no room "
         "in a box of 0.6 m x 0.4 m; the walls must be thinner"),
        ("flange", 0.7, "walls of 0.7 m (flange) and 0.01 m (web) leave no room in a box of 0.6 m "
         "x 0.4 m; the walls must be thinner"),
    ],
)  # fmt: skip
def test_bad_boxes_are_refused(dimension: str, value: float, message: str) -> None:
    plates = {"height": 0.6, "width": 0.4, "flange": 0.04, "web": 0.01, dimension: value}
    with pytest.raises(SectionError, match=f"^{re.escape(message)}$"):
        BoxSection(**plates)
