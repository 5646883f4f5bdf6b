# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statics of beams: reactions, section forces, cylinders, ropes, kept models; buckling."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from math import pi, radians

import numpy as np
import pytest
from scipy.optimize import brentq

from protractile.beam_model.boom_modes import (
    BoomModes,
    ContactPlace,
    StationCompliance,
    critical_factor,
)
from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import Theory, finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments, rigid_segment
from protractile.beam_model.lines import lines, lines_of_modes
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.static_model import StaticModel, estimate_critical_factor
from protractile.beam_model.statics import Elements, loaded_system, static_state
from protractile.beam_model.wall_compliance import station_compliance
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_stiffness
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.stability import closing_loads
from protractile.geometry.arrays import Array
from protractile.geometry.axial import Lead, Thrust, with_compression
from protractile.geometry.boom import Boom, Cylinder, Joint, Load, Pad, PointMass, Segment, Support
from protractile.geometry.compression import NO_COMPRESSION
from protractile.geometry.profiles import octagon
from studies.reference_models.statics import static_response
from tests.beam_model.exact import BUILDS, Build, beam
from tests.booms import ARM, FLY, PAD, STEEL
from tests.touching import in_space, level, raised, touching

LAW = PowerContact(1.0e9, 1.0).with_clearance(7.0e-3)
Models = Sequence[SegmentModel]


def elements(boom: Boom, theory: Theory = "euler-bernoulli") -> tuple[GapSystem, Models]:
    """Return the system of a boom under its loads, and its elements of 0.25 m."""
    models = finite_element_segments(boom, 0.25, theory, rotary_inertia=False)
    return gap_system(boom, models).gather_loads(), models


@pytest.mark.parametrize("second", [2.0, 9.0], ids=["apart", "at the tail of the inner segment"])
def test_reactions_of_supports_and_stations_follow_the_lever_rule(
    paper_boom: Boom, second: float
) -> None:
    """Reference: by hand, 550.7 N at 14 m on 9 and 10 m; also 831.6 N at 5 m on the supports."""
    outer, inner = paper_boom.segments
    outer = replace(outer, supports=(Support(0.0), Support(second)))
    boom = touching(replace(paper_boom, segments=(outer, inner)), LAW)
    head = 550.7 * (14.0 - 9.0) / (10.0 - 9.0)
    far = -(831.6 * 5.0 + 550.7 * 14.0) / second
    expected = {(0, 0.0): -831.6 - 550.7 - far, (0, 9.0): 0.0, (0, 10.0): 0.0, (0, second): far}
    expected |= {(1, 9.0): head - 550.7, (1, 10.0): -head}
    found = static_state(boom).reactions
    forces = {reaction[:2]: reaction.force for reaction in found}
    assert forces == pytest.approx(expected, rel=1e-5, abs=1e-3)
    assert np.abs([reaction.moment for reaction in found]).max() < 1e-3
    # The moment of 9 m of load at 10 m, where the shear force jumps.
    system, models = elements(boom)
    line = lines(boom, models)[1]
    read, at_head = line.read(equilibrium(system, system.load)), line.x == 10.0
    assert read["moment"][at_head] == pytest.approx(-55.07 * 81.0 / 2.0, rel=2e-4)
    before, behind = read["shear"][at_head]
    assert behind - before == pytest.approx(head, rel=1e-4)


def test_the_tip_turns_by_the_play(paper_boom: Boom) -> None:
    """Reference: by hand. Plays of 7 mm on both sides, 1 m apart, lift the tip by 7 + 14 · 9 mm."""
    stiff = replace(paper_boom.segments[0].material, youngs_modulus=2.1e14)
    segments = tuple(replace(segment, material=stiff) for segment in paper_boom.segments)
    hard = PowerContact(1.0e12, 1.0).with_clearance(7.0e-3)
    found = static_state(touching(replace(paper_boom, segments=segments), hard))
    assert found.tip == pytest.approx(0.007 + 0.014 * 9.0, rel=1e-3)


@BUILDS
def test_section_forces_of_a_column_refer_to_the_straight_axis(build: Build) -> None:
    """Reference: by hand. −500 N/m and −44,049 N, half of Euler's force P adds P w to M."""
    free = beam(supports=[Support(3.0, "clamped")], load=-500.0)
    force = 0.5 * np.pi**2 * free.bending_stiffness / (4.0 * 5.0**2)
    pressed = with_compression([free], [], [Thrust(0, 8.0, force)])
    boom = Boom(pressed, (), (Load(0, "z", -44049.0, 8.0, Step()),))
    models = build(boom)
    system = gap_system(boom.bonded, models).gather_loads()
    (line,) = lines(boom, models)
    found = line.read(static_response(system, system.load))
    s = 8.0 - line.x
    np.testing.assert_allclose(found["shear"], -44049.0 - 500.0 * s, rtol=3e-4)
    sunk = found["deflection"] - found["deflection"][-1]
    expected = 44049.0 * s + 250.0 * s**2 + force * sunk
    np.testing.assert_allclose(found["moment"], expected, rtol=2e-3, atol=100.0)


