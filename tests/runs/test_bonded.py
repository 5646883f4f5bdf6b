# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contacts that press are ties, and those of the ground stay."""

from dataclasses import replace

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.equilibrium import equilibrium
from dynamics.excitation import Excitation, Step
from dynamics.gap_system import GapSystem, Observer
from runs.pipeline.bonded import bonded_system

LAW = PowerContact(1e6, 1.0).behind(0.01)


@pytest.fixture
def pair() -> GapSystem:
    """1 kg on a spring of 100 N/m, 1 kg that hangs in it by a play of 10 mm each way, with 5 N on
    it, and a rest on the ground far below.
    """
    return GapSystem(
        omega2=np.array([100.0, 0.0]),
        load=np.array([0.0, -5.0]),
        rows=np.array([[-1.0, 1.0], [0.0, 1.0]]),
        laws=[LAW, PowerContact(1e5, 1.0).behind(0.5)],
        station_of_row=np.array([0, 1]),
        stations=[1.0, 2.0],
        station_directions=("z", "z"),
        grounded=[1],
        observers={"tip": Observer(np.array([0.0, 1.0]))},
        excitations=[Excitation(np.array([1.0, 0.0]), Step())],
    )


def test_the_bonded_boom_lacks_the_play_alone(pair: GapSystem) -> None:
    """Reference: by hand. Both hang at −5/100 m; with play the inner one is 10 mm and 5 µm lower.
    Together they swing at √(100/2) rad/s.
    """
    rest = equilibrium(pair, pair.load)
    bonded, basis = bonded_system(pair, [rest])
    hung = equilibrium(bonded, bonded.load)
    np.testing.assert_allclose(basis @ hung, [-0.05, -0.05], rtol=1e-9)
    tip = bonded.observers["tip"].row @ hung
    assert pair.observers["tip"].row @ rest - tip == pytest.approx(-0.01 - 5e-6, rel=1e-6)
    np.testing.assert_allclose(bonded.omega2, [50.0], rtol=1e-12)
    np.testing.assert_allclose(basis @ bonded.excitations[0].load, [0.5, 0.5], rtol=1e-12)


def test_bonded_system_keeps_the_softening_by_axial_forces(pair: GapSystem) -> None:
    """Reference: analytic. Of 100 N/m they take 30 N/m, and both swing at √(70/2) rad/s."""
    pressed = replace(pair, geometric_stiffness=np.diag([30.0, 0.0]))
    bonded, _ = bonded_system(pressed, [equilibrium(pressed, pressed.load)])
    np.testing.assert_allclose(bonded.omega2, [35.0], rtol=1e-12)
    assert bonded.in_own_modes() is bonded


def test_the_ground_is_still_met(pair: GapSystem) -> None:
    """Reference: by hand. −100 N press it 0.5 m and (100 − 50)/(1e5 + 100) m down."""
    bonded, basis = bonded_system(pair, [equilibrium(pair, pair.load)])
    assert (list(bonded.stations), list(bonded.grounded)) == ([2.0], [0])
    deep = basis @ equilibrium(bonded, np.array([0.0, -100.0]) @ basis)
    assert deep[1] == pytest.approx(-0.5 - 50.0 / (1e5 + 100.0), rel=1e-6)


def test_where_nothing_presses_all_is_bonded(pair: GapSystem) -> None:
    bonded, _ = bonded_system(pair, [])
    np.testing.assert_allclose(bonded.omega2, [50.0], rtol=1e-12)
