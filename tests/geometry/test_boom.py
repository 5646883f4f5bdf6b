# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms and their parts, their fields, and numbers in messages."""

import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import PiecewiseLinear, Ramp, ReleasedLoad, Step
from protractile.dynamics.motion_laws import SCurve
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
    PointMass,
    Segment,
    SlidePad,
    Stop,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.joint import Drive
from protractile.geometry.observation import Observation
from protractile.geometry.place import Distance
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.support_check import check_contacts_at_rest
from protractile.geometry.typography import join_words, number, with_minus_signs
from tests.touching import in_space

CLAMP, HINGE, ACROSS = Support(0.0, "clamped"), Support(0.0), Support(0.0, "hinged")


def changed(
    boom: Boom, outer: Any = None, inner: Any = None, joint: Any = None, **fields: Any
) -> Boom:
    """Return a boom of two segments with changes of its parts, and of its own fields."""
    (first, second), (tie,) = boom.segments, boom.joints
    segments = replace(first, **outer or {}), replace(second, **inner or {})
    return replace(boom, segments=segments, joints=(replace(tie, **joint or {}),), **fields)


def test_numbers_of_a_segment(steel: Material, paper_boom: Boom) -> None:
    """Reference: analytic, by hand; a collar of 0.5 m around the walls, a lid of 8 mm within."""
    outer, inner = paper_boom.segments
    assert outer.material.shear_modulus == pytest.approx(2.1e11 / 2.6, rel=1e-14)
    assert outer.bending_stiffness == pytest.approx(7.97706e7, rel=1e-14)
    assert (outer.rigid_modes, inner.rigid_modes) == (0, 2)
    assert (outer.rigid_twists, inner.rigid_twists) == (0, 1)
    for supports, expected in (
        ((Support(2.0),), 1),
        (tuple(map(Support, (0.0, 2.0, 10.0))), 0),
        ((CLAMP,), 0),
        ((Support(0.0, stiffness=1.0e6),), 1),
    ):
        assert replace(outer, supports=supports).rigid_modes == expected
    held = [inner.holds(x) for x in (9.0, 19.0, 9.0 - 1e-10, 9.0 - 1e-8, 19.0 + 1e-8)]
    assert held == [True, True, True, False, False]
    box = BoxSection(0.4, 0.3, 0.01, 0.01)
    collars, lids = (Collar((1.0, 1.5), 0.012),), (Diaphragm(2.0, 0.008),)
    arm = Segment.of_section("arm", 0.0, 3.0, steel, box, collars=collars, diaphragms=lids)
    volume = box.area * 3.0 + 1.4 * 0.5 * 0.012 + 0.4 * 0.3 * 0.008
    assert arm.mass == pytest.approx(7850.0 * volume, rel=1e-12)
    # A segment turned has its planes exchanged, and its hinge turned.
    hinged = in_space(replace(outer, supports=(ACROSS,))).turned()
    assert hinged.supports[0].holds_slope("z")
    assert hinged.rigid_modes == 0


STOP = Stop(1, 14.0, 0.002, PowerContact(1.0e9, 1.0, stiffness_below=0.0))


