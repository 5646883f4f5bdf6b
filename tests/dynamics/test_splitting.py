# SPDX-License-Identifier: LGPL-3.0-or-later
"""The splitting against known contact problems, its order, its symmetry and its complaints."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from dynamics.integrators import splitting
from dynamics.integrators.splitting import integrate
from dynamics.integrators.step import DRAGGED, PHASE
from scipy.integrate import solve_ivp

from dynamics.arrays import Array
from dynamics.contact import PowerContact
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem, Observer
from dynamics.kernels.modal_flow import ModalFlow
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory
from tests.dynamics.one_stop import reference_states, two_modes

OneMass = Callable[..., GapSystem]


def crossings(time: Array, y: Array, level: float) -> Array:
    """Times at which y passes the level, by linear interpolation."""
    (before,) = np.nonzero((y[:-1] > level) != (y[1:] > level))
    part = (level - y[before]) / (y[before + 1] - y[before])
    return np.asarray(time[before] + part * (time[before + 1] - time[before]))


def test_mass_on_a_spring_against_a_spring_stop(one_mass: OneMass) -> None:
    """Reference: external source, SDND101 of the Code_Aster validation manual.

    100 kg on 1e4 N/m meet a stop of 1e6 N/m without gap at 1 m/s.
    """
    stop = PowerContact(stiffness=1.0e6, exponent=1.0, clearance=0.0).upper()
    system = one_mass(100.0, stop, spring=1.0e4)
    run = integrate(Motion(system, 0.04, output_step=1.0e-6, velocity=np.array([10.0])))
    peak = run.data["contact_force_peak"].isel(station=0)
    assert float(peak.max()) == pytest.approx(9950.372, rel=1e-4)
    assert float(run.time[peak.values.argmax()]) == pytest.approx(0.0156300, rel=1e-4)
    left = crossings(run.time[1:], run.data["gap"].values[1:, 0], 0.0)
    assert left == pytest.approx([0.0312600], rel=1e-4)
    # Analytic: the stop takes k/(k + spring) of the change of momentum 2 m v.
    impulse = 1.0e-6 * float(run.data["contact_force"].sum())
    assert impulse == pytest.approx(200.0 * 1.0e6 / 1.01e6, rel=1e-4)


def test_falling_mass(one_mass: OneMass) -> None:
    """Reference: external source, SDND108 of the Code_Aster validation manual.

    1 kg falls from 0 at −1 m/s under 10 m/s² on a stop of 100 N/m at −2 m.
    """
    stop = PowerContact(stiffness=100.0, exponent=1.0, clearance=2.0).lower()
    system = one_mass(1.0, stop, force=-10.0)
    run = integrate(Motion(system, 1.2, output_step=1.0e-3, velocity=np.array([-1.0])), step=1.0e-4)
    assert run.first_contact == pytest.approx(0.5403124, rel=1e-4)
    touch, release = crossings(run.time, run.data["tip"].values, -2.0)
    assert touch == pytest.approx(0.5403124, rel=1e-4)
    assert release == pytest.approx(0.8854562, rel=1e-4)
    assert run.data.attrs["contact_changes"] == 2
    assert float(run.data["contact_force"].max()) == 0.0


def test_mass_between_two_stops_of_unlike_stiffness(one_mass: OneMass) -> None:
    """Reference: analytic. Flights of 2Δ/v and presses of π √(m/k) on either side."""
    law = PowerContact(stiffness=4.0e4, exponent=1.0, clearance=0.1, stiffness_below=9.0e4)
    system = one_mass(1.0, law)
    period = 2.0 * 0.2 / 2.0 + np.pi / 200.0 + np.pi / 300.0
    run = integrate(
        Motion(system, 3.0 * period, output_step=period / 1000.0, velocity=np.array([2.0])),
        step=2.0e-6,
    )
    tip = run.data["tip"].values
    np.testing.assert_allclose(tip[::1000], 0.0, atol=1e-6)
    force = run.data["contact_force_peak"].values
    assert force.max() == pytest.approx(2.0 * np.sqrt(4.0e4), rel=1e-5)
    assert force.min() == pytest.approx(-2.0 * np.sqrt(9.0e4), rel=1e-5)
    assert run.data.attrs["contact_changes"] == 12
    assert run.first_contact == pytest.approx(0.05, rel=1e-6)
    # Impulse: each press turns the momentum around.
    impulse = np.maximum(run.data["contact_force"].values, 0.0).sum() * period / 1000.0
    assert impulse == pytest.approx(3 * 4.0, rel=1e-6)


@pytest.mark.parametrize("step", [2.0e-2, 1.0e-2, 1.0e-3, 1.0e-4])
def test_first_contact_does_not_depend_on_the_step(one_mass: OneMass, step: float) -> None:
    """Reference: analytic. The line through two places of a fall misses by g h²/8 at most."""
    stop = PowerContact(stiffness=100.0, exponent=1.0, clearance=2.0).lower()
    run = integrate(
        Motion(
            one_mass(1.0, stop, force=-10.0), 1.0, output_step=2.0e-2, velocity=np.array([-1.0])
        ),
        step=step,
    )
    exact = (np.sqrt(41.0) - 1.0) / 10.0
    assert abs(run.first_contact - exact) < 10.0 * step**2 / 8.0 / np.sqrt(41.0) + 1e-13


def test_first_contact_is_that_of_the_first_row() -> None:
    """Two rows close within one step; the second one in the list does so earlier."""
    stop = PowerContact(stiffness=1.0, exponent=1.0, clearance=0.0105)
    system = GapSystem(
        omega2=np.zeros(1),
        load=np.zeros(1),
        rows=np.ones((2, 1)),
        laws=[stop, replace(stop, clearance=0.0102)],
        station_of_row=np.array([0, 1]),
        stations=[9.0, 10.0],
        observers={},
    )
    run = integrate(Motion(system, 0.1, output_step=0.01, velocity=np.ones(1)), step=0.01)
    assert run.first_contact == pytest.approx(0.0102, rel=1e-9)


@pytest.mark.parametrize("step", [2.0e-3, 3.0e-4])
def test_first_contact_with_a_stop_without_gap(one_mass: OneMass, step: float) -> None:
    """Reference: analytic. A mass comes from below at 1 m/s to a one-sided stop at 0."""
    stop = PowerContact(stiffness=100.0, exponent=1.0, clearance=0.0).upper()
    run = integrate(
        Motion(
            one_mass(1.0, stop),
            0.5,
            output_step=0.01,
            position=np.array([-0.1003]),
            velocity=np.ones(1),
        ),
        step=step,
    )
    assert run.first_contact == pytest.approx(0.1003, rel=1e-6)
    assert run.data.attrs["contact_changes"] == 2


def test_letting_go_is_no_first_contact(one_mass: OneMass) -> None:
    """A mass that starts pressed is in contact from the start."""
    stop = PowerContact(stiffness=100.0, exponent=1.0, clearance=0.1)
    run = integrate(
        Motion(one_mass(1.0, stop), 0.18, output_step=0.01, position=np.array([0.11])), step=1.0e-3
    )
    assert float(run.data["gap"][-1, 0]) < 0.1
    assert run.first_contact == 0.0


def test_no_contact_is_not_a_number(one_mass: OneMass) -> None:
    stop = PowerContact(stiffness=100.0, exponent=1.0, clearance=2.0)
    run = integrate(Motion(one_mass(1.0, stop, spring=4.0, force=1.0), 1.0))
    assert np.isnan(run.first_contact)
    assert run.data.attrs["contact_changes"] == 0
    assert not run.data["contact_force"].values.any()


def test_order_and_error_through_one_contact() -> None:
    """Reference: other code, scipy's DOP853. Slope 2, and the error itself is small."""
    system, duration = two_modes(), 0.6
    expected = reference_states(system, np.array([0.0, duration]))[-1]
    steps = 2.0e-3 / 2.0 ** np.arange(5)
    errors = []
    for step in steps:
        run = integrate(Motion(system, duration, output_step=0.02), step=step)
        errors.append(np.abs(run.states[-1] - expected).max() / np.abs(run.states).max())
    assert run.data.attrs["contact_changes"] == 2
    slopes = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert slopes[1:] == pytest.approx(2.0, abs=0.1)
    assert errors[-1] < 2.0e-6


