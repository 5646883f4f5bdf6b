# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of the paper's boom with and without friction and damping."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import find_peaks

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
from protractile.geometry.boom import Boom
from tests.beam_model.exact import beam_elements, beam_series
from tests.modal import damping_matrix, modal_system
from tests.touching import touching


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


def test_with_friction_the_complete_series_follows_the_elements(
    paper_boom: Boom,
) -> None:
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
    """Reference: the same boom. 1e-9 of the load changes its motion for 5 s as little."""
    rubbing = replace(
        five_terms,
        friction_rows=five_terms.rows,
        frictions=[DryFriction(0.2, 0, 4500.0), DryFriction(0.2, 1, 5000.0)],
    )

    def change(system: GapSystem) -> tuple[Trajectory, Trajectory]:
        changed = replace(system, load=system.load * (1.0 + 1e-9))
        run = FixedStep(4.0e-6)
        return run(Motion(system, 5.0)), run(Motion(changed, 5.0))

    one, other = change(rubbing)
    tip = one.data["tip"].values
    assert np.abs(tip - other.data["tip"].values).max() < 1e-7 * np.ptp(tip)
    assert one.data.attrs["contact_changes"] > 20
    # Without friction the same change grows to the size of the motion.
    free = change(five_terms)
    apart = np.abs(free[0].data["tip"].values - free[1].data["tip"].values)
    assert apart.max() > 0.1 * np.ptp(tip)


LINEAR = PowerContact(stiffness=1.0e9, exponent=1.0).with_clearance(7.0e-3)


@pytest.fixture(scope="module")
def heavy(paper_boom: Boom) -> GapSystem:
    """Return a series of 6 + 6 functions under its weight, which closes the joint."""
    system = gap_system(touching(paper_boom, LINEAR), beam_series(paper_boom, (6, 6), "complete"))
    return replace(system, load=9.81 * system.load)


@pytest.mark.parametrize("ratio", [0.005, 0.02, 0.05])
def test_pressed_modes_have_the_ratio(heavy: GapSystem, ratio: float) -> None:
    """Reference: analytic, Φᵀ C Φ = 2ζω with a positive semidefinite C."""
    damped = with_modal_damping(heavy, ratio)
    omega, shapes = closed_contact_modes(heavy)
    found = shapes[:, :8].T @ damping_matrix(damped) @ shapes[:, :8]
    np.testing.assert_allclose(found, np.diag(2.0 * ratio * omega[:8]), atol=1e-9 * omega[7])
    assert np.linalg.eigvalsh(damping_matrix(damped))[0] > 0.0
    hertz, ratios = closed_contact_damping(damped)
    np.testing.assert_allclose(ratios[:8], ratio, rtol=1e-9)
    np.testing.assert_allclose(hertz, omega / (2.0 * np.pi))


def test_rigid_motions_lose_speed_no_faster_than_the_first_mode(heavy: GapSystem) -> None:
    """Reference: analytic. The amplitude of an oscillator decays at the rate ζω."""
    damped = with_modal_damping(heavy, 0.02)
    first = closed_contact_modes(heavy)[0][0]
    rigid = heavy.omega2 == 0.0
    assert rigid.sum() == 2
    expected = np.zeros((2, heavy.num_modes))
    expected[:, rigid] = 0.02 * first * np.eye(2)
    np.testing.assert_allclose(damping_matrix(damped)[rigid], expected, atol=1e-12)


@pytest.mark.parametrize("ratio", [0.005, 0.02, 0.05])
@pytest.mark.parametrize("mode", [0, 1, 2])
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


def test_free_segment_decays_at_the_ratio_of_the_first_mode(heavy: GapSystem) -> None:
    """Reference: analytic, exp(−ζω₁t)."""
    wide = replace(
        heavy, load=0.0 * heavy.load, laws=[LINEAR.law.with_clearance(10.0)] * len(heavy.laws)
    )
    damped = with_modal_damping(wide, 0.05)
    bonded = closed_contact_modes(wide)[0][0]
    thrown = np.where(np.arange(wide.num_modes) == np.flatnonzero(wide.omega2 == 0.0)[0], 1.0, 0.0)
    run = AdaptiveStep()(Motion(damped, 1.0, 0.1, velocity=thrown))
    way = (1.0 - np.exp(-0.05 * bonded * run.time)) / (0.05 * bonded)
    np.testing.assert_allclose(run.states @ thrown, way, rtol=1e-9, atol=1e-12)
    assert run.energy_residual < 1e-12


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


def test_a_bonded_boom_keeps_its_exact_flow(
    paper_boom: Boom,
) -> None:
    """Reference: analytic. Modes of the bonded boom have the damping 2ζω each, without dashpots."""
    bonded = gap_system(paper_boom.bonded, beam_series(paper_boom, (6, 6), "complete"))
    damped = with_modal_damping(bonded, 0.02)
    np.testing.assert_allclose(damped.damping, 0.04 * np.sqrt(bonded.omega2))
    assert not damped.dashpots.size