def test_places(paper_boom: Boom, spatial_boom: Boom) -> None:
    """Stations are ordered by joints along z, joints along y, stops; nodes are at all forces."""
    outer, inner = paper_boom.segments
    (joint,) = paper_boom.joints
    assert (paper_boom.tip, paper_boom.spatial) == (19.0, False)
    assert paper_boom.observed == {"tip": (1, 19.0), "head": (0, 10.0), "tail": (1, 9.0)}
    last = replace(inner, name="last", start=17.5, end=27.0, section=None)
    second = replace(joint, outer=1, inner=2, stations=(17.5, 19.0))
    boom = Boom((outer, inner, last), (joint, second))
    assert [boom.stations_of(k) for k in (1, 2)] == [(9.0, 10.0, 17.5, 19.0), (17.5, 19.0)]
    assert boom.observed == {
        "tip": (2, 27.0), "head": (0, 10.0), "tail": (1, 9.0), "head-2": (1, 19.0),
        "tail-2": (2, 17.5),
    }  # fmt: skip
    loads = (Load(0, "z", 5.0, 4.0, np.ones_like), Load(0, "z", 5.0, None, np.ones_like))
    heavy = replace(inner, masses=(PointMass(19.0, 80.0),))
    boom = Boom((outer, heavy), (joint,), loads, (STOP,))
    assert [boom.stations_of(k) for k in (0, 1)] == [(4.0, 9.0, 10.0), (9.0, 10.0, 14.0, 19.0)]
    both = replace(spatial_boom, stops=(STOP,))
    assert [(one.name, one.place, one.stop) for one in both.stations] == [
        ("9", 0, None), ("10", 1, None), ("9y", 0, None), ("10y", 1, None), ("14", 0, STOP)
    ]  # fmt: skip
    bonded = changed(paper_boom, joint={"bonded": True}, stops=(STOP,))
    assert [station.name for station in bonded.stations] == ["14"]
    assert bonded.stations_of(0) == (9.0, 10.0)
    # Fields are typed as they are in a boom, with x in m; a user may give other places before.
    tail: Any = "tail"
    near_head: Any = Distance(head=0.5)
    before_head: Any = Distance(head=1.0)
    arm: dict[str, Any] = {
        "supports": (Support(tail), Support(2.0)),
        "collars": (Collar((near_head, "head"), 0.01),),
    }
    stop = Stop("inner", before_head, 0.002, PowerContact(1.0e9))
    boom = changed(paper_boom, arm, stops=(stop,))
    assert boom.segments[0].supports == (Support(0.0), Support(2.0))
    assert boom.segments[0].collars[0].span == (9.5, 10.0)
    assert (boom.stops[0].segment, boom.stops[0].x) == (1, 18.0)


JACK = Cylinder(0, x=4.0, depth=0.3, ground=(1.0, -2.0), stiffness=1.0e7)
# Holds from below what is pressed down, from above what is pressed up.
BELOW = Stop(0, 6.0, 0.02, PowerContact(0.0, 1.0, stiffness_below=1.0e7))
ABOVE = replace(BELOW, contact=PowerContact(1.0e7, 1.0).upper())
BOTH = replace(BELOW, contact=PowerContact(1.0e7, 1.0))
TWO = {"supports": (HINGE, Support(2.0))}
SPRING = replace(HINGE, rotation_stiffness=1e6)


def on(*supports: Support) -> dict[str, Any]:
    return {"supports": supports}


def driven(travel: float, start: float = 5.0, least: float = 0.0, **joint: Any) -> dict[str, Any]:
    """Return the changes by which the inner segment has its tail at a start in m, and a drive."""
    drive = Drive(SCurve(travel, 5.0), ("inner", "outer"), least)
    inner = {"start": start, "end": start + 10.0}
    return {"inner": inner, "joint": {"stations": (start, 10.0), "drive": drive, **joint}}


# A fold at the bottom, flats elsewhere.
FOLDED = PolygonSection(
    ((0, -0.22), (0.11, -0.18), (0.11, 0.2), (-0.11, 0.2), (-0.11, -0.18)), (0.005,) * 5
)
OCTAGONS = (
    {"section": octagon(0.50, 0.32, 0.05, *(0.006,) * 3)},
    {"section": octagon(0.45, 0.25, 0.05, *(0.005,) * 3)},
)
HEXAGONS = (
    {"section": hexagon(0.5, 0.5, 0.3, *(0.006,) * 3)},
    {"section": hexagon(0.40, 0.40, 0.24, *(0.005,) * 3)},
)
ONE_WAY = {"joint": {"stations": (9.5,)}}