FOOT = Support(0.0, "hinged", depth=0.2)


def crane(
    angle: float, mass: float = 300.0, thrust: float = 2.0e4, lateral: float | None = None
) -> Boom:
    """Return a luffed boom of two boxes on a cylinder, under its weight and a payload."""
    along, across = 9.81 * np.sin(radians(angle)), 9.81 * np.cos(radians(angle))
    own = {"load": -50.0 * across, "masses": (PointMass(14.0, mass),)}
    segments = (
        Segment.of_section("base", 0.0, 8.0, STEEL, ARM, supports=(FOOT,), load=-800.0 * across),
        Segment.of_section("fly", 6.0, 14.0, STEEL, FLY, **own),
    )
    joint = Joint(0, 1, (6.0, 8.0), 0.010, pad=PAD, lateral_play=lateral)
    jack = Cylinder(0, 3.0, 0.4, ground=(1.0, -2.0), stiffness=5e7, spread=0.5 if lateral else 0.0)
    jack = jack.on_earth(0.0, FOOT).in_boom_axes(radians(angle), FOOT)
    compressed = with_compression(segments, (joint,), [Thrust(1, 14.0, thrust)], along)
    loads = [Load(1, "z", -mass * across, 14.0, Step())]
    return Boom(compressed, (joint,), loads, cylinders=(jack,))


# The stiffness of a cylinder follows from its data and its length.
DATA = {"closed": 2.3, "stroke": 2.2, "bore": 0.2, "rod": 0.14, "pressure": 2.5e7}
CRANES: dict[str, Boom] = {
    "heavier": crane(60.0, mass=900.0, thrust=5.0e4),
    "unloaded": crane(30.0, thrust=0.0),
    "with a lead": replace(crane(50.0), leads=(Lead(1, 14.0, 2.0e4, -2.0),)),
    "on a cylinder": replace(
        crane(60.0), cylinders=(replace(crane(60.0).cylinders[0], stiffness=None, **DATA),)
    ),
    "in space": crane(45.0, lateral=0.006),
    "on a softer cylinder": replace(
        crane(60.0), cylinders=(replace(crane(60.0).cylinders[0], stiffness=2e6),)
    ),
}


@pytest.mark.parametrize("name", CRANES)
def test_a_kept_model_has_the_states_of_a_new_one(name: str) -> None:
    """Reference: other code, modes of the boom with its masses and axial forces; 1e-8 round-off."""
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


LENGTH = 10.0
STIFFNESS = STEEL.youngs_modulus * ARM.second_moment_of_area


def pole(force: float, winch: float, load: float = 0.0) -> Boom:
    """Return a clamped pole with the lead of a rope; ``winch`` is its distance behind the foot."""
    clamp = (Support(0.0, "clamped"),)
    whole = Segment.of_section("pole", 0.0, LENGTH, STEEL, ARM, supports=clamp)
    segments = with_compression([whole], [], [Thrust(0, LENGTH, force)])
    lead = Lead(0, LENGTH, force, -winch)
    return Boom(segments, (), (Load(0, "z", load, LENGTH, Step()),), leads=(lead,))


@pytest.mark.parametrize("winch", [0.0, 1.5])
def test_pole_with_a_guided_rope_buckles_at_the_force_of_the_closed_form(winch: float) -> None:
    """Reference: analytic, tan k L = −k c for a force through c behind the foot; else k L = π."""
    root = pi
    if winch:
        root = brentq(lambda k: np.sin(k) + k * winch / LENGTH * np.cos(k), 0.5 * pi + 1e-9, pi)
    expected = STIFFNESS * (root / LENGTH) ** 2
    boom = pole(1000.0, winch)
    factor = critical_factor(boom, elements(boom)[1])
    assert factor == pytest.approx(expected / 1000.0, rel=1e-4)


