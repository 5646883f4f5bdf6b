# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers that the dynamics refuses, each with its exact message."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.contact import DryFriction, PowerContact, restitution_damping
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.excitation import Excitation, PiecewiseLinear, Step
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.hanging_load import HangingLoad
from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import SCurve, Shaped, Stroke
from protractile.dynamics.predictability import integrate_ensemble
from protractile.dynamics.stick_slip import ElasticDrive
from protractile.dynamics.travel import RowTable, Travel
from tests.dynamics.reference import CHAOTIC, LINEAR
from tests.dynamics.test_gap_system import parts
from tests.dynamics.test_telescoping import lossy

NAN, INF = float("nan"), float("inf")
SOFT_ABOVE = PowerContact(1.0e6, 2.0, stiffness_below=2.0e9)
TABLE = RowTable(np.array([0.0, 1.0]), np.zeros((1, 4, 1, 1)))
RUB = DryFriction(0.2, station=1, normal_force=10.0, normal_rows=(0, 1))
DRAWN = lossy(SCurve(1.0, 1.0))


def law(**numbers: float) -> PowerContact:
    return PowerContact(**{"stiffness": 1.0e13, "exponent": 2.0, **numbers})


def system(**given: Any) -> GapSystem:
    return GapSystem(**parts() | given)


def rubbing(**given: Any) -> GapSystem:
    return system(friction_rows=np.ones((1, 3)), frictions=[replace(RUB, **given)])


def motion(**given: Any) -> Motion:
    return Motion(CHAOTIC, **{"duration": 1.0, **given})


def ensemble(members: int, relative: float, vary: Any) -> object:
    return integrate_ensemble(Motion(LINEAR, 1.0), members, relative, 1, vary)


def rope(**given: float) -> ElasticDrive:
    return ElasticDrive(**{"mass": 500.0, "stiffness": 1.0e5, "sticking": 1.5, **given})


def load(name: str) -> HangingLoad:
    return HangingLoad(**{"mass": 1.0, "stiffness": 1.0, "gravity": 1.0, name: 0.0})


