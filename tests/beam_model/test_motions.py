# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rigid segments, the paper's boom with friction, and damping by modes and dashpots, in motion."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import find_peaks

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import rigid_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.damping import (
    closed_contact_damping,
    closed_contact_modes,
    with_modal_damping,
)
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Cylinder, Joint, PointMass, Support
from tests.beam_model.exact import beam, beam_elements, beam_series
from tests.modal import damping_matrix, modal_system
from tests.touching import touching

LAW = PowerContact(stiffness=2.0e6, exponent=1.0).with_clearance(7.0e-3)


def rigid(boom: Boom, laws: list[PowerContact]) -> GapSystem:
    return gap_system(touching(boom, laws), [rigid_segment(segment) for segment in boom.segments])


@pytest.fixture
def inside(paper_boom: Boom) -> Boom:
    """Return an inner segment in a clamped outer one, with its midpoint between the stations."""
    outer, inner = paper_boom.segments
    return Boom(
        (
            replace(outer, supports=(Support(0.0, "clamped"),)),
            replace(inner, start=2.0, end=10.0, load=-540.0),
        ),
        (replace(paper_boom.joints[0], stations=(4.0, 8.0)),),
    )


def test_a_segment_falls_on_its_contacts_and_bounces(inside: Boom) -> None:
    """Reference: analytic, free fall through the clearance, then half a period on two springs."""
    system = rigid(inside, [LAW])
    assert system.num_modes == 2
    inner = inside.segments[1]
    mass, force = inner.mass_per_length * inner.length, -inner.load * inner.length
    gravity, omega = force / mass, np.sqrt(2.0 * LAW.law.stiffness / mass)
    fall = np.sqrt(2.0 * LAW.above / gravity)
    speed, sag = gravity * fall, force / (2.0 * LAW.law.stiffness)
    contact = 2.0 / omega * (np.pi - np.arctan(speed * omega / gravity))
    lowest = -LAW.above - sag - np.hypot(sag, speed / omega)
    period = 2.0 * fall + contact

    found = FixedStep(2.0e-6)(Motion(system, 4.0 * period, period / 40.0))
    tip = found.data["tip"].values
    assert tip[20::40] == pytest.approx([lowest] * 4, rel=1e-6)
    assert tip[::40] == pytest.approx(np.zeros(5), abs=1e-6 * LAW.above)
    assert found.data["tail"].values == pytest.approx(tip, abs=1e-12)
    assert found.data.attrs["energy_residual"] < 1e-7


def test_a_body_swings_on_springs(paper_boom: Boom) -> None:
    """Reference: analytic, bounce and pitch of a symmetric bar with a mass in its middle."""
    stiffness = 3.0e5
    springs = tuple(Support(x, stiffness=stiffness) for x in (1.0, 9.0))
    bar = replace(paper_boom.segments[0], supports=springs, masses=(PointMass(5.0, 400.0),))
    mass = bar.mass_per_length * bar.length + 400.0
    inertia = bar.mass_per_length * bar.length**3 / 12.0 + bar.rotary_inertia * bar.length
    expected = np.sqrt([2.0 * stiffness / mass, 2.0 * stiffness * 4.0**2 / inertia])
    modes = BoomModes(Boom((bar,), ()), [rigid_segment(bar)])
    assert np.sqrt(np.sort(modes.omega2)) == pytest.approx(np.sort(expected), rel=1e-12)


@pytest.fixture
def five_terms(paper_boom: Boom, paper_law: PowerContact) -> GapSystem:
    return gap_system(touching(paper_boom, paper_law), beam_series(paper_boom, (2, 3)))