@pytest.mark.parametrize("winch", [0.0, 2.0])
def test_deflected_pole_is_in_equilibrium_with_the_rope_that_follows_it(winch: float) -> None:
    """Reference: analytic, E J w″ = S (w_L − w) − V (L − x) with V = S w_L/(L + c) − F."""
    force, load = 0.6 * STIFFNESS * (pi / LENGTH) ** 2, 500.0
    k = np.sqrt(force / STIFFNESS)
    tangent = np.tan(k * LENGTH)
    # Flexibility of the tip to a transverse force under a dead axial force, Timoshenko and Gere.
    flexibility = (tangent - k * LENGTH) / (k * force)
    expected = load * flexibility / (1.0 + flexibility * force / (LENGTH + winch))
    boom = pole(force, winch, load)
    loaded = elements(boom)[0].at_time(0.0)
    tip = float(loaded.observers["tip"].row @ equilibrium(loaded, loaded.load_at(0.0)))
    assert tip == pytest.approx(expected, rel=1e-4)


UNIFORM, TIP = -2.0e3, -1.5e4
# The hinge is 0.15 m below the axis; the line rises steeply, and passes it at some distance.
HINGE = Support(3.0, depth=0.15)
CYLINDER = Cylinder(0, x=5.0, depth=0.45, ground=(3.8, -2.2), stiffness=3.0e7)


# Of the cylinder about the hinge in m.
LEVER = float(np.linalg.det([[2.0, -0.45 + 0.15], CYLINDER.direction]))


def by_hand(segment: Segment, stiffness: float, shear: bool) -> tuple[float, float]:
    """Return the cylinder force in N, positive in compression, and the tip deflection in m.

    The beam is statically determinate, and the deflection is the work on the forces of 1 N at the
    tip. ``stiffness`` is that of the cylinder in N/m; ``shear`` includes shear deflection.
    """
    length, lug = segment.length, CYLINDER.x - 3.0
    along, up = CYLINDER.direction
    # Three Gauss points on both sides of the lug are exact.
    nodes, weights = np.polynomial.legendre.leggauss(3)
    spans = ((0.0, lug), (lug, length))
    x = np.concatenate([a + 0.5 * (b - a) * (nodes + 1.0) for a, b in spans])
    dx = np.concatenate([0.5 * (b - a) * weights for a, b in spans])
    beyond = x > lug

    def forces(uniform: float, tip: float) -> tuple[float, Array, Array]:
        push = -(0.5 * uniform * length**2 + tip * length) / LEVER
        hinge = -(uniform * length + tip) - push * up
        raised = along * HINGE.depth + beyond * (up * (x - lug) - along * CYLINDER.depth)
        moment = hinge * x + 0.5 * uniform * x**2 + push * raised
        return push, moment, hinge + uniform * x + push * up * beyond

    (push, moment, across), (unit_push, unit_moment, unit_across) = (
        forces(*load) for load in ((UNIFORM, TIP), (0.0, 1.0))
    )
    moved = dx @ (moment * unit_moment) / segment.bending_stiffness + push * unit_push / stiffness
    if shear:
        area = segment.material.shear_modulus * segment.section.shear_area
        moved += dx @ (across * unit_across) / area
    return push, float(moved)


def rest(system: GapSystem) -> tuple[float, float]:
    """Return the static cylinder force in N and tip deflection in m."""
    position = equilibrium(system, system.gather_loads().load)
    force, tip = (system.observers[name].row @ position for name in ("cylinder_force", "tip"))
    return float(force), float(tip)


@pytest.mark.parametrize("stiffness", [3.0e7, 1.0e10], ids=["elastic", "stiff"])
def test_statics_of_a_luffed_beam(stiffness: float) -> None:
    """Reference: by hand, as above. Elements are exact at nodes."""
    segment = beam(supports=(HINGE,), load=UNIFORM)
    jack, tip_load = replace(CYLINDER, stiffness=stiffness), Load(0, "z", TIP, 8.0, Step())
    boom = Boom((segment,), (), (tip_load,), cylinders=(jack,))
    for theory in ("timoshenko", "euler-bernoulli"):
        models = finite_element_segments(boom, 1.0, theory, rotary_inertia=True)
        expected = by_hand(segment, stiffness, theory == "timoshenko")
        assert rest(gap_system(boom, models)) == pytest.approx(expected, rel=1e-6)
    force, tip = rest(gap_system(boom, kantorovich_segments(boom, [24], "complete", True)))
    assert force == pytest.approx(expected[0], rel=1e-6)
    # Powers do not reach the kink of moments at the lug.
    assert tip == pytest.approx(expected[1], rel=1e-3 if stiffness < 1e9 else 2e-3)
    force, tip = rest(gap_system(boom, [rigid_segment(segment)]))
    assert force == pytest.approx(expected[0], rel=1e-9)
    assert tip == pytest.approx(-force / stiffness * segment.length / LEVER, rel=1e-9)


