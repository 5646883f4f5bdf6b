# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plates of a section, their clearances and contact faces, and supported and unsupported booms."""

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import Ramp, ReleasedLoad, Step
from protractile.geometry.boom import (
    Boom,
    BoomError,
    Collar,
    Cylinder,
    Joint,
    Load,
    Material,
    Segment,
    SlidePad,
    Stop,
    Support,
)
from protractile.geometry.box import BoxSection, infer_inner_section
from protractile.geometry.joint import PadSide
from protractile.geometry.observation import Observation
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import Section
from protractile.geometry.support_check import check_contacts_at_rest
from protractile.geometry.walls import free_room, trapezoids
from tests.geometry.test_polygon import HEXAGON, offset_corners
from tests.touching import in_space


def test_plates_meet_at_the_corners_of_their_surfaces() -> None:
    """Reference: analytic. Trapezoids of a box have its outer and inner corners."""
    walls = trapezoids(BoxSection(0.6, 0.4, flange=0.04, web=0.01).plates)
    outside = [(-0.205, -0.32), (0.205, -0.32), (0.205, 0.32), (-0.205, 0.32)]
    hole = [(-0.195, -0.28), (0.195, -0.28), (0.195, 0.28), (-0.195, 0.28)]
    assert walls[:, 0] == pytest.approx(np.array(outside), rel=1e-12)
    assert walls[:, 3] == pytest.approx(np.array(hole), rel=1e-12)


def test_room_of_boxes() -> None:
    """Reference: analytic, a box with outer sizes 0.52 x 0.34 m in a hole of 0.58 x 0.38 m."""
    outer, inner = BoxSection(0.6, 0.4, 0.02, 0.02), BoxSection(0.5, 0.33, 0.02, 0.01)
    assert free_room(outer, inner) == pytest.approx((0.06, 0.04), rel=1e-12)
    assert free_room(outer, inner, 0.05) == pytest.approx((0.06, 0.04), rel=1e-12)


def _smaller(section: Section, clear: float) -> PolygonSection:
    """Return the section with plates inside the given ones by a gap of ``clear`` in m."""
    walls = np.array([plate.thickness for plate in section.plates])
    corners = offset_corners(section, -walls - clear)
    return PolygonSection(tuple((y, z) for y, z in corners.tolist()), tuple(walls))


def test_room_between_inclined_plates() -> None:
    """Reference: analytic. In a hexagon with a uniform gap g, the flat plates leave 2 g along z,
    less than the 2 g/n_z of inclined plates. Along y inclined plates leave 2 g/n_y. If the section
    is at one end of its play along z, this decreases by n_z times half the play.
    """
    inner, gap = _smaller(HEXAGON, 0.01), 0.01
    n_y, n_z = HEXAGON.plates[1].tangent[1], -HEXAGON.plates[1].tangent[0]
    height, width = free_room(HEXAGON, inner)
    assert height == pytest.approx(2.0 * gap, rel=1e-9)
    assert width == pytest.approx(2.0 * gap / n_y, rel=1e-9)
    _, pressed = free_room(HEXAGON, inner, 0.5 * gap)
    assert pressed == pytest.approx(2.0 * (gap - 0.25 * gap * abs(n_z)) / n_y, rel=1e-9)


def test_inclined_plates_stand_in_the_way() -> None:
    """Reference: analytic. The corners of a box in an octagon touch the chamfers first."""
    outer = octagon(0.5, 0.4, 0.1, 0.01, 0.01, 0.01)
    box = BoxSection(0.28, 0.28, 0.01, 0.01)
    # Chamfers are at |y| + |z| = 0.35 − 0.01/√2 within, the box's corner at (0.145, 0.145).
    room = 0.35 - 0.01 / np.sqrt(2.0) - 2.0 * 0.145
    assert free_room(outer, box)[0] == pytest.approx(2.0 * room, rel=1e-9)
    assert free_room(outer, replace(box, height=0.4))[0] < 0.0


def _in(boom: Boom, outer: Section, inner: Section) -> Boom:
    first, second = boom.segments
    return replace(boom, segments=(replace(first, section=outer), replace(second, section=inner)))


