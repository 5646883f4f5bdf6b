# SPDX-License-Identifier: LGPL-3.0-or-later
"""Box sections, their shear flow, and data of drawings: wind, moments of loads beside the axis."""

import re
from dataclasses import replace
from math import cos, hypot, radians, sin

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import Step
from protractile.geometry.boom import BoomError, Joint, Material, Segment
from protractile.geometry.box import BoxSection, infer_inner_section, infer_outer_section
from protractile.geometry.cylinder import Cylinder, EarthPoint
from protractile.geometry.head import Head
from protractile.geometry.load import Load, Moment, PartialLoad, Torque
from protractile.geometry.polygon import PolygonSection, ShearFlow, closed_polygon
from protractile.geometry.profiles import hexagon, u_section
from protractile.geometry.section import Direction, Section, SectionError
from protractile.geometry.support import Support
from protractile.geometry.walls import free_room
from protractile.geometry.wind import wind_direction, wind_loads
from studies.reference_models.statics import shear_centre
from tests.geometry.test_polygon import ALL, HEXAGON

PAPER_AREAS = (83.16 / 7850.0, 55.07 / 7850.0)
PAPER_SECOND_MOMENTS = (3.7986e-4, 2.1829e-4)

# One box worked by hand: outside 0.64 m high and 0.41 m wide, hole 0.56 m high and 0.39 m wide.
BOX = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01)
# Outside 0.41 m wide, from -0.31 to 0.32 m; hole 0.39 m wide, from -0.29 to 0.28 m.
UNEQUAL = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01, bottom_flange=0.02)
OUTER, INNER = (0.41, -0.31, 0.32), (0.39, -0.29, 0.28)


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
    """Reference: other code, to its four digits. A, J and 2Δ are exact to round-off."""
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
    """Reference: analytic. The A, J and ratio of a box give the same box."""
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
    """Reference: analytic. The inner box follows from the clearance in an outer box around it."""
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
    """The largest wall thickness is half of the remaining height."""
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
        ("width", -0.4, "width must be a positive number of m, got -0.4"),
        ("flange", float("nan"), "flange must be a positive number of m, got nan"),
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


def test_shear_flow_of_a_box_by_hand() -> None:
    """Reference: analytic, t b h/4 J at the end of half a flange, (t/2J)(h²/4 − z²) on webs."""
    b, h, t = 0.4, 0.6, 0.01
    bending = t * h**3 / 6.0 + b * t * h**2 / 2.0
    corner, hump = t * b * h / (4.0 * bending), t * h**2 / (8.0 * bending)
    webs = 2.0 * h * (corner**2 + 4.0 / 3.0 * corner * hump + 8.0 / 15.0 * hump**2)
    flanges = 2.0 * b * corner**2 / 3.0
    flow = ShearFlow.from_plates(BoxSection(h, b, t, t).plates, "z")
    assert flow.shear_area == pytest.approx(t / (webs + flanges), rel=1e-12)
    assert flow.moment == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("direction", ["z", "y"])
def test_it_is_the_force_and_does_not_twist(name: str, direction: Direction) -> None:
    """Reference: analytic, equilibrium and ∮ q/t ds = 0."""
    plates = ALL[name].plates
    flow = ShearFlow.from_plates(plates, direction)
    tangents = np.array([plate.tangent for plate in plates])
    expected = [1.0, 0.0] if direction == "y" else [0.0, 1.0]
    assert flow.forces @ tangents == pytest.approx(expected, abs=1e-12)
    assert flow.forces @ (1.0 / flow.thicknesses) == pytest.approx(0.0, abs=1e-9)


ASKEW = BoxSection(0.4889, 0.3259, flange=0.010, web=0.0065, bottom_flange=0.005, left_web=0.004)


@pytest.mark.parametrize("section", [*ALL.values(), ASKEW], ids=[*ALL, "box of four walls"])
@pytest.mark.parametrize("direction", ["z", "y"])
def test_carriers_hold_a_force_through_the_axis(section: Section, direction: Direction) -> None:
    """Reference: analytic. Of rigid motions, the forces do work on the translation alone."""
    found = section.shear_plates(direction)
    forces = sum(force * section.plates[n].tangent for n, force in found)
    assert forces == pytest.approx([1.0, 0.0] if direction == "y" else [0.0, 1.0], abs=1e-12)
    arms = [
        np.linalg.det([section.plates[n].midpoint, section.plates[n].tangent]) for n, _ in found
    ]
    assert sum(f * arm for (_, f), arm in zip(found, arms, strict=True)) == pytest.approx(
        0.0, abs=1e-15
    )


