# SPDX-License-Identifier: LGPL-3.0-or-later
"""Support reactions against hand calculations and balance."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from beam_model.statics import NodeReaction, net_reactions, static_state
from dynamics.contact import PowerContact
from dynamics.excitation import Ramp, Step
from geometry.boom import Boom, Cylinder, Load, PointMass, Segment, Support
from geometry.load import Moment, PartialLoad
from tests.touching import touching

LAW = PowerContact(1.0e9, 1.0).behind(7.0e-3)


def test_reactions_of_supports_and_stations_follow_the_lever_rule(paper_boom: Boom) -> None:
    """Reference: by hand. 550.7 N upwards at 14 m on 9 and 10 m, all with 831.6 N at 5 m on 0 and 2
    m."""
    head = 550.7 * (14.0 - 9.0) / (10.0 - 9.0)
    tail = 550.7 - head
    far = -(831.6 * 5.0 + tail * 9.0 + head * 10.0) / 2.0
    near = -831.6 - 550.7 - far
    expected = [
        NodeReaction(0, 0.0, near, 0.0),
        NodeReaction(0, 2.0, far, 0.0),
        NodeReaction(0, 9.0, tail, 0.0),
        NodeReaction(0, 10.0, head, 0.0),
        NodeReaction(1, 9.0, -tail, 0.0),
        NodeReaction(1, 10.0, -head, 0.0),
    ]
    found = static_state(touching(paper_boom, LAW))
    assert [(reaction.segment, reaction.x) for reaction in found.reactions] == [
        h[:2] for h in expected
    ]
    np.testing.assert_allclose(
        [h.force for h in found.reactions], [h[2] for h in expected], rtol=1e-5
    )
    assert np.abs([h.moment for h in found.reactions]).max() < 1e-3


def test_transferred_loads_are_counted_once(paper_boom: Boom) -> None:
    """Reference: by hand, as above with the support at the inner segment's tail, 9 m."""
    outer, inner = paper_boom.segments
    moved = replace(outer, supports=(Support(0.0), Support(9.0)))
    boom = replace(paper_boom, segments=(moved, inner))
    head = 550.7 * (14.0 - 9.0) / (10.0 - 9.0)
    far = -(831.6 * 5.0 + 550.7 * 14.0) / 9.0
    reactions = net_reactions(boom, static_state(touching(boom, LAW)).reactions)
    found = {reaction[:2]: reaction.force for reaction in reactions}
    assert found == {
        (0, 0.0): pytest.approx(-831.6 - 550.7 - far),
        (0, 9.0): pytest.approx(far),
        (0, 10.0): pytest.approx(0.0, abs=0.1),
        (1, 9.0): pytest.approx(head - 550.7, rel=1e-5),
        (1, 10.0): pytest.approx(-head, rel=1e-5),
    }


def test_the_tip_turns_by_the_play(paper_boom: Boom) -> None:
    """Reference: by hand. The play of 7 mm each way at 1 m lifts the tip by 7 + 14 · 9 mm."""
    stiff = replace(paper_boom.segments[0].material, youngs_modulus=2.1e14)
    segments = tuple(replace(segment, material=stiff) for segment in paper_boom.segments)
    hard = PowerContact(1.0e12, 1.0).behind(7.0e-3)
    found = static_state(touching(replace(paper_boom, segments=segments), hard))
    assert found.tip == pytest.approx(0.007 + 0.014 * 9.0, rel=1e-3)


def test_a_clamp_bears_force_and_moment(beam: Callable[..., Segment]) -> None:
    """Reference: by hand, all kinds of loads on a cantilever from 3 to 8 m."""
    segment = beam(supports=[Support(3.0, "clamped")], load=-100.0, masses=(PointMass(8.0, 50.0),))
    loads = (
        Load(0, "z", -2000.0, 8.0, Step()),
        PartialLoad(0, "z", -300.0, None, Step(), span=(5.0, 7.0)),
        Moment(0, "z", 400.0, 6.0, Step()),
        Load(0, "z", -1.0e6, 8.0, Ramp(1.0)),
    )
    (reaction,) = static_state(Boom((segment,), (), loads)).reactions
    assert reaction.force == pytest.approx(500.0 + 2000.0 + 600.0)
    assert reaction.moment == pytest.approx(500.0 * 2.5 + 2000.0 * 5.0 + 600.0 * 3.0 - 400.0)


def test_three_supports_bear_by_their_stiffness(beam: Callable[..., Segment]) -> None:
    """Reference: analytic, the middle of two equal spans bears 5/4 q L of a slender beam."""
    segment = replace(beam(supports=[3.0, 5.5, 8.0], load=-100.0), section=None)
    forces = [reaction.force for reaction in static_state(Boom((segment,), ())).reactions]
    span = 2.5 * 100.0
    assert forces == pytest.approx([0.375 * span, 1.25 * span, 0.375 * span])


def test_cylinder_carries_the_moment_about_the_hinge(beam: Callable[..., Segment]) -> None:
    """Reference: by hand. 500 N at 2.5 m from the hinge on an upright cylinder 2 m from it."""
    segment = beam(supports=[3.0], load=-100.0)
    jack = Cylinder(0, 5.0, depth=0.3, ground=(5.0, -2.0), stiffness=1.0e7)
    hinge, lug = static_state(Boom((segment,), (), cylinders=(jack,))).reactions
    assert (hinge.x, lug.x) == (3.0, 5.0)
    assert lug.force == pytest.approx(500.0 * 2.5 / 2.0, rel=1e-5)
    assert hinge.force == pytest.approx(500.0 - lug.force, rel=1e-5)