def end_velocity(system: GapSystem, run: Trajectory) -> Array:
    """(num_modes,) ȧ at the end of a trajectory whose last output interval is free of contact."""
    assert not run.data["contact_force"].values[-1].any()
    h = float(run.time[-1] - run.time[-2])
    flow = ModalFlow.over(system, h)
    before = (run.states[-1] - flow.aa * run.states[-2] - flow.ap) / flow.av
    return np.asarray(flow.va * run.states[-2] + flow.vv * before + flow.vp)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_motion_runs_back_through_its_contacts(exponent: float) -> None:
    """Reference: analytic, time reversibility; the load is the same both ways."""
    system = two_modes(exponent)
    start = np.array([0.02, -0.01])
    there = integrate(Motion(system, 1.8, output_step=0.02, position=start), step=1.0e-3)
    turned = end_velocity(system, there)
    back = integrate(
        Motion(system, 1.8, output_step=0.02, position=there.states[-1], velocity=-turned),
        step=1.0e-3,
    )
    assert there.data.attrs["contact_changes"] == back.data.attrs["contact_changes"] >= 6
    assert np.abs(back.states[-1] - start).max() < 1e-9 * np.abs(there.states).max()
    speed = np.abs(end_velocity(system, back)).max()
    assert speed < 1e-9 * np.abs(turned).max()


