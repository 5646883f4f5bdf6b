# SPDX-License-Identifier: LGPL-3.0-or-later
"""Permitted travels of drives, axial forces of each segment, and positions of pads, by hand."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import PiecewiseLinear, Step
from protractile.dynamics.motion_laws import SCurve
from protractile.geometry.axial import (
    AxialChange,
    MovingForce,
    Thrust,
    axial_force,
    moving_force,
    with_compression,
)
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
    Stop,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactInterval, ContactPair, Patch, pads
from protractile.geometry.fit import room
from protractile.geometry.joint import Carrier, Drive

BASE = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
FLY = BoxSection(height=0.34, width=0.24, flange=0.006, web=0.005)


def drawn(
    steel: Material,
    start: float,
    end: float,
    travel: float,
    least: float = 0.0,
    base: dict[str, Any] | None = None,
    fly: dict[str, Any] | None = None,
    **joint: Any,
) -> Boom:
    """Return a base of 6.5 m, and a fly from start to end in m, touching at the overlap's ends."""
    held = (Support(0.0, "clamped"),)
    segments = (
        Segment.of_section("base", 0.0, 6.5, steel, BASE, supports=held, **(base or {})),
        Segment.of_section("fly", start, end, steel, FLY, **(fly or {})),
    )
    drive = Drive(SCurve(travel, 2.0), ("inner", "outer"), least)
    joint = {"play": 3.0e-3, "stations": (start, 6.5), **joint}
    return Boom(segments, (Joint(0, 1, drive=drive, **joint),))


@pytest.mark.parametrize(
    ("start", "end", "travel", "least"),
    [(6.5 + 4.8 - 6.0, 11.3, 0.7, 0.5), (0.5, 6.8, -0.3, 0.0)],
    ids=["out", "in"],
)
def test_travel_may_reach_the_least_overlap(
    steel: Material, start: float, end: float, travel: float, least: float
) -> None:
    """Overlaps of 0.5 m and 0.3 m of the fly remain; both are smaller by round-off."""
    assert drawn(steel, start, end, travel, least).telescopes


def test_no_segment_is_drawn_in_through_a_diaphragm(steel: Material) -> None:
    """From 2.5 to 1.5 m the segment hits a plate at 2 m; with 0.4 m it does not reach it."""
    plated = {"diaphragms": (Diaphragm(2.0, 0.008),)}
    assert drawn(steel, 2.5, 9.0, -0.4, base=plated)
    with pytest.raises(BoomError) as caught:
        drawn(steel, 2.5, 9.0, -1.0, base=plated)
    assert (caught.value.where, caught.value.what) == (
        "joints[0].drive",
        "retracts 'fly' by 1 m, and the diaphragm of 'base' at 2 m is in its way; it must be less "
        "than 0.5 m",
    )


def test_tapered_segments_fit_all_of_the_way(steel: Material) -> None:
    """Sections taper from 0.40 to 0.36 m and from 0.34 to 0.30 m. Initially 26 mm are free between
    the walls, at 9 m 16 mm less.
    """
    sections = (
        BoxSection(height, width, flange, web=0.006)
        for height, width, flange in (
            (0.40, 0.30, 0.008), (0.36, 0.30, 0.008), (0.34, 0.24, 0.006), (0.30, 0.24, 0.006),
        )
    )  # fmt: skip
    tail, head, *inner = sections
    held = (Support(0.0, "clamped"),)
    base = Segment.of_section("base", 0.0, 10.0, steel, tail, supports=held, head_section=head)
    fly = Segment.of_section("fly", 5.0, 15.0, steel, inner[0], head_section=inner[1])
    joint = Joint(0, 1, (5.0, 10.0), play=0.014)
    assert room(joint, base, fly)[0] == pytest.approx(0.026)
    assert room(joint, base, fly, 4.0)[0] == pytest.approx(0.010)
    for travel, clearance in ((3.0, 0.007), (4.0, 0.005)):
        drive = Drive(SCurve(travel, 2.0), ("inner", "outer"))
        assert Boom((base, fly), (replace(joint, play=2.0 * clearance, drive=drive),)).telescopes
    drive = Drive(SCurve(4.0, 2.0), ("inner", "outer"))
    with pytest.raises(BoomError) as caught:
        Boom((base, fly), (replace(joint, drive=drive),))
    assert (caught.value.where, caught.value.what) == (
        "joints[0].drive",
        "moves 'fly' by 4 m to where it does not fit in 'base': 0.01 m of height and 0.048 m of "
        "width are free there, and a play of 0.014 m is asked for; make the travel or the taper "
        "smaller",
    )


