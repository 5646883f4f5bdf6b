# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms on a hinge and a luffing cylinder, and linear dashpots, against mechanics by hand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import find_peaks

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments, rigid_segment
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import static_state
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_contact_damping
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import (
    Boom,
    Cylinder,
    Joint,
    Load,
    Material,
    Pad,
    Segment,
    Stop,
    Support,
)
from protractile.geometry.box import BoxSection
from tests.beam_model.exact import beam, beam_elements
from tests.touching import in_space, level, raised, touching

SMALL = BoxSection(height=0.4, width=0.3, flange=0.01, web=0.01)
UNIFORM, TIP = -2.0e3, -1.5e4
# The hinge is 0.15 m below the axis; the line rises steeply, and passes it at some distance.
HINGE = Support(3.0, depth=0.15)
CYLINDER = Cylinder(0, x=5.0, depth=0.45, ground=(3.8, -2.2), stiffness=3.0e7)


def by_hand(segment: Segment, cylinder: Cylinder) -> tuple[float, float]:
    """Return the cylinder force in N, positive in compression, and the tip deflection in m.

    From the hinge on, E J w = R x³/6 + q x⁴/24 + Σ P ⟨x − a⟩³/6 − Σ C ⟨x − a⟩²/2 + E J θ x. Moment
    and shear force are 0 at the tip. The cylinder shortens by F/k.
    """
    length, stiffness = segment.length, segment.bending_stiffness
    lug, arm, foot = cylinder.x - 3.0, cylinder.depth, HINGE.depth
    run, rise = cylinder.x - cylinder.ground[0], -arm - cylinder.ground[1]
    along, up = run / np.hypot(run, rise), rise / np.hypot(run, rise)
    # Unknown: the hinge's force R, the cylinder's F, the slope at the hinge θ.
    at_lug = np.array([lug**3 / 6.0, along * foot * lug**2 / 2.0, stiffness * lug]) / stiffness
    slope = np.array([lug**2 / 2.0, along * foot * lug, stiffness]) / stiffness
    shortened = up * at_lug + along * (arm * slope - foot * np.array([0.0, 0.0, 1.0]))
    system = np.array(
        [
            [1.0, up, 0.0],
            [length, up * (length - lug) - along * (arm - foot), 0.0],
            shortened + np.array([0.0, 1.0 / cylinder.stiffness, 0.0]),
        ]
    )
    load = UNIFORM / stiffness
    right = [
        -(UNIFORM * length + TIP),
        -UNIFORM * length**2 / 2.0,
        -load * (up * lug**4 / 24.0 + along * arm * lug**3 / 6.0),
    ]
    reaction, force, turn = np.linalg.solve(system, right)
    beyond = length - lug
    bent = reaction * length**3 + force * up * beyond**3 + UNIFORM * length**4 / 4.0
    turned = force * along * (foot * length**2 - arm * beyond**2)
    return force, (bent / 6.0 + turned / 2.0) / stiffness + turn * length


def shear_deflection(segment: Segment, arm: float, force: float) -> float:
    """Return ∫ V v/(G A_s) dx in m, for the shear force v under 1 N at the tip.

    ``force`` is the force of the cylinder in N, ``arm`` its lever arm in m.
    """
    assert segment.section is not None
    length, lug, up = segment.length, CYLINDER.x - 3.0, CYLINDER.direction[1]
    hinge = -(UNIFORM * length + TIP) - force * up
    unit = up * length / arm - 1.0
    inner = hinge * lug + 0.5 * UNIFORM * lug**2
    outer = (hinge + force * up) * (length - lug) + 0.5 * UNIFORM * (length**2 - lug**2)
    return (unit * inner - outer) / (segment.material.shear_modulus * segment.section.shear_area)


def luffed(cylinder: Cylinder = CYLINDER) -> Boom:
    segment = beam(supports=(HINGE,), load=UNIFORM)
    return Boom((segment,), (), (Load(0, "z", TIP, 8.0, Step()),), cylinders=(cylinder,))


def rest(system: GapSystem) -> tuple[float, float]:
    """Return the static cylinder force in N and tip deflection in m."""
    position = equilibrium(system, system.gather_loads().load)
    force, tip = (system.observers[name].row @ position for name in ("cylinder_force", "tip"))
    return float(force), float(tip)


