# SPDX-License-Identifier: LGPL-3.0-or-later
"""Gap systems, trajectories with their labels, and numbers that the dynamics refuses."""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.signal import find_peaks

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import DryFriction, PowerContact, restitution_damping
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.energy import check_energy, energy_residual
from protractile.dynamics.excitation import Excitation, PiecewiseLinear, Step
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.hanging_load import HangingLoad
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import SCurve, Shaped, Stroke
from protractile.dynamics.predictability import integrate_ensemble
from protractile.dynamics.stick_slip import ElasticDrive
from protractile.dynamics.trajectory import Trajectory, prominent_peaks
from protractile.dynamics.travel import RowTable, Travel
from tests.dynamics.reference import CHAOTIC, LINEAR
from tests.dynamics.test_telescoping import lossy
from tests.modal import modal_system, one_mass

LAW = PowerContact(stiffness=1.0e6, exponent=1.0).with_clearance(1.0e-3)


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


NAN, INF = float("nan"), float("inf")
STOP = PowerContact(stiffness=1.0e4, exponent=1.0).with_clearance(1.0e-2)


def test_outputs_of_stations() -> None:
    """Reference: analytic and other code path. Frequencies and masses; three rows at two stops give
    the forces of two rows; gaps are means; two friction rows equal one with both limits.
    """
    numbers = GapSystem(**parts())
    assert numbers.frequencies == pytest.approx([0.0, 1.0, 1.5], rel=1e-14)
    assert numbers.row_masses == pytest.approx([1.0 / 25.0, 4.0], rel=1e-14)
    push = Excitation(np.array([0.0, -1.0, 2.0]), PiecewiseLinear([0.0], [-3.0]))
    assert replace(numbers, excitations=[push]).largest_load.tolist() == [1.0, 5.0, 9.0]
    row, stress = np.array([[0.8], [-0.5]]), {"stress": Observer(np.array([5.0]), "Pa")}
    whole = modal_system(
        [10.0], [2.0], row, [STOP, STOP.law.with_clearance(5.0e-3)], stations=[9.0, 10.0],
        station_directions=["z", "y"], friction_rows=row[:1], observers=stress,
        frictions=[DryFriction(0.1, 1, 10.0)],
    )  # fmt: skip
    shared = replace(
        whole,
        rows=row[[0, 1, 0]],
        laws=[STOP.with_weight(0.25), whole.laws[1], STOP.with_weight(0.75)],
        station_of_row=np.array([0, 1, 0]),
        friction_rows=row[[0, 0]],
        frictions=[DryFriction(0.1, 1, 4.0), DryFriction(0.1, 1, 6.0)],
    )
    one, two = (FixedStep(1e-4)(Motion(s, 2.0, output_step=1.0e-2)) for s in (whole, shared))
    assert np.abs(one.data["contact_force"]).max("time").values.min() > 1.0
    for name in ("contact_force", "contact_force_peak", "gap", "friction_force"):
        assert two.data[name].shape == (201, 2)
        np.testing.assert_allclose(two.data[name], one.data[name], rtol=1e-7, atol=1e-8)
    force = np.abs(two.data["friction_force"].values)
    assert force.max(axis=0) == pytest.approx([0.0, 1.0], rel=1e-12)
    np.testing.assert_array_equal(two.data["station"], [9.0, 10.0])
    assert two.data["direction"].values.tolist() == ["z", "y"]
    np.testing.assert_allclose(one.time, 0.01 * np.arange(201), rtol=1e-15)
    np.testing.assert_allclose(one.data["stress"], 5.0 * one.states[:, 0], rtol=1e-15)
    assert one.data["stress"].attrs["units"] == "Pa"
    mean = {"station_of_row": np.array([1, 1, 0]), "stations": [9.0, 10.0]}
    rows, laws = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]], [STOP.law.with_clearance(10.0)] * 3
    run = FixedStep(0.1)(Motion(modal_system([4.0, 9.0], [1.0, 1.0], rows, laws, **mean), 1.0, 0.1))
    np.testing.assert_allclose(run.data["gap"][:, 0], run.states.sum(axis=1), rtol=1e-14)
    np.testing.assert_allclose(run.data["gap"][:, 1], run.states.mean(axis=1), rtol=1e-14)


