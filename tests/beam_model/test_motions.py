# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rigid segments, the paper's boom with friction, and damping by modes and dashpots, in motion."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import find_peaks

from protractile.beam_model.kantorovich import rigid_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import (
    closed_contact_damping,
    closed_contact_modes,
    with_modal_damping,
)
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Cylinder, Joint, Support
from tests.beam_model.exact import beam, beam_elements, beam_series
from tests.modal import damping_matrix, modal_system
from tests.touching import touching

LAW, LINEAR = (PowerContact(stiffness, 1.0).with_clearance(7.0e-3) for stiffness in (2.0e6, 1.0e9))


def rigid(boom: Boom, law: PowerContact = LAW) -> GapSystem:
    return gap_system(touching(boom, law), [rigid_segment(segment) for segment in boom.segments])


def test_a_segment_falls_on_its_contacts_and_bounces(paper_boom: Boom) -> None:
    """Reference: analytic, free fall through the clearance, then half a period on two springs."""
    outer, inner = paper_boom.segments
    outer = replace(outer, supports=(Support(0.0, "clamped"),))
    inner = replace(inner, start=2.0, end=10.0, load=-540.0)
    system = rigid(Boom((outer, inner), (replace(paper_boom.joints[0], stations=(4.0, 8.0)),)), LAW)
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


def rubs(boom: Boom) -> Boom:
    """Return the paper's boom with friction under its normal forces."""
    joint = replace(boom.joints[0], friction=0.2, normal_forces=(4500.0, 5000.0))
    return replace(boom, joints=(joint,))


def test_with_friction_the_complete_series_follows_the_elements(paper_boom: Boom) -> None:
    """Reference: other code, Hermite elements. Friction makes the motion regular."""
    boom = rubs(paper_boom)
    beams, complete, printed = (
        FixedStep(4.0e-6)(Motion(gap_system(touching(boom, LINEAR), models), 0.6))
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


@pytest.mark.slow
def test_with_friction_a_small_change_stays_small(
    paper_boom: Boom, paper_law: PowerContact
) -> None:
    """Reference: the same boom. 1e-9 of the load changes its motion for 5 s as little."""
    rubbing = rubs(paper_boom)
    system = gap_system(touching(rubbing, paper_law), beam_series(rubbing, (2, 3)))
    one, other = (
        FixedStep(4.0e-6)(Motion(replace(system, load=factor * system.load), 5.0))
        for factor in (1.0, 1.0 + 1e-9)
    )
    tip = one.data["tip"].values
    assert np.abs(tip - other.data["tip"].values).max() < 1e-7 * np.ptp(tip)
    assert one.data.attrs["contact_changes"] > 20


def test_pressed_modes_have_the_ratio(paper_boom: Boom) -> None:
    """Reference: analytic, Φᵀ C Φ = 2ζω of a joint that weight closes; rigid motions lose less."""
    ratio = 0.02
    system = gap_system(touching(paper_boom, LINEAR), beam_series(paper_boom, (6, 6), "complete"))
    heavy = replace(system, load=9.81 * system.load)
    damped = with_modal_damping(heavy, ratio)
    omega, shapes = closed_contact_modes(heavy)
    found = shapes[:, :8].T @ damping_matrix(damped) @ shapes[:, :8]
    np.testing.assert_allclose(found, np.diag(2.0 * ratio * omega[:8]), atol=1e-9 * omega[7])
    assert np.linalg.eigvalsh(damping_matrix(damped))[0] > 0.0
    hertz, ratios = closed_contact_damping(damped)
    np.testing.assert_allclose(ratios[:8], ratio, rtol=1e-9)
    np.testing.assert_allclose(hertz, omega / (2.0 * np.pi))
    rigid = heavy.omega2 == 0.0
    expected = np.zeros((2, heavy.num_modes))
    expected[:, rigid] = ratio * omega[0] * np.eye(2)
    np.testing.assert_allclose(damping_matrix(damped)[rigid], expected, atol=1e-12)


@pytest.mark.parametrize("gap", [0.0, 1.0e-3])
def test_contact_force_of_round_off_does_not_close_a_contact(gap: float) -> None:
    """Reference: analytic. At 1e-17 m it has 20 rad/s, held on both sides √(400 + 10⁶) rad/s."""
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


def assert_decays(system: GapSystem, position: Array, duration: float, ratio: float) -> None:
    """Check the logarithmic decrement 2πζ/√(1 − ζ²) of successive maxima of the tip."""
    run = AdaptiveStep()(Motion(system, duration, 1e-4, position))
    swing = run.data["tip"].values
    peaks, _ = find_peaks(swing)
    assert peaks.size > 6
    # The parabola through three points finds the maximum between two outputs.
    before, at, after = (swing[peaks + shift] for shift in (-1, 0, 1))
    heights = at + 0.125 * (after - before) ** 2 / (2.0 * at - before - after)
    expected = 2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2)
    assert -np.diff(np.log(heights)) == pytest.approx(expected, rel=1e-4)
    assert run.energy_residual < 1e-6


def test_a_rigid_segment_on_two_stations_loses_its_swing() -> None:
    """Reference: analytic, ζ = c/√(2km) on two springs, both ways without play, and dashpots."""
    outer = beam(name="outer", start=0.0, end=4.0, supports=(Support(0.0, "clamped"),))
    inner = beam(name="inner", start=3.0, end=4.0, section=None)
    joint = Joint(0, 1, stations=(3.25, 3.75), play=0.0, dashpot=DASHPOT)
    system = rigid(Boom((outer, inner), (joint,)), PowerContact(SPRING, 1.0).with_clearance(0.0))
    raised = np.linalg.lstsq(system.rows, np.full(2, 1e-3), rcond=None)[0]
    ratio = DASHPOT / np.sqrt(2.0 * SPRING * inner.mass_per_length * inner.length)
    assert_decays(system, raised, 0.5, ratio)


@pytest.mark.parametrize("held", ["support", "cylinder"])
def test_a_rigid_segment_on_its_hinge_loses_its_swing(held: str) -> None:
    """Reference: analytic, ζ = c r / 2√(k I) with the lever arm r about the hinge."""
    spring = {"stiffness": SPRING, "dashpot": 8.0e3}
    if held == "support":
        supports, cylinders, arm = (Support(3.0), Support(5.5, **spring)), (), 2.5
    else:
        supports = (Support(3.0, depth=0.25),)
        cylinders = (Cylinder(0, 6.0, depth=0.5, ground=(1.4, -2.0), **spring),)
        # (6 − 3, −0.5 + 0.25) m × the direction of (4.6, 1.5) m
        arm = (3.0 * 1.5 + 0.25 * 4.6) / np.hypot(4.6, 1.5)
    segment = beam(supports=supports)
    system = rigid(Boom((segment,), (), cylinders=cylinders))
    mass = segment.mass_per_length * segment.length
    inertia = mass * segment.length**2 / 3.0 + segment.rotary_inertia * segment.length
    omega = arm * np.sqrt(SPRING / inertia)
    assert np.sqrt(system.omega2) == pytest.approx([omega], rel=1e-9)
    ratio = 0.5 * 8.0e3 * arm / np.sqrt(SPRING * inertia)
    assert_decays(system, np.ones(1), 12.5 * 2.0 * np.pi / omega, ratio)
    hertz, ratios = closed_contact_damping(system)
    assert (hertz, ratios) == (pytest.approx([omega / (2.0 * np.pi)]), pytest.approx([ratio]))