@pytest.mark.parametrize("stiffness", [3.0e7, 1.0e10], ids=["elastic", "stiff"])
def test_statics_of_a_luffed_beam(stiffness: float) -> None:
    """Reference: by hand, as above. Elements are exact at nodes. In every model the force follows
    from the lever arm.
    """
    boom = luffed(replace(CYLINDER, stiffness=stiffness))
    (segment,) = boom.segments
    expected = by_hand(segment, boom.cylinders[0])
    arm = float(np.linalg.det([[2.0, -0.45 + 0.15], CYLINDER.direction]))
    weight = UNIFORM * segment.length**2 / 2.0 + TIP * segment.length
    assert expected[0] == pytest.approx(-weight / arm, rel=1e-12)
    models = finite_element_segments(boom, 1.0, "euler-bernoulli", rotary_inertia=True)
    assert rest(gap_system(boom, models)) == pytest.approx(expected, rel=1e-6)
    models = finite_element_segments(boom, 1.0, "timoshenko", rotary_inertia=True)
    sheared = expected[0], expected[1] + shear_deflection(segment, arm, expected[0])
    assert rest(gap_system(boom, models)) == pytest.approx(sheared, rel=1e-6)
    force, tip = rest(gap_system(boom, kantorovich_segments(boom, [24], "complete", True)))
    assert force == pytest.approx(expected[0], rel=1e-6)
    # Powers do not reach the kink of moments at the lug.
    assert tip == pytest.approx(expected[1], rel=1e-3 if stiffness < 1e9 else 2e-3)
    force, tip = rest(gap_system(boom, [rigid_segment(segment)]))
    assert force == pytest.approx(expected[0], rel=1e-9)
    assert tip == pytest.approx(-force / stiffness * segment.length / arm, rel=1e-9)


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
    equilibrium_at = Support(5.0, stiffness=1.0e9)
    held = replace(segment, supports=(*segment.supports, equilibrium_at))
    pin, prop = static_state(replace(boom, segments=(held,), cylinders=())).reactions
    expected = (10.0e3 * 10.0 - 50.0e3 * 0.35) / 5.0
    assert prop.force == pytest.approx(expected, rel=1e-3)
    assert pin.force == pytest.approx(10.0e3 - expected, rel=1e-3)
    assert pin.moment == pytest.approx(50.0e3 * 0.35, rel=1e-6)


@pytest.mark.parametrize("bonded", [False, True], ids=["one", "of two bonded"])
def test_frequency_of_a_stiff_boom_on_its_cylinder(bonded: bool) -> None:
    """Reference: analytic, r √(k / I) about the hinge, within 2e-4; rigid beams to round-off."""
    stiff = Material(youngs_modulus=2.1e15, poissons_ratio=0.3, density=7850.0)
    whole = beam(supports=(HINGE,), material=stiff)
    parts = (replace(whole, end=6.0), replace(whole, start=6.0, supports=(), name="fly"))
    joint = Joint(0, 1, stations=(6.0,), play=0.0, bonded=True)
    boom = Boom((whole,), (), cylinders=(CYLINDER,))
    if bonded:
        over = replace(parts[1], start=5.5, mass_per_length=0.8 * whole.mass_per_length)
        over = replace(over, section=None)
        boom = Boom((parts[0], over), (replace(joint, stations=(5.6, 5.9)),), cylinders=(CYLINDER,))
    inertia = sum(
        s.mass_per_length * ((s.end - 3.0) ** 3 - (s.start - 3.0) ** 3) / 3.0
        + s.rotary_inertia * s.length
        for s in boom.segments
    )
    arm = float(np.linalg.det([[2.0, -0.45 + 0.15], CYLINDER.direction]))
    expected = arm * np.sqrt(CYLINDER.stiffness / inertia) / (2.0 * np.pi)
    rigid = gap_system(boom.bonded, [rigid_segment(segment) for segment in boom.segments])
    assert rigid.frequencies == pytest.approx([expected], rel=1e-9)
    for models in (
        finite_element_segments(boom, 0.5, "euler-bernoulli", rotary_inertia=True),
        kantorovich_segments(boom, [8] * len(boom.segments), "complete", rotary_inertia=True),
    ):
        first = gap_system(boom.bonded, models).frequencies[0]
        assert first == pytest.approx(expected, rel=2e-4)