HELD: dict[str, dict[str, Any]] = {
    "by a clamp": {"outer": on(CLAMP)},
    "at its end": {"outer": on(), "inner": on(Support(18.0), Support(19.0))},
    "by a cylinder": {"outer": on(HINGE), "cylinders": (JACK,)},
    "by a spring against rotation": {"outer": on(SPRING)},
    "by a stop both ways": {"outer": on(HINGE), "stops": (BOTH,)},
    # Its own loads press up.
    "by a stop that is pressed": {"outer": on(HINGE), "stops": (ABOVE,)},
    "by two stops that are pressed": {"outer": on(), "stops": (ABOVE, replace(ABOVE, x=9.0))},
    "by a stop that a force presses": {
        "outer": on(HINGE), "stops": (BELOW,), "loads": (Load(1, "z", -1e5, 19.0, Step()),)
    },
    "by a station and a stop": ONE_WAY | {"stops": (replace(BOTH, segment=1, x=18.0),)},
    "with a stop where a support gives way": {
        "outer": on(HINGE, Support(2.0, stiffness=1.0e6)), "stops": (replace(BOTH, x=2.0),)
    },
    "in contact on octagons": {"outer": OCTAGONS[0], "inner": OCTAGONS[1]},
    "in contact on hexagons": {"outer": HEXAGONS[0], "inner": HEXAGONS[1]},
    "sideways by a hinge": {"spatial": True, "outer": on(ACROSS), "cylinders": (JACK,)},
    "sideways by cylinders": {
        "spatial": True, "outer": on(HINGE), "cylinders": (replace(JACK, spread=1.0),)
    },
    "in space on octagons": {"spatial": True, "outer": OCTAGONS[0], "inner": OCTAGONS[1]},
}  # fmt: skip


@pytest.mark.parametrize("case", HELD)
def test_a_boom_is_held(paper_boom: Boom, spatial_boom: Boom, case: str) -> None:
    """Reference: by hand, what holds a boom; supports at its end are as good as at its foot."""
    changes = dict(HELD[case])
    boom = spatial_boom if changes.pop("spatial", False) else paper_boom
    check_contacts_at_rest(changed(boom, **changes))


def test_an_unloaded_stop_gives_no_support(steel: Material, paper_boom: Boom) -> None:
    """Reference: by hand. About the hinge at 4 m, the moment of the part beyond it is 75.36 kg/m ·
    10 m · 1 m = 754 kg m. A collar of 7850 kg/m³ · 1.4 m · 1 m · 30 mm at 3.5 m has 1154 kg m.
    """
    passing = Load(1, "z", -1e5, 19.0, Ramp(1.0)), Load(1, "z", -1e5, 19.0, ReleasedLoad())
    for loads in ((), passing):
        lifted = changed(paper_boom, on(HINGE), stops=(BELOW,), loads=loads)
        with pytest.raises(BoomError) as caught:
            check_contacts_at_rest(lifted)
        assert str(caught.value) == (
            "segments[0]: the loads at t = 0 lift 'outer' off its one-way supports, and nothing "
            "else holds it: give it two supports, or a stop that holds both ways"
        )
    box = BoxSection(height=0.4, width=0.3, flange=0.008, web=0.006)
    arm = Segment.of_section("arm", 0.0, 10.0, steel, box, supports=(Support(4.0),))
    weight = Load(0, "z", -9.81 * arm.mass_per_length, None, Step(), inertial=True)
    rest = (replace(BELOW, x=0.0),)
    pressed = replace(arm, collars=(Collar((0.0, 1.0), 0.03),))
    check_contacts_at_rest(Boom((pressed,), (), (weight,), rest))
    with pytest.raises(BoomError, match="the loads at t = 0 lift 'arm'"):
        check_contacts_at_rest(Boom((arm,), (), (weight,), rest))