def test_contact_sections_need_flat_faces(paper_boom: Boom, spatial_boom: Boom) -> None:
    inner = octagon(0.45, 0.25, 0.05, 0.005, 0.005, 0.005)
    outer = octagon(0.50, 0.32, 0.05, 0.006, 0.006, 0.006)
    for boom in (paper_boom, spatial_boom):
        assert _in(boom, outer, inner).segments[0].section is outer
    beside = hexagon(0.5, 0.5, 0.3, 0.006, 0.006, 0.006)
    within = hexagon(0.40, 0.40, 0.24, 0.005, 0.005, 0.005)
    assert _in(paper_boom, beside, within).segments[0].section is beside
    message = (
        "segments[0].section: has no single plate at right angles to y at its right, where the "
        "boom touches it; folds and inclined plates cannot be touched, give it a flat there"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        _in(spatial_boom, beside, within)
    folded = PolygonSection(
        ((0, -0.22), (0.11, -0.18), (0.11, 0.2), (-0.11, 0.2), (-0.11, -0.18)), (0.005,) * 5
    )
    message = (
        "segments[1].section: has no single plate at right angles to z at its bottom, where the "
        "boom touches it; folds and inclined plates cannot be touched, give it a flat there"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        _in(paper_boom, outer, folded)
    joint = replace(paper_boom.joints[0], bonded=True)
    bonded = _in(replace(paper_boom, joints=(joint,)), outer, folded)
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        replace(bonded, stops=(Stop(1, 15.0, 0.2, PowerContact(1e7, 1.0, stiffness_below=1e7)),))


def test_a_flat_lies_on_one_as_wide(paper_boom: Boom) -> None:
    outer = u_section(0.50, 0.32, 0.15, 3, 0.006, 0.006, 0.006)
    inner = u_section(0.30, 0.20, 0.02, 1, 0.005, 0.005, 0.005)
    message = (
        "segments[1].section: its bottom is 0.176569 m wide, and that of 'outer', which it "
        "touches, 0.0796737 m; make it narrower"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        _in(paper_boom, outer, inner)


def test_a_box_is_inferred_in_boxes_alone() -> None:
    message = (
        "a box is inferred within a box alone, and the section around it has inclined plates; give "
        "the section explicitly"
    )
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        infer_inner_section(0.007, 2.2e-4, HEXAGON, 0.007)


BASE = BoxSection(height=0.56, width=0.26, flange=0.008, web=0.006)
FLY = BoxSection(height=0.50, width=0.20, flange=0.006, web=0.005)
# In m.
WIDTHS: Mapping[PadSide, float] = {"above": 0.05, "below": 0.05, "left": 0.15, "right": 0.15}


def padded(steel: Material, widths: Mapping[PadSide, float]) -> Boom:
    """Return a boom in space with a pad on each side of its fly."""
    held = (Support(0.0, "clamped"),)
    base = Segment.of_section("base", 0.0, 6.0, steel, BASE, supports=held)
    fly = Segment.of_section("fly", 5.0, 11.0, steel, FLY)
    pads = tuple(SlidePad(0.1, width, side=side, thickness=0.02) for side, width in widths.items())
    return Boom((base, fly), (Joint(0, 1, (5.0, 6.0), play=0.01, lateral_play=0.01, pads=pads),))


def test_pads_of_a_wall_lie_side_by_side(steel: Material) -> None:
    """Reference: by hand, a pad of 40 mm from the corner inwards, and another from 30 mm on."""
    boom = padded(steel, WIDTHS)
    (joint,) = boom.joints
    second = SlidePad(0.1, 0.03, side="above", thickness=0.02, offset=0.06)
    assert replace(boom, joints=(replace(joint, pads=(*joint.pads, second)),)).joints[0].padded
    over = replace(joint, pads=(*joint.pads, replace(second, offset=0.03)))
    with pytest.raises(BoomError) as caught:
        replace(boom, joints=(over,))
    assert (caught.value.where, caught.value.what) == (
        "joints[0].pads",
        "two lie on one another above, 0.03 m from the corner; give the outer one a width of at "
        "most 0.03 m",
    )


def test_a_pad_has_the_room_of_its_own_wall(steel: Material) -> None:
    """Half a wall of 0.5 m has room for 0.15 m, half a wall of 0.2 m does not."""
    assert padded(steel, WIDTHS).joints[0].padded
    with pytest.raises(BoomError) as caught:
        padded(steel, {**WIDTHS, "below": 0.15})
    assert caught.value.where == "joints[0].pads[1].width"
    assert caught.value.what.startswith("must be above 0 and not above half a wall of the inner")


HINGE = Support(0.0)
ACROSS = Support(0.0, "hinged")
ARM = Cylinder(0, x=4.0, depth=0.3, ground=(1.0, -2.0), stiffness=1.0e7)
# Holds from below what is pressed down, from above what is pressed up.
BELOW = Stop(0, 6.0, 0.02, PowerContact(0.0, 1.0, stiffness_below=1.0e7))
ABOVE = replace(BELOW, contact=PowerContact(1.0e7, 1.0).upper())
BOTH = replace(BELOW, contact=PowerContact(1.0e7, 1.0))


def held(boom: Boom, *supports: Support, stations: tuple[float, ...] = (), **others: Any) -> Boom:
    """Return the boom with other supports, and optionally other stations."""
    outer, inner = boom.segments
    (joint,) = boom.joints
    joint = replace(joint, stations=stations or joint.stations)
    return replace(
        boom, segments=(replace(outer, supports=supports), inner), joints=(joint,), **others
    )


HELD: Mapping[str, Mapping[str, Any]] = {
    "by a cylinder": {"supports": [HINGE], "cylinders": (ARM,)},
    "by a spring against rotation": {"supports": [replace(HINGE, rotation_stiffness=1e6)]},
    "by a stop both ways": {"supports": [HINGE], "stops": (BOTH,)},
    # Its own loads press up.
    "by a stop that is pressed": {"supports": [HINGE], "stops": (ABOVE,)},
    "by two stops that are pressed": {"supports": [], "stops": (ABOVE, replace(ABOVE, x=9.0))},
    "by a stop that a force presses": {
        "supports": [HINGE],
        "stops": (BELOW,),
        "loads": (Load(1, "z", -1e5, 19.0, Step()),),
    },
    # The inner segment by one station and its own stop.
    "by a station and a stop": {
        "supports": [HINGE, Support(2.0)],
        "stations": (9.5,),
        "stops": (replace(BOTH, segment=1, x=18.0),),
    },
}


@pytest.mark.parametrize("case", HELD.values(), ids=HELD.keys())
def test_a_boom_is_held(paper_boom: Boom, case: Mapping[str, Any]) -> None:
    others = {key: value for key, value in case.items() if key != "supports"}
    check_contacts_at_rest(held(paper_boom, *case["supports"], **others))


LIFTED = (
    "the loads at t = 0 lift 'outer' off its one-way supports, and nothing else holds it: give it "
    "two supports, or a stop that holds both ways"
)
LOOSE = (
    "nothing holds '{}': give it two supports, a hinge and a cylinder whose line passes beside it, "
    "or a joint with two stations to a segment that is held"
)
PASSING = Load(1, "z", -1e5, 19.0, Ramp(1.0)), Load(1, "z", -1e5, 19.0, ReleasedLoad())


@pytest.mark.parametrize("loads", [(), PASSING], ids=["none", "none that lasts"])
def test_unloaded_stop_gives_no_support(paper_boom: Boom, loads: tuple[Load, ...]) -> None:
    lifted = held(paper_boom, HINGE, stops=(BELOW,), loads=loads)
    with pytest.raises(BoomError) as caught:
        check_contacts_at_rest(lifted)
    assert (caught.value.where, caught.value.what) == ("segments[0]", LIFTED)


def test_a_collar_presses_a_stop_by_its_weight(steel: Material) -> None:
    """Reference: by hand. About the hinge at 4 m, the moment of the part beyond it is
    75.36 kg/m · 10 m · 1 m = 754 kg m. A collar of 7850 kg/m³ · 1.4 m · 1 m · 30 mm with the lever
    arm 3.5 m has 1154 kg m.
    """
    box = BoxSection(height=0.4, width=0.3, flange=0.008, web=0.006)
    assert steel.density * box.area == pytest.approx(75.36)
    arm = Segment.of_section("arm", 0.0, 10.0, steel, box, supports=(Support(4.0),))
    weight = Load(0, "z", -9.81 * arm.mass_per_length, None, Step(), inertial=True)
    rest = replace(BELOW, x=0.0)
    check_contacts_at_rest(
        Boom((replace(arm, collars=(Collar((0.0, 1.0), 0.03),)),), (), (weight,), (rest,))
    )
    with pytest.raises(BoomError, match="the loads at t = 0 lift 'arm'"):
        check_contacts_at_rest(Boom((arm,), (), (weight,), (rest,)))


UNHELD: Mapping[str, tuple[str, str, Mapping[str, Any]]] = {
    "by a stop at its hinge": (
        "segments[0]",
        LOOSE.format("outer"),
        {"supports": [replace(HINGE, stiffness=1e6)], "stops": (replace(BOTH, x=0.0),)},
    ),
    "by a cylinder through its hinge": (
        "segments[0]",
        LOOSE.format("outer"),
        {
            "supports": [replace(HINGE, depth=-0.1)],
            "cylinders": (replace(ARM, x=4.0, depth=0.3, ground=(1.0, 0.0)),),
        },
    ),
    "by one station": (
        "segments[1]",
        LOOSE.format("inner"),
        {"supports": [HINGE, Support(2.0)], "stations": (9.5,)},
    ),
}


@pytest.mark.parametrize(("where", "what", "case"), UNHELD.values(), ids=UNHELD.keys())
def test_a_boom_is_not_held(
    paper_boom: Boom, where: str, what: str, case: Mapping[str, Any]
) -> None:
    others = {key: value for key, value in case.items() if key != "supports"}
    with pytest.raises(BoomError) as caught:
        held(paper_boom, *case["supports"], **others)
    assert (caught.value.where, caught.value.what) == (where, what)


def test_in_space_a_boom_is_held_sideways_too(spatial_boom: Boom) -> None:
    """A pin permits lateral rotation; a hinge and a pair of cylinders prevent it."""
    pair = replace(ARM, spread=1.0)
    assert held(spatial_boom, ACROSS, cylinders=(ARM,))
    assert held(spatial_boom, HINGE, cylinders=(pair,))
    with pytest.raises(BoomError) as caught:
        held(spatial_boom, HINGE, cylinders=(ARM,))
    assert (caught.value.where, caught.value.what) == (
        "segments[0]",
        "nothing holds 'outer' sideways: give it two supports, one that is hinged or clamped, or a "
        "joint with two stations to a segment that is held",
    )


FAULTS: Mapping[str, tuple[str, str, list[Support], Mapping[str, Any]]] = {
    "lug beside the segment": (
        "cylinders[0].x", "12 m lies outside 'outer'; it must be between 0 and 10 m", [HINGE],
        {"cylinders": (replace(ARM, x=12.0),)},
    ),
    "no length": (
        "cylinders[0].ground", "must be another point than the lug; give x and z in m", [HINGE],
        {"cylinders": (replace(ARM, ground=(4.0, -0.3)),)},
    ),
    "an output of a cylinder's name": (
        "observations[0].name",
        "'cylinder_force' is the name of another output already; give it its own", [HINGE],
        {"cylinders": (ARM,), "observations": (Observation("cylinder_force", 0, 5.0),)},
    ),
    "two side by side in a flat boom": (
        "cylinders[0].spread",
        "the boom is flat, and nothing turns about its axis; leave it out, or give the joints "
        "lateral_play",
        [HINGE],
        {"cylinders": (replace(ARM, spread=1.0),)},
    ),
    "a depth that nothing reads": (
        "segments[0].supports[1].depth",
        "of no use: only the first support of a segment has a depth, under a cylinder or axial "
        "forces; leave it out",
        [HINGE, Support(2.0, depth=0.1)],
        {"cylinders": (ARM,)},
    ),
    "a depth under nothing": (
        "segments[0].supports[0].depth",
        "of no use: only the first support of a segment has a depth, under a cylinder or axial "
        "forces; leave it out",
        [replace(HINGE, depth=0.1), Support(2.0)],
        {},
    ),
    "a soft clamp against rotation": (
        "segments[0].supports",
        "a clamped support holds the slope, and the one at 0 m has a rotation_stiffness; leave it "
        "out, or make the support pinned",
        [Support(0.0, "clamped", rotation_stiffness=1e6)],
        {},
    ),
    "a soft hinge": (
        "segments[0].supports",
        "a hinge is rigid, and the one at 0 m has a stiffness; leave it out, or make the support "
        "pinned",
        [replace(ACROSS, stiffness=1e6), Support(2.0)],
        {},
    ),
    "a dashpot that never moves": (
        "segments[0].supports",
        "the support at 2 m is rigid, and its dashpot would never move; leave it out, or give the "
        "support a stiffness",
        [HINGE, Support(2.0, dashpot=1e3)],
        {},
    ),
}  # fmt: skip


@pytest.mark.parametrize(
    ("where", "what", "supports", "others"), FAULTS.values(), ids=FAULTS.keys()
)
def test_insufficient_supports_are_refused(
    paper_boom: Boom, where: str, what: str, supports: list[Support], others: Mapping[str, Any]
) -> None:
    with pytest.raises(BoomError) as caught:
        held(paper_boom, *supports, **others)
    assert (caught.value.where, caught.value.what) == (where, what)


def test_a_turned_segment_has_its_hinge_turned(paper_boom: Boom) -> None:
    segment: Segment = in_space(replace(paper_boom.segments[0], supports=(ACROSS,)))
    (support,) = segment.turned().supports
    assert support.holds_slope("z")
    assert segment.turned().rigid_modes == 0