def test_the_step_of_the_paper_keeps_the_first_peak(five_terms: GapSystem) -> None:
    """Reference: a finer step than the paper's 4375 in 7 s. Micro-impacts scatter by 2 %."""
    coarse = FixedStep(1.6e-3)(Motion(five_terms, 7.0, output_step=1.6e-3))
    fine = FixedStep(1.0e-5)(Motion(five_terms, 0.7))
    assert coarse.data.attrs["steps"] == 4375
    assert coarse.energy_residual < 1e-10
    assert coarse.first_peak() == pytest.approx(fine.first_peak(), rel=0.02)


def test_four_and_five_terms_coincide_until_they_touch(
    paper_boom: Boom, paper_law: PowerContact
) -> None:
    """Reference: external source, statement 4.1. Until contact, the inner segment is rigid."""
    four, five = (
        FixedStep(4.0e-6)(
            Motion(gap_system(touching(paper_boom, paper_law), beam_series(paper_boom, terms)), 0.4)
        )
        for terms in ((2, 2), (2, 3))
    )
    assert 0.1 < five.first_contact < 0.2
    assert four.first_contact == pytest.approx(five.first_contact, rel=1e-9)
    before = five.time < five.first_contact
    for name in ("tip", "head", "tail"):
        one, other = (run.data[name].values for run in (four, five))
        size = np.abs(other[before]).max()
        assert np.abs(one - other)[before].max() < 1e-9 * size
        # Then they do not, or the comparison would say nothing.
        assert np.abs(one - other).max() > 1e-2 * size


def test_with_friction_the_complete_series_follows_the_elements(paper_boom: Boom) -> None:
    """Reference: other code, Hermite elements. Friction makes the motion regular. Over 10 s and
    with elements of 0.25 m, the difference is 0.11 % of the tip's range.
    """
    (joint,) = paper_boom.joints
    joint = replace(joint, friction=0.2, normal_forces=(4500.0, 5000.0))
    boom = replace(paper_boom, joints=(joint,))
    law = PowerContact(stiffness=1.0e9, exponent=1.0).with_clearance(7.0e-3)
    beams, complete, printed = (
        FixedStep(4.0e-6)(Motion(gap_system(touching(boom, law), models), 0.6))
        for models in (
            beam_elements(paper_boom, 1.0),
            beam_series(paper_boom, (12, 12), "complete"),
            beam_series(paper_boom, (2, 3)),
        )
    )
    assert 0.3 < beams.first_contact < 0.4
    assert beams.data["friction_loss"].values[-1] > 1.0
    expected = beams.data["tip"].values
    error, far_off = (
        np.abs(run.data["tip"].values - expected).max() / np.ptp(expected)
        for run in (complete, printed)
    )
    assert error < 1e-3
    assert far_off > 4e-2


def test_with_friction_a_small_change_stays_small(five_terms: GapSystem) -> None:
    """Reference: the same boom. 1e-9 of the load changes its motion for 3 s as little."""
    rubbing = replace(
        five_terms,
        friction_rows=five_terms.rows,
        frictions=[DryFriction(0.2, 0, 4500.0), DryFriction(0.2, 1, 5000.0)],
    )

    def change(system: GapSystem, step: float) -> list[Trajectory]:
        changed = replace(system, load=system.load * (1.0 + 1e-9))
        return [FixedStep(step)(Motion(each, 3.0)) for each in (system, changed)]

    one, other = change(rubbing, 4.0e-6)
    tip = one.data["tip"].values
    assert np.abs(tip - other.data["tip"].values).max() < 1e-7 * np.ptp(tip)
    assert one.data.attrs["contact_changes"] > 20
    # Without friction the same change grows to the size of the motion.
    free = change(five_terms, 2.0e-5)
    apart = np.abs(free[0].data["tip"].values - free[1].data["tip"].values)
    assert apart.max() > 0.1 * np.ptp(tip)


LINEAR = PowerContact(stiffness=1.0e9, exponent=1.0).with_clearance(7.0e-3)


@pytest.fixture(scope="module")
def heavy(paper_boom: Boom) -> GapSystem:
    """Return a series of 6 + 6 functions under its weight, which closes the joint."""
    system = gap_system(touching(paper_boom, LINEAR), beam_series(paper_boom, (6, 6), "complete"))
    return replace(system, load=9.81 * system.load)


