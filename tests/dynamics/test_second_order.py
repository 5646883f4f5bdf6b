# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modes softened by axial forces, and unstable motions limited by contact."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.damping import closed_contact_damping, with_modal_damping
from dynamics.equilibrium import equilibrium
from dynamics.gap_system import GapSystem, Observer
from dynamics.integrator import FixedStep
from dynamics.motion import Motion
from dynamics.second_order import buckling_factor, soften_modes

MASS, NEGATIVE, STIFFNESS, CLEARANCE = 3.0, -48.0, 1.0e6, 0.01
GROWTH = np.sqrt(-NEGATIVE / MASS)
STOPS = PowerContact(STIFFNESS, 1.0).behind(CLEARANCE)


@pytest.fixture(name="tipping")
def _tipping(one_mass: Callable[..., GapSystem]) -> GapSystem:
    """Return a mass on a negative spring between two stops."""
    return one_mass(MASS, STOPS, spring=NEGATIVE)


def test_modes_soften_as_the_whole_stiffness_does() -> None:
    """Reference: analytic, the eigenvalues of diag(ω²) − G by another routine; translations keep ω
    = 0."""
    omega2 = np.array([0.0, 0.0, 4.0e2, 9.0e4])
    slope = np.array([[0.0, 0.3, 0.7, -0.2], [0.0, 0.5, -0.4, 0.6]])
    geometric = 20.0 * slope.T @ slope
    found, shapes = soften_modes(omega2, geometric)
    expected = np.linalg.eigvals(np.diag(omega2) - geometric).real
    np.testing.assert_allclose(found, np.sort(expected), rtol=1e-9, atol=1e-9)
    assert np.count_nonzero(found == 0.0) == 1
    assert np.count_nonzero(found < 0.0) == 1
    turned = shapes.T @ (np.diag(omega2) - geometric) @ shapes
    np.testing.assert_allclose(turned, np.diag(found), atol=1e-9)


def test_a_mode_buckles_where_its_stiffness_vanishes() -> None:
    """Reference: analytic, K/K_G of one coordinate; of two, the root of a determinant."""
    assert buckling_factor(np.array([[9.0]]), np.array([[2.0]])) == pytest.approx(4.5, rel=1e-14)
    stiffness, geometric = np.array([[9.0, 2.0], [2.0, 16e6]]), np.array([[2.0, 1.0], [1.0, 1e6]])
    factor = buckling_factor(stiffness, geometric)
    left = stiffness - factor * geometric
    assert np.linalg.det(left) == pytest.approx(0.0, abs=1e-12 * 9.0 * 16e6)
    assert np.trace(left) > 1.0
    # A tension never buckles it, and nothing is left to buckle where nothing moves.
    assert buckling_factor(np.array([[9.0]]), np.array([[-2.0]])) == float("inf")
    assert buckling_factor(np.zeros((0, 0)), np.zeros((0, 0))) == float("inf")


def test_unstable_mass_reaches_its_stop_at_the_analytic_time(tipping: GapSystem) -> None:
    """Reference: analytic. From rest at a, a cosh κt is the clearance at acosh(Δ/a)/κ."""
    start = 1.0e-4
    motion = Motion(tipping, 2.0, 1e-3, position=np.array([start * np.sqrt(MASS)]))
    run = FixedStep(1e-5)(motion)
    meets = np.arccosh(CLEARANCE / start) / GROWTH
    assert run.first_contact == pytest.approx(meets, abs=2e-5)
    before = run.time < meets
    tip = run.data["tip"].values[before]
    np.testing.assert_allclose(tip, start * np.cosh(GROWTH * run.time[before]), rtol=1e-9)
    assert np.abs(run.data["tip"].values).max() < 1.1 * CLEARANCE


def test_unstable_mass_rests_on_its_stop(tipping: GapSystem) -> None:
    """Reference: analytic, F = k (y − Δ) = P + κ² m y."""
    pushed = replace(tipping, load=np.array([5.0 / np.sqrt(MASS)]))
    rest = (5.0 + STIFFNESS * CLEARANCE) / (STIFFNESS + NEGATIVE)
    found = equilibrium(pushed, pushed.load) / np.sqrt(MASS)
    np.testing.assert_allclose(found, [rest], rtol=1e-9)


def test_the_pressed_boom_is_damped_as_asked_for() -> None:
    """Reference: the ratio that is asked for, of a mass bonded to an elastic one beside it."""
    two = GapSystem(
        omega2=np.array([NEGATIVE / MASS, 400.0]),
        load=np.array([-9.0, 0.0]),
        rows=np.array([[0.5, -0.4]]),
        laws=[STOPS],
        station_of_row=np.array([0]),
        stations=[0.0],
        observers={"tip": Observer(np.ones(2))},
    )
    omega, ratios = closed_contact_damping(with_modal_damping(two, 0.03))
    assert (omega > 0.0).all()
    assert ratios[0] == pytest.approx(0.03, rel=1e-6)
