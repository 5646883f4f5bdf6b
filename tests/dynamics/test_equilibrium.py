# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rest positions are where all forces balance."""

from dataclasses import replace

import numpy as np
import pytest

from beam_model.finite_element import finite_element_segment
from beam_model.segment_model import gap_system
from dynamics.contact import PowerContact
from dynamics.equilibrium import equilibrium
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem, Observer
from dynamics.integrator import FixedStep
from dynamics.motion import Motion
from geometry.boom import Boom
from tests.touching import touching


def mass_over_stop(exponent: float, omega2: float) -> GapSystem:
    """2 kg on a spring, and a stop of 3e6 N/mⁿ after 4 mm above alone."""
    row = np.array([1.0 / np.sqrt(2.0)])
    return GapSystem(
        omega2=np.array([omega2]),
        load=np.zeros(1),
        rows=row[None],
        laws=[PowerContact(3.0e6, exponent).upper().behind(4.0e-3)],
        station_of_row=np.zeros(1, dtype=np.int64),
        stations=[0.0],
        observers={"tip": Observer(row)},
    )


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_a_free_mass_rests_where_its_stop_carries_the_force(exponent: float) -> None:
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
    """Reference: analytic. A shim 1 mm beyond the play below lifts a mass until it is free."""
    below = PowerContact(3.0e6, 1.0).lower().behind(-1.0e-3)
    above = mass_over_stop(1.0, 0.0)
    row, laws, places = above.rows[0], [*above.laws, below], np.zeros(2, dtype=np.int64)
    system = replace(above, rows=np.vstack([row, row]), laws=laws, station_of_row=places)
    assert row @ equilibrium(system, -weight * row) == pytest.approx(expected, abs=1e-8)


def test_unsupported_mass_has_no_equilibrium() -> None:
    """Below the mass there is no stop."""
    system = mass_over_stop(1.0, 0.0)
    with pytest.raises(NumericsError, match="no static equilibrium"):
        equilibrium(system, -50.0 * system.rows[0])


def test_buckled_system_has_no_equilibrium() -> None:
    """They take more than its spring gives."""
    free = {"rows": np.zeros((0, 1)), "laws": [], "station_of_row": np.zeros(0, dtype=np.int64)}
    buckled = replace(mass_over_stop(1.0, 900.0), **free, geometric_stiffness=np.array([[901.0]]))
    message = "nothing holds the boom, or axial forces buckle it: it has no static equilibrium"
    with pytest.raises(NumericsError, match=f"^{message}$"):
        equilibrium(buckled, np.ones(1))


@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_the_inner_segment_hangs_on_its_stations(paper_boom: Boom, exponent: float) -> None:
    """Reference: analytic, the lever rule: 550.7 N at x = 14 m on stations at 9 and 10 m."""
    models = [
        finite_element_segment(segment, 0.5, (9.0, 10.0), "euler-bernoulli", False)
        for segment in paper_boom.segments
    ]
    law = PowerContact(1.0e9 if exponent == 1.0 else 1.0e13, exponent).behind(7.0e-3)
    system = gap_system(touching(paper_boom, law), models)
    at_rest = equilibrium(system, system.load)
    forces = [law.force(y) for law, y in zip(system.laws, system.rows @ at_rest, strict=True)]
    assert forces == pytest.approx([-4.0 * 550.7, 5.0 * 550.7], rel=1e-5)
    stays = FixedStep(1e-4)(Motion(system, 0.2, position=at_rest))
    assert np.ptp(stays.data["tip"].values) < 1e-6 * abs(stays.data["tip"].values[0])
