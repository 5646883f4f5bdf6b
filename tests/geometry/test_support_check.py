# SPDX-License-Identifier: LGPL-3.0-or-later
"""Supported and unsupported booms, and loads on stops. Reference: statics by hand."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import Ramp, ReleasedLoad, Step
from protractile.geometry.boom import (
    Boom,
    BoomError,
    Collar,
    Cylinder,
    Load,
    Material,
    Segment,
    Stop,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.observation import Observation
from protractile.geometry.support_check import check_contacts_at_rest
from tests.touching import in_space

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
