# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reactions and section forces of beams at rest."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments, rigid_segment
from protractile.beam_model.lines import lines
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import static_state
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Load, Support
from studies.reference_models.statics import static_response
from tests.beam_model.exact import beam
from tests.touching import touching

LAW = PowerContact(1.0e9, 1.0).with_clearance(7.0e-3)


def test_reactions_of_supports_and_stations_follow_the_lever_rule(paper_boom: Boom) -> None:
    """Reference: by hand. The inner segment has 550.7 N upwards at 14 m on stations at 9 and 10 m;
    the boom also has 831.6 N at 5 m, on supports at 0 and 2 m.
    """
    head = 550.7 * (14.0 - 9.0) / (10.0 - 9.0)
    tail = 550.7 - head
    far = -(831.6 * 5.0 + tail * 9.0 + head * 10.0) / 2.0
    near = -831.6 - 550.7 - far
    expected = {
        (0, 0.0): near, (0, 2.0): far, (0, 9.0): 0.0, (0, 10.0): 0.0,
        (1, 9.0): -tail, (1, 10.0): -head,
    }  # fmt: skip
    found = static_state(touching(paper_boom, LAW)).reactions
    forces = {reaction[:2]: reaction.force for reaction in found}
    assert forces == pytest.approx(expected, rel=1e-5, abs=1e-3)
    assert np.abs([reaction.moment for reaction in found]).max() < 1e-3


def test_transferred_loads_are_counted_once(paper_boom: Boom) -> None:
    """Reference: by hand, as above, with the support at the tail of the inner segment, 9 m."""
    outer, inner = paper_boom.segments
    moved = replace(outer, supports=(Support(0.0), Support(9.0)))
    boom = replace(paper_boom, segments=(moved, inner))
    head = 550.7 * (14.0 - 9.0) / (10.0 - 9.0)
    far = -(831.6 * 5.0 + 550.7 * 14.0) / 9.0
    reactions = static_state(touching(boom, LAW)).reactions
    found = {reaction[:2]: reaction.force for reaction in reactions}
    assert found == {
        (0, 0.0): pytest.approx(-831.6 - 550.7 - far),
        (0, 9.0): pytest.approx(far),
        (0, 10.0): pytest.approx(0.0, abs=0.1),
        (1, 9.0): pytest.approx(head - 550.7, rel=1e-5),
        (1, 10.0): pytest.approx(-head, rel=1e-5),
    }


def test_the_tip_turns_by_the_play(paper_boom: Boom) -> None:
    """Reference: by hand. Plays of 7 mm on both sides, 1 m apart, lift the tip by 7 + 14 · 9 mm."""
    stiff = replace(paper_boom.segments[0].material, youngs_modulus=2.1e14)
    segments = tuple(replace(segment, material=stiff) for segment in paper_boom.segments)
    hard = PowerContact(1.0e12, 1.0).with_clearance(7.0e-3)
    found = static_state(touching(replace(paper_boom, segments=segments), hard))
    assert found.tip == pytest.approx(0.007 + 0.014 * 9.0, rel=1e-3)


MODELS: dict[str, Callable[[Boom], list[SegmentModel]]] = {
    "euler": lambda boom: finite_element_segments(boom, 0.25, "euler-bernoulli", False),
    "timoshenko": lambda boom: finite_element_segments(boom, 0.25, "timoshenko", False),
    "series": lambda boom: kantorovich_segments(boom, [12], "complete", False),
}