def test_units_do_not_matter() -> None:
    """Reference: analytic. The same system in mm, t and s, before chaos sets in.

    √t·mm are √1000 times as many as √kg·m; forces in N stay what they are.
    """
    si = two_modes()
    scale = np.sqrt(1000.0)
    law = si.laws[0]
    small = GapSystem(
        omega2=si.omega2,
        load=si.load * scale,
        rows=si.rows * scale,
        laws=[PowerContact(law.stiffness / 1e6, 2.0, 1e3 * law.clearance).upper()],
        station_of_row=si.station_of_row,
        stations=[0.0],
        observers={"first": Observer(np.array([scale, 0.0]))},
    )
    metres, millimetres = (integrate(Motion(s, 1.5, output_step=0.01)) for s in (si, small))
    assert metres.data.attrs["contact_changes"] >= 5
    assert millimetres.data.attrs["steps"] == metres.data.attrs["steps"]
    assert millimetres.first_contact == pytest.approx(metres.first_contact, rel=1e-9)
    for name, factor in (("first", 1e3), ("gap", 1e3), ("contact_force", 1.0), ("work", 1e3)):
        expected = factor * metres.data[name].values
        error = np.abs(millimetres.data[name].values - expected).max()
        assert error < 1e-9 * np.abs(expected).max(), name


@pytest.mark.parametrize(("stiffness", "exponent"), [(1e8, 1.0), (1e10, 1.5), (1e13, 2.0)])
def test_bouncing_ball_keeps_its_energy(
    one_mass: OneMass, stiffness: float, exponent: float
) -> None:
    """Reference: analytic. 1 kg falls 1 mm some three hundred times on a hard floor.

    Within a contact the energy swings by less than (step · contact frequency)²/2; from bounce to
    bounce nothing adds up.
    """
    floor = PowerContact(stiffness, exponent, clearance=1.0e-3).lower()
    run = integrate(Motion(one_mass(1.0, floor, force=-10.0), 9.0))
    assert run.data.attrs["contact_changes"] > 600
    assert run.energy_residual < 0.5 * PHASE**2
    tip = run.data["tip"].values
    assert tip[-300:].max() == pytest.approx(0.0, abs=5e-6)
    assert tip.max() < 2e-7


@pytest.mark.parametrize("speed", [0.1, 10.0, 300.0])
def test_a_hard_blow_gives_back_its_speed(one_mass: OneMass, speed: float) -> None:
    """Reference: analytic. The step is resolved from the blow itself, k = 1e13 N/m²."""
    stop = PowerContact(stiffness=1.0e13, exponent=2.0, clearance=1.0e-3)
    depth = (1.5 * speed**2 / 1.0e13) ** (1.0 / 3.0)
    step = PHASE / np.sqrt(2.0e13 * depth)
    period = 2.0 * (2.0e-3 + 2.8 * depth) / speed
    run = integrate(
        Motion(one_mass(1.0, stop), 500.0 * period, output_step=period, velocity=np.array([speed])),
        step=step,
    )
    assert run.data.attrs["contact_changes"] > 900
    assert run.energy_residual < 0.5 * PHASE**2
    kinetic = run.data["kinetic_energy"].where(run.data["contact_energy"] == 0.0, drop=True)
    np.testing.assert_allclose(kinetic, 0.5 * speed**2, rtol=0.5 * PHASE**2)


def test_damping_takes_what_the_ledger_says(one_mass: OneMass) -> None:
    """Reference: analytic, the free decay and the step response of a damped oscillator."""
    mass, spring, dashpot, force = 4.0, 100.0, 2.0, 30.0
    decay, omega = dashpot / (2.0 * mass), np.sqrt(spring / mass - 0.0625)
    system = one_mass(mass, spring=spring, dashpot=dashpot, force=force)
    run = integrate(Motion(system, 5.0, output_step=0.01))
    t, rest = run.time, force / spring
    swing = np.exp(-decay * t) * (np.cos(omega * t) + decay / omega * np.sin(omega * t))
    speed = rest * np.exp(-decay * t) * np.sin(omega * t) * (omega + decay**2 / omega)
    place = rest * (1.0 - swing)
    np.testing.assert_allclose(run.data["tip"], place, atol=1e-12)
    kinetic, strain, work = 0.5 * mass * speed**2, 0.5 * spring * place**2, force * place
    np.testing.assert_allclose(run.data["kinetic_energy"], kinetic, atol=1e-11)
    np.testing.assert_allclose(run.data["strain_energy"], strain, atol=1e-11)
    np.testing.assert_allclose(run.data["work"], work, atol=1e-11)
    np.testing.assert_allclose(run.data["damping_loss"], work - kinetic - strain, atol=1e-11)
    assert run.data["damping_loss"].values[-1] > 3.0
    assert run.energy_residual < 1e-12


