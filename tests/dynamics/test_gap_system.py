# SPDX-License-Identifier: LGPL-3.0-or-later
"""Properties of gap systems, and refusal of inconsistent shapes."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.excitation import Excitation, PiecewiseLinear, Step
from protractile.dynamics.gap_system import GapSystem, Observer
from studies.reference_models.statics import static_response

LAW = PowerContact(stiffness=1.0e6, exponent=1.0).with_clearance(1.0e-3)
RUB = DryFriction(0.2, station=1, normal_force=10.0, normal_rows=(0, 1))


def parts() -> dict[str, Any]:
    """Return three modes, one of them rigid, and two contact rows."""
    return {
        "omega2": np.array([9.0, 0.0, 4.0]) * np.pi**2,
        "load": np.array([1.0, 2.0, 3.0]),
        "rows": np.array([[3.0, 4.0, 0.0], [0.0, 0.0, 0.5]]),
        "laws": [LAW, LAW],
        "station_of_row": np.array([0, 1]),
        "stations": [9.0, 10.0],
        "observers": {"tip": Observer(np.ones(3))},
    }


def test_numbers_of_a_system() -> None:
    """Reference: analytic, by hand."""
    system = GapSystem(**parts())
    assert system.num_modes == 3
    assert system.frequencies == pytest.approx([0.0, 1.0, 1.5], rel=1e-14)
    assert system.row_masses == pytest.approx([1.0 / 25.0, 4.0], rel=1e-14)
    assert system.damping.tolist() == [0.0, 0.0, 0.0]


def test_friction_and_directions_are_optional_and_loads_add_up() -> None:
    system = GapSystem(**parts())
    assert system.friction_rows.shape == (0, 3)
    assert tuple(system.station_directions) == ("z", "z")
    push = Excitation(np.array([0.0, -1.0, 2.0]), PiecewiseLinear([0.0], [-3.0]))
    excited = replace(system, excitations=[push])
    assert excited.largest_load.tolist() == [1.0, 5.0, 9.0]


def test_rest_under_a_force() -> None:
    system = GapSystem(**parts() | {"omega2": np.array([4.0, 1.0, 2.0])})
    assert static_response(system, np.array([1.0, 2.0, 3.0])) == pytest.approx([0.25, 2.0, 1.5])
    softer = replace(system, geometric_stiffness=np.diag([2.0, 0.5, 0.0]))
    assert static_response(softer, np.array([1.0, 2.0, 3.0])) == pytest.approx([0.5, 4.0, 1.5])


def test_no_rest_with_a_rigid_mode() -> None:
    with pytest.raises(ValueError, match=r"^a system with rigid modes has no static response$"):
        static_response(GapSystem(**parts()), np.ones(3))


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("load", np.ones(2), "load must have the shape (3,), got (2,)"),
        ("omega2", np.ones((3, 1)), "omega2 must have the shape (3,), got (3, 1)"),
        ("rows", np.ones((2, 2)), "rows must have the shape (2, 3), got (2, 2)"),
        ("station_of_row", np.array([0]), "station_of_row must have the shape (2,), got (1,)"),
        ("damping", np.ones(4), "damping must have the shape (3,), got (4,)"),
        ("dashpots", np.ones((2, 2)), "dashpots must have the shape (2, 3), got (2, 2)"),
        ("observers", {"tip": Observer(np.ones(2))},
         "observer 'tip' must have the shape (3,), got (2,)"),
        ("load", np.array([0.0, np.nan, 0.0]), "load must be finite"),
        ("damping", np.array([0.0, -1.0, 0.0]), "damping must not be negative"),
        ("station_of_row", np.array([0, 2]), "station_of_row must hold positions in stations"),
        ("friction_rows", np.ones((1, 3)), "friction_rows must have the shape (0, 3), got (1, 3)"),
        ("excitations", [Excitation(np.ones(2), Step())],
         "excitation 0 must have the shape (3,), got (2,)"),
        ("station_directions", ("z",),
         "station_directions must be one for each of 2 stations, got 1"),
    ],
)  # fmt: skip
def test_inconsistent_arrays_are_refused(name: str, value: object, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        GapSystem(**parts() | {name: value})


@pytest.mark.parametrize(
    ("friction", "message"),
    [
        (replace(RUB, station=2), "the station of a friction must be a position in stations"),
        (replace(RUB, station=-1), "the station of a friction must be a position in stations"),
        (replace(RUB, normal_rows=(0, 2)), "normal_rows must hold positions in rows"),
        (replace(RUB, normal_rows=(-1,)), "normal_rows must hold positions in rows"),
    ],
)
def test_refuses_friction_in_no_place(friction: DryFriction, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        GapSystem(**parts() | {"friction_rows": np.ones((1, 3)), "frictions": [friction]})