# Changes that a flat boom refuses, or one in space, by the line that each of them earns.
LOOSE = (
    "nothing holds '{}': give it two supports, a hinge and a cylinder whose line passes beside it, "
    "or a joint with two stations to a segment that is held"
)
FLAT: dict[str, dict[str, Any]] = {
    "segments[0].supports: 10.5 m lies outside 'outer'; it must be between 0 and 10 m":
        {"outer": on(HINGE, Support(10.5))},
    "segments[0].supports: two are within 0.001 m of one another; give one, or move them farther "
    "apart": {"outer": on(Support(2.0), Support(2.0 + 1e-5))},
    "segments[0].supports: a clamped support is rigid, and the one at 2 m has a stiffness; leave "
    "it out, or make the support pinned": {"outer": on(HINGE, Support(2.0, "clamped", 1e6))},
    "segments[0].supports: a clamped support holds the slope, and the one at 0 m has a "
    "rotation_stiffness; leave it out, or make the support pinned":
        {"outer": on(replace(CLAMP, rotation_stiffness=1e6))},
    "segments[0].supports: a hinge is rigid, and the one at 0 m has a stiffness; leave it out, or "
    "make the support pinned": {"outer": on(replace(ACROSS, stiffness=1e6), Support(2.0))},
    "segments[0].supports: the support at 2 m is rigid, and its dashpot would never move; leave it "
    "out, or give the support a stiffness": {"outer": on(HINGE, Support(2.0, dashpot=1e3))},
    "segments[0].supports[1].depth: of no use: only the first support of a segment has a depth, "
    "under a cylinder or axial forces; leave it out":
        {"outer": on(HINGE, Support(2.0, depth=0.1)), "cylinders": (JACK,)},
    "segments[0].supports[0].depth: of no use: only the first support of a segment has a depth, "
    "under a cylinder or axial forces; leave it out":
        {"outer": on(replace(HINGE, depth=0.1), Support(2.0))},
    "joints[0]: 'outer' ends at 8.5 m before 'inner' starts at 9 m; the segments of a joint must "
    "overlap": {"outer": {"end": 8.5}},
    "joints[0].stations: 8 m lies outside the overlap of 'outer' and 'inner'; it must be between 9 "
    "and 10 m": {"joint": {"stations": (8.0, 10.0)}},
    "joints[0].stations: must rise from the base to the tip, each given once":
        {"joint": {"stations": (9.0, 9.0 + 1e-12, 10.0)}},
    "joints[0]: 'outer' is nearer to the base than 'inner'; exchange inner and outer":
        {"outer": {"section": None}, "inner": {"section": None}, "joint": {"outer": 1, "inner": 0}},
    "joints[0].play: 'inner' does not fit in 'outer': 0.014 m of height and 0.0399939 m of width "
    "are free, and a play of 0.028 m is asked for; make the inner section or the play smaller":
        {"joint": {"play": 0.028}},
    "joints[0].normal_forces: missing, and the joint has friction; give normal_forces, one in N "
    "for each station, since a flat boom has no lateral contact forces":
        {"joint": {"friction": 0.2}},
    "segments[0].lateral: missing; with lateral play the segments bend along y and twist":
        {"joint": {"lateral_play": 0.002}},
    "joints[0].locked_at: 11 m is no place at which 'inner' is locked in 'outer'; it must be "
    "between 0 and 10 m": {"joint": {"locked_at": 11.0}},
    "joints[0].dashpot: the joint is bonded, and nothing moves; leave it out":
        {"joint": {"bonded": True, "dashpot": 1.0}},
    "segments[1].name: 'outer' is the name of another segment already; give each its own":
        {"inner": {"name": "outer"}},
    "segments[1].section: does not mirror itself in y, and would bend sideways under its weight":
        {"inner": {"section": BoxSection(0.45, 0.25, 0.006, 0.006, left_web=0.005)}},
    "segments[1].section: has no single plate at right angles to z at its bottom, where the boom "
    "touches it; folds and inclined plates cannot be touched, give it a flat there":
        {"outer": OCTAGONS[0], "inner": {"section": FOLDED}, "joint": {"bonded": True},
         "stops": (replace(BOTH, segment=1, x=15.0, play=0.2),)},
    "segments[1].section: its bottom is 0.176569 m wide, and that of 'outer', which it touches, "
    "0.0796737 m; make it narrower":
        {"outer": {"section": u_section(0.50, 0.32, 0.15, 3, 0.006, 0.006, 0.006)},
         "inner": {"section": u_section(0.30, 0.20, 0.02, 1, 0.005, 0.005, 0.005)}},
    "segments[0].head_section: has other shapes than the one at the tail; a segment tapers "
    "between sections of one kind": {"outer": {"head_section": OCTAGONS[0]["section"]}},
    "segments[0].head_section: a segment tapers from a section; give section, at its tail":
        {"outer": {"head_section": BoxSection(0.4, 0.3, 0.01, 0.01), "section": None}},
    f"segments[0]: {LOOSE.format('outer')}":
        {"outer": on(replace(HINGE, stiffness=1e6)), "stops": (replace(BOTH, x=0.0),)},
    f"segments[0]: {LOOSE.format('outer')} ": # by a cylinder through its hinge
        {"outer": on(replace(HINGE, depth=-0.1)), "cylinders": (replace(JACK, ground=(1.0, 0.0)),)},
    f"segments[1]: {LOOSE.format('inner')}": ONE_WAY,
    "cylinders[0].x: 12 m lies outside 'outer'; it must be between 0 and 10 m":
        {"outer": on(HINGE), "cylinders": (replace(JACK, x=12.0),)},
    "cylinders[0].ground: must be another point than the lug; give x and z in m":
        {"outer": on(HINGE), "cylinders": (replace(JACK, ground=(4.0, -0.3)),)},
    "cylinders[0].spread: the boom is flat, and nothing turns about its axis; leave it out, or "
    "give the joints lateral_play":
        {"outer": on(HINGE), "cylinders": (replace(JACK, spread=1.0),)},
    "observations[0].name: 'cylinder_force' is the name of another output already; give it its own":
        {"outer": on(HINGE), "cylinders": (JACK,),
         "observations": (Observation("cylinder_force", 0, 5.0),)},
    "joints[0].drive: extends 'inner' by 4.5 m until 0.5 m of overlap are left; it must leave at "
    "least 1 m": driven(4.5, least=1.0),
    "joints[0].drive: extends 'inner' by 5 m until 0 m of overlap are left; it must leave above 0 "
    "m": driven(5.0),
    "joints[0].drive: retracts 'inner' by 5.5 m; it must be at most 5 m, where it is wholly in "
    "'outer'": driven(-5.5),
    "joints[0].drive: does not move 'inner'; leave it out": {"joint": {
        "drive": Drive(PiecewiseLinear([0.0, 1.0], [0.0, 0.0]), ("inner", "outer"))}},
    "joints[0].drive: retracts 'inner' by 1 m, and the diaphragm of 'outer' at 4.5 m is in its "
    "way; it must be less than 0.5 m":
        driven(-1.0) | {"outer": {"diaphragms": (Diaphragm(4.5, 0.008),)}},
    "joints[0].drive: stations pass one another as 'inner' telescopes by 0.3 m; make the travel "
    "shorter, or move them": driven(0.3, 9.0, stations=(9.3, 9.5)),
    "joints[0].drive: the station at 9.5 m leaves the overlap as 'inner' telescopes by 0.6 m; make "
    "the travel shorter, or move the station": {"joint": {
        "stations": (9.5, 10.0), "drive": Drive(SCurve(0.6, 1.0), ("outer", "outer"))}},
    "stops[0].x: 'inner' moves past 6 m; it must be there over the whole travel":
        driven(4.0) | {"stops": (replace(BOTH, segment=1, x=6.0, play=0.2),)},
    "segments[1].supports: the ground holds 'inner', which a drive moves along; let it hold a "
    "segment that stays, or leave drive out":
        {"inner": driven(4.0)["inner"] | on(Support(12.0)), "joint": driven(4.0)["joint"]},
}  # fmt: skip
SPATIAL: dict[str, dict[str, Any]] = {
    "segments[1].section: missing; with lateral play the segments touch in corners":
        {"inner": {"section": None}},
    "segments[1].section: does not mirror itself in z, and would twist as it bends sideways, which "
    "no model in space knows; leave lateral_play out, or make the flanges alike":
        {"inner": {"section": BoxSection(0.45, 0.25, 0.008, 0.005, bottom_flange=0.005)}},
    "joints[0].lateral_play: 'inner' does not fit in 'outer': 0.0399939 m of width are free, and a "
    "lateral play of 0.042 m is asked for; make the inner section or the lateral play smaller":
        {"joint": {"lateral_play": 0.042}},
    "segments[0]: nothing holds 'outer' sideways: give it two supports, one that is hinged or "
    "clamped, or a joint with two stations to a segment that is held":
        {"outer": on(HINGE), "cylinders": (JACK,)},
    "loads[1].x: 12 m lies outside 'outer'; it must be between 0 and 10 m":
        {"loads": (Load(0, "z", 5.0, None, np.ones_like), Load(0, "z", 5.0, 12.0, np.ones_like))},
    "stops[0].x: a support holds 'outer' at 2 m already; move one of them":
        {"stops": (replace(STOP, segment=0, x=2.0),)},
}  # fmt: skip