LEFT = "must not be above the overlap of 0.1 m that is left where 'fly' extends by 1.1 m, got "
PAD = Pad(0.12, 0.05)
PADS = (
    SlidePad(0.08, 0.05, side="above", thickness=0.02),
    SlidePad(0.11, 0.05, side="below", thickness=0.02),
)


@pytest.mark.parametrize(
    ("joint", "key", "message"),
    [
        ({"pad": PAD}, "pad.length", LEFT + "0.12 m"),
        ({"contact_length": 0.15}, "contact_length", LEFT + "0.15 m"),
        ({"pads": PADS}, "pads[1].length", LEFT + "0.11 m"),
        ({"pad": replace(PAD, length=0.08), "stations": (5.38, 6.5)}, "pad.length", "the pad at "
         "5.38 m leaves 'base' as 'fly' telescopes by 1.1 m; make it shorter, or move the station"),
    ],
)  # fmt: skip
def test_pads_stay_on_both_segments(
    steel: Material, joint: dict[str, Any], key: str, message: str
) -> None:
    """The initial overlap is 1.2 m. A pad at 5.38 m ends at 5.42 m, or 0.02 m beyond the base."""
    place = 6.5 + 4.8 - 6.0
    assert drawn(steel, place, 11.3, 1.0, **joint).telescopes
    with pytest.raises(BoomError) as caught:
        drawn(steel, place, 11.3, 1.1, **joint)
    assert (caught.value.where, caught.value.what) == (f"joints[0].{key}", message)


STEEL = Material(2.1e11, 0.3, 7850.0)
OUTER = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
INNER = BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005)
# Of both segments in kg/m.
HEAVY, LIGHT = 7850.0 * OUTER.area, 7850.0 * INNER.area
JOINT = Joint(outer=0, inner=1, stations=(6.0, 8.0), play=0.01)


def segments() -> tuple[Segment, Segment]:
    arm = Segment.of_section("arm", 0.0, 8.0, STEEL, OUTER, supports=(Support(1.0), Support(3.0)))
    return arm, Segment.of_section("fly", 6.0, 14.0, STEEL, INNER)


def at(segment: Segment, *places: float) -> list[float]:
    return segment.compression(np.array(places)).tolist()


def test_weights_compress_below_and_pull_behind_the_support() -> None:
    """Reference: analytic. The fly transfers its weight at its tail; the arm's foot is at 1 m."""
    arm, fly = with_compression(segments(), [JOINT], [], gravity=5.0)
    assert at(fly, 6.5, 10.0, 13.9) == pytest.approx(
        [5.0 * LIGHT * length for length in (7.5, 4.0, 0.1)], rel=1e-12
    )
    expected = [-0.5 * HEAVY, 7.0 * HEAVY, 2.5 * HEAVY + 8.0 * LIGHT, HEAVY]
    assert at(arm, 0.5, 6.999999, 5.5, 7.0) == pytest.approx(
        [5.0 * expected[0], 5.0 * 1.000001 * HEAVY, 5.0 * expected[2], 5.0 * expected[3]], rel=1e-9
    )


def test_a_thrust_goes_by_the_lock_into_the_next_segment() -> None:
    """Reference: analytic. Force transfers at the tail by default, at a lock, or at the foot."""
    rope = [Thrust(1, 14.0, 1000.0)]
    for locked, of_fly, of_arm in (
        (None, [1000.0, 1000.0, 1000.0], [1000.0, 0.0, 0.0]),
        (7.5, [0.0, 0.0, 1000.0], [1000.0, 1000.0, 0.0]),
        (2.0, [1000.0, 1000.0, 1000.0], [0.0, 0.0, 0.0]),
    ):
        joint = replace(JOINT, locked_at=locked)
        arm, fly = with_compression(segments(), [joint], rope)
        assert at(fly, 6.5, 7.0, 9.0) == of_fly
        assert at(arm, 5.0, 7.0, 7.9) == of_arm
        assert at(arm, 0.5) == [0.0]
    assert at(arm, 1.5) == [1000.0]


