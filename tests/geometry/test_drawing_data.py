# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wind on exposed parts of segments, and moments of a load beside the axis."""

from dataclasses import replace
from math import cos, hypot, radians, sin

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import Step
from protractile.geometry.boom import BoomError, Joint, Material, Segment
from protractile.geometry.box import BoxSection
from protractile.geometry.cylinder import Cylinder, EarthPoint
from protractile.geometry.head import Head
from protractile.geometry.load import Load, Moment, PartialLoad, Torque
from protractile.geometry.polygon import closed_polygon
from protractile.geometry.profiles import hexagon, u_section
from protractile.geometry.support import Support
from protractile.geometry.wind import wind_direction, wind_loads

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
        assert placed.stroke == pytest.approx(expected - 1.5, rel=1e-12)


def test_cylinder_data_give_stiffness_pressure_and_buckling() -> None:
    """Reference: analytic, springs in series, area times pressure, Euler's hinged column."""
    jack = Cylinder(
        0, 4.0, 0.3, ground=(1.0, -4.3), bore=0.14, rod=0.10, closed=3.0, open=5.2, pressure=2.5e7
    )
    area, rod = 0.25 * np.pi * 0.14**2, 0.25 * np.pi * 0.10**2
    assert jack.stroke == 2.0
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
            replace(jack, rod=None),
            "cylinders[0].rod: missing; the stiffness needs it beside bore, rod and closed, or "
            "give it",
        ),
    ):
        with pytest.raises(BoomError) as caught:
            wrong.check("cylinders[0]", spatial=False)
        assert str(caught.value) == message
