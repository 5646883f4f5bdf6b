# SPDX-License-Identifier: LGPL-3.0-or-later
"""Integrators are values that move a system as the functions that they name do."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest

from dynamics.event_driven import integrate_events
from dynamics.integrators import FEW_MODES, Events, Integrator, Splitting, by_splitting, suited
from dynamics.splitting import integrate
from dynamics.step import contact_step, initial_speeds
from tests.dynamics.two_stops import CHAOTIC

START = {"position": np.array([0.01, 0.0]), "velocity": np.array([0.5, -1.0])}


@pytest.mark.parametrize("integrator", [Splitting(1e-3), Events(1e-6)])
def test_values_move_as_their_functions(integrator: Integrator) -> None:
    """Reference: other code path."""
    parts: list[float] = []
    run = pickle.loads(pickle.dumps(integrator))(CHAOTIC, 2.0, 1e-2, **START, progress=parts.append)
    if isinstance(integrator, Splitting):
        expected = integrate(CHAOTIC, 2.0, 1e-2, step=1e-3, **START)
    else:
        expected = integrate_events(CHAOTIC, 2.0, 1e-2, tolerance=1e-6, **START)
    np.testing.assert_array_equal(run.states, expected.states)
    assert parts[-1] == 1.0


@pytest.mark.parametrize("integrator", [Splitting(2e-3), Events(1e-4)])
def test_finer_ones_lose_less(integrator: Integrator) -> None:
    """Reference: the coarser one's energy residual; half a step of order two leaves a quarter."""
    coarse = integrator(CHAOTIC, 5.0, 1e-2).energy_residual
    assert integrator.finer()(CHAOTIC, 5.0, 1e-2).energy_residual < 0.6 * coarse


def test_few_modes_go_from_contact_to_contact() -> None:
    assert suited(CHAOTIC, 1e-3) == Events()
    assert suited(replace(CHAOTIC, damping=np.ones(2)), 1e-3) == Splitting(1e-3)
    many = FEW_MODES + 1
    system = replace(
        CHAOTIC,
        omega2=np.arange(1.0, many + 1.0),
        load=np.ones(many),
        rows=np.ones((1, many)),
        damping=np.zeros(0),
        friction_rows=np.zeros((0, 0)),
        observers={},
    )
    assert suited(system, 1e-3) == Splitting(1e-3)


def test_the_step_fits_the_initial_state() -> None:
    """Reference: other code path."""
    speeds = initial_speeds(CHAOTIC, *START.values())
    assert by_splitting(CHAOTIC, 1e-2, None, **START).step == contact_step(CHAOTIC, 1e-2, speeds)
    assert by_splitting(CHAOTIC, 1e-2).step == contact_step(CHAOTIC, 1e-2)
    assert by_splitting(CHAOTIC, 1e-2, 3e-4, **START) == Splitting(3e-4)