@pytest.mark.parametrize("kind", MODELS)
def test_a_cantilever_bends_as_its_loads_ask(kind: str) -> None:
    """Reference: by hand. −100 N/m and −2000 N: M = 2000 s + 50 s², V = −2000 − 100 s."""
    segment = beam(supports=[Support(3.0, "clamped")], load=-100.0)
    boom = Boom((segment,), (), (Load(0, "z", -2000.0, 8.0, Step()),))
    models = MODELS[kind](boom)
    system = gap_system(boom.bonded, models).gather_loads()
    (line,) = lines(boom, models)
    found = line.read(equilibrium(system, system.load))
    s = 8.0 - line.x
    np.testing.assert_allclose(found["moment"], 2000.0 * s + 50.0 * s**2, atol=1.0)
    np.testing.assert_allclose(found["shear"], -2000.0 - 100.0 * s, rtol=1e-4)
    assert found["deflection"][-1] == pytest.approx(
        system.observers["tip"].row @ equilibrium(system, system.load)
    )


@pytest.mark.parametrize("kind", MODELS)
def test_section_forces_of_a_column_refer_to_the_straight_axis(kind: str) -> None:
    """Reference: by hand. A column of 5 m has −500 N/m, −44,049 N and half of Euler's force P,
    which adds P w to M. The mean slope of M is 5 to 9 % above V at the clamp, and twice the load at
    the tip.
    """
    free = beam(supports=[Support(3.0, "clamped")], load=-500.0)
    force = 0.5 * np.pi**2 * free.bending_stiffness / (4.0 * 5.0**2)
    pressed = with_compression([free], [], [Thrust(0, 8.0, force)])
    boom = Boom(pressed, (), (Load(0, "z", -44049.0, 8.0, Step()),))
    models = MODELS[kind](boom)
    system = gap_system(boom.bonded, models).gather_loads()
    (line,) = lines(boom, models)
    found = line.read(static_response(system, system.load))
    s = 8.0 - line.x
    np.testing.assert_allclose(found["shear"], -44049.0 - 500.0 * s, rtol=3e-4)
    sunk = found["deflection"] - found["deflection"][-1]
    expected = 44049.0 * s + 250.0 * s**2 + force * sunk
    np.testing.assert_allclose(found["moment"], expected, rtol=2e-3, atol=100.0)


def test_joint_with_play_transfers_forces_of_the_lever_rule(paper_boom: Boom) -> None:
    """Reference: by hand, 550.7 N at 14 m: M = 55.07 · 9²/2 N m at 10 m, V jumps 2753.5 N."""
    models = finite_element_segments(paper_boom, 0.25, "euler-bernoulli", False)
    system = gap_system(touching(paper_boom, PowerContact(1e9, 1.0).with_clearance(7e-3)), models)
    inner = lines(paper_boom, models)[1]
    found = inner.read(equilibrium(system, system.load))
    head = inner.x == 10.0
    assert found["moment"][head] == pytest.approx(-55.07 * 81.0 / 2.0, rel=2e-4)
    before, behind = found["shear"][head]
    assert behind - before == pytest.approx(2753.5, rel=1e-4)


def test_a_boom_in_space_bends_sideways_and_twists(spatial_boom: Boom) -> None:
    """Reference: by hand. 300 N at 19 m along y cause −300 (19 − x) in the inner segment."""
    load = Load(1, "y", 300.0, 19.0, Step())
    boom = replace(spatial_boom.bonded, loads=(load,))
    models = finite_element_segments(boom, 0.5, "timoshenko", True)
    system = gap_system(boom.bonded, models).gather_loads()
    inner = lines(boom, models)[1]
    found = inner.read(equilibrium(system, system.load))
    outside = inner.x > 10.0
    np.testing.assert_allclose(
        found["lateral_moment"][outside], -300.0 * (19.0 - inner.x[outside]), atol=1e-3
    )
    np.testing.assert_allclose(found["lateral_shear"][outside], 300.0, rtol=1e-6)
    np.testing.assert_allclose(found["torque"], 0.0, atol=1e-6)


def test_rigid_segments_have_no_section_forces() -> None:
    segment = beam(supports=[Support(3.0, stiffness=1e6), Support(6.0, stiffness=1e6)])
    boom = Boom((segment,), ())
    (line,) = lines(boom, [rigid_segment(segment)])
    assert list(line.rows) == ["deflection"]