def test_two_inclined_cylinders_hold_the_twist_by_the_slope() -> None:
    """Reference: analytic, Bredt's shaft and Bernoulli's beam from a hinge that fixes twist and
    lateral slope. The cylinders have the elongations ±q, q = b (s_z φ − s_x v′), and the forces
    ∓k q.
    """
    base = in_space(beam(supports=(Support(3.0, "hinged"),)))
    inner = in_space(beam(name="fly", start=7.0, end=9.0, section=SMALL))
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
    # One in the middle knows nothing of it.
    single = BoomModes(replace(boom, cylinders=(CYLINDER,)), models)
    row = single.beams[0].torque(7.2)
    free = 4.2 / twisting
    assert row @ (row / single.omega2) == pytest.approx(free, rel=1e-7)
    assert twist < 0.96 * free


def test_a_boom_rests_on_a_hinge_and_a_stop() -> None:
    """Reference: analytic, the lever rule. The weight presses the boom on the stop."""
    segment = beam(supports=(Support(3.0),), load=UNIFORM)
    stop = Stop(0, 6.0, 0.02, PowerContact(0.0, 1.0, stiffness_below=1e7))
    boom = Boom((segment,), (), stops=(stop,))
    models = finite_element_segments(boom, 1.0, "euler-bernoulli", rotary_inertia=True)
    system = gap_system(boom, models)
    gap = float(system.rows[0] @ equilibrium(system, system.load))
    assert system.laws[0].force(gap) == pytest.approx(UNIFORM * 5.0 * 2.5 / 3.0, rel=1e-6)


SPRING, DASHPOT = 2.0e6, 900.0
# A spring both ways, since no play is between its sides.
BOTH_WAYS = PowerContact(SPRING, exponent=1.0).with_clearance(0.0)


def decrements(system: GapSystem, position: Array, duration: float, name: str) -> Array:
    """Return the logarithmic decrements of successive maxima of an output about 0."""
    run = AdaptiveStep()(Motion(system, duration, 1e-4, position))
    swing = run.data[name].values
    peaks, _ = find_peaks(swing)
    # The parabola through three points finds the maximum between two outputs.
    before, at, after = (swing[peaks + shift] for shift in (-1, 0, 1))
    heights = at + 0.125 * (after - before) ** 2 / (2.0 * at - before - after)
    return -np.diff(np.log(heights))


def test_a_rigid_segment_on_two_stations_loses_its_swing() -> None:
    """Reference: analytic. On two springs and two dashpots ζ = c/√(2km), δ = 2πζ/√(1 − ζ²)."""
    outer = beam(name="outer", start=0.0, end=4.0, supports=(Support(0.0, "clamped"),))
    inner = beam(name="inner", start=3.0, end=4.0, section=None)
    joint = Joint(0, 1, stations=(3.25, 3.75), play=0.0, dashpot=DASHPOT)
    boom = Boom((outer, inner), (joint,))
    system = gap_system(touching(boom, BOTH_WAYS), [rigid_segment(one) for one in boom.segments])
    mass = inner.mass_per_length * inner.length
    ratio = DASHPOT / np.sqrt(2.0 * SPRING * mass)
    assert 0.01 < ratio < 0.1
    raised = np.linalg.lstsq(system.rows, np.full(2, 1e-3), rcond=None)[0]
    expected = 2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2)
    found = decrements(system, raised, 0.5, "tip")
    assert found.size > 5
    assert found == pytest.approx(expected, rel=1e-4)


