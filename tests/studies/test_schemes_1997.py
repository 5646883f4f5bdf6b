# SPDX-License-Identifier: LGPL-3.0-or-later
"""Schemes of the 1990s, compared with a textbook, and contacts compared with a spring."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from studies.numerics_1997.schemes import (
    CENTRAL,
    NEWMARK,
    WILSON,
    Scheme,
    integrate,
    lowest,
)
from tests.modal import modal_system, oscillator

ALL = (NEWMARK, WILSON, CENTRAL)
DEEP = 100.0
# Number of steps for the measurement of an eigenvalue.
STEPS = 100


def textbook_root(scheme: Scheme, phase: float) -> complex:
    """Return the eigenvalue λ of the amplification matrix of an undamped oscillator.

    Newmark's scheme and central differences have closed forms; Wilson's scheme has the matrix of
    Bathe (1996, section 9.4).

    Args:
        scheme: one of the three schemes.
        phase: ω h, the circular frequency times the step.
    """
    if scheme == NEWMARK:
        return complex(np.exp(2.0j * np.arctan(0.5 * phase)))
    if scheme == CENTRAL:
        return complex(np.exp(2.0j * np.arcsin(0.5 * phase)))
    theta = scheme.theta
    b = 1.0 / (theta / phase**2 + theta**3 / 6.0)
    matrix = [
        [1.0 - b * theta**2 / 3.0 - 1.0 / theta, -b * theta, -b],
        [1.0 - 0.5 / theta - b * theta**2 / 6.0, 1.0 - 0.5 * b * theta, -0.5 * b],
        [0.5 - (1.0 / theta + b * theta**2 / 3.0) / 6.0, 1.0 - b * theta / 6.0, 1.0 - b / 6.0],
    ]
    return _rotating_root(np.linalg.eigvals(matrix))


def measured_root(scheme: Scheme, phase: float) -> complex:
    """Return the eigenvalue λ of the amplification matrix from a computed motion."""
    motion = Motion(oscillator(), STEPS * phase, phase, position=np.ones(1))
    way = integrate(motion, scheme, iterated=False).trajectory.states[:, 0]
    behind = np.stack([way[2:-1], way[1:-2], way[:-3]], axis=1)
    return _rotating_root(np.roots([1.0, *-np.linalg.lstsq(behind, way[3:], rcond=1.0e-9)[0]]))


def _rotating_root(roots: object) -> complex:
    """Return the eigenvalue with a positive imaginary part."""
    return complex(max(np.asarray(roots), key=lambda root: root.imag))


def sprung() -> GapSystem:
    """Return 1 kg always in contact with two stops of together 1 N/m, without another spring."""
    contact = PowerContact(0.5, 1.0).with_clearance(-DEEP)
    return modal_system([0.0], [0.0], [1.0], [contact], tip=[1.0])


def rubbing(force: float) -> GapSystem:
    """Return 1 kg that slides against a friction force in N."""
    friction = DryFriction(coefficient=1.0, station=0, normal_force=force)
    rows = {"friction_rows": np.ones((1, 1)), "frictions": [friction]}
    return replace(oscillator(), omega2=np.zeros(1), stations=[0.0], **rows)


@pytest.mark.parametrize("scheme", ALL, ids=str)
@pytest.mark.parametrize("phase", [0.1, 0.628, 1.5])
def test_an_oscillator_turns_as_the_textbook_says(scheme: Scheme, phase: float) -> None:
    """Reference: analytic, roots of the amplification matrix, Bathe 1996, section 9.4."""
    assert measured_root(scheme, phase) == pytest.approx(textbook_root(scheme, phase), rel=1e-9)


def test_wilson_overshoots_and_newmark_does_not() -> None:
    """Reference: analytic, ω h = 50: Wilson overshoots 1 m (Goudreau and Taylor 1973)."""
    far = {
        scheme: np.abs(integrate(let_go, scheme, False).trajectory.states).max()
        for scheme in (NEWMARK, WILSON)
        for let_go in [Motion(oscillator(), 500.0, 50.0, position=np.ones(1))]
    }
    assert far[NEWMARK] <= 1.0 + 1e-9
    assert far[WILSON] > 100.0


def test_central_differences_break_out_beyond_two_over_omega() -> None:
    """Reference: analytic. The scheme is stable for ω h < 2 only."""
    stays, grows = (
        integrate(Motion(oscillator(), 100.0, step, position=np.ones(1)), CENTRAL, False)
        for step in (1.98, 2.02)
    )
    assert np.abs(stays.trajectory.states).max() < 10.0
    assert grows.finite_steps < 100
    assert np.isnan(grows.trajectory.states[-1]).all()


@pytest.mark.parametrize("scheme", ALL, ids=str)
def test_an_iterated_contact_is_a_spring_of_the_mode(scheme: Scheme) -> None:
    """Reference: other code path, the same spring as the stiffness of the mode."""
    of_mode, of_contact = (
        integrate(Motion(system, 20.0, 0.1, position=np.ones(1)), scheme, True).trajectory
        for system in (replace(sprung(), omega2=np.ones(1), rows=np.zeros((1, 1))), sprung())
    )
    assert of_contact.states == pytest.approx(of_mode.states, abs=1e-9)


def test_a_lagged_contact_gains_energy() -> None:
    """Reference: analytic. A lag is a dashpot of −k h: amplitudes grow as exp(h t/4)."""
    step, duration = 0.05, 20.0
    swings = []
    for iterated in (True, False):
        motion = Motion(sprung(), duration, step, position=np.ones(1))
        late = integrate(motion, NEWMARK, iterated).trajectory.states[-200:, 0]
        swings.append(np.abs(late).max())
    assert swings[0] == pytest.approx(1.0, abs=1e-2)
    assert swings[1] > np.exp(0.25 * step * duration)


def test_iterated_impacts_come_near_the_converged_ones() -> None:
    """Reference: other code, splitting. An impact has 60 steps; the rebound agrees within 1 %."""
    stop = replace(sprung(), laws=[PowerContact(100.0, 1.0).with_clearance(0.5)])
    motion = Motion(stop, 2.0, 0.005, velocity=np.ones(1))
    found = integrate(motion, NEWMARK, True).trajectory.states[-1]
    assert found == pytest.approx(FixedStep(1e-4)(motion).states[-1], abs=1e-2)


def test_sliding_dissipates_the_work_of_friction() -> None:
    """Reference: analytic, v t − F t²/2 while it slides, and the loss F s."""
    motion = Motion(rubbing(0.5), 1.0, 0.01, velocity=np.ones(1))
    for iterated in (True, False):
        run = integrate(motion, NEWMARK, iterated).trajectory
        assert float(run.states[-1, 0]) == pytest.approx(0.75, abs=1e-9)
        assert float(run.data["friction_loss"][-1]) == pytest.approx(0.375, abs=1e-9)
        assert run.energy_residual < 1e-9


def test_friction_stop_within_a_step_does_not_converge() -> None:
    """Reference: by hand. At rest after 1 s, the sign of the speed changes with every iteration."""
    run = integrate(Motion(rubbing(1.0), 2.0, 0.03, velocity=np.ones(1)), NEWMARK, True)
    assert not run.unconverged[:33].any()
    assert run.unconverged[33:].mean() > 0.4


def test_the_lowest_modes_are_kept_in_their_order() -> None:
    system = modal_system([9.0, 0.0, 4.0], [1.0, 2.0, 3.0], np.arange(3.0), sprung().laws)
    cut = lowest(system, 2)
    assert cut.omega2.tolist() == [0.0, 4.0]
    assert cut.load.tolist() == [2.0, 3.0]
    assert cut.rows.tolist() == [[1.0, 2.0]]