def test_damping_and_contact_share_one_ledger(one_mass: OneMass) -> None:
    """Reference: analytic. In the end all of the work not held at rest is dissipated."""
    stop = PowerContact(stiffness=1.0e4, exponent=1.0, clearance=0.1)
    system = one_mass(4.0, stop, spring=100.0, dashpot=20.0, force=30.0)
    run = integrate(Motion(system, 20.0, output_step=0.01))
    depth = (30.0 - 10.0) / 1.01e4
    end = run.data.isel(time=-1)
    assert run.data.attrs["contact_changes"] >= 3
    assert float(end["tip"]) == pytest.approx(0.1 + depth, rel=1e-6)
    assert float(end["contact_force"][0]) == pytest.approx(1.0e4 * depth, rel=1e-6)
    held = 0.5 * 100.0 * (0.1 + depth) ** 2 + 0.5 * 1.0e4 * depth**2
    assert float(end["damping_loss"]) == pytest.approx(30.0 * (0.1 + depth) - held, rel=1e-4)
    assert run.energy_residual < 1e-4


def test_step_fits_the_output_and_progress_is_told(one_mass: OneMass) -> None:
    told: list[float] = []
    system = one_mass(1.0, spring=1.0)
    run = integrate(Motion(system, 1.04, output_step=0.1), step=0.03, progress=told.append)
    assert run.time[-1] == pytest.approx(1.0, rel=1e-15)
    assert run.data.attrs["step"] == pytest.approx(0.025, rel=1e-12)
    assert run.data.attrs["steps"] == 40
    assert told == sorted(told)
    assert told[-1] == 1.0
    assert integrate(Motion(system, 0.01, output_step=0.1)).time.size == 2


def test_complains_of_energy_from_a_coarse_step(one_mass: OneMass) -> None:
    stop = PowerContact(stiffness=1.0e8, exponent=1.0, clearance=1.0e-3)
    message = (
        r"^the energy residual is (\S+) of the work done, above the bound of 0\.01, at a step of "
        r"0\.0003 s; halve the step$"
    )
    with pytest.raises(NumericsError, match=message) as caught:
        integrate(Motion(one_mass(1.0, stop, force=-10.0), 1.0, output_step=3.0e-4), step=3.0e-4)
    found = re.match(message, str(caught.value))
    assert found is not None
    assert float(found[1]) > 0.01


def test_energy_bound_can_be_set(one_mass: OneMass) -> None:
    stop = PowerContact(stiffness=1.0e8, exponent=1.0, clearance=1.0e-3)
    system = one_mass(1.0, stop, force=-10.0)
    residual = integrate(Motion(system, 0.1)).energy_residual
    assert integrate(Motion(system, 0.1), energy_bound=1.01 * residual).energy_residual == residual
    message = (
        f"the energy residual is {residual:.3g} of the work done, above the bound of "
        f"{0.99 * residual:.3g}, at a step of "
    )
    with pytest.raises(NumericsError, match=f"^{re.escape(message)}"):
        integrate(Motion(system, 0.1), energy_bound=0.99 * residual)


def test_complains_of_a_motion_that_is_not_finite(one_mass: OneMass) -> None:
    stop = PowerContact(stiffness=1.0e13, exponent=3.0, clearance=1.0e-3)
    message = "the motion is not finite at a step of 0.01 s; halve the step"
    with pytest.raises(NumericsError, match=f"^{re.escape(message)}$"):
        integrate(Motion(one_mass(1.0, stop, force=-10.0), 200.0, output_step=0.1), step=0.01)


def test_what_nothing_moves_stays(one_mass: OneMass) -> None:
    """A boom may have segments without load: their gaps close at no speed at all."""
    run = integrate(
        Motion(one_mass(1.0, PowerContact(1.0e6, 2.0, clearance=0.1)), 0.1), step=1.0e-4
    )
    assert not run.states.any()
    assert np.isnan(run.first_contact)


