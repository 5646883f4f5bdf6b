# SPDX-License-Identifier: LGPL-3.0-or-later
"""Equilibria, second-order effects of axial forces, and buckling with closed contacts."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_contact_damping, with_modal_damping
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.second_order import buckling_factor, soften_modes
from protractile.dynamics.stability import closed_contact_factor
from tests.modal import modal_system, one_mass


def mass_over_stop(exponent: float, omega2: float) -> GapSystem:
    """Return 2 kg on a spring, with a stop of 3e6 N/mⁿ after 4 mm on the upper side only."""
    row = np.array([1.0 / np.sqrt(2.0)])
    law = PowerContact(3.0e6, exponent).upper().with_clearance(4.0e-3)
    return modal_system([omega2], [0.0], row, [law], tip=row)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_free_mass_rests_on_its_stop(exponent: float) -> None:
    """Reference: analytic. k pⁿ = 50 N."""
    system = mass_over_stop(exponent, 0.0)
    position = equilibrium(system, 50.0 * system.rows[0])
    depth = (50.0 / 3.0e6) ** (1.0 / exponent)
    assert system.rows[0] @ position == pytest.approx(4.0e-3 + depth, rel=1e-6)


def test_spring_carries_the_load_before_contact() -> None:
    """Reference: analytic. 2 kg · 900 rad²/s² = 1800 N/m, 5 N."""
    system = mass_over_stop(1.0, 900.0)
    assert system.rows[0] @ equilibrium(system, 5.0 * system.rows[0]) == pytest.approx(5.0 / 1800.0)


@pytest.mark.parametrize(("weight", "expected"), [(0.0, 1.0e-3), (4.0, 1.0e-3 - 4.0 / 3.0e6)])
def test_shim_preload_displaces_an_unloaded_mass(weight: float, expected: float) -> None:
    """Reference: analytic. A shim 1 mm thicker than the play lifts a mass until it is free."""
    below = PowerContact(3.0e6, 1.0).lower().with_clearance(-1.0e-3)
    above = mass_over_stop(1.0, 0.0)
    row, laws, places = above.rows[0], [*above.laws, below], np.zeros(2, dtype=np.int64)
    system = replace(above, rows=np.vstack([row, row]), laws=laws, station_of_row=places)
    assert row @ equilibrium(system, -weight * row) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("weight", [40.0, 60.0, -30.0])
def test_the_start_of_the_search_does_not_matter(weight: float) -> None:
    """Reference: analytic, a spring and a Hertzian stop below; the start is 50 N on the stop."""
    system = mass_over_stop(1.5, 900.0)
    near = equilibrium(system, 50.0 * system.rows[0])
    found = equilibrium(system, weight * system.rows[0], near)
    gap = float(system.rows[0] @ found)
    force = 1800.0 * gap + 3.0e6 * max(gap - 4.0e-3, 0.0) ** 1.5
    assert force == pytest.approx(weight, rel=1e-6)


def test_unsupported_mass_has_no_equilibrium() -> None:
    """The mass has no stop below it."""
    system = mass_over_stop(1.0, 0.0)
    with pytest.raises(NumericsError, match="no static equilibrium"):
        equilibrium(system, -50.0 * system.rows[0])


def test_buckled_system_has_no_equilibrium() -> None:
    """The axial forces exceed the stiffness of its spring."""
    buckled = modal_system([900.0], [0.0], geometric_stiffness=np.array([[901.0]]))
    message = "nothing holds the boom, or axial forces buckle it: it has no static equilibrium"
    with pytest.raises(NumericsError, match=f"^{message}$"):
        equilibrium(buckled, np.ones(1))


MASS, NEGATIVE, STIFFNESS, CLEARANCE = 3.0, -48.0, 1.0e6, 0.01
GROWTH = np.sqrt(-NEGATIVE / MASS)
STOPS = PowerContact(STIFFNESS, 1.0).with_clearance(CLEARANCE)


@pytest.fixture(name="tipping")
def _tipping() -> GapSystem:
    """Return a mass on a negative spring between two stops."""
    return one_mass(MASS, STOPS, spring=NEGATIVE)


def test_modes_soften_like_the_whole_stiffness() -> None:
    """Reference: analytic, eigenvalues of diag(ω²) − G by another routine; translations keep 0."""
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


def test_mode_buckles_at_zero_stiffness() -> None:
    """Reference: analytic, K/K_G for one coordinate, and the root of a determinant for two."""
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
    """Reference: analytic. From rest at a, a cosh κt, which touches at acosh(Δ/a)/κ."""
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


def test_boom_in_contact_has_the_given_damping() -> None:
    """Reference: the given ratio, for a mass bonded to an elastic one."""
    two = modal_system([NEGATIVE / MASS, 400.0], [-9.0, 0.0], [0.5, -0.4], [STOPS], tip=[1.0, 1.0])
    omega, ratios = closed_contact_damping(with_modal_damping(two, 0.03))
    assert (omega > 0.0).all()
    assert ratios[0] == pytest.approx(0.03, rel=1e-6)


@pytest.mark.parametrize(("exponent", "force"), [(1.0, 300.0), (2.0, 300.0), (2.0, 1200.0)])
def test_a_bar_on_a_contact_buckles_as_its_stiffness_says(exponent: float, force: float) -> None:
    """Reference: analytic, a hinged bar on a contact with tangent stiffness k buckles at k b²/L.

    The bar turns by a/√I with the moment of inertia I, and its tip is pressed onto a contact at
    the distance b. The stiffness k at rest follows from the force and the exponent.
    """
    inertia, arm, length, axial = 40.0, 2.0, 5.0, 1e4
    law = PowerContact(1e6, exponent).lower()
    geometric = np.array([[axial * length / inertia]])
    system = GapSystem(
        omega2=-geometric[0],
        load=np.array([-force * arm / np.sqrt(inertia)]),
        rows=np.array([[arm / np.sqrt(inertia)]]),
        laws=[law],
        station_of_row=np.array([0]),
        stations=[arm],
        observers={"tip": Observer(np.array([length / np.sqrt(inertia)]))},
    )
    rest = equilibrium(system, system.load)
    stiffness = float(law.slope(system.rows[0] @ rest))
    factor = closed_contact_factor(system, geometric, rest)
    assert factor == pytest.approx(stiffness * arm**2 / (axial * length), rel=1e-9)


def test_a_boom_without_axial_forces_does_not_buckle() -> None:
    """Reference: analytic."""
    bar = GapSystem(
        omega2=np.array([4.0]),
        load=np.array([1.0]),
        rows=np.zeros((0, 1)),
        laws=[],
        station_of_row=np.zeros(0, dtype=int),
        stations=[],
        observers={"tip": Observer(np.ones(1))},
    )
    assert closed_contact_factor(bar, np.zeros((1, 1)), np.array([0.25])) == float("inf")