@pytest.mark.parametrize("held", ["support", "cylinder"])
def test_a_rigid_segment_on_its_hinge_loses_its_swing(held: str) -> None:
    """Reference: analytic, ζ = c r / 2√(k I) and δ = 2πζ/√(1 − ζ²) with the lever arm r about the
    hinge at (3, −0.25) m. The cylinder is between (1.4, −2) and (6, −0.5) m.
    """
    supports, cylinders = [Support(3.0, depth=0.25 if held == "cylinder" else 0.0)], []
    if held == "support":
        arm, damping = 2.5, 4.0e3
        supports.append(Support(5.5, stiffness=SPRING, dashpot=damping))
    else:
        line = np.array([4.6, 1.5]) / np.hypot(4.6, 1.5)
        # (6 − 3, −0.5 + 0.25) × line
        arm, damping = 3.0 * line[1] + 0.25 * line[0], 8.0e3
        cylinders.append(
            Cylinder(0, 6.0, depth=0.5, ground=(1.4, -2.0), stiffness=SPRING, dashpot=damping)
        )
    segment = beam(supports=supports)
    boom = Boom((segment,), (), cylinders=tuple(cylinders))
    system = gap_system(boom, [rigid_segment(segment)])
    mass = segment.mass_per_length * segment.length
    inertia = mass * segment.length**2 / 3.0 + segment.rotary_inertia * segment.length
    omega = arm * np.sqrt(SPRING / inertia)
    assert np.sqrt(system.omega2) == pytest.approx([omega], rel=1e-9)
    ratio = 0.5 * damping * arm / np.sqrt(SPRING * inertia)
    assert 0.005 < ratio < 0.1
    found = decrements(system, np.ones(1), 12.5 * 2.0 * np.pi / omega, "tip")
    assert found.size > 8
    assert found == pytest.approx(2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2), rel=1e-4)
    hertz, ratios = closed_contact_damping(system)
    assert (hertz, ratios) == (pytest.approx([omega / (2.0 * np.pi)]), pytest.approx([ratio]))


def test_a_nearly_rigid_bar_on_a_dashpot_loses_its_swing() -> None:
    """Reference: analytic, the rigid bar: ζ = c r / 2√(k I). Bending has much higher frequencies;
    the default step must not cause damping by them.
    """
    arm, damping, spring = 10.0, 1.0e3, 2.0e5
    stiff = Material(youngs_modulus=2.1e15, poissons_ratio=0.3, density=7850.0)
    supports = (Support(0.0), Support(arm, stiffness=spring, dashpot=damping))
    segment = replace(beam(start=0.0, end=arm, supports=supports), material=stiff)
    boom = Boom((segment,), ())
    system = gap_system(boom, finite_element_segments(boom, 1.0, "timoshenko", True))
    mass = segment.mass_per_length * arm
    inertia = mass * arm**2 / 3.0 + segment.rotary_inertia * arm
    omega, ratio = arm * np.sqrt(spring / inertia), 0.5 * damping * arm / np.sqrt(spring * inertia)
    assert 0.02 < ratio < 0.06
    first = np.eye(system.num_modes)[np.argmin(system.omega2)]
    found = decrements(system, first, 8.5 * 2.0 * np.pi / omega, "tip")
    assert found.size > 5
    assert found == pytest.approx(2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2), rel=2e-3)


@pytest.mark.parametrize("spatial", [False, True], ids=["flat", "in space"])
def test_a_dashpot_reads_the_axis(
    paper_boom: Boom, spatial_boom: Boom, paper_law: PowerContact, spatial: bool
) -> None:
    """Reference: analytic, √c (u − w) at each station along each direction."""
    boom = spatial_boom if spatial else paper_boom
    (joint,) = boom.joints
    boom = replace(boom, joints=(replace(joint, dashpot=DASHPOT),))
    models = finite_element_segments(boom, 2.0, "euler-bernoulli", rotary_inertia=False)
    system = gap_system(touching(boom, paper_law, paper_law), models)
    modes = BoomModes(boom, models)
    expected = [
        np.sqrt(DASHPOT) * (modes.displacement(1, x, along) - modes.displacement(0, x, along))
        for along in boom.directions
        for x in joint.stations
    ]
    np.testing.assert_allclose(system.dashpots, expected, atol=1e-12)


def test_dashpots_and_pads_take_no_part_in_a_bonded_boom(
    paper_boom: Boom,
) -> None:
    """Reference: the same boom without them, to the last bit."""
    (joint,) = paper_boom.joints
    there = replace(joint, dashpot=DASHPOT, pad=Pad(0.2, 0.06))
    dragged = replace(paper_boom, joints=(there,))
    models = beam_elements(paper_boom, 1.0)
    bare, bonded = (gap_system(boom.bonded, models) for boom in (paper_boom, dragged))
    np.testing.assert_array_equal(bonded.frequencies, bare.frequencies)
    assert not bonded.damping.any()
    assert not bonded.dashpots.any()