@pytest.mark.parametrize("luffed", [raised, level])
def test_axial_forces_turn_a_boom_about_its_lowered_pin(
    luffed: Callable[[], tuple[Boom, float]],
) -> None:
    """Reference: analytic, moments about the pin; without axial forces 4 to 21 % larger."""
    boom, expected = luffed()
    for models in (
        finite_element_segments(boom, 0.5, "timoshenko", rotary_inertia=True),
        finite_element_segments(boom, 0.5, "euler-bernoulli", rotary_inertia=True),
        kantorovich_segments(boom, [16], "complete", rotary_inertia=True),
        [rigid_segment(segment) for segment in boom.segments],
    ):
        force, _ = rest(gap_system(boom, models))
        assert force == pytest.approx(expected, rel=1e-3)


def test_a_lowered_pin_needs_no_cylinder() -> None:
    """Reference: analytic, a thrust of 50 kN at 0.35 m above the pin of a beam on two supports."""
    boom, _ = level()
    (segment,) = boom.segments
    held = replace(segment, supports=(*segment.supports, Support(5.0, stiffness=1.0e9)))
    pin, prop = static_state(replace(boom, segments=(held,), cylinders=())).reactions
    expected = (10.0e3 * 10.0 - 50.0e3 * 0.35) / 5.0
    assert prop.force == pytest.approx(expected, rel=1e-3)
    assert pin.force == pytest.approx(10.0e3 - expected, rel=1e-3)
    assert pin.moment == pytest.approx(50.0e3 * 0.35, rel=1e-6)


def test_two_inclined_cylinders_hold_the_twist_by_the_slope() -> None:
    """Reference: analytic, Bredt and Bernoulli; ∓k q of elongations ±q, q = b (s_z φ − s_x v′)."""
    base = in_space(beam(supports=(Support(3.0, "hinged"),)))
    inner = in_space(beam(name="fly", start=7.0, end=9.0, section=FLY))
    joint = Joint(0, 1, (7.2, 7.8), play=0.0, lateral_play=0.0, bonded=True)
    pair = replace(CYLINDER, spread=1.2)
    boom = Boom((base, inner), (joint,), cylinders=(pair,))
    models = finite_element_segments(boom, 0.5, "euler-bernoulli", rotary_inertia=True)
    modes = BoomModes(boom, models)
    twisting = base.material.shear_modulus * base.lateral.torsion_constant
    bending = base.material.youngs_modulus * base.lateral.second_moment_of_area
    along, up = pair.direction
    lever, lug = 0.5 * pair.spread, pair.x - base.start
    # Under 1 N·m about the axis at 7.2 m, a node where the fly does not help yet.
    read = lever * up * lug / twisting
    yielding = lever**2 * (up**2 / twisting + along**2 / bending) * lug
    force = read / (1.0 / pair.stiffness + yielding)
    twist = 4.2 / twisting - force * lever * up * lug / twisting
    aside = force * lever * along * lug / bending * (4.2 - 0.5 * lug)
    row = modes.beams[0].torque(7.2)
    at_rest = row / modes.omega2
    assert row @ at_rest == pytest.approx(twist, rel=1e-7)
    assert modes.displacement(0, 7.2, "y") @ at_rest == pytest.approx(aside, rel=1e-7)
    system = gap_system(boom, models)
    names = "cylinder_force", "cylinder_force_difference"
    found = [float(system.observers[name].row @ at_rest) for name in names]
    assert found == pytest.approx([0.0, -force], rel=1e-7, abs=1e-9 * force)


MAST = (
    octagon(0.56, 0.56, 0.15, 0.007, 0.007, 0.007),
    octagon(0.50, 0.50, 0.135, 0.006, 0.006, 0.006),
)
CLAMP = (Support(0.0, "clamped"),)


def column(thrust: float, gravity: float = 0.0, **others: object) -> Boom:
    """Return a clamped column of 10 m under a thrust in N and its weight."""
    one = Segment.of_section("column", 0.0, 10.0, STEEL, ARM, supports=CLAMP, **others)
    return Boom(with_compression([one], [], [Thrust(0, 10.0, thrust)], gravity), ())


def telescope(thrust: float) -> Boom:
    """Return a clamped arm and a fly with an overlap of 2 m, with a force at its tip."""
    arm = Segment.of_section("arm", 0.0, 8.0, STEEL, ARM, supports=CLAMP)
    fly = Segment.of_section("fly", 6.0, 14.0, STEEL, FLY, load=-500.0)
    joint = Joint(0, 1, (6.0, 8.0), play=0.01)
    return Boom(with_compression((arm, fly), (joint,), [Thrust(1, 14.0, thrust)]), (joint,))