OF_LAWS: list[tuple[str, Callable[..., object], dict[str, Any]]] = [
    ("stiffness must be a number of N/m^n, not negative, got -1.0", law, {"stiffness": -1.0}),
    ("stiffness_below must be a number of N/m^n, not negative, got -1.0", law,
     {"stiffness_below": -1.0}),
    ("stiffness must be a number of N/m^n, not negative, got inf", law, {"stiffness": INF}),
    ("stiffness must be positive on one side at least, got 0.0 on both", law, {"stiffness": 0.0}),
    ("stiffness must be positive on one side at least, got 0.0 on both", law,
     {"stiffness": 0.0, "stiffness_below": 0.0}),
    ("exponent must be at least 1, got 0.5", law, {"exponent": 0.5}),
    ("exponent must be at least 1, got nan", law, {"exponent": NAN}),
    ("damping must be finite and not negative, got -1.0 s/m", law, {"damping": -1.0}),
    ("damping must be finite and not negative, got nan s/m", law, {"damping": NAN}),
    ("a law must be linear behind a negative clearance, got k 1e+06, 2e+09 below, n 2",
     SOFT_ABOVE.with_clearance, {"above": -1.0e-3}),
    ("clearance must be a finite number of m, got nan and nan", SOFT_ABOVE.with_clearance,
     {"above": NAN}),
    ("restitution must be above 0 and at most 1, got 0.0", restitution_damping,
     {"restitution": 0.0, "speed": 1.0}),
    ("restitution must be above 0 and at most 1, got 1.1", restitution_damping,
     {"restitution": 1.1, "speed": 1.0}),
    ("speed must be finite and positive, got 0.0 m/s", restitution_damping,
     {"restitution": 0.5, "speed": 0.0}),
    ("speed must be finite and positive, got inf m/s", restitution_damping,
     {"restitution": 0.5, "speed": INF}),
    ("a table needs one force for each depth, and one at least", TableContact,
     {"depths": (), "forces": ()}),
    ("a table needs one force for each depth, and one at least", TableContact,
     {"depths": (1e-3,), "forces": (1.0, 2.0)}),
    ("depths must be finite and rise from above 0", TableContact,
     {"depths": (1e-3, 1e-3), "forces": (1.0, 2.0)}),
    ("depths must be finite and rise from above 0", TableContact,
     {"depths": (0.0,), "forces": (1.0,)}),
    ("forces must be positive, and must not fall at the end", TableContact,
     {"depths": (1e-3,), "forces": (-1.0,)}),
    ("forces must be positive, and must not fall at the end", TableContact,
     {"depths": (1e-3, 2e-3), "forces": (2.0, 1.0)}),
    ("coefficient must be finite, not negative, got -0.1", DryFriction,
     {"coefficient": -0.1, "station": 0}),
    ("coefficient must be finite, not negative, got nan", DryFriction,
     {"coefficient": NAN, "station": 0}),
    ("normal_force must be finite, not negative, got -1.0 N", DryFriction,
     {"coefficient": 0.2, "station": 0, "normal_force": -1.0}),
    ("normal_force must be finite, not negative, got inf N", DryFriction,
     {"coefficient": 0.2, "station": 0, "normal_force": INF}),
]  # fmt: skip
OF_SYSTEMS: list[tuple[str, Callable[..., object], dict[str, Any]]] = [
    ("load must have the shape (3,), got (2,)", system, {"load": np.ones(2)}),
    ("omega2 must have the shape (3,), got (3, 1)", system, {"omega2": np.ones((3, 1))}),
    ("rows must have the shape (2, 3), got (2, 2)", system, {"rows": np.ones((2, 2))}),
    ("station_of_row must have the shape (2,), got (1,)", system,
     {"station_of_row": np.array([0])}),
    ("damping must have the shape (3,), got (4,)", system, {"damping": np.ones(4)}),
    ("dashpots must have the shape (2, 3), got (2, 2)", system, {"dashpots": np.ones((2, 2))}),
    ("observer 'tip' must have the shape (3,), got (2,)", system,
     {"observers": {"tip": Observer(np.ones(2))}}),
    ("load must be finite", system, {"load": np.array([0.0, NAN, 0.0])}),
    ("damping must not be negative", system, {"damping": np.array([0.0, -1.0, 0.0])}),
    ("station_of_row must hold positions in stations", system,
     {"station_of_row": np.array([0, 2])}),
    ("friction_rows must have the shape (0, 3), got (1, 3)", system,
     {"friction_rows": np.ones((1, 3))}),
    ("excitation 0 must have the shape (3,), got (2,)", system,
     {"excitations": [Excitation(np.ones(2), Step())]}),
    ("station_directions must be one for each of 2 stations, got 1", system,
     {"station_directions": ("z",)}),
    ("the station of a friction must be a position in stations", rubbing, {"station": 2}),
    ("the station of a friction must be a position in stations", rubbing, {"station": -1}),
    ("normal_rows must hold positions in rows", rubbing, {"normal_rows": (0, 2)}),
    ("normal_rows must hold positions in rows", rubbing, {"normal_rows": (-1,)}),
]  # fmt: skip
OF_MOTIONS: list[tuple[str, Callable[..., object], dict[str, Any]]] = [
    ("duration must be finite and positive, got 0.0 s", motion, {"duration": 0.0}),
    ("output_step must be finite and positive, got -1.0 s", motion, {"output_step": -1.0}),
    ("duration must be finite and positive, got '1' s", motion, {"duration": "1"}),
    ("1e+12 outputs are too many, at most 10000000 are stored; give a shorter duration or a "
     "longer output_step", motion, {"duration": 1.0e9}),
    ("position must have the shape (2,), got (3,)", motion, {"position": np.ones(3)}),
    ("velocity must be finite", motion, {"velocity": np.array([0.0, NAN])}),
    *((f"tolerance must be between 0 and 1, got {value}", AdaptiveStep, {"tolerance": value})
      for value in (0.0, 1.0, NAN)),
    ("an ensemble must have at least 2 members, got 1", ensemble,
     {"members": 1, "relative": 1e-9, "vary": "load"}),
    ("relative must be between 0 and 1, got 0", ensemble,
     {"members": 8, "relative": 0.0, "vary": "load"}),
    ("relative must be between 0 and 1, got nan", ensemble,
     {"members": 8, "relative": NAN, "vary": "load"}),
    ("the velocity is zero, so that no relative change moves it", ensemble,
     {"members": 8, "relative": 1e-9, "vary": "velocity"}),
    ("the clearance is zero, so that no relative change moves it", ensemble,
     {"members": 8, "relative": 1e-9, "vary": "clearance"}),
    *((f"{name} must be finite and positive, got 0.0", load, {"name": name})
      for name in ("mass", "stiffness", "gravity")),
    ("mass must be finite and above 0, got 0.0", rope, {"mass": 0.0}),
    ("stiffness must be finite and above 0, got inf", rope, {"stiffness": INF}),
    ("dashpot must be finite and at least 0, got -1.0", rope, {"dashpot": -1.0}),
    ("sticking must be finite and at least 1, got 0.5", rope, {"sticking": 0.5}),
]  # fmt: skip
OF_TRAVELS: list[tuple[str, Callable[..., object], dict[str, Any]]] = [
    ("duration must be finite and positive, got 0.0 s", SCurve, {"travel": 1.0, "duration": 0.0}),
    ("speed must be finite and positive, got -1.0 m/s", Stroke, {"travel": 1.0, "speed": -1.0}),
    ("ramp must be finite and not negative, got -1.0 s", Stroke,
     {"travel": 1.0, "speed": 1.0, "ramp": -1.0}),
    ("within a travel of 1 a ramp of 1 s does not come to a speed of 2; the ramp must be at most "
     "0.5 s", Stroke, {"travel": 1.0, "speed": 2.0, "ramp": 1.0}),
    ("frequency must be finite and positive, got 0.0 Hz", partial(Shaped, SCurve(1.0, 1.0), 0.0),
     {}),
    ("damping must be at least 0 and below 1, got 1.0", partial(Shaped, SCurve(1.0, 1.0), 1.0, 1.0),
     {}),
    ("the knots of a table of rows must be two at least, and rise",
     partial(RowTable, np.array([1.0]), np.zeros((0, 4, 1, 1))), {}),
    ("coefficients must have the shape (1, 4, num_rows, num_modes), got (2, 4, 1, 1)",
     partial(RowTable, np.array([0.0, 1.0]), np.zeros((2, 4, 1, 1))), {}),
    ("the table has 1 rows, and 0 move", partial(Travel, SCurve(1.0, 1.0), TABLE, ()), {}),
    ("a travel must be 0 at t = 0, got 0.5 m",
     partial(Travel, PiecewiseLinear([0.0, 1.0], [0.5, 1.0]), TABLE, (("rows", 0),)), {}),
    ("travel 0 must move rows of the system", partial(replace, DRAWN),
     {"laws": [], "rows": np.zeros((0, 9)), "station_of_row": np.zeros(0, dtype=int)}),
    ("the frictions of a station that may telescope must have one coefficient, got 0.3 and 0.2 at "
     "2 m", partial(replace, DRAWN),
     {"friction_rows": np.ones((2, 9)),
      "frictions": [DryFriction(0.3, 0, 400.0), DryFriction(0.2, 0, 400.0)]}),
]  # fmt: skip


@pytest.mark.parametrize(
    ("message", "make", "given"), [*OF_LAWS, *OF_SYSTEMS, *OF_MOTIONS, *OF_TRAVELS]
)
def test_a_number_out_of_sense_is_refused(
    message: str, make: Callable[..., object], given: dict[str, Any]
) -> None:
    """Reference: exact words."""
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        make(**given)