def test_masses_collars_and_diaphragms_weigh_along_the_boom() -> None:
    """Reference: analytic, their masses times the acceleration."""
    arm, fly = segments()
    fly = replace(
        fly,
        masses=(PointMass(14.0, 300.0), PointMass(10.0, 50.0)),
        collars=(Collar((8.0, 9.0), 0.01),),
        diaphragms=(Diaphragm(12.0, 0.02),),
    )
    _, pressed = with_compression((arm, fly), [JOINT], [], gravity=2.0)
    collar, plate = 7850.0 * INNER.perimeter * 0.01, 7850.0 * INNER.enclosed_area * 0.02
    assert at(pressed, 13.0, 11.0, 8.5, 7.0) == pytest.approx(
        [
            2.0 * (LIGHT + 300.0),
            2.0 * (3.0 * LIGHT + 300.0 + plate),
            2.0 * (5.5 * LIGHT + 350.0 + plate + 0.5 * collar),
            2.0 * (7.0 * LIGHT + 350.0 + plate + collar),
        ],
        rel=1e-12,
    )


def test_each_of_three_segments_carries_the_outboard_forces() -> None:
    """Reference: analytic, the sum of the outboard thrusts, with negative tension."""
    arm, fly = segments()
    jib = Segment.of_section("jib", 12.0, 20.0, STEEL, INNER)
    second = Joint(outer=1, inner=2, stations=(12.0, 14.0), play=0.01)
    thrusts = [Thrust(2, 20.0, 700.0), Thrust(1, 13.0, -100.0), Thrust(0, 7.0, 10.0)]
    arm, fly, jib = with_compression((arm, fly, jib), [JOINT, second], thrusts)
    assert at(jib, 13.0, 19.0) == [700.0, 700.0]
    assert at(fly, 7.0, 12.5, 13.5) == pytest.approx([600.0, -100.0, 0.0], abs=1e-9)
    assert at(arm, 5.0, 6.5, 7.5) == pytest.approx([610.0, 10.0, 0.0], abs=1e-9)


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


@pytest.mark.parametrize(
    ("carrier", "locked", "entered"),
    [
        ("inner", None, MovingForce(0, 6.0, 1, 1000.0 + 40.0 * LIGHT)),
        ("inner", 7.0, MovingForce(0, 7.0, 1, 1000.0 + 40.0 * LIGHT)),
        ("outer", 8.0, MovingForce(1, 8.0, -1, 1000.0 + 40.0 * LIGHT)),
        ("outer", 6.0, MovingForce(1, 6.0, -1, 1000.0 + 40.0 * LIGHT)),
        ("outer", 5.0, None),
    ],
)
def test_drawn_out_a_force_goes_along(
    carrier: Carrier, locked: float | None, entered: MovingForce | None
) -> None:
    """Reference: other code path, the forces in the boom built at this extension."""
    ways = PiecewiseLinear([0.0, 1.0], [0.0, 1.0])
    rope, drive = [Thrust(1, 14.0, 1000.0)], Drive(ways, ("inner", "outer"), 0.0, carrier)
    joint = replace(JOINT, drive=drive, locked_at=locked)
    own = with_compression(segments(), [joint], rope, gravity=5.0)
    found = moving_force(own, [joint], 0)
    if found is not None:
        found = replace(found, force=round(found.force, 6))
    assert found == (None if entered is None else replace(entered, force=round(entered.force, 6)))
    arm, fly = segments()
    for way in (1.0, -1.0):
        along = locked
        if carrier == "inner" and locked is not None:
            along = locked + way
        there = replace(JOINT, locked_at=along)
        drawn = arm, replace(fly, start=6.0 + way, end=14.0 + way)
        expected = with_compression(drawn, [there], [Thrust(1, 14.0 + way, 1000.0)], gravity=5.0)
        for number, moved in ((0, 0.0), (1, way)):
            x = np.linspace(own[number].start, own[number].end, 97)[1:-1] + 1e-3
            here = own[number].compression(x)
            if way > 0.0:
                here = axial_force(own, [joint], number, x, np.array([0.3, way]))[1]
            elif found is not None and found.segment == number:
                here = here + found.change(x, np.array(way))
            assert here == pytest.approx(expected[number].compression(x + moved), abs=1e-6)


def test_a_flat_boom_touches_on_its_axis(paper_boom: Boom) -> None:
    (joint,) = paper_boom.joints
    joint = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    boom = replace(paper_boom, joints=(joint,))
    axis = (0.0, 0.0)
    outer, inner = paper_boom.segments
    # A tenth of the overlap from 9 to 10 m.
    tail, head = (
        (ContactInterval.from_station(inner, x, 0.1), ContactInterval.from_station(outer, x, 0.1))
        for x in joint.stations
    )
    assert pads(boom) == [
        ContactPair(boom.stations[0], joint, 0, axis, axis, 1.0, "z", 4500.0, tail, None),
        ContactPair(boom.stations[1], joint, 0, axis, axis, 1.0, "z", 5000.0, head, None),
    ]