@pytest.mark.parametrize("load", [0.0, 3.0])
def test_steps_made_at_once_miss_no_contact(load: float) -> None:
    """Reference: the same motion with strides that the gap's bound forbids nowhere.

    A fast and a slow mode bring a gap to its stop in short grazing blows: made one by one (a
    stop on the other side, so near that it always holds the stride back, but without effect
    on the motion) and at once, the steps meet the same contacts.
    """
    law = PowerContact(stiffness=4.0e4, exponent=2.0, clearance=0.97).upper()
    rows = np.array([[0.9, 0.2]])
    start = np.array([-1.0, 0.5])

    def system(*laws: PowerContact) -> GapSystem:
        return GapSystem(
            omega2=np.array([4.0, 9.0e4]),
            load=np.array([load, 0.0]),
            rows=np.repeat(rows, len(laws), axis=0),
            laws=laws,
            station_of_row=np.zeros(len(laws), dtype=np.int64),
            stations=[0.0],
            observers={"y": Observer(rows[0])},
        )

    feather = PowerContact(stiffness=1.0e-30, exponent=2.0, clearance=0.0)
    at_once, one_by_one = (
        integrate(Motion(system(*laws), 6.0, 0.01, position=start), step=1.0e-5)
        for laws in ((law,), (law, feather))
    )
    assert one_by_one.data.attrs["steps"] == 600_000
    assert at_once.data.attrs["steps"] < 200_000
    assert at_once.data.attrs["contact_changes"] >= 20
    force, expected = (run.data["contact_force_peak"] for run in (at_once, one_by_one))
    assert float(expected.max()) > 1.0
    np.testing.assert_allclose(force, expected, rtol=0.0, atol=1e-6)
    np.testing.assert_allclose(at_once.data["y"], one_by_one.data["y"], rtol=0.0, atol=1e-9)


def test_a_dashpot_hands_one_mode_the_speed_of_another() -> None:
    """Reference: other code, Runge and Kutta's method. A mass at 1 m/s drags one at rest by a
    dashpot across 0.02 mm to its stop, where it comes with 0.06 m/s.
    """
    drag, stiffness, gap = 100.0, 1.0e8, 2.0e-5
    system = GapSystem(
        omega2=np.zeros(2),
        load=np.zeros(2),
        rows=np.array([[1.0, 0.0]]),
        laws=[PowerContact(stiffness, 1.0, clearance=gap)],
        station_of_row=np.array([0]),
        stations=[0.0],
        observers={"tip": Observer(np.array([1.0, 0.0]))},
        dashpots=np.sqrt(drag) * np.ones((1, 2)),
    )
    start = np.array([0.0, 1.0])
    run = integrate(Motion(system, 1.0e-3, output_step=1.0e-3, velocity=start))

    def rates(_: float, state: Array) -> list[float]:
        a, _, v, other = state
        pull = drag * (v + other)
        return [v, other, -pull + stiffness * max(-a - gap, 0.0), -pull]

    times = np.linspace(0.0, 1.0e-3, 10_001)
    exact = solve_ivp(rates, (0.0, 1.0e-3), [0.0, 0.0, *start], "DOP853", times, max_step=1e-6)
    pressed = np.maximum(-exact.y[0] - gap, 0.0)
    assert run.first_contact == pytest.approx(times[np.flatnonzero(pressed)[0]], abs=1e-6)
    assert run.data["contact_force_peak"][1, 0] == pytest.approx(
        -stiffness * pressed.max(), rel=2e-3
    )
    assert run.energy_residual < 1e-6


def test_dashpots_that_leave_no_stride(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: analytic, ½ v² (1 − e^{−2ct}) of what a dashpot takes, whose every step is small.

    Python reads no array beyond its end, as the compiled loop does unseen.
    """
    drag, duration = 100.0, 0.01
    system = GapSystem(
        omega2=np.zeros(1),
        load=np.zeros(1),
        rows=np.zeros((0, 1)),
        laws=[],
        station_of_row=np.zeros(0, dtype=np.int64),
        stations=[],
        observers={},
        dashpots=np.full((1, 1), np.sqrt(drag)),
    )
    assert 8.0 * drag * 1.0e-3 > DRAGGED
    monkeypatch.setattr(splitting, "_march", splitting._march.py_func)
    run = integrate(Motion(system, duration, 1.0e-3, velocity=np.ones(1)), 1.0e-3)
    taken = -0.5 * np.expm1(-2.0 * drag * run.time)
    assert run.data["damping_loss"].values == pytest.approx(taken, rel=1e-12)