def test_pressed_modes_have_the_ratio(heavy: GapSystem) -> None:
    """Reference: analytic, Φᵀ C Φ = 2ζω with a positive semidefinite C. The amplitude of an
    oscillator decays at the rate ζω; rigid motions lose speed no faster than the first mode.
    """
    ratio = 0.02
    damped = with_modal_damping(heavy, ratio)
    omega, shapes = closed_contact_modes(heavy)
    found = shapes[:, :8].T @ damping_matrix(damped) @ shapes[:, :8]
    np.testing.assert_allclose(found, np.diag(2.0 * ratio * omega[:8]), atol=1e-9 * omega[7])
    assert np.linalg.eigvalsh(damping_matrix(damped))[0] > 0.0
    hertz, ratios = closed_contact_damping(damped)
    np.testing.assert_allclose(ratios[:8], ratio, rtol=1e-9)
    np.testing.assert_allclose(hertz, omega / (2.0 * np.pi))
    rigid = heavy.omega2 == 0.0
    assert rigid.sum() == 2
    expected = np.zeros((2, heavy.num_modes))
    expected[:, rigid] = ratio * omega[0] * np.eye(2)
    np.testing.assert_allclose(damping_matrix(damped)[rigid], expected, atol=1e-12)


@pytest.mark.parametrize(("mode", "ratio"), [(0, 0.05), (2, 0.005)])
def test_a_pressed_boom_swings_with_the_ratio(heavy: GapSystem, mode: int, ratio: float) -> None:
    """Reference: analytic, the logarithmic decrement 2πζ/√(1 − ζ²)."""
    omega, shapes = closed_contact_modes(heavy)
    rest = equilibrium(heavy, heavy.load)
    run = AdaptiveStep()(
        Motion(
            with_modal_damping(heavy, ratio),
            3.2 * 2.0 * np.pi / omega[mode],
            2.0 * np.pi / omega[mode] / 200.0,
            position=rest + 1e-3 * shapes[:, mode],
        )
    )
    swing = (run.states - rest) @ shapes[:, mode]
    peaks, _ = find_peaks(swing)
    decrement = np.log(swing[peaks[0]] / swing[peaks[-1]]) / (peaks.size - 1)
    assert decrement == pytest.approx(2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2), rel=0.01)
    assert run.energy_residual < 1e-6


@pytest.mark.parametrize("gap", [0.0, 1.0e-3])
def test_contact_force_of_round_off_does_not_close_a_contact(gap: float) -> None:
    """Reference: analytic. With a penetration of 1e-17 m, the mass still has 20 rad/s.

    Held on both sides without a gap, it has √(400 + 10⁶) rad/s; it had 20 rad/s.
    """
    stop = PowerContact(stiffness=1.0e6, exponent=1.0)
    first = stop.with_clearance(0.0, gap)
    system = modal_system([400.0, 0.0], [0.0, 10.0], np.eye(2), [first, stop], grounded=[0, 1])
    omega, _ = closed_contact_modes(system, np.array([1.0e-17, 1.0e-5]))
    held = np.sqrt(400.0 + 1.0e6)
    right = [20.0, 1000.0] if gap else [1000.0, held]
    np.testing.assert_allclose(omega, right, rtol=1e-12)


def test_a_bonded_boom_keeps_its_exact_flow(paper_boom: Boom) -> None:
    """Reference: analytic. Modes of the bonded boom have the damping 2ζω each, without dashpots."""
    bonded = gap_system(paper_boom.bonded, beam_series(paper_boom, (6, 6), "complete"))
    damped = with_modal_damping(bonded, 0.02)
    np.testing.assert_allclose(damped.damping, 0.04 * np.sqrt(bonded.omega2))
    assert not damped.dashpots.size


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