@BUILDS
def test_segment_held_by_contacts_only_tips_over(build: Build) -> None:
    """Reference: analytic, −P L θ²/2 and m̄ L³ θ̇²/24 of a rotation. Bending changes it by 1e-3."""
    thrust, boom = 5.0e3, telescope(5.0e3)
    fly = boom.segments[1]
    system = gap_system(touching(boom, LAW), build(boom))
    tipping = system.omega2[system.omega2 < 0.0]
    np.testing.assert_allclose(tipping, -12.0 * thrust / (fly.mass_per_length * 8.0**2), rtol=2e-3)
    # Its fall stays what it was, and the arm has none.
    assert np.count_nonzero(system.omega2 == 0.0) == 1
    # Rotary inertia is included in the mass of rigid segments.
    rigid = gap_system(touching(boom, LAW), [rigid_segment(one) for one in boom.segments])
    inertia = fly.mass_per_length * 8.0**3 / 12.0 + fly.rotary_inertia * 8.0
    np.testing.assert_allclose(rigid.omega2.min(), -thrust * 8.0 / inertia, rtol=1e-12)


@BUILDS
def test_soft_walls_at_pads_lower_the_buckling_load(build: Build) -> None:
    """Reference: analytic, P = a²/(2 c L) of a rigid fly on two springs; bending is 0.3 % less."""
    thrust, compliance = 5.0e3, 1.0e-4
    boom = telescope(thrust)
    models = build(boom)
    places = ContactPlace(0, "z", 0), ContactPlace(0, "z", 1)
    soft = critical_factor(boom, models, StationCompliance(places, compliance * np.eye(2)))
    assert soft == pytest.approx(2.0**2 / (2.0 * compliance * 8.0) / thrust, rel=5e-3)
    hard = critical_factor(boom, models, StationCompliance(places, 1.0e-14 * np.eye(2)))
    assert hard == pytest.approx(critical_factor(boom, models), rel=1e-5)


def mast(thrust: float, *loads: Load, lateral_play: float | None = None) -> Boom:
    """Return an octagonal mast on corner pads under an axial force at its tip."""
    segments = (
        Segment.of_section("outer", 0.0, 7.5, STEEL, MAST[0], supports=CLAMP),
        Segment.of_section("inner", 6.2, 13.7, STEEL, MAST[1]),
    )
    pad, contact = Pad(0.2, 0.06, bears="corner"), PowerContact(1e9, 1.0)
    joint = Joint(0, 1, (6.2, 7.5), 0.003, contact=contact, pad=pad, lateral_play=lateral_play)
    compressed = with_compression(segments, (joint,), [Thrust(1, 13.7, thrust)])
    return Boom(compressed, (joint,), loads)


def test_the_estimate_is_the_growth_of_the_tip_on_distorting_sections() -> None:
    """Reference: the tip of the same beam under growing axial forces, by Southwell's plot (1932).

    The forces of both stations distort the sections together, and pads have their centres half
    their length within the overlap. Without both, the estimate is 1.6 times as large.
    """
    push = Load(1, "z", -2000.0, 13.7, Step())
    estimate = estimate_critical_factor(mast(1.0e5, push))
    assert estimate is not None
    parts = 1.0e5 * np.array([0.0, 0.9, 0.97]) * estimate
    tips = np.array([static_state(mast(thrust, push)).tip for thrust in parts])
    growth = tips[1:] - tips[0]
    critical = np.diff(growth)[0] / np.diff(growth / parts[1:])[0]
    assert 1.0e5 * estimate == pytest.approx(critical, rel=0.02)


def test_a_square_column_without_loads_across_it_buckles_as_in_a_plane() -> None:
    """Reference: analytic, the symmetry of a square section; the factor was 1.85 for 3.13."""
    flat, spatial = (
        estimate_critical_factor(mast(1.0e5, lateral_play=play)) for play in (None, 0.003)
    )
    assert spatial == pytest.approx(flat, rel=1e-6)


@BUILDS
def test_weights_of_point_masses_press(build: Build) -> None:
    """Reference: analytic, Euler's and Greenhill's cantilevers (Timoshenko and Gere 1961)."""
    boom = column(0.0, gravity=9.80665, masses=(PointMass(10.0, 5.0e4),))
    (segment,) = boom.segments
    factor = critical_factor(boom, build(boom))
    of_mass = 5.0e4 * 9.80665 * 10.0**2 / (0.25 * np.pi**2 * segment.bending_stiffness)
    own = segment.mass_per_length * 9.80665 * 10.0**3 / (7.8373474 * segment.bending_stiffness)
    assert factor == pytest.approx(1.0 / (of_mass + own), rel=5e-3)