@pytest.mark.parametrize(
    ("spatial", "line"), [*((False, line) for line in FLAT), *((True, line) for line in SPATIAL)]
)
def test_a_wrong_boom_is_refused(
    paper_boom: Boom, spatial_boom: Boom, spatial: bool, line: str
) -> None:
    with pytest.raises(BoomError) as caught:
        changed(spatial_boom if spatial else paper_boom, **(SPATIAL if spatial else FLAT)[line])
    assert str(caught.value) == line.rstrip()


def test_wrong_chains_are_refused(paper_boom: Boom, spatial_boom: Boom) -> None:
    (outer, inner), (joint,) = paper_boom.segments, paper_boom.joints
    last = replace(spatial_boom.segments[1], name="last", start=18.0, end=27.0, section=None)
    flat = replace(joint, outer=1, inner=2, stations=(18.0, 19.0))
    for segments, joints, line in (
        ((), (), "segments: a boom needs at least one segment"),
        ((inner, outer), (replace(joint, outer=1, inner=0),),
         "segments[1].start: must start and end beyond 'inner'; give the segments from the base "
         "to the tip"),
        ((*spatial_boom.segments, last), (*spatial_boom.joints, flat),
         "joints[1].lateral_play: missing, and another joint has it; a boom is flat or in space "
         "as a whole"),
    ):  # fmt: skip
        with pytest.raises(BoomError) as caught:
            Boom(segments, joints)
        assert str(caught.value) == line


