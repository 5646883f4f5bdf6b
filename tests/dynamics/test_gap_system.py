# SPDX-License-Identifier: LGPL-3.0-or-later
"""Gap systems, and trajectories with their labels and measures."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import xarray as xr
from scipy.signal import find_peaks

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.energy import energy_residual
from protractile.dynamics.excitation import Excitation, PiecewiseLinear
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory, prominent_peaks
from studies.reference_models.statics import static_response
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


STOP = PowerContact(stiffness=1.0e4, exponent=1.0).with_clearance(1.0e-2)


def deflections(tip: Array, end: float) -> Trajectory:
    time = np.linspace(0.0, end, tip.size)
    data = xr.Dataset({"tip": ("time", tip)}, coords={"time": time})
    return Trajectory(data, np.zeros((tip.size, 0)))


def test_observers_are_read_at_output_times() -> None:
    system = one_mass(2.0, STOP, force=3.0)
    system = replace(
        system, observers={**system.observers, "stress": Observer(np.array([5.0]), "Pa")}
    )
    run = AdaptiveStep()(Motion(system, 0.2, output_step=1.0e-2))
    assert run.states.shape == (21, 1)
    np.testing.assert_allclose(run.time, 0.01 * np.arange(21), rtol=1e-15)
    np.testing.assert_allclose(run.data["stress"], 5.0 * run.states[:, 0], rtol=1e-15)
    assert 20 <= run.data.attrs["steps"] <= 1.001 * 0.2 / run.data.attrs["step"]
    assert run.data["stress"].attrs["units"] == "Pa"


def test_rows_are_gathered_by_station() -> None:
    """Reference: other code path. Three rows at two stops give the forces of two rows."""
    row = np.array([[0.8], [-0.5]])
    laws = [STOP, STOP.law.with_clearance(5.0e-3)]
    whole = modal_system([10.0], [2.0], row, laws, stations=[9.0, 10.0])
    shared = replace(
        whole,
        rows=row[[0, 1, 0]],
        laws=[STOP.with_weight(0.25), whole.laws[1], STOP.with_weight(0.75)],
        station_of_row=np.array([0, 1, 0]),
    )
    one, two = (FixedStep(1e-4)(Motion(s, 2.0, output_step=1.0e-2)) for s in (whole, shared))
    assert np.abs(one.data["contact_force"]).max("time").values.min() > 1.0
    for name in ("contact_force", "contact_force_peak", "gap"):
        assert two.data[name].shape == (201, 2)
        np.testing.assert_allclose(two.data[name], one.data[name], rtol=1e-8, atol=1e-9)
    np.testing.assert_array_equal(two.data["station"], [9.0, 10.0])


def test_stations_have_directions_and_friction_forces() -> None:
    """Reference: other code path. Two friction rows of a station equal one with both limits."""
    system = modal_system(
        [10.0],
        [2.0],
        [0.8],
        [STOP.law.with_clearance(1.0)],
        stations=[9.0, 9.0],
        station_directions=["z", "y"],
        friction_rows=np.array([[0.8], [0.8]]),
        frictions=[DryFriction(0.1, 1, 4.0), DryFriction(0.1, 1, 6.0)],
    )
    whole = replace(system, friction_rows=system.rows, frictions=[DryFriction(0.1, 1, 10.0)])
    one, two = (FixedStep(1e-3)(Motion(s, 1.0, output_step=0.01)) for s in (whole, system))
    assert two.data["direction"].values.tolist() == ["z", "y"]
    assert not two.data["friction_force"].values[:, 0].any()
    force = one.data["friction_force"].values[:, 1]
    assert np.abs(force).max() == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose(two.data["friction_force"].values[:, 1], force, atol=1e-9)


def test_gap_of_a_station_is_the_mean_of_its_rows() -> None:
    rows, laws = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]], [STOP.law.with_clearance(10.0)] * 3
    shared = {"station_of_row": np.array([1, 1, 0]), "stations": [9.0, 10.0]}
    system = modal_system([4.0, 9.0], [1.0, 1.0], rows, laws, **shared)
    run = FixedStep(0.1)(Motion(system, 1.0, output_step=0.1))
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
    found = deflections(side * tip, 6.0).first_peak()
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


@pytest.mark.parametrize("count", [0, 1, 3, 50, 400])
def test_prominent_peaks(count: int) -> None:
    """Reference: scipy.signal.find_peaks, for noise and for random walks."""
    noise = np.random.default_rng(count).standard_normal(count)
    for values in (noise, np.cumsum(noise)):
        for prominence in (0.1, 1.0, 3.0):
            expected, _ = find_peaks(values, prominence=prominence)
            assert prominent_peaks(values, prominence) == expected.tolist()
