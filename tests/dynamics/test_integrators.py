# SPDX-License-Identifier: LGPL-3.0-or-later
"""Integrators are values that move a system as the functions that they name do."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from dynamics.integrators.event_driven import integrate_events
from dynamics.integrators.integrator import (
    FEW_MODES,
    Events,
    Integrator,
    Splitting,
    by_splitting,
    simulate,
    suited,
)
from dynamics.integrators.splitting import integrate
from dynamics.integrators.step import contact_step

from dynamics.motion import Motion
from tests.dynamics.two_stops import CHAOTIC

MOTION = Motion(CHAOTIC, 2.0, 1e-2, np.array([0.01, 0.0]), np.array([0.5, -1.0]))


@pytest.mark.parametrize("integrator", [Splitting(1e-3), Events(1e-6)])
def test_values_move_as_their_functions(integrator: Integrator) -> None:
    """Reference: other code path."""
    parts: list[float] = []
    run = pickle.loads(pickle.dumps(integrator))(MOTION, parts.append)
    if isinstance(integrator, Splitting):
        expected = integrate(MOTION, step=1e-3)
    else:
        expected = integrate_events(MOTION, tolerance=1e-6)
    np.testing.assert_array_equal(run.states, expected.states)
    assert parts[-1] == 1.0


@pytest.mark.parametrize("integrator", [Splitting(2e-3), Events(1e-4)])
def test_finer_ones_lose_less(integrator: Splitting | Events) -> None:
    """Reference: the coarser one's energy residual; half a step of order two leaves a quarter."""
    motion = Motion(CHAOTIC, 5.0, 1e-2)
    coarse = integrator(motion).energy_residual
    assert integrator.finer()(motion).energy_residual < 0.6 * coarse
    assert integrator.coarser()(motion).energy_residual > coarse / 0.6


def test_few_modes_go_from_contact_to_contact() -> None:
    motion = Motion(CHAOTIC, 5.0, 1e-2)
    assert suited(motion) == Events()
    assert suited(MOTION) == by_splitting(MOTION)
    hindered = replace(motion, system=replace(CHAOTIC, damping=np.ones(2)))
    assert suited(hindered) == by_splitting(hindered)
    many = FEW_MODES + 1
    system = replace(
        CHAOTIC,
        omega2=np.arange(1.0, many + 1.0),
        load=np.ones(many),
        rows=np.ones((1, many)),
        **dict.fromkeys(("damping", "released", "thrown"), np.zeros(0)),
        friction_rows=np.zeros((0, 0)),
        observers={},
    )
    crowded = Motion(system, 5.0, 1e-2)
    assert suited(crowded) == by_splitting(crowded)


def test_the_step_fits_the_initial_state() -> None:
    """Reference: by hand, √(v² + ω² a²) of each mode."""
    speeds = np.sqrt(MOTION.velocity**2 + CHAOTIC.omega2 * MOTION.position**2)
    assert by_splitting(MOTION).step == contact_step(CHAOTIC, 1e-2, speeds)
    assert by_splitting(Motion(CHAOTIC, 2.0, 1e-2)).step == contact_step(CHAOTIC, 1e-2)


def test_what_is_simulated_is_the_motion() -> None:
    """Reference: other code path."""
    start = {"position": [0.01, 0.0], "velocity": [0.5, -1.0]}
    run = simulate(CHAOTIC, 2.0, 1e-2, **start)
    np.testing.assert_array_equal(run.states, by_splitting(MOTION)(MOTION).states)
    run = simulate(CHAOTIC, 2.0, 1e-2, **start, integrator=Splitting(1e-3))
    np.testing.assert_array_equal(run.states, Splitting(1e-3)(MOTION).states)