def test_flats_carry_nothing_along_z_and_inclined_plates_equal_forces() -> None:
    """Reference: symmetry."""
    assert [n for n, _ in HEXAGON.shear_plates("z")] == [1, 2, 4, 5]
    right, left = (dict(HEXAGON.shear_plates("z"))[n] for n in (1, 5))
    assert right == pytest.approx(-left, rel=1e-12)


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


def test_the_shear_centre_of_a_box_with_unequal_webs() -> None:
    """Reference: other code, sums over small pieces. With equal webs it is on the axis."""
    box = BoxSection(0.6, 0.4, 0.02, 0.02, left_web=0.01)
    assert shear_centre(box.plates)[0] == pytest.approx(_by_small_steps(box, "z")[1], abs=1e-7)
    assert shear_centre(box.plates)[0] > 0.04
    assert shear_centre(BoxSection(0.6, 0.4, 0.02, 0.01).plates) == pytest.approx((0, 0), abs=1e-15)


def test_properties_worked_by_hand() -> None:
    """Reference: analytic, outer rectangle less inner one, with the parallel axis theorem."""
    areas = [width * (top - bottom) for width, bottom, top in (OUTER, INNER)]
    midpoints = [0.5 * (bottom + top) for _, bottom, top in (OUTER, INNER)]
    area = areas[0] - areas[1]
    z = (areas[0] * midpoints[0] - areas[1] * midpoints[1]) / area
    assert UNEQUAL.area == pytest.approx(area, rel=1e-12)
    assert UNEQUAL.centroid == pytest.approx((0.0, z), rel=1e-12, abs=1e-15)
    own = [width * (top - bottom) ** 3 / 12.0 for width, bottom, top in (OUTER, INNER)]
    parts = [i + a * (middle - z) ** 2 for i, a, middle in zip(own, areas, midpoints, strict=True)]
    assert UNEQUAL.second_moment_of_area == pytest.approx(parts[0] - parts[1], rel=1e-12)
    aside = (0.63 * 0.41**3 - 0.57 * 0.39**3) / 12.0
    assert UNEQUAL.lateral_second_moment_of_area == pytest.approx(aside, rel=1e-12)
    assert UNEQUAL.polar_second_moment_of_area == pytest.approx(
        parts[0] - parts[1] + aside, rel=1e-12
    )
    # 4 (0.24 m²)² over 2 · 0.6/0.01 + 0.4/0.04 + 0.4/0.02 = 150
    assert UNEQUAL.torsion_constant == pytest.approx(0.2304 / 150.0, rel=1e-12)
    assert UNEQUAL.shear_area == pytest.approx(0.012, rel=1e-12)
    assert UNEQUAL.lateral_shear_area == pytest.approx(0.024, rel=1e-12)
    assert UNEQUAL.perimeter == pytest.approx(2.0, rel=1e-12)
    assert UNEQUAL.enclosed_area == pytest.approx(0.24, rel=1e-12)


def test_equal_walls_are_those_of_a_plain_box() -> None:
    plain = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01)
    assert BoxSection(0.60, 0.40, 0.04, 0.01, bottom_flange=0.04, left_web=0.01) == plain
    assert (str(plain), str(UNEQUAL)) == ("600 x 400 x 40 / 10", "600 x 400 x 40 / 20 / 10 / 10")


def test_faces_count_from_the_centroid() -> None:
    """Reference: analytic. The outer surfaces are 0.63 m apart, the inner ones 0.57 m."""
    z = UNEQUAL.centroid[1]
    top, bottom = UNEQUAL.face("z", 1), UNEQUAL.face("z", -1)
    assert (top.outside, bottom.outside) == pytest.approx((0.32 - z, -0.31 - z), rel=1e-12)
    assert (top.inside, bottom.inside) == pytest.approx((0.28 - z, -0.29 - z), rel=1e-12)
    inner = BoxSection(height=0.53, width=0.30, flange=0.02, web=0.02)
    assert free_room(UNEQUAL, inner)[0] == pytest.approx(0.02, rel=1e-12)


def test_places_on_plates() -> None:
    """Reference: analytic. Ends and midpoints are on them, the middle of the section is not."""
    places = np.array(
        [place for plate in UNEQUAL.plates for place in (plate.start, plate.midpoint)]
    )
    assert UNEQUAL.on_plates(places).all()
    assert not UNEQUAL.on_plates(np.vstack([[0.0, 0.0], 1.001 * places])).any()


STEEL = Material(2.1e11, 0.3, 7850.0)
PRESSURE, FACTORS = 250.0, (1.5, 1.3)
# Outer sizes of both boxes: height and width.
SIZES = ((0.408, 0.306), (0.366, 0.265))