BEAM: dict[str, Any] = {
    "name": "arm", "start": 0.0, "end": 1.0, "material": Material(2.1e11, 0.3, 7850.0),
    "mass_per_length": 1.0, "second_moment_of_area": 1.0, "rotary_inertia": 0.0,
}  # fmt: skip
GIVEN: dict[str, Any] = {"segment": 0, "x": 4.0, "ground": (1.0, -2.0), "stiffness": 1.0e7}
PADDED: dict[str, Any] = {"length": 0.1, "width": 0.1, "side": "above"}
LAW = "must be a contact law such as PowerContact(1e9, exponent=1.0), got"

# Wrong calls of Python, by their messages, with mistakes that type checkers find, too.
SLIPS: dict[str, tuple[Callable[..., object], tuple[Any, ...], dict[str, Any]]] = {
    "Support.stiffness: must be a number greater than 0, got -5.0":
        (Support, (2.0,), {"stiffness": -5.0}),
    "Support.dashpot: must be a number not less than 0, got -1.0":
        (Support, (2.0,), {"dashpot": -1.0}),
    "Cylinder.ground: missing; give ground=… by name; it is the other end in m, which does not "
    "luff: { front, below }, its distances in front of and below the foot pin in earth axes; or "
    "[x, height above the axis] in the axes of the boom at the luffing angle gravity.angle of the "
    "case": (Cylinder, (0, 4.0, 0.3, (1.0, -4.3), 5e7), {}),
    "Cylinder.stiff: unknown; known are segment, x, depth, ground, stiffness, dashpot, spread, "
    "capacity, closed, open, stroke, bore, rod, pressure, oil_modulus, pin":
        (Cylinder, (), GIVEN | {"stiff": 1.0}),
    "Cylinder.ground: must be two numbers, x and z in m, got 3.0":
        (Cylinder, (), GIVEN | {"ground": 3.0}),
    "Material: takes 5 values by position, youngs_modulus, poissons_ratio, density, "
    "yield_strength, yield_by_thickness; give others by name":
        (Material, (2e11, 0.3, 7850.0, 3e8, (), 1.0), {}),
    "Material: has yield_strength and yield_by_thickness; give one of them":
        (Material, (2e11, 0.3, 7850.0, 3e8, ((0.01, 3e8),)), {}),
    "SlidePad.thickness: missing; give thickness=… by name; it is the thickness in m, which "
    "determines the stiffness": (SlidePad, (), PADDED),
    f"Joint.contact: {LAW} 'x'": (Joint, (0, 1, (1.0,), 0.0, "x"), {}),
    f"Stop.contact: {LAW} None": (Stop, (0, 1.0, 0.0, None), {}),
    "Joint.pad.width: missing": (Joint, (0, 1, (1.0,), 0.0), {"pad": {"length": 0.1}}),
    "Load.direction: must be 'z' or 'y', got 'x'": (Load, (0, "x", 1.0, None, Step()), {}),
    "Load.history: must be a history such as Step(), got 2.0": (Load, (0, "z", 1.0, None, 2.0), {}),
    "Thrust.force: must be a number, got '1 kN'": (Thrust, (0, 1.0, "1 kN"), {}),
    "Segment.section: must be a section such as BoxSection(height=0.4, width=0.3, flange=0.01, "
    "web=0.01), got 'box'": (Segment, (), BEAM | {"section": "box"}),
    "Segment.material: must be a Material, got None": (Segment, (), BEAM | {"material": None}),
    "segments[0]: must be a Segment, got 'arm'": (Boom, (["arm"],), {}),
    "stiffness must be a number of N/m^n, not negative, got 1e9 N/m":
        (PowerContact, ("1e9 N/m",), {}),
    "exponent must be at least 1, got linear": (PowerContact, (1e9, "linear"), {}),
}  # fmt: skip


@pytest.mark.parametrize("message", SLIPS)
def test_slips_in_python_are_told_in_one_line(message: str) -> None:
    make, values, named = SLIPS[message]
    with pytest.raises(ValueError, match=rf"^{re.escape(message)}$"):
        make(*values, **named)


def test_numbers_and_lists_in_texts() -> None:
    """Reference: by hand, without hyphens; a number has three significant digits."""
    assert with_minus_signs("-1.5") == "\N{MINUS SIGN}1.5"
    assert [join_words("abc"[:count]) for count in (1, 2, 3)] == ["a", "a and b", "a, b and c"]
    found = [number(value) for value in (1234.0, 99.96, -12.34, 0.001, 2e-5)]
    assert found == ["1230", "100", "−12.3", "0.001", "2 × 10⁻⁵"]