def test_energy_residual_by_hand() -> None:
    """Reference: analytic. 1 J initially, 4 J of work, 0.5 J of losses each by damping, friction
    and contact, and 0.2 J too much.
    """
    energies = np.array([[0.5, 0.3, 0.2] + 4 * [0.0], [2.0, 2.0, 0.7, 4.0, 0.2, 0.1, 0.2]])
    assert energy_residual(energies) == pytest.approx([0.0, 0.2 / 4.0], rel=1e-12)
    # Without work what there was at first is the measure, and at rest there is none.
    energies[:, 3] = 0.0
    energies[1] = [0.6, 0.4, 0.1, 0.0, 0.0, 0.0, 0.0]
    assert energy_residual(energies) == pytest.approx([0.0, 0.1], rel=1e-12)
    assert not energy_residual(np.zeros((3, 7))).any()
    # What is put in counts from a least energy on.
    assert energy_residual(energies, 5.0) == pytest.approx([0.0, 0.1 / 5.0], rel=1e-12)
    check_energy(energies, bound=0.11)
    for wrong, message in (
        (energies, "the energy residual is 0.1 of the work done, above the bound of 1e-06"),
        (energies + INF, "the motion is not finite; check the loads and the stiffnesses"),
    ):
        with pytest.raises(NumericsError, match=f"^{re.escape(message)}$"):
            check_energy(wrong)


T = np.linspace(0.0, 6.0, 6001)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(
    ("tip", "time", "height", "within"),
    [
        # A ripple of 5 % is no peak of its own.
        (1.0 - np.cos(2.0 * T) + 0.05 * np.cos(60.0 * T), 0.5 * np.pi, 2.05, (np.pi / 60.0, 0.01)),
        # The first counts, not the highest: tan 2t = −2 (1 + 0.3 t)/0.3.
        (np.sin(2.0 * T) * (1.0 + 0.3 * T), 0.84495, 1.24469, (1e-3, 1e-4)),
        (T, np.nan, np.nan, (0.0, 0.0)),
    ],
    ids=["ripple", "first", "steady rise"],
)
def test_first_peak_of_a_slow_motion(
    side: float, tip: Array, time: float, height: float, within: tuple[float, float]
) -> None:
    """Reference: analytic. Downward motions have the peaks of their mirror images."""
    data = xr.Dataset({"tip": ("time", side * tip)}, coords={"time": T})
    found = Trajectory(data, np.zeros((T.size, 0))).first_peak()
    assert found[0] == pytest.approx(time, abs=within[0], nan_ok=True)
    assert found[1] == pytest.approx(side * height, abs=within[1], nan_ok=True)


def test_rates_are_those_of_the_motion() -> None:
    """Reference: analytic, −a ω sin ω t, and its difference quotients between outputs."""
    system = one_mass(2.0, spring=800.0)
    row = system.observers["tip"].row
    system = replace(
        system, observers={"rate": Observer(row, "m/s", 1), "push": Observer(row, "m/s2", 2)}
    )
    data = FixedStep(1e-2)(Motion(system, 1.0, 1.0e-2, position=np.array([0.1 / row[0]]))).data
    rate = -0.1 * 20.0 * np.sin(20.0 * data["time"].values)
    np.testing.assert_allclose(data["rate"], rate, atol=1e-9)
    np.testing.assert_allclose(data["push"][1:], np.diff(rate) / 1.0e-2, atol=1e-7)
    assert float(data["push"][0]) == 0.0