def telescope(overlap: float) -> tuple[list[Segment], list[Joint]]:
    boxes = BoxSection(0.40, 0.30, 0.008, 0.006), BoxSection(0.36, 0.26, 0.006, 0.005)
    arm = Segment.of_section("arm", 0.0, 8.0, STEEL, boxes[0])
    fly = Segment.of_section("fly", 8.0 - overlap, 15.0 - overlap, STEEL, boxes[1])
    stations = (8.0 - overlap, 8.0)
    return [arm, fly], [Joint(0, 1, stations, play=0.01, contact=PowerContact(1e9, 1.0))]


@pytest.mark.parametrize("overlap", [0.5, 2.0, 6.0])
@pytest.mark.parametrize(("angle", "luffing"), [(0.0, 60.0), (35.0, 25.0)])
def test_resultant_and_moment_of_wind_follow_by_hand(
    overlap: float, angle: float, luffing: float
) -> None:
    """Reference: analytic, pressure times outer size and exposed length of each segment."""
    turn, raised = radians(angle), radians(luffing)
    lateral, up = sin(turn), -cos(turn) * sin(raised)
    lengths, middles = (8.0, 7.0 - overlap), (4.0, 8.0 + 0.5 * (7.0 - overlap))
    expected = {"y": [0.0, 0.0], "z": [0.0, 0.0]}
    for length, middle, factor, (height, width) in zip(
        lengths, middles, FACTORS, SIZES, strict=True
    ):
        for axis, size, part in (("y", height, lateral), ("z", width, up)):
            force = PRESSURE * factor * size * hypot(lateral, up) * part * length
            expected[axis][0] += force
            expected[axis][1] += force * middle
    found = {"y": [0.0, 0.0], "z": [0.0, 0.0]}
    direction = wind_direction(turn, raised)
    for load in wind_loads(*telescope(overlap), PRESSURE, direction, FACTORS, Step()):
        assert isinstance(load, PartialLoad)
        force = load.resultant(0.0)
        found[load.direction][0] += force
        found[load.direction][1] += force * 0.5 * sum(load.span)
    for axis, values in expected.items():
        np.testing.assert_allclose(found[axis], values, rtol=1e-9, atol=1e-9)


def test_wind_along_the_axis_does_nothing() -> None:
    direction = wind_direction(0.0, 0.0)
    assert not [*wind_loads(*telescope(2.0), PRESSURE, direction, FACTORS, Step())]


def test_wind_on_a_taper_has_the_resultant_of_the_mean_width() -> None:
    """Reference: analytic, the mean of the outer widths of both ends."""
    (arm, _), _ = telescope(2.0)
    assert isinstance(arm.section, BoxSection)
    tapered = replace(arm, head_section=replace(arm.section, height=0.2, width=0.1))
    upright = wind_direction(0.0, radians(90.0))
    loads = [*wind_loads([tapered], [], PRESSURE, upright, (1.0,), Step())]
    assert sum(load.resultant(0.0) for load in loads) == pytest.approx(
        -PRESSURE * 0.5 * (0.306 + 0.106) * 8.0, rel=1e-9
    )


def test_a_segment_in_the_wind_needs_a_section() -> None:
    (arm, fly), joints = telescope(2.0)
    side = wind_direction(radians(90.0), 0.0)
    with pytest.raises(BoomError) as caught:
        list(wind_loads([arm, replace(fly, section=None)], joints, 1.0, side, FACTORS, Step()))
    assert str(caught.value) == (
        "segments[1].section: missing; the wind meets the height and width of 'fly'"
    )


def test_moments_of_a_load_beside_the_axis_follow_by_hand() -> None:
    """Reference: analytic, lever arms of a weight at 30 degrees and of a force aside."""
    head = Head(ahead=0.9, below=0.6, beside=0.25)
    weight, aside, raised = 1000.0, 120.0, radians(30.0)
    force = [-weight * sin(raised), aside, -weight * cos(raised)]
    loads: list[Load] = list(head.moments(1, 14.0, np.array(force), Step()))
    bending, lateral, torque = loads
    assert type(bending) is Moment
    assert type(lateral) is Moment
    assert type(torque) is Torque
    assert lateral.direction == "y"
    assert bending.magnitude == pytest.approx(
        -weight * (0.9 * cos(raised) + 0.6 * sin(raised)), rel=1e-12
    )
    assert lateral.magnitude == pytest.approx(0.9 * aside + 0.25 * weight * sin(raised), rel=1e-12)
    assert torque.magnitude == pytest.approx(-0.25 * weight * cos(raised) + 0.6 * aside, rel=1e-12)


