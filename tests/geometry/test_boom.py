# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms and their parts, their fields, and numbers in messages."""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import Step
from protractile.geometry.axial import Thrust
from protractile.geometry.boom import (
    Boom,
    BoomError,
    Collar,
    Cylinder,
    Diaphragm,
    Joint,
    Load,
    Material,
    Observation,
    Pad,
    PointMass,
    Segment,
    SlidePad,
    Stop,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.place import Distance
from protractile.geometry.typography import join_words, number, with_minus_signs

# What changes of the outer segment, of the inner one and of the joint.
Changes = dict[str, dict[str, Any]]


def test_numbers_of_a_segment(paper_boom: Boom) -> None:
    """Reference: analytic, by hand from the paper's data."""
    outer, inner = paper_boom.segments
    assert outer.material.shear_modulus == pytest.approx(2.1e11 / 2.6, rel=1e-14)
    assert outer.bending_stiffness == pytest.approx(7.97706e7, rel=1e-14)
    assert (outer.length, inner.length) == (10.0, 10.0)
    assert (outer.rigid_modes, inner.rigid_modes) == (0, 2)
    assert replace(outer, supports=(Support(2.0),)).rigid_modes == 1
    assert replace(outer, supports=tuple(map(Support, (0.0, 2.0, 10.0)))).rigid_modes == 0
    assert replace(outer, supports=(Support(0.0, "clamped"),)).rigid_modes == 0
    assert replace(outer, supports=(Support(0.0, stiffness=1.0e6),)).rigid_modes == 1
    assert (outer.rigid_twists, inner.rigid_twists) == (0, 1)


def test_stiffeners_weigh_as_their_plates(steel: Material) -> None:
    """Reference: by hand, a collar of 0.5 m around the walls, and a lid of 8 mm within them."""
    box = BoxSection(0.4, 0.3, 0.01, 0.01)
    collars, lids = (Collar((1.0, 1.5), 0.012),), (Diaphragm(2.0, 0.008),)
    arm = Segment.of_section("arm", 0.0, 3.0, steel, box, collars=collars, diaphragms=lids)
    volume = box.area * 3.0 + 1.4 * 0.5 * 0.012 + 0.4 * 0.3 * 0.008
    assert arm.mass == pytest.approx(7850.0 * volume, rel=1e-12)


def test_ends_belong_to_a_segment(paper_boom: Boom) -> None:
    inner = paper_boom.segments[1]
    assert inner.holds(9.0)
    assert inner.holds(19.0)
    assert inner.holds(9.0 - 1e-10)
    assert not inner.holds(9.0 - 1e-8)
    assert not inner.holds(19.0 + 1e-8)


def test_a_segment_turned_has_its_planes_exchanged(spatial_boom: Boom) -> None:
    inner = spatial_boom.segments[1]
    turned = replace(inner, lateral=replace(inner.lateral, load=7.0)).turned()
    assert turned.second_moment_of_area == inner.section.lateral_second_moment_of_area
    assert turned.rotary_inertia == 7850.0 * inner.section.lateral_second_moment_of_area
    assert turned.section == inner.section.turned()
    assert turned.load == 7.0
    assert turned.turned() == replace(inner, lateral=replace(inner.lateral, load=7.0))
    with pytest.raises(ValueError, match=r"^'inner' has no lateral numbers to exchange$"):
        replace(inner, lateral=None).turned()


def test_places_of_the_paper(paper_boom: Boom) -> None:
    assert paper_boom.tip == 19.0
    assert [station.x for station in paper_boom.stations] == [9.0, 10.0]
    assert not paper_boom.spatial
    assert paper_boom.stations_of(0) == paper_boom.stations_of(1) == (9.0, 10.0)
    assert paper_boom.observed == {"tip": (1, 19.0), "head": (0, 10.0), "tail": (1, 9.0)}


def test_places_of_three_segments(paper_boom: Boom) -> None:
    outer, middle = paper_boom.segments
    (joint,) = paper_boom.joints
    last = replace(middle, name="last", start=17.5, end=27.0, section=None)
    second = replace(joint, outer=1, inner=2, stations=(17.5, 19.0))
    boom = Boom((outer, middle, last), (joint, second))
    assert boom.tip == 27.0
    assert boom.stations_of(1) == (9.0, 10.0, 17.5, 19.0)
    assert boom.stations_of(2) == (17.5, 19.0)
    assert boom.observed == {
        "tip": (2, 27.0),
        "head": (0, 10.0),
        "tail": (1, 9.0),
        "head-2": (1, 19.0),
        "tail-2": (2, 17.5),
    }


def test_positions_of_stations_and_loads(paper_boom: Boom, spatial_boom: Boom) -> None:
    """Stations are ordered by joints along z, joints along y, stops; nodes are at all forces."""
    loads = (Load(0, "z", 5.0, 4.0, np.ones_like), Load(0, "z", 5.0, None, np.ones_like))
    stop = Stop(1, 14.0, 0.002, PowerContact(1.0e9, 1.0, stiffness_below=0.0))
    outer, inner = paper_boom.segments
    heavy = replace(inner, masses=(PointMass(19.0, 80.0),))
    boom = Boom((outer, heavy), paper_boom.joints, loads, (stop,))
    assert [station.name for station in boom.stations] == ["9", "10", "14"]
    assert boom.stations_of(0) == (4.0, 9.0, 10.0)
    assert boom.stations_of(1) == (9.0, 10.0, 14.0, 19.0)
    assert spatial_boom.spatial
    both = replace(spatial_boom, stops=(stop,))
    assert [station.name for station in both.stations] == ["9", "10", "9y", "10y", "14"]
    assert [station.place for station in both.stations] == [0, 1, 0, 1, 0]
    assert [station.stop for station in both.stations] == [None] * 4 + [stop]
    bonded = Boom(paper_boom.segments, (replace(paper_boom.joints[0], bonded=True),), stops=(stop,))
    assert [station.name for station in bonded.stations] == ["14"]
    assert bonded.stations_of(0) == (9.0, 10.0)


# Changes that the boom refuses, by the line that each of them earns.
FAULTS: dict[str, list[Changes]] = {
    "segments[1].start: must run from a smaller to a larger x, got [19, 9] m": [
        {"inner": {"start": 19.0, "end": 9.0}},
    ],
    "segments[0].supports: 10.5 m lies outside 'outer'; it must be between 0 and 10 m": [
        {"outer": {"supports": (Support(0.0), Support(10.5))}},
    ],
    "segments[0].supports: two are within 0.001 m of one another; give one, or move them "
    "farther apart": [
        {"outer": {"supports": (Support(2.0), Support(2.0))}},
        {"outer": {"supports": (Support(2.0), Support(2.0 + 1e-5))}},
    ],
    "segments[0].supports: a clamped support is rigid, and the one at 2 m has a stiffness; "
    "leave it out, or make the support pinned": [
        {"outer": {"supports": (Support(0.0), Support(2.0, "clamped", 1e6))}},
    ],
    "segments[1].masses: 20 m lies outside 'inner'; it must be between 9 and 19 m": [
        {"inner": {"masses": (PointMass(20.0, 5.0),)}},
    ],
    "joints[0]: 'outer' ends at 8.5 m before 'inner' starts at 9 m; the segments of a joint "
    "must overlap": [
        {"outer": {"end": 8.5}},
    ],
    "joints[0].stations: 8 m lies outside the overlap of 'outer' and 'inner'; it must be "
    "between 9 and 10 m": [
        {"joint": {"stations": (8.0, 10.0)}},
    ],
    "joints[0].stations: must rise from the base to the tip, each given once": [
        {"joint": {"stations": (10.0, 9.0)}},
        {"joint": {"stations": (9.0, 9.0 + 1e-12, 10.0)}},
    ],
    "joints[0]: 'outer' is nearer to the base than 'inner'; exchange inner and outer": [
        {"outer": {"section": None}, "inner": {"section": None}, "joint": {"outer": 1, "inner": 0}},
    ],
    "joints[0].play: 'inner' does not fit in 'outer': 0.014 m of height and 0.0399939 m of "
    "width are free, and a play of 0.028 m is asked for; make the inner section or the play "
    "smaller": [
        {"joint": {"play": 0.028}},
    ],
    "joints[0].normal_forces: missing, and the joint has friction; give normal_forces, one "
    "in N for each station, since a flat boom has no lateral contact forces": [
        {"joint": {"friction": 0.2}},
    ],
    "joints[0].normal_forces: must have one number for each of the 2 stations, got 3": [
        {"joint": {"friction": 0.2, "normal_forces": (1.0, 2.0, 3.0)}},
    ],
    "segments[0].lateral: missing; with lateral play the segments bend along y and twist": [
        {"joint": {"lateral_play": 0.002}},
    ],
    "joints[0].locked_at: 11 m is no place at which 'inner' is locked in 'outer'; it must be "
    "between 0 and 10 m": [
        {"joint": {"locked_at": 11.0}},
    ],
    "segments[1].name: 'outer' is the name of another segment already; give each its own": [
        {"inner": {"name": "outer"}},
    ],
    "segments[1].section: does not mirror itself in y, and would bend sideways under its weight": [
        {"inner": {"section": BoxSection(0.45, 0.25, 0.006, 0.006, left_web=0.005)}},
    ],
}  # fmt: skip


@pytest.mark.parametrize(
    ("line", "changes"), [(line, each) for line, several in FAULTS.items() for each in several]
)
def test_bad_booms_are_refused(paper_boom: Boom, line: str, changes: Changes) -> None:
    names = ("outer", "inner", "joint")
    parts = zip((*paper_boom.segments, *paper_boom.joints), names, strict=True)
    *segments, joint = (replace(part, **changes.get(name, {})) for part, name in parts)
    with pytest.raises(BoomError) as caught:
        Boom(segments, [joint])
    assert str(caught.value) == line
    assert line.startswith(f"{caught.value.where}: ")


def test_refuses_a_boom_without_segments_or_from_the_tip(paper_boom: Boom) -> None:
    (outer, inner), (joint,) = paper_boom.segments, paper_boom.joints
    for segments, joints, line in (
        ((), (), "segments: a boom needs at least one segment"),
        (
            (inner, outer),
            (replace(joint, outer=1, inner=0),),
            "segments[1].start: must start and end beyond 'inner'; give the segments from the base "
            "to the tip",
        ),
    ):
        with pytest.raises(BoomError) as caught:
            Boom(segments, joints)
        assert str(caught.value) == line


Change = Callable[[Boom], Boom]
STOP = Stop(1, 14.0, 0.002, PowerContact(1.0e9, 1.0, stiffness_below=0.0))


def with_inner(boom: Boom, section: BoxSection | None) -> Boom:
    outer, inner = boom.segments
    return replace(boom, segments=(outer, replace(inner, section=section)))


def _another_joint(boom: Boom) -> Boom:
    (joint,) = boom.joints
    last = replace(boom.segments[1], name="last", start=18.0, end=27.0, section=None)
    flat = replace(joint, outer=1, inner=2, stations=(18.0, 19.0), lateral_play=None)
    return replace(boom, segments=(*boom.segments, last), joints=(joint, flat))


FAULTS_OF_A_BOOM: dict[str, tuple[str, str, Change]] = {
    "in space without plates": (
        "segments[1].section",
        "missing; with lateral play the segments touch in corners",
        lambda boom: with_inner(boom, None),
    ),
    "in space with unequal flanges": (
        "segments[1].section",
        "does not mirror itself in z, and would twist as it bends sideways, which no model in "
        "space knows; leave lateral_play out, or make the flanges alike",
        lambda boom: with_inner(boom, BoxSection(0.45, 0.25, 0.008, 0.005, bottom_flange=0.005)),
    ),
    "in space and flat": (
        "joints[1].lateral_play",
        "missing, and another joint has it; a boom is flat or in space as a whole",
        _another_joint,
    ),
    "inner box too wide": (
        "joints[0].lateral_play",
        "'inner' does not fit in 'outer': 0.0399939 m of width are free, and a lateral play of "
        "0.042 m is asked for; make the inner section or the lateral play smaller",
        lambda boom: replace(boom, joints=(replace(boom.joints[0], lateral_play=0.042),)),
    ),
    "load outside": (
        "loads[1].x",
        "12 m lies outside 'outer'; it must be between 0 and 10 m",
        lambda boom: replace(
            boom,
            loads=(
                Load(0, "z", 5.0, None, np.ones_like),
                Load(0, "z", 5.0, 12.0, np.ones_like),
            ),
        ),
    ),
    "load out of the plane": (
        "loads[0].direction",
        "the boom is flat, and nothing moves along 'y'; give 'z', or the joints lateral_play",
        lambda boom: replace(
            boom,
            joints=(replace(boom.joints[0], lateral_play=None),),
            loads=(Load(1, "y", 5.0, None, np.ones_like),),
        ),
    ),
    "stop outside": (
        "stops[0].x",
        "20 m lies outside 'inner'; it must be between 9 and 19 m",
        lambda boom: replace(boom, stops=(replace(STOP, x=20.0),)),
    ),
    "stop where nothing moves": (
        "stops[0].x",
        "a support holds 'outer' at 2 m already; move one of them",
        lambda boom: replace(boom, stops=(replace(STOP, segment=0, x=2.0),)),
    ),
}


@pytest.mark.parametrize(
    ("where", "what", "change"), FAULTS_OF_A_BOOM.values(), ids=FAULTS_OF_A_BOOM.keys()
)
def test_bad_loads_and_booms_in_space_are_refused(
    spatial_boom: Boom, where: str, what: str, change: Change
) -> None:
    with pytest.raises(BoomError) as caught:
        change(spatial_boom)
    assert (caught.value.where, caught.value.what) == (where, what)


def test_a_clamped_segment_is_held_by_itself(paper_boom: Boom) -> None:
    outer, inner = paper_boom.segments
    clamped = replace(outer, supports=(Support(0.0, "clamped"),))
    Boom((clamped, inner), paper_boom.joints)
    # A stop may be where a support gives way.
    soft = replace(outer, supports=(Support(0.0), Support(2.0, stiffness=1.0e6)))
    Boom((soft, inner), paper_boom.joints, stops=(replace(STOP, segment=0, x=2.0),))


def test_a_chain_is_held_from_either_end(steel: Material, paper_boom: Boom) -> None:
    """Supports on the last segment are as sufficient as supports on the first one."""
    outer, inner = (replace(s, section=None, supports=()) for s in paper_boom.segments)
    (joint,) = paper_boom.joints
    last = replace(
        inner, name="last", start=18.0, end=27.0, supports=(Support(26.0), Support(27.0))
    )
    second = replace(joint, outer=1, inner=2, stations=(18.0, 19.0))
    Boom((outer, inner, last), (joint, second))


POSITIVE = "greater than 0, got 0.0"
BEAM: dict[str, Any] = {
    "name": "arm", "start": 0.0, "end": 1.0, "material": Material(2.1e11, 0.3, 7850.0),
    "mass_per_length": 1.0, "second_moment_of_area": 1.0, "rotary_inertia": 0.0,
}  # fmt: skip
JACK: dict[str, Any] = {"segment": 0, "x": 4.0, "ground": (1.0, -2.0), "stiffness": 1.0e7}


@pytest.mark.parametrize(
    ("part", "fields", "key", "message"),
    [
        (Support, {"x": 2.0, "stiffness": -5.0}, "stiffness", "greater than 0, got -5.0"),
        (Support, {"x": 2.0, "dashpot": -1.0}, "dashpot", "not less than 0, got -1.0"),
        (Support, {"x": 0.0, "rotation_stiffness": 0.0}, "rotation_stiffness", POSITIVE),
        (PointMass, {"x": 19.0, "mass": 0.0}, "mass", POSITIVE),
        (Collar, {"span": (1.0, 2.0), "thickness": 0.0}, "thickness", POSITIVE),
        (Cylinder, JACK | {"dashpot": -1.0}, "dashpot", "not less than 0, got -1.0"),
        (Cylinder, JACK | {"stiffness": 0.0}, "stiffness", POSITIVE),
        (Pad, {"length": 0.0, "width": 0.1}, "length", POSITIVE),
        (Segment, BEAM | {"mass_per_length": 0.0}, "mass_per_length", POSITIVE),
    ],
)
def test_impossible_numbers_are_refused(
    part: type, fields: dict[str, Any], key: str, message: str
) -> None:
    with pytest.raises(BoomError) as error:
        part(**fields)
    assert str(error.value) == f"{part.__name__}.{key}: must be a number {message}"


# Wrong calls of Python, by their messages. Each ignored error is the mistake that is tested, which
# type checkers find, too.
SLIPS: dict[str, Callable[[], object]] = {
    "Cylinder.ground: missing; give ground=… by name; it is the other end in m, which does not "
    "luff: { front, below }, its distances in front of and below the foot pin in earth axes; or "
    "[x, height above the axis] in the axes of the boom at the luffing angle gravity.angle of the "
    "case": lambda: Cylinder(0, 4.0, 0.3, (1.0, -4.3), 5e7),  # type: ignore[call-arg,misc,arg-type]
    "Cylinder.stiff: unknown; known are segment, x, depth, ground, stiffness, dashpot, spread, "
    "capacity, closed, open, bore, rod, pressure, oil_modulus, pin": lambda: Cylinder(
        **JACK, stiff=1.0
    ),
    "Cylinder.ground: must be two numbers, x and z in m, got 3.0": lambda: Cylinder(
        **JACK | {"ground": 3.0}
    ),
    "Material: takes 5 values by position, youngs_modulus, poissons_ratio, density, "
    "yield_strength, yield_by_thickness; give others by name": lambda: Material(
        2e11,
        0.3,
        7850.0,
        3e8,
        (),
        1.0,  # type: ignore[call-arg]
    ),
    "Material: has yield_strength and yield_by_thickness; give one of them": lambda: Material(
        2e11, 0.3, 7850.0, 3e8, ((0.01, 3e8),)
    ),
    "Support.x: must be a number of m, 'tail', 'head' or a distance in m from one of them such as "
    "Distance(tail=0.2), got 'tip'": lambda: Support("tip"),  # type: ignore[arg-type]
    "Support.kind: must be 'pinned', 'hinged' or 'clamped', got 'free'": lambda: Support(
        0.0,
        "free",  # type: ignore[arg-type]
    ),
    "Diaphragm.thickness: must be a finite number, got inf": lambda: Diaphragm(1.0, float("inf")),
    "Observation.name: must be made of Latin letters, digits, blanks and . _ + -, starting with a "
    "letter or a digit, got 'a/b'": lambda: Observation("a/b", 0, 1.0),
    "SlidePad.thickness: missing; give thickness=… by name; it is the thickness in m, which "
    "determines the stiffness": lambda: SlidePad(**{"length": 0.1, "width": 0.1, "side": "above"}),
    "Joint.contact: must be a contact law such as PowerContact(1e9, exponent=1.0), got 'x'": (
        lambda: Joint(0, 1, (1.0,), 0.0, "x")
    ),
    "Stop.contact: must be a contact law such as PowerContact(1e9, exponent=1.0), got None": (
        lambda: Stop(0, 1.0, 0.0, None)
    ),
    "Joint.pad.width: missing": lambda: Joint(
        0,
        1,
        (1.0,),
        0.0,
        pad={"length": 0.1},  # type: ignore[arg-type]
    ),
    "Load.direction: must be 'z' or 'y', got 'x'": lambda: Load(0, "x", 1.0, None, Step()),  # type: ignore[arg-type]
    "Load.history: must be a history such as Step(), got 2.0": lambda: Load(0, "z", 1.0, None, 2.0),
    "Thrust.force: must be a number, got '1 kN'": lambda: Thrust(0, 1.0, "1 kN"),  # type: ignore[arg-type]
    "Segment.section: must be a section such as BoxSection(height=0.4, width=0.3, flange=0.01, "
    "web=0.01), got 'box'": lambda: Segment(**BEAM | {"section": "box"}),
    "Segment.material: must be a Material, got None": lambda: Segment(**BEAM | {"material": None}),
    "segments[0]: must be a Segment, got 'arm'": lambda: Boom(["arm"]),  # type: ignore[list-item]
    "height must be a positive number of m, got 0.4 m": lambda: BoxSection(
        "0.4 m", 1.0, 0.01, 0.01
    ),  # type: ignore[arg-type]
    "stiffness must be a number of N/m^n, not negative, got 1e9 N/m": lambda: PowerContact(
        "1e9 N/m"  # type: ignore[arg-type]
    ),
    "exponent must be at least 1, got linear": lambda: PowerContact(1e9, "linear"),  # type: ignore[arg-type]
}


@pytest.mark.parametrize("message", SLIPS)
def test_slips_in_python_are_told_in_one_line(message: str) -> None:
    with pytest.raises(ValueError, match=rf"^{re.escape(message)}$"):
        SLIPS[message]()


def test_a_boom_finds_the_places_of_its_parts(paper_boom: Boom) -> None:
    outer, inner = paper_boom.segments
    # Fields are typed as they are in a boom, with x in m; a user may give other places before.
    arm = replace(
        outer,
        supports=(Support("tail"), Support(2.0)),  # type: ignore[arg-type] # see above
        collars=(Collar((Distance(head=0.5), "head"), 0.01),),  # type: ignore[arg-type] # see above
    )
    stop = Stop("inner", Distance(head=1.0), 0.002, PowerContact(1.0e9))  # type: ignore[arg-type] # see above
    boom = Boom((arm, inner), paper_boom.joints, stops=(stop,))
    assert boom.segments[0].supports == (Support(0.0), Support(2.0))
    assert boom.segments[0].collars[0].span == (9.5, 10.0)
    assert (boom.stops[0].segment, boom.stops[0].x) == (1, 18.0)


def test_numbers_and_lists_in_texts() -> None:
    """Reference: by hand, without hyphens."""
    assert with_minus_signs("-1.5") == "\N{MINUS SIGN}1.5"
    assert [join_words("abc"[:count]) for count in (1, 2, 3)] == ["a", "a and b", "a, b and c"]


@pytest.mark.parametrize(
    ("value", "text"),
    [(1234.0, "1230"), (99.96, "100"), (-12.34, "−12.3"), (0.001, "0.001"), (2e-5, "2 × 10⁻⁵")],
)
def test_a_number_has_three_significant_digits(value: float, text: str) -> None:
    """Reference: by hand."""
    assert number(value) == text
