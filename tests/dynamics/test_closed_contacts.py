# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contacts that press at the start: exact while they stay closed, none missed when they open."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from dynamics.integrators.splitting import integrate

from dynamics.contact import PowerContact
from dynamics.contact_table import TableContact
from dynamics.equilibrium import equilibrium
from dynamics.excitation import Excitation, Ramp, Table
from dynamics.friction import DryFriction
from dynamics.gap_system import GapSystem, Observer
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory

# Of a body of 1 kg in N, of what it lies on in N/m.
WEIGHT, STIFFNESS = 10.0, 1.0e6


def lying(history: Ramp | Table, load: float) -> Motion:
    """The body, from its rest on a floor with a ceiling above, under a further load in N."""
    system = GapSystem(
        omega2=np.zeros(1),
        load=np.array([-WEIGHT]),
        rows=np.ones((1, 1)),
        laws=[PowerContact(STIFFNESS, 1.0, clearance=2.0e-3)],
        station_of_row=np.array([0]),
        stations=[0.0],
        observers={"tip": Observer(np.ones(1)), "speed": Observer(np.ones(1), "m/s", 1)},
        excitations=[Excitation(np.array([load]), history)],
    )
    return Motion(system, 0.2, 1.0e-3, position=equilibrium(system, system.load))


def boom(pull: float, damping: float = 0.0, dashpot: float = 0.0) -> Motion:
    """Two segments that press at three rows of as many kinds, pulled up and let go."""
    random = np.random.default_rng(7)
    n = 9
    omega2 = np.array([0.0, 0.0, 5.0e1, 3.0e2, 2.0e3, 9.0e3, 4.0e4, 2.0e5, 6.0e5])
    rigid = np.array([[0.1, 0.2], [0.2, -0.1], [0.15, 0.1]])
    up = np.array([90.0, -30.0, *random.normal(0.0, 3.0, n - 2)])
    system = GapSystem(
        omega2=omega2,
        load=np.array([-40.0, 9.0, *random.normal(0.0, 3.0, n - 2)]),
        rows=rigid @ np.eye(2, n) + random.normal(0.0, 0.05, (3, n)),
        laws=[
            PowerContact(2.0e6, 1.0, clearance=2.0e-3),
            TableContact((1.0e-5, 1.0e-4), (20.0, 300.0), clearance=1.0e-3),
            PowerContact(1.0e6, 1.0, clearance=1.0e-3, stiffness_below=3.0e6),
        ],
        station_of_row=np.array([0, 1, 2]),
        stations=[0.0, 1.0, 2.0],
        observers={"tip": Observer(random.normal(0.0, 1.0, n))},
        damping=damping * np.sqrt(omega2),
        dashpots=dashpot * random.normal(0.0, 0.5, (1, n)),
        excitations=[Excitation(pull * up, Table((0.0, 0.05, 0.0803, 0.1, 0.13), (0, 0, 1, 1, 0)))],
    )
    return Motion(system, 0.3, 1.0e-3, position=equilibrium(system, system.load))


def step_by_step(motion: Motion, step: float) -> Trajectory:
    """The same motion by impulses of every contact: friction without strength asks for them."""
    row = np.ones((1, motion.system.num_modes))
    rubbed = replace(motion.system, friction_rows=row, frictions=[DryFriction(0.0, 0)])
    return integrate(replace(motion, system=rubbed), step)


def test_a_closed_contact_is_a_spring() -> None:
    """Reference: analytic, a mass on a spring under a load that rises to 5 N within 10.4 ms."""
    rise, load = 0.0104, -5.0
    run = integrate(lying(Ramp(rise), load), step=1.0e-5)
    time, omega = run.time, np.sqrt(STIFFNESS)
    since = np.maximum(time - rise, 0.0)
    grown = (time - since - (np.sin(omega * time) - np.sin(omega * since)) / omega) / rise
    rest = -2.0e-3 - WEIGHT / STIFFNESS
    np.testing.assert_allclose(run.data["tip"], rest + load / STIFFNESS * grown, atol=1e-14)
    assert run.data.attrs["steps"] < 2000
    assert run.energy_residual < 1e-9
    # The impulse of each interval is what the momentum and the loads ask for.
    impulse = np.where(time < rise, 0.5 * time**2 / rise, time - 0.5 * rise)
    asked = 1.0e3 * (np.diff(load * impulse) - np.diff(run.data["speed"])) - WEIGHT
    np.testing.assert_allclose(run.data["contact_force"][1:, 0], asked, atol=1e-8)


@pytest.mark.parametrize(
    ("motion", "openings", "fewer", "within"),
    [
        (boom(0.4), 1, 50, 1e-8),
        (boom(0.4, damping=2.0e-5), 1, 50, 2e-6),
        (boom(0.6), 30, 1.2, 1e-6),
        (boom(0.4, damping=0.02, dashpot=20.0), 5, 0.9, 1e-8),
    ],
    ids=["closed", "damped", "opening", "coupled"],
)
def test_closed_contacts_and_impulses_find_the_same(
    motion: Motion, openings: int, fewer: float, within: float
) -> None:
    """Reference: other code, the splitting by impulses of every contact.

    The last boom has so much damping between its modes that no contact is closed.
    """
    run, expected = integrate(motion, 1.0e-6), step_by_step(motion, 1.0e-6)
    assert fewer * run.data.attrs["steps"] <= expected.data.attrs["steps"]
    assert run.data.attrs["contact_changes"] == expected.data.attrs["contact_changes"] >= openings
    for name, digits in (("tip", 1.0), ("gap", 50.0), ("contact_force", 500.0)):
        error = np.abs(run.data[name] - expected.data[name]).max()
        assert error < digits * within * np.abs(expected.data[name]).max(), name
    assert run.energy_residual < 1e-8