def test_outer_sizes_give_the_section_of_its_mid_lines() -> None:
    """Reference: analytic, each wall half a thickness further in."""
    box = BoxSection(0.408, 0.306, 0.010, 0.006, bottom_flange=0.006).within_outline()
    assert (box.height, box.width) == pytest.approx((0.400, 0.300), rel=1e-15)
    corners = ((-0.15, -0.3), (0.15, -0.3), (0.25, 0.3), (-0.25, 0.3))
    drawn = closed_polygon(corners, (0.01, 0.006, 0.008, 0.006)).within_outline()
    # The inclined side moves by half its thickness along its normal.
    slope = 0.1 / 0.6
    shift = 0.003 * hypot(1.0, slope)
    low, high = -0.3 + 0.005, 0.3 - 0.004
    y_low, y_high = 0.15 + slope * 0.005 - shift, 0.25 - slope * 0.004 - shift
    middle = closed_polygon(
        ((-y_low, low), (y_low, low), (y_high, high), (-y_high, high)), (0.01, 0.006, 0.008, 0.006)
    )
    for name in ("area", "second_moment_of_area", "torsion_constant", "shear_area"):
        assert getattr(drawn, name) == pytest.approx(getattr(middle, name), rel=1e-12)
    # A bend keeps its facets, tangent to a circle that is smaller by half the thickness.
    drawn_u = u_section(0.5, 0.4, 0.15, 3, 0.006, 0.006, 0.006).within_outline()
    middle_u = u_section(0.494, 0.394, 0.147, 3, 0.006, 0.006, 0.006)
    for name in ("area", "second_moment_of_area", "torsion_constant"):
        assert getattr(drawn_u, name) == pytest.approx(getattr(middle_u, name), rel=1e-12)
    assert hexagon(0.5, 0.4, 0.2, 0.01, 0.01, 0.005).within_outline().size("z") == pytest.approx(
        0.49, rel=1e-12
    )


def test_stroke_follows_by_the_law_of_cosines() -> None:
    """Reference: analytic, the triangle of foot pin, lug and ground at two angles."""
    hand = hypot(2.0, 0.4), hypot(0.5, 1.2)
    between = np.arctan2(0.4, 2.0)
    below = np.arctan2(1.2, 0.5)
    for luffing in (radians(10.0), radians(55.0)):
        lug_angle = luffing - between
        expected = np.sqrt(
            hand[0] ** 2 + hand[1] ** 2 - 2.0 * hand[0] * hand[1] * cos(lug_angle + below)
        )
        ground = EarthPoint(front=0.5, below=1.2)
        jack = Cylinder(0, 2.0, 0.4, ground=ground, closed=1.5, stiffness=1e7)
        placed = jack.in_boom_axes(luffing, Support(0.0, "hinged"))
        assert placed.length == pytest.approx(expected, rel=1e-12)
        assert placed.extension == pytest.approx(expected - 1.5, rel=1e-12)


def test_cylinder_data_give_stiffness_pressure_and_buckling() -> None:
    """Reference: analytic, springs in series, area times pressure, Euler's hinged column."""
    jack = Cylinder(
        0, 4.0, 0.3, ground=(1.0, -4.3), bore=0.14, rod=0.10, closed=3.0, open=5.2, pressure=2.5e7
    )
    area, rod = 0.25 * np.pi * 0.14**2, 0.25 * np.pi * 0.10**2
    assert jack.extension == 2.0
    assert jack.axial_stiffness == pytest.approx(
        1.0 / (2.0 / (1.4e9 * area) + 3.0 / (2.1e11 * rod)), rel=1e-12
    )
    buckling = np.pi**3 * 2.1e11 * 0.10**4 / 64.0 / 5.0**2
    assert jack.buckling_force == pytest.approx(buckling, rel=1e-12)
    assert jack.resistance == pytest.approx(min(2.5e7 * area, buckling), rel=1e-12)
    pair = replace(jack, spread=0.6)
    assert pair.axial_stiffness == pytest.approx(2.0 * jack.axial_stiffness, rel=1e-12)
    for wrong, message in (
        (
            replace(jack, open=4.5),
            "cylinders[0].open: 4.5 m, and from ground to lug it is 5 m: the cylinder does not "
            "reach; change it, the ground or the luffing angle",
        ),
        (
            replace(jack, rod=0.14),
            "cylinders[0].rod: must be below the bore of 0.14 m, got 0.14 m",
        ),
        (
            replace(jack, open=6.0),
            "cylinders[0].open: must be below 6 m, twice closed, as the rod goes into the closed "
            "cylinder, got 6 m",
        ),
        (
            replace(jack, rod=None),
            "cylinders[0].rod: missing; the stiffness needs it beside bore, rod and closed, or "
            "give it",
        ),
    ):
        with pytest.raises(BoomError) as caught:
            wrong.check("cylinders[0]", spatial=False)
        assert str(caught.value) == message
