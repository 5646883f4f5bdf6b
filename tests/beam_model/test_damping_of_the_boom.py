# SPDX-License-Identifier: LGPL-3.0-or-later
"""A damping ratio is one of the boom's own modes, with its joints pressed."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import find_peaks

from beam_model.component import SegmentModel
from beam_model.segment_model import gap_system
from dynamics.contact import PowerContact
from dynamics.damping import closed_contact_damping, closed_contact_modes, with_modal_damping
from dynamics.equilibrium import equilibrium
from dynamics.gap_system import GapSystem
from dynamics.integrator import AdaptiveStep, FixedStep
from dynamics.motion import Motion
from geometry.boom import Boom
from tests.touching import touching

LINEAR = PowerContact(stiffness=1.0e9, exponent=1.0).behind(7.0e-3)


@pytest.fixture(scope="module")
def heavy(paper_boom: Boom, series: Callable[..., list[SegmentModel]]) -> GapSystem:
    """Return a series of 6 + 6 functions under its weight, which closes the joint."""
    system = gap_system(touching(paper_boom, LINEAR), series((6, 6), "complete"))
    return replace(system, load=9.81 * system.load)


@pytest.mark.parametrize("ratio", [0.005, 0.02, 0.05])
def test_pressed_modes_have_the_ratio(heavy: GapSystem, ratio: float) -> None:
    """Reference: analytic, Φᵀ C Φ = 2ζω, and a matrix that takes energy only."""
    damped = with_modal_damping(heavy, ratio)
    omega, shapes = closed_contact_modes(heavy)
    found = shapes[:, :8].T @ damped.damping_matrix @ shapes[:, :8]
    np.testing.assert_allclose(found, np.diag(2.0 * ratio * omega[:8]), atol=1e-9 * omega[7])
    assert np.linalg.eigvalsh(damped.damping_matrix)[0] > 0.0
    hertz, ratios = closed_contact_damping(damped)
    np.testing.assert_allclose(ratios[:8], ratio, rtol=1e-9)
    np.testing.assert_allclose(hertz, omega / (2.0 * np.pi))


def test_rigid_motions_lose_speed_no_faster_than_the_first_mode(heavy: GapSystem) -> None:
    """Reference: analytic, an oscillator of the ratio ζ loses its amplitude at the rate ζω."""
    damped = with_modal_damping(heavy, 0.02)
    first = closed_contact_modes(heavy)[0][0]
    rigid = heavy.omega2 == 0.0
    assert rigid.sum() == 2
    expected = np.zeros((2, heavy.num_modes))
    expected[:, rigid] = 0.02 * first * np.eye(2)
    np.testing.assert_allclose(damped.damping_matrix[rigid], expected, atol=1e-12)


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
    wide = replace(heavy, load=0.0 * heavy.load, laws=[LINEAR.law.behind(10.0)] * len(heavy.laws))
    damped = with_modal_damping(wide, 0.05)
    bonded = closed_contact_modes(wide)[0][0]
    thrown = np.where(np.arange(wide.num_modes) == np.flatnonzero(wide.omega2 == 0.0)[0], 1.0, 0.0)
    run = AdaptiveStep()(Motion(damped, 1.0, 0.1, velocity=thrown))
    way = (1.0 - np.exp(-0.05 * bonded * run.time)) / (0.05 * bonded)
    np.testing.assert_allclose(run.states @ thrown, way, rtol=1e-9, atol=1e-12)
    assert run.energy_residual < 1e-12


def test_contact_force_of_round_off_does_not_close_a_contact() -> None:
    """Reference: analytic. A stop with 1e-17 m of penetration leaves its mass at 20 rad/s."""
    stop = PowerContact(stiffness=1.0e6, exponent=1.0)
    system = GapSystem(
        omega2=np.array([400.0, 0.0]),
        load=np.array([0.0, 10.0]),
        rows=np.eye(2),
        laws=[stop, stop],
        station_of_row=np.array([0, 1]),
        stations=[0.0, 1.0],
        grounded=[0, 1],
        observers={},
    )
    omega, _ = closed_contact_modes(system, np.array([1.0e-17, 1.0e-5]))
    np.testing.assert_allclose(omega, [20.0, 1000.0], rtol=1e-12)


def test_rest_under_weight_loses_nothing(heavy: GapSystem) -> None:
    """Reference: analytic. Nothing moves, however much the modes are damped."""
    damped = replace(heavy, damping=3e-4 * heavy.omega2)
    run = AdaptiveStep()(Motion(damped, 0.5, 0.01, position=equilibrium(heavy, heavy.load)))
    strain = float(run.data["strain_energy"][0])
    assert float(run.data["damping_loss"][-1]) < 1e-6 * strain


def test_the_error_is_of_second_order_in_the_step(heavy: GapSystem) -> None:
    """Reference: the same motion at a sixteenth of the finest step."""
    damped = with_modal_damping(heavy, 0.05)
    rest = equilibrium(heavy, heavy.load)
    _, shapes = closed_contact_modes(heavy)
    start = rest + 1e-3 * shapes[:, :3].sum(axis=1)

    def states(step: float) -> np.ndarray:
        return FixedStep(step)(Motion(damped, 0.05, 0.01, position=start)).states

    exact = states(5e-6 / 16.0)
    errors = [np.abs(states(step) - exact).max() for step in (2e-5, 1e-5, 5e-6)]
    assert np.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(2.0, abs=0.1)


def test_a_bonded_boom_keeps_its_exact_flow(
    paper_boom: Boom, series: Callable[..., list[SegmentModel]]
) -> None:
    """Reference: analytic. Its modes are the pressed ones already: 2ζω each, and no dashpots."""
    bonded = gap_system(paper_boom.bonded, series((6, 6), "complete"))
    damped = with_modal_damping(bonded, 0.02)
    np.testing.assert_allclose(damped.damping, 0.04 * np.sqrt(bonded.omega2))
    assert not damped.dashpots.size
