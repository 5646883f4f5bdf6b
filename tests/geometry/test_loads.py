# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads along a boom, and how its segments fit in one another."""

from collections.abc import Mapping
from dataclasses import replace
from math import cos, hypot, pi, radians, sin
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.excitation import PiecewiseLinear, Step
from protractile.dynamics.motion_laws import SCurve
from protractile.geometry.axial import AxialChange, Thrust, axial_force, with_compression
from protractile.geometry.boom import (
    Boom,
    BoomError,
    Collar,
    Diaphragm,
    Joint,
    Material,
    Pad,
    PointMass,
    Segment,
    SlidePad,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactInterval, pads
from protractile.geometry.cylinder import Cylinder, EarthPoint
from protractile.geometry.fit import room
from protractile.geometry.head import Head
from protractile.geometry.joint import Carrier, Drive, PadSide
from protractile.geometry.load import Load, Moment, PartialLoad, Torque
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.profiles import octagon
from protractile.geometry.section import Section
from protractile.geometry.walls import free_room
from protractile.geometry.wind import wind_direction, wind_loads
from tests.booms import ARM, FLY, STEEL
from tests.geometry.test_section import HEXAGON, offset_corners

# Of both segments in kg/m.
HEAVY, LIGHT = 7850.0 * ARM.area, 7850.0 * FLY.area
JOINT = Joint(outer=0, inner=1, stations=(6.0, 8.0), play=0.01)


def segments(tail: float = 6.0, length: float = 8.0) -> tuple[Segment, Segment]:
    arm = Segment.of_section("arm", 0.0, 8.0, STEEL, ARM, supports=(Support(1.0), Support(3.0)))
    return arm, Segment.of_section("fly", tail, tail + length, STEEL, FLY)


def at(segment: Segment, *places: float) -> list[float]:
    return segment.compression(np.array(places)).tolist()


def test_weights_compress_below_and_pull_behind_the_support() -> None:
    """Reference: analytic, masses times acceleration. The fly transfers its weight at its tail; the
    arm's foot is at 1 m.
    """
    arm, fly = segments()
    stiff = replace(
        fly,
        masses=(PointMass(14.0, 300.0), PointMass(10.0, 50.0)),
        collars=(Collar((8.0, 9.0), 0.01),),
        diaphragms=(Diaphragm(12.0, 0.02),),
    )
    arm, plain = with_compression((arm, fly), [JOINT], [], gravity=5.0)
    assert at(plain, 6.5, 10.0, 13.9) == pytest.approx(
        [5.0 * LIGHT * length for length in (7.5, 4.0, 0.1)], rel=1e-12
    )
    assert at(arm, 0.5, 5.5, 7.0) == pytest.approx(
        [-2.5 * HEAVY, 12.5 * HEAVY + 40.0 * LIGHT, 5.0 * HEAVY], rel=1e-9
    )
    _, pressed = with_compression((arm, stiff), [JOINT], [], gravity=2.0)
    collar, plate = 7850.0 * FLY.perimeter * 0.01, 7850.0 * FLY.enclosed_area * 0.02
    expected = [
        LIGHT + 300.0, 3.0 * LIGHT + 300.0 + plate, 5.5 * LIGHT + 350.0 + plate + 0.5 * collar,
        7.0 * LIGHT + 350.0 + plate + collar,
    ]  # fmt: skip
    found = np.array(at(pressed, 13.0, 11.0, 8.5, 7.0))
    assert 0.5 * found == pytest.approx(np.array(expected), rel=1e-12)


def test_a_thrust_goes_by_the_lock_into_the_next_segment() -> None:
    """Reference: analytic. Force transfers at the tail by default, at a lock, or at the foot; each
    of three segments carries the outboard forces.
    """
    for locked, of_fly, of_arm in (
        (None, [1000.0, 1000.0, 1000.0], [1000.0, 0.0, 0.0]),
        (7.5, [0.0, 0.0, 1000.0], [1000.0, 1000.0, 0.0]),
        (2.0, [1000.0, 1000.0, 1000.0], [0.0, 0.0, 0.0]),
    ):
        joint = replace(JOINT, locked_at=locked)
        arm, fly = with_compression(segments(), [joint], [Thrust(1, 14.0, 1000.0)])
        assert at(fly, 6.5, 7.0, 9.0) == of_fly
        assert at(arm, 5.0, 7.0, 7.9) == of_arm
        assert at(arm, 0.5, 1.5) == [0.0, 1000.0]
    jib = Segment.of_section("jib", 12.0, 20.0, STEEL, FLY)
    second = Joint(outer=1, inner=2, stations=(12.0, 14.0), play=0.01)
    thrusts = [Thrust(2, 20.0, 700.0), Thrust(1, 13.0, -100.0), Thrust(0, 7.0, 10.0)]
    arm, fly, jib = with_compression((*segments(), jib), [JOINT, second], thrusts)
    assert at(jib, 13.0, 19.0) == [700.0, 700.0]
    assert at(fly, 7.0, 12.5, 13.5) == pytest.approx([600.0, -100.0, 0.0], abs=1e-9)
    assert at(arm, 5.0, 6.5, 7.5) == pytest.approx([610.0, 10.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("way", [1.0, -1.0])
@pytest.mark.parametrize(
    ("carrier", "locked"), [("inner", None), ("inner", 7.0), ("outer", 6.0), ("outer", 5.0)]
)
def test_axial_forces_on_the_way_are_those_of_the_boom_there(
    carrier: Carrier, locked: float | None, way: float
) -> None:
    """Reference: other code path, the boom built at this extension or retraction."""
    drive = Drive(PiecewiseLinear([0.0, 1.0], [0.0, way]), ("inner", "outer"), 0.0, carrier)
    joint = replace(JOINT, drive=drive, locked_at=locked)
    own = with_compression(segments(), [joint], [Thrust(1, 14.0, 1000.0)], gravity=5.0)
    along = locked + way if locked is not None and carrier == "inner" else locked
    lock, thrust = replace(JOINT, locked_at=along), Thrust(1, 14.0 + way, 1000.0)
    there = with_compression(segments(6.0 + way), [lock], [thrust], gravity=5.0)
    for number, moved in ((0, 0.0), (1, way)):
        x = np.linspace(*own[number].ends, 97)[1:-1] + 1e-3
        found = axial_force(own, [joint], number, x, np.array([0.0, 1.0]))
        assert found[0] == pytest.approx(own[number].compression(x), rel=1e-12)
        assert found[1] == pytest.approx(there[number].compression(x + moved), abs=1e-6)


def test_axial_forces_and_masses_soften_a_mode() -> None:
    """Reference: analytic, ∫ P w′² dx = P π²/2L and m w² of w = sin πx/L with a mass at L/3."""
    (arm,) = with_compression([segments()[0]], [], [Thrust(0, 8.0, 900.0)])
    x = np.linspace(0.0, 8.0, 81)
    lines = {"z": (x, np.sin(np.pi * x / 8.0)[:, None]), "y": (x, 0.0 * x[:, None])}
    masses = [[PointMass(8.0 / 3.0, 60.0)]]
    found = AxialChange(Step(), [arm.compression], masses, "z").geometric_stiffness([lines])
    # The force ends at the foot, at 1 m.
    bent = 900.0 * (np.pi / 8.0) ** 2 * (3.5 - np.sin(0.25 * np.pi) / (0.5 * np.pi))
    assert found == pytest.approx(np.array([[bent + 0.75 * 60.0]]), rel=1e-5)


PRESSURE, FACTORS = 250.0, (1.5, 1.3)


@pytest.mark.parametrize("overlap", [0.5, 6.0])
@pytest.mark.parametrize(("angle", "luffing"), [(0.0, 60.0), (35.0, 25.0)])
def test_resultant_and_moment_of_wind_follow_by_hand(
    overlap: float, angle: float, luffing: float
) -> None:
    """Reference: analytic, pressure times outer size and exposed length of each segment."""
    turn, raised = radians(angle), radians(luffing)
    lateral, up = sin(turn), -cos(turn) * sin(raised)
    lengths, middles = (8.0, 7.0 - overlap), (4.0, 8.0 + 0.5 * (7.0 - overlap))
    expected, found = ({"y": np.zeros(2), "z": np.zeros(2)} for _ in "12")
    sizes = ((0.408, 0.306), (0.366, 0.265))  # outside
    for length, middle, factor, (high, wide) in zip(lengths, middles, FACTORS, sizes, strict=True):
        for axis, size, part in (("y", high, lateral), ("z", wide, up)):
            force = PRESSURE * factor * size * hypot(lateral, up) * part * length
            expected[axis] += force * np.array([1.0, middle])
    joint = replace(JOINT, stations=(8.0 - overlap, 8.0))
    exposed = segments(8.0 - overlap, 7.0), [joint], PRESSURE
    for load in wind_loads(*exposed, wind_direction(turn, raised), FACTORS, Step()):
        assert isinstance(load, PartialLoad)
        found[load.direction] += load.resultant(0.0) * np.array([1.0, 0.5 * sum(load.span)])
    for axis, values in expected.items():
        np.testing.assert_allclose(found[axis], values, rtol=1e-9, atol=1e-9)


def test_wind_on_a_taper_has_the_resultant_of_the_mean_width() -> None:
    """Reference: analytic, the mean outer width; wind along the axis does nothing."""
    arm, fly = segments()
    tapered = replace(arm, head_section=replace(ARM, height=0.2, width=0.1))
    upright, along, side = (
        wind_direction(*map(radians, angles)) for angles in ((0.0, 90.0), (0.0, 0.0), (90.0, 0.0))
    )
    loads = [*wind_loads([tapered], [], PRESSURE, upright, (1.0,), Step())]
    assert sum(load.resultant(0.0) for load in loads) == pytest.approx(
        -PRESSURE * 0.5 * (0.306 + 0.106) * 8.0, rel=1e-9
    )
    assert not [*wind_loads([tapered], [], PRESSURE, along, (1.0,), Step())]
    with pytest.raises(BoomError) as caught:
        list(wind_loads([arm, replace(fly, section=None)], [JOINT], 1.0, side, FACTORS, Step()))
    assert str(caught.value) == (
        "segments[1].section: missing; the wind meets the height and width of 'fly'"
    )


def test_moments_of_a_load_beside_the_axis_follow_by_hand() -> None:
    """Reference: analytic, lever arms of a weight at 30 degrees and of a force aside."""
    head = Head(ahead=0.9, below=0.6, beside=0.25)
    weight, aside, raised = 1000.0, 120.0, radians(30.0)
    force = [-weight * sin(raised), aside, -weight * cos(raised)]
    loads: list[Load] = list(head.moments(1, 14.0, np.array(force), Step()))
    assert [type(load) for load in loads] == [Moment, Moment, Torque]
    assert loads[1].direction == "y"
    assert [load.magnitude for load in loads] == pytest.approx(
        [
            -weight * (0.9 * cos(raised) + 0.6 * sin(raised)),
            0.9 * aside + 0.25 * weight * sin(raised),
            -0.25 * weight * cos(raised) + 0.6 * aside,
        ],
        rel=1e-12,
    )


def test_stroke_follows_by_the_law_of_cosines() -> None:
    """Reference: analytic, the triangle of foot pin, lug and ground at two angles."""
    a, b = hypot(2.0, 0.4), hypot(0.5, 1.2)
    jack = Cylinder(0, 2.0, 0.4, ground=EarthPoint(front=0.5, below=1.2), closed=1.5, stiffness=1e7)
    for luffing in (radians(10.0), radians(55.0)):
        turned = luffing - np.arctan2(0.4, 2.0) + np.arctan2(1.2, 0.5)
        placed = jack.in_boom_axes(luffing, Support(0.0, "hinged"))
        expected = np.sqrt(a**2 + b**2 - 2.0 * a * b * cos(turned))
        assert placed.length == pytest.approx(expected, rel=1e-12)
        assert placed.extension == pytest.approx(expected - 1.5, rel=1e-12)


def test_cylinder_data_give_stiffness_pressure_and_buckling() -> None:
    """Reference: analytic, springs in series, area times pressure, Euler's hinged column."""
    jack = Cylinder(
        0, 4.0, 0.3, ground=(1.0, -4.3), bore=0.14, rod=0.10, closed=3.0, open=5.2, pressure=2.5e7
    )
    area, rod = 0.25 * pi * 0.14**2, 0.25 * pi * 0.10**2
    stiffness = 1.0 / (2.0 / (1.4e9 * area) + 3.0 / (2.1e11 * rod))
    buckling = pi**3 * 2.1e11 * 0.10**4 / 64.0 / 5.0**2
    assert jack.extension == 2.0
    assert jack.axial_stiffness == pytest.approx(stiffness, rel=1e-12)
    assert jack.buckling_force == pytest.approx(buckling, rel=1e-12)
    assert jack.resistance() == pytest.approx(min(2.5e7 * area, buckling), rel=1e-12)
    # The oil pulls at the ring about the rod, which does not buckle; its column is the rest of the
    # stroke of 2.2 m, or up to twice the closed length.
    ring = area - rod
    for pulling, column in ((jack, 0.2), (replace(jack, open=None), 1.0)):
        compliance = column / (1.4e9 * ring) + 3.0 / (2.1e11 * rod)
        assert pulling.oil_stiffness(pulls=True) == pytest.approx(1.0 / compliance, rel=1e-12)
    assert jack.resistance(pulls=True) == pytest.approx(2.5e7 * ring, rel=1e-12)
    assert replace(jack, capacity=1e5).resistance(pulls=True) == 1e5
    # Without pressure a push is limited by buckling, and a pull by nothing that is known.
    assert replace(jack, pressure=None).resistance() == pytest.approx(buckling, rel=1e-12)
    assert replace(jack, pressure=None).resistance(pulls=True) is None
    assert replace(jack, spread=0.6).axial_stiffness == pytest.approx(2.0 * stiffness, rel=1e-12)
    for wrong, message in (
        ({"open": 4.5}, "open: 4.5 m, and from ground to lug it is 5 m: the cylinder does not "
         "reach; change it, the ground or the luffing angle"),
        ({"rod": 0.14}, "rod: must be below the bore of 0.14 m, got 0.14 m"),
        ({"open": 6.0}, "open: must be below 6 m, twice closed, as the rod goes into the closed "
         "cylinder, got 6 m"),
        ({"rod": None}, "rod: missing; give bore, rod and closed, or the stiffness"),
    ):  # fmt: skip
        with pytest.raises(BoomError) as caught:
            replace(jack, **wrong).check("cylinders[0]", spatial=False)
        assert str(caught.value) == f"cylinders[0].{message}"


CLAMP = (Support(0.0, "clamped"),)


def _smaller(section: Section, clear: float) -> PolygonSection:
    """Return the section with plates inside the given ones by a gap of ``clear`` in m."""
    walls = np.array([plate.thickness for plate in section.plates])
    corners = offset_corners(section, -walls - clear)
    return PolygonSection(tuple((y, z) for y, z in corners.tolist()), tuple(walls))


def test_room_within_sections() -> None:
    """Reference: analytic. In a hexagon with a uniform gap g, the flat plates leave 2 g along z,
    less than the 2 g/n_z of inclined plates. Along y inclined plates leave 2 g/n_y. If the section
    is at one end of its play along z, this decreases by n_z times half the play. The corners of a
    box in an octagon touch the chamfers first.
    """
    outer, inner = BoxSection(0.6, 0.4, 0.02, 0.02), BoxSection(0.5, 0.33, 0.02, 0.01)
    for play in (0.0, 0.05):
        assert free_room(outer, inner, play) == pytest.approx((0.06, 0.04), rel=1e-12)
    gap, within = 0.01, _smaller(HEXAGON, 0.01)
    n_y, n_z = HEXAGON.plates[1].tangent[1], -HEXAGON.plates[1].tangent[0]
    assert free_room(HEXAGON, within) == pytest.approx((2.0 * gap, 2.0 * gap / n_y), rel=1e-9)
    _, pressed = free_room(HEXAGON, within, 0.5 * gap)
    assert pressed == pytest.approx(2.0 * (gap - 0.25 * gap * abs(n_z)) / n_y, rel=1e-9)
    around, box = octagon(0.5, 0.4, 0.1, 0.01, 0.01, 0.01), BoxSection(0.28, 0.28, 0.01, 0.01)
    # Chamfers are at |y| + |z| = 0.35 − 0.01/√2 within, the box's corner at (0.145, 0.145).
    left = 0.35 - 0.01 / np.sqrt(2.0) - 2.0 * 0.145
    assert free_room(around, box)[0] == pytest.approx(2.0 * left, rel=1e-9)
    assert free_room(around, replace(box, height=0.4))[0] < 0.0


def drawn(
    steel: Material, start: float, end: float, travel: float, least: float = 0.0, **joint: Any
) -> Boom:
    """Return a base of 6.5 m, and a fly from start to end in m, touching at the overlap's ends."""
    base = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
    fly = BoxSection(height=0.34, width=0.24, flange=0.006, web=0.005)
    segments = (
        Segment.of_section("base", 0.0, 6.5, steel, base, supports=CLAMP),
        Segment.of_section("fly", start, end, steel, fly),
    )
    drive = Drive(SCurve(travel, 2.0), ("inner", "outer"), least)
    joint = {"play": 3.0e-3, "stations": (start, 6.5), **joint}
    return Boom(segments, (Joint(0, 1, drive=drive, **joint),))


def test_travel_may_reach_the_least_overlap(steel: Material) -> None:
    """Overlaps of 0.5 m and 0.3 m of the fly remain; both are smaller by round-off."""
    assert drawn(steel, 6.5 + 4.8 - 6.0, 11.3, 0.7, 0.5).telescopes
    assert drawn(steel, 0.5, 6.8, -0.3).telescopes


def test_tapered_segments_fit_all_of_the_way(steel: Material) -> None:
    """Reference: by hand. Sections taper from 0.40 to 0.36 m and from 0.34 to 0.30 m. Initially 26
    mm are free between the walls, at 9 m 16 mm less.
    """
    tail, head, *inner = (
        BoxSection(height, width, flange, web=0.006)
        for height, width, flange in (
            (0.40, 0.30, 0.008), (0.36, 0.30, 0.008), (0.34, 0.24, 0.006), (0.30, 0.24, 0.006),
        )
    )  # fmt: skip
    base = Segment.of_section("base", 0.0, 10.0, steel, tail, supports=CLAMP, head_section=head)
    fly = Segment.of_section("fly", 5.0, 15.0, steel, inner[0], head_section=inner[1])
    joint = Joint(0, 1, (5.0, 10.0), play=0.014)
    assert room(joint, base, fly)[0] == pytest.approx(0.026)
    assert room(joint, base, fly, 4.0)[0] == pytest.approx(0.010)
    for travel, play in ((3.0, 0.014), (4.0, 0.010)):
        drive = Drive(SCurve(travel, 2.0), ("inner", "outer"))
        assert Boom((base, fly), (replace(joint, play=play, drive=drive),)).telescopes
    with pytest.raises(BoomError) as caught:
        Boom((base, fly), (replace(joint, drive=drive),))
    assert str(caught.value) == (
        "joints[0].drive: moves 'fly' by 4 m to where it does not fit in 'base': 0.01 m of height "
        "and 0.048 m of width are free there, and a play of 0.014 m is asked for; make the travel "
        "or the taper smaller"
    )


LEFT = "must not be above the overlap of 0.1 m that is left where 'fly' extends by 1.1 m, got "
PADS = tuple(
    SlidePad(length, 0.05, side=side, thickness=0.02)
    for side, length in (("above", 0.08), ("below", 0.11))
)


@pytest.mark.parametrize(
    ("joint", "message"),
    [
        ({"pad": Pad(0.12, 0.05)}, f"pad.length: {LEFT}0.12 m"),
        ({"contact_length": 0.15}, f"contact_length: {LEFT}0.15 m"),
        ({"pads": PADS}, f"pads[1].length: {LEFT}0.11 m"),
        ({"pad": Pad(0.08, 0.05), "stations": (5.38, 6.5)}, "pad.length: the pad at 5.38 m leaves "
         "'base' as 'fly' telescopes by 1.1 m; make it shorter, or move the station"),
    ],
)  # fmt: skip
def test_pads_stay_on_both_segments(steel: Material, joint: dict[str, Any], message: str) -> None:
    """The initial overlap is 1.2 m. A pad at 5.38 m ends at 5.42 m, or 0.02 m beyond the base."""
    place = 6.5 + 4.8 - 6.0
    assert drawn(steel, place, 11.3, 1.0, **joint).telescopes
    with pytest.raises(BoomError) as caught:
        drawn(steel, place, 11.3, 1.1, **joint)
    assert str(caught.value) == f"joints[0].{message}"


def test_pads_lie_side_by_side_on_walls_of_their_width(steel: Material) -> None:
    """Reference: by hand. Half a wall of 0.5 m has room for 0.15 m, half a wall of 0.2 m does not.
    A pad reaches 40 mm from the corner inwards, and another from 30 mm on.
    """
    base = BoxSection(height=0.56, width=0.26, flange=0.008, web=0.006)
    fly = BoxSection(height=0.50, width=0.20, flange=0.006, web=0.005)
    segments = (
        Segment.of_section("base", 0.0, 6.0, steel, base, supports=CLAMP),
        Segment.of_section("fly", 5.0, 11.0, steel, fly),
    )

    def padded(widths: Mapping[PadSide, float], *more: SlidePad) -> Boom:
        each = [SlidePad(0.1, w, side=side, thickness=0.02) for side, w in widths.items()]
        joint = Joint(0, 1, (5.0, 6.0), play=0.01, lateral_play=0.01, pads=(*each, *more))
        return Boom(segments, (joint,))

    widths: dict[PadSide, float] = {"above": 0.05, "below": 0.05, "left": 0.15, "right": 0.15}
    second = SlidePad(0.1, 0.03, side="above", thickness=0.02, offset=0.06)
    assert padded(widths, second).joints[0].padded
    with pytest.raises(BoomError, match=r"^joints\[0\].pads: two lie on one another above, 0.03 m"):
        padded(widths, replace(second, offset=0.03))
    with pytest.raises(BoomError, match=r"^joints\[0\].pads\[1\].width: must be above 0 and not a"):
        padded({**widths, "below": 0.15})


def test_pads_in_space_are_in_the_corners(spatial_boom: Boom) -> None:
    """Reference: analytic, by hand: 4 flange pads at each station, then 4 web pads at each. The
    pads of a side have the whole law, all pads the whole N.
    """
    (joint,) = spatial_boom.joints
    rubbing = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    boom = replace(spatial_boom, joints=(rubbing,))
    outer, inner = (segment.section for segment in boom.segments)
    found = pads(boom)
    assert [pad.station.name for pad in found[::4]] == ["9", "10", "9y", "10y"]
    across = [(pad.station.direction, pad.sliding_direction) for pad in found[::4]]
    assert across == 2 * [("z", "y")] + 2 * [("y", "z")]
    b, h = 0.5 * inner.width, 0.5 * inner.height
    top, side = 0.5 * (outer.height - outer.flange), 0.5 * (outer.width - outer.web)
    assert [(pad.side, pad.inner, pad.outer) for pad in (*found[:4], *found[8:12])] == [
        *((s, (y, s * (top - 7.0e-3)), (y, s * top)) for s in (1, -1) for y in (-b, b)),
        *((s, (s * (side - 5.0e-3), z), (s * side, z)) for s in (1, -1) for z in (-h, h)),
    ]
    # The boxes of this boom leave the vertical clearance by themselves.
    assert top - 7.0e-3 == pytest.approx(0.5 * (inner.height + inner.flange), rel=1e-12)
    for station, force in enumerate((4500.0, 5000.0, 4500.0, 5000.0)):
        here = [pad for pad in found if pad.station.index == station]
        for one in (1, -1):
            assert sum(pad.weight for pad in here if pad.side == one) == 1.0
        assert sum(pad.normal_force or 0.0 for pad in here) == force
    # 30 mm and half of 60 mm, towards the middle of each wall.
    padded = replace(joint, pad=Pad(length=0.1, width=0.06, offset=0.03))
    found = pads(replace(spatial_boom, joints=(padded,)))
    assert {pad.half for pad in found} == {-1, 1}
    for pad in found:
        assert pad.across == pytest.approx(-0.06 * pad.half, rel=0.1)


@pytest.mark.parametrize(
    ("station", "start", "ends"),
    [(4.0, 3.95, (10.0, 10.0)), (10.0, 9.9, (-20.0, 40.0)), (0.02, 0.0, (28.0, -8.0))],
)
def test_a_station_presses_corners_evenly_or_about_itself(
    paper_boom: Boom, station: float, start: float, ends: tuple[float, float]
) -> None:
    """Reference: analytic. A unit force on 0.1 m of the outer segment, [0, 10] m, has its resultant
    at the station. It is uniform inside the segment, and linear from 4/c to −2/c at an end.
    """
    stretch = ContactInterval.from_station(paper_boom.segments[0], station, 0.1)
    assert (stretch.start, stretch.end) == pytest.approx((start, start + 0.1))
    assert stretch.line_load(np.array([start, start + 0.1])) == pytest.approx(ends)
    x, weights = np.polynomial.legendre.leggauss(2)
    x = start + 0.05 + 0.05 * x
    forces = 0.05 * weights * stretch.line_load(x)
    assert [forces.sum(), forces @ x] == pytest.approx([1.0, station])
