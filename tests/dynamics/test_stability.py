# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling with closed contacts: their stiffness counts, and open stations are bonded."""

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.stability import closed_contact_factor


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