def test_blows_from_both_sides_within_an_output_interval_do_not_cancel() -> None:
    """Reference: analytic, v √(k m) of a mass between two stops, with two rows and one."""
    both = one_mass(2.0, STOP)
    apart = replace(
        both,
        rows=np.vstack([both.rows, both.rows]),
        laws=[law for side in (1, -1) if (law := STOP.one_sided(side)) is not None],
        station_of_row=np.array([0, 0]),
    )
    for system in (both, apart):
        free = replace(system, omega2=np.zeros(1))
        run = FixedStep(5e-4)(Motion(free, 2.0, output_step=0.5, velocity=[5.0 * np.sqrt(2.0)]))
        peaks = np.abs(run.data["contact_force_peak"].values[1:, 0])
        np.testing.assert_allclose(peaks, 5.0 * np.sqrt(1.0e4 * 2.0), rtol=1e-3)


@pytest.mark.parametrize("count", [0, 3, 400])
def test_prominent_peaks(count: int) -> None:
    """Reference: scipy.signal.find_peaks, for noise and for random walks."""
    noise = np.random.default_rng(count).standard_normal(count)
    for values in (noise, np.cumsum(noise)):
        for prominence in (0.1, 1.0, 3.0):
            expected, _ = find_peaks(values, prominence=prominence)
            assert prominent_peaks(values, prominence) == expected.tolist()


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
    ("stiffness must be a number of N/m^n, not negative, got inf", law, {"stiffness": INF}),
    ("stiffness must be positive on one side at least, got 0.0 on both", law,
     {"stiffness": 0.0, "stiffness_below": 0.0}),
    ("exponent must be at least 1, got 0.5", law, {"exponent": 0.5}),
    ("damping must be finite and not negative, got -1.0 s/m", law, {"damping": -1.0}),
    ("a law must be linear behind a negative clearance, got k 1e+06, 2e+09 below, n 2",
     SOFT_ABOVE.with_clearance, {"above": -1.0e-3}),
    ("clearance must be a finite number of m, got nan and nan", SOFT_ABOVE.with_clearance,
     {"above": NAN}),
    ("restitution must be above 0 and at most 1, got 0.0", restitution_damping,
     {"restitution": 0.0, "speed": 1.0}),
    ("speed must be finite and positive, got 0.0 m/s", restitution_damping,
     {"restitution": 0.5, "speed": 0.0}),
    ("a table needs one force for each depth, and one at least", TableContact,
     {"depths": (1e-3,), "forces": (1.0, 2.0)}),
    ("depths must be finite and rise from above 0", TableContact,
     {"depths": (1e-3, 1e-3), "forces": (1.0, 2.0)}),
    ("forces must be positive, and must not fall at the end", TableContact,
     {"depths": (1e-3, 2e-3), "forces": (2.0, 1.0)}),
    ("coefficient must be finite, not negative, got -0.1", DryFriction,
     {"coefficient": -0.1, "station": 0}),
    ("normal_force must be finite, not negative, got -1.0 N", DryFriction,
     {"coefficient": 0.2, "station": 0, "normal_force": -1.0}),
]  # fmt: skip
OF_SYSTEMS: list[tuple[str, Callable[..., object], dict[str, Any]]] = [
    ("rows must have the shape (2, 3), got (2, 2)", system, {"rows": np.ones((2, 2))}),
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
    ("normal_rows must hold positions in rows", rubbing, {"normal_rows": (0, 2)}),
]  # fmt: skip
OF_MOTIONS: list[tuple[str, Callable[..., object], dict[str, Any]]] = [
    ("duration must be finite and positive, got 0.0 s", motion, {"duration": 0.0}),
    ("output_step must be finite and positive, got -1.0 s", motion, {"output_step": -1.0}),
    ("1e+12 outputs are too many, at most 10000000 are stored; give a shorter duration or a "
     "longer output_step", motion, {"duration": 1.0e9}),
    ("velocity must be finite", motion, {"velocity": np.array([0.0, NAN])}),
    *((f"tolerance must be between 0 and 1, got {value}", AdaptiveStep, {"tolerance": value})
      for value in (0.0, 1.0, NAN)),
    ("an ensemble must have at least 2 members, got 1", ensemble,
     {"members": 1, "relative": 1e-9, "vary": "load"}),
    ("relative must be between 0 and 1, got 0", ensemble,
     {"members": 8, "relative": 0.0, "vary": "load"}),
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
