# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reactions and section forces of beams at rest, kept models, and the lead of a hoist rope."""

from collections.abc import Callable
from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from scipy.optimize import brentq

from protractile.beam_model.boom_modes import BoomModes, critical_factor
from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments
from protractile.beam_model.lines import lines, lines_of_modes
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.static_model import StaticModel
from protractile.beam_model.statics import Elements, loaded_system, static_state
from protractile.beam_model.wall_compliance import station_compliance
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_stiffness
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.stability import closing_loads
from protractile.geometry.axial import Lead, Thrust, with_compression
from protractile.geometry.boom import (
    Boom,
    Cylinder,
    Joint,
    Load,
    Material,
    Pad,
    PointMass,
    Segment,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.compression import NO_COMPRESSION
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
    # 550.7 N at 14 m: M = 55.07 · 9²/2 N m at 10 m, V jumps 2753.5 N.
    models = finite_element_segments(paper_boom, 0.25, "euler-bernoulli", False)
    system = gap_system(touching(paper_boom, LAW), models)
    inner = lines(paper_boom, models)[1]
    read = inner.read(equilibrium(system, system.load))
    at_head = inner.x == 10.0
    assert read["moment"][at_head] == pytest.approx(-55.07 * 81.0 / 2.0, rel=2e-4)
    before, behind = read["shear"][at_head]
    assert behind - before == pytest.approx(2753.5, rel=1e-4)


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


STEEL = Material(2.1e11, 0.3, 7850.0)
FOOT = Support(0.0, "hinged", depth=0.2)


def crane(
    angle: float, mass: float = 300.0, thrust: float = 2.0e4, lateral: float | None = None
) -> Boom:
    """Return a luffed boom of two boxes on a cylinder, under its weight and a payload."""
    outer, inner = BoxSection(0.50, 0.40, 0.010, 0.008), BoxSection(0.45, 0.35, 0.008, 0.006)
    along, across = 9.81 * np.sin(radians(angle)), 9.81 * np.cos(radians(angle))
    segments = (
        Segment.of_section("base", 0.0, 8.0, STEEL, outer, supports=(FOOT,), load=-800.0 * across),
        Segment.of_section(
            "fly", 6.0, 14.0, STEEL, inner, load=-50.0 * across, masses=(PointMass(14.0, mass),)
        ),
    )
    if lateral is None:
        segments = tuple(replace(one, lateral=None) for one in segments)
    pad = Pad(length=0.1, width=0.08, thickness=0.02, modulus=2e9)
    joint = Joint(0, 1, (6.0, 8.0), 0.010, pad=pad, lateral_play=lateral)
    jack = Cylinder(0, 3.0, 0.4, ground=(1.0, -2.0), stiffness=5e7)
    jack = jack.on_earth(0.0, FOOT).in_boom_axes(radians(angle), FOOT)
    if lateral is not None:
        jack = replace(jack, spread=0.5)
    compressed = with_compression(segments, (joint,), [Thrust(1, 14.0, thrust)], along)
    loads = [Load(1, "z", -mass * across, 14.0, Step())]
    return Boom(compressed, (joint,), loads, cylinders=(jack,))


# The stiffness of a cylinder follows from its data and its length.
DATA = {"closed": 2.3, "open": 4.5, "bore": 0.2, "rod": 0.14, "pressure": 2.5e7}
CRANES: dict[str, Boom] = {
    "heavier": crane(60.0, mass=900.0, thrust=5.0e4),
    "unloaded": crane(30.0, mass=300.0, thrust=0.0),
    "with a lead": replace(crane(50.0), leads=(Lead(1, 14.0, 2.0e4, -2.0),)),
    **{
        f"on a cylinder at {angle:g}": replace(
            crane(angle), cylinders=(replace(crane(angle).cylinders[0], stiffness=None, **DATA),)
        )
        for angle in (10.0, 60.0)
    },
    "in space": crane(45.0, lateral=0.006),
}


@pytest.mark.parametrize("name", CRANES)
def test_a_kept_model_has_the_states_of_a_new_one(name: str) -> None:
    """Reference: other code, modes of the boom with its masses and axial forces, which have a
    round-off of 1e-8; buckling by groups of bonded components in their own unknowns.
    """
    boom = CRANES[name]
    modes = BoomModes(boom, Elements(boom, 20).segments)
    system = loaded_system(boom, modes)
    kept, lines = StaticModel.of(boom).loaded(boom)
    position, other = (equilibrium(one, one.load) for one in (kept, system))
    for output, observer in system.observers.items():
        expected = observer.row @ other
        size = 1e-7 * np.linalg.norm(observer.row) * np.linalg.norm(other)
        assert kept.observers[output].row @ position == pytest.approx(expected, rel=1e-7, abs=size)
    for line, reference in zip(lines, lines_of_modes(boom, modes), strict=True):
        forces, expected_forces = line.read(position), reference.read(other)
        # Lateral forces without a lateral load are the round-off of those in the plane.
        round_off = 1e-13 * np.abs(expected_forces["moment"]).max()
        for quantity, values in expected_forces.items():
            near = 1e-7 * np.abs(values).max() + round_off
            np.testing.assert_allclose(forces[quantity], values, rtol=1e-7, atol=near)
    plain = [replace(one, compression=NO_COMPRESSION) for one in boom.segments]
    unloaded = replace(boom, segments=plain, leads=())
    system = loaded_system(unloaded, BoomModes(unloaded, Elements(unloaded, 20).segments))
    models = Elements(boom, 20).segments
    factors = []
    for load in closing_loads(system, system.load):
        stiffness = closed_stiffness(system, equilibrium(system, load))
        factors.append(critical_factor(boom, models, station_compliance(boom, stiffness)))
    smallest = min(factor for factor in factors if factor is not None)
    assert StaticModel.of(boom).critical_factor(boom) == pytest.approx(smallest, rel=1e-7)


BOX = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
LENGTH = 10.0
STIFFNESS = STEEL.youngs_modulus * BOX.second_moment_of_area


def pole(force: float, winch: float, load: float = 0.0) -> Boom:
    """Return a clamped pole with the lead of a rope; ``winch`` is its distance behind the foot."""
    clamp = (Support(0.0, "clamped"),)
    whole = Segment.of_section("pole", 0.0, LENGTH, STEEL, BOX, supports=clamp)
    segments = with_compression([whole], [], [Thrust(0, LENGTH, force)])
    lead = Lead(0, LENGTH, force, -winch)
    return Boom(segments, (), (Load(0, "z", load, LENGTH, Step()),), leads=(lead,))


@pytest.mark.parametrize("winch", [0.0, 1.5])
def test_pole_with_a_guided_rope_buckles_at_the_force_of_the_closed_form(winch: float) -> None:
    """Reference: analytic, tan k L = −k c for a force through a point c behind the clamped foot.

    Without c it is k L = π: four times the force of a dead load.
    """
    root = pi
    if winch:
        root = brentq(lambda k: np.sin(k) + k * winch / LENGTH * np.cos(k), 0.5 * pi + 1e-9, pi)
    expected = STIFFNESS * (root / LENGTH) ** 2
    boom = pole(1000.0, winch)
    models = finite_element_segments(boom, 0.25, "euler-bernoulli", False)
    factor = critical_factor(boom, models)
    assert factor is not None
    assert 1000.0 * factor == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("winch", [0.0, 2.0])
def test_deflected_pole_is_in_equilibrium_with_the_rope_that_follows_it(winch: float) -> None:
    """Reference: analytic, an own beam-column with a follower pair.

    From E J w″ = S (w_L − w) − V (L − x) with V = S w_L/(L + c) − F, it is
    w_L = F (tan λ − λ)/(k S) / (1 − (L − tan λ/k)/(L + c)), λ = k L.
    """
    force, load = 0.6 * STIFFNESS * (pi / LENGTH) ** 2, 500.0
    k = np.sqrt(force / STIFFNESS)
    tangent = np.tan(k * LENGTH)
    # Flexibility of the tip to a transverse force under a dead axial force, Timoshenko and Gere.
    flexibility = (tangent - k * LENGTH) / (k * force)
    expected = load * flexibility / (1.0 + flexibility * force / (LENGTH + winch))
    boom = pole(force, winch, load)
    system = gap_system(boom, finite_element_segments(boom, 0.25, "euler-bernoulli", False))
    loaded = system.gather_loads().at_time(0.0)
    tip = float(system.observers["tip"].row @ equilibrium(loaded, loaded.load_at(0.0)))
    assert tip == pytest.approx(expected, rel=1e-4)