def test_a_pad_keeps_its_distance_from_the_corner(paper_boom: Boom) -> None:
    """Reference: by hand, 30 mm inwards from half the width, then 60 mm wide."""
    (joint,) = paper_boom.joints
    padded = replace(joint, pad=Pad(length=0.1, width=0.06, offset=0.03))
    tail, _ = pads(replace(paper_boom, joints=(padded,)))
    assert tail.patch == Patch(9.0, 9.1, 0.03, 0.06)


def test_the_centre_of_a_pad_lies_inwards_of_its_corner(spatial_boom: Boom) -> None:
    """Reference: by hand, 30 mm and half of 60 mm, towards the middle of each wall."""
    (joint,) = spatial_boom.joints
    padded = replace(joint, pad=Pad(length=0.1, width=0.06, offset=0.03))
    found = pads(replace(spatial_boom, joints=(padded,)))
    assert {pad.half for pad in found} == {-1, 1}
    for pad in found:
        assert pad.across == pytest.approx(-0.06 * pad.half, rel=0.1)


def test_pads_in_space_are_in_the_corners(spatial_boom: Boom) -> None:
    """Reference: analytic, by hand: 4 flange pads at each station, then 4 web pads at each."""
    outer, inner = (segment.section for segment in spatial_boom.segments)
    found = pads(spatial_boom)
    assert [pad.station for pad in found[::4]] == [*spatial_boom.stations]
    assert [pad.station.name for pad in found[::4]] == ["9", "10", "9y", "10y"]
    assert [(pad.station.direction, pad.sliding_direction) for pad in found[::4]] == 2 * [
        ("z", "y")
    ] + 2 * [("y", "z")]
    b, h = 0.5 * inner.width, 0.5 * inner.height
    top, side = 0.5 * (outer.height - outer.flange), 0.5 * (outer.width - outer.web)
    flange = [(pad.side, pad.inner, pad.outer) for pad in found[:4]]
    assert flange == [
        (1, (-b, top - 7.0e-3), (-b, top)),
        (1, (b, top - 7.0e-3), (b, top)),
        (-1, (-b, 7.0e-3 - top), (-b, -top)),
        (-1, (b, 7.0e-3 - top), (b, -top)),
    ]
    web = [(pad.side, pad.inner, pad.outer) for pad in found[8:12]]
    assert web == [
        (1, (side - 5.0e-3, -h), (side, -h)),
        (1, (side - 5.0e-3, h), (side, h)),
        (-1, (5.0e-3 - side, -h), (-side, -h)),
        (-1, (5.0e-3 - side, h), (-side, h)),
    ]
    # The boxes of this boom leave the vertical clearance by themselves.
    assert top - 7.0e-3 == pytest.approx(0.5 * (inner.height + inner.flange), rel=1e-12)


def test_stations_are_those_of_the_boom(spatial_boom: Boom) -> None:
    """The boom has three segments and a stop, and one bonded joint or none."""
    (joint,) = spatial_boom.joints
    inner = spatial_boom.segments[1]
    box = replace(inner.section, height=0.4, width=0.2)
    last = replace(inner, name="last", start=17.0, end=26.0, section=box)
    for bonded in (False, True):
        boom = Boom(
            (*spatial_boom.segments, last),
            (
                replace(joint, bonded=bonded),
                replace(joint, outer=1, inner=2, stations=(17.0, 18.0, 19.0)),
            ),
            stops=(Stop(2, 26.0, 0.02, PowerContact(1.0e8, 1.0, stiffness_below=1.0e8)),),
        )
        found = pads(boom)
        assert len(boom.stations) == (7 if bonded else 11)
        assert len(found) == 4 * (len(boom.stations) - 1)
        for pad in found:
            assert pad.station is boom.stations[pad.station.index]
            assert pad.joint is pad.station.joint is boom.joints[pad.station.number]
            assert pad.station.x == pad.joint.stations[pad.station.place]


def test_shares_of_a_station_sum_to_one(spatial_boom: Boom) -> None:
    """Reference: analytic. The pads of a side have the whole law, all pads the whole N."""
    (joint,) = spatial_boom.joints
    joint = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    found = pads(replace(spatial_boom, joints=(joint,)))
    assert len(found) == 16
    for station, force in enumerate((4500.0, 5000.0, 4500.0, 5000.0)):
        here = [pad for pad in found if pad.station.index == station]
        for side in (1, -1):
            assert sum(pad.weight for pad in here if pad.side == side) == 1.0
        assert sum(pad.normal_force or 0.0 for pad in here) == force


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
