# SPDX-License-Identifier: LGPL-3.0-or-later
"""Moving axial forces: reduction of the stiffness, as matrices and in the time loop."""

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import PiecewiseLinear
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import SCurve
from protractile.dynamics.travel import MovingAxialForce, RowTable, Travel
from tests.dynamics.reference import errors_in_the_step, runge_kutta, slopes
from tests.modal import modal_system

# Sines of a beam of 10 m, from its middle on, in two planes that share no mode.
WAVES = np.pi * np.arange(1, 4) / 10.0
FORCE = 100.0


def slope(s: float) -> np.ndarray:
    """Return the slopes (2, 6) in both planes at an extension in m."""
    own = WAVES * np.cos(WAVES * (5.0 + s))
    return np.array([[*own, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, *(2.0 * own)]])


def thrust() -> MovingAxialForce:
    def rows(s: float) -> np.ndarray:
        own = np.sin(WAVES * (5.0 + s))
        return np.array([[*own, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, *(2.0 * own)]])

    return MovingAxialForce(FORCE, RowTable.interpolate(rows, [-1.0, 0.5, 2.0]))


def softer(s: float) -> np.ndarray:
    """Return N ∫ w′ᵀ w′ dσ by Gauss's rule over the whole extension."""
    points, weights = np.polynomial.legendre.leggauss(30)
    slopes = [slope(0.5 * s * (point + 1.0)) for point in points]
    total = sum(w * one.T @ one for w, one in zip(weights, slopes, strict=True))
    return np.asarray(0.5 * s * FORCE * total)


def pressed_along(history: SCurve | PiecewiseLinear) -> GapSystem:
    """Return six modes on a soft contact with a constant row."""
    row = np.array([[0.1, -0.2, 0.3, 0.2, 0.1, -0.3]])
    table = RowTable(np.array([-1.0, 2.0]), np.array([[row, 0 * row, 0 * row, 0 * row]]))
    return modal_system(
        [200.0, 300.0, 900.0, 400.0, 2000.0, 5000.0],
        [1.0, -2.0, 0.5, 1.0, 0.2, 0.1],
        row,
        [PowerContact(1e4, 1.0).with_clearance(1e-4)],
        tip=row[0],
        damping=np.array([0.1, 0.2, 0.3, 0.1, 0.2, 0.3]),
        travels=[Travel(history, table, (("rows", 0),), "", (thrust(),))],
    )


@pytest.mark.parametrize("s", [-1.0, -0.3, 0.0, 0.5, 1.7])
def test_thrust_softens_the_passed_length(s: float) -> None:
    """Reference: analytic, the integral over the extension by Gauss's rule."""
    assert thrust().geometric_stiffness(s) == pytest.approx(softer(s), rel=1e-6, abs=1e-6 * FORCE)


@pytest.mark.parametrize("knots", [[-1.0, -0.4, 1.0], [-2.0, 0.0], [0.0, 1.0]])
def test_thrust_without_travel_changes_no_stiffness(knots: list[float]) -> None:
    """Reference: analytic, 0 to the last bit, for any knots."""
    table = RowTable.interpolate(lambda s: np.sin(WAVES * (5.0 + s))[None], knots)
    assert not MovingAxialForce(FORCE, table).geometric_stiffness(0.0).any()


def test_only_passed_pieces_are_integrated() -> None:
    """Reference: analytic, a polynomial in many pieces, whose matrices would need 0.16 GB."""
    modes, knots = 200, np.linspace(-1.0, 1.0, 501)
    table = RowTable(
        knots, np.tile(np.diff(knots)[0] * np.eye(4)[1][:, None, None], (500, 1, 1, modes))
    )
    tracemalloc.start()
    found = MovingAxialForce(2.0, table).geometric_stiffness(0.0105)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found == pytest.approx(np.full((modes, modes), 0.021), rel=1e-12)
    assert most < 50e6


def test_as_it_stands_its_own_modes_are_those_of_the_softer_boom() -> None:
    """Reference: analytic, the eigenvalues of diag(ω²) − K_G. The equilibrium is the same."""
    stands = pressed_along(SCurve(2.0, 1.0)).at_time(1.0)
    own = stands.in_own_modes()
    expected = eigh(np.diag(stands.omega2) - softer(2.0), eigvals_only=True)
    assert own.omega2 == pytest.approx(expected, rel=1e-6)
    assert (np.abs(own.omega2 - np.sort(stands.omega2)) > 10.0).any()
    rests = [float(one.observers["tip"].row @ equilibrium(one, one.load)) for one in (stands, own)]
    assert rests[0] == pytest.approx(rests[1], rel=1e-8)
    assert own.in_own_modes() is own
    message = "^a system with geometric_stiffness must be transformed by in_own_modes$"
    with pytest.raises(ValueError, match=message):
        Motion(stands, 1.0)


@pytest.mark.parametrize("travel", [2.0, -0.9])
def test_a_motion_by_an_integration_of_its_own(travel: float) -> None:
    """Reference: other code, scipy's DOP853 with the matrix: order 2, error, and effect of the
    force. The energy balance verifies the work of the drive.
    """
    drawn = pressed_along(SCurve(travel, 1.0))
    motion = Motion(replace(drawn, damping=np.zeros(6)), 1.0, 1e-2)
    expected = runge_kutta(motion, 2e-3)
    errors = errors_in_the_step(motion, expected, np.array([1e-3, 5e-4, 2.5e-4]))
    assert slopes(errors) == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < 1e-4
    plain = replace(motion.system, travels=[replace(drawn.travels[0], axial_forces=())])
    (off,) = errors_in_the_step(replace(motion, system=plain), expected, np.array([5e-4]))
    assert off > 0.05
    assert FixedStep(5e-4)(motion).energy_residual < 1e-11
