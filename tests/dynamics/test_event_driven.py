# SPDX-License-Identifier: LGPL-3.0-or-later
"""From contact to contact: as exact as its tolerance, missing none."""

from __future__ import annotations

import re
import signal
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from dynamics.integrators.event_driven import integrate_events, what_hinders
from dynamics.integrators.integrator import Events, Splitting
from dynamics.integrators.splitting import integrate
from scipy.special import gamma

from dynamics.contact import PowerContact
from dynamics.excitation import Excitation, Ramp
from dynamics.failure import NumericsError
from dynamics.friction import DryFriction
from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory
from tests.dynamics.one_stop import reference_states, two_modes

OneMass = Callable[..., GapSystem]


@pytest.fixture(autouse=True)
def _deadline() -> Iterator[None]:
    """Motion from event to event may fail by never ending; these tests take a second, and some more
    where the loops must be compiled first."""

    def late(*_: object) -> None:
        raise TimeoutError("the motion does not end")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(90)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def test_mass_on_a_spring_against_a_spring_stop(one_mass: OneMass) -> None:
    """Reference: analytic, SDND101: half a sine of √((k + spring)/m) in contact, exactly."""
    stop = PowerContact(stiffness=1.0e6, exponent=1.0, clearance=0.0).upper()
    system = one_mass(100.0, stop, spring=1.0e4)
    omega = np.sqrt(1.01e4)
    half = np.pi / omega
    run = integrate_events(Motion(system, half, output_step=half / 2.0, velocity=np.array([10.0])))
    assert float(run.data["contact_force_peak"][1, 0]) == pytest.approx(1.0e6 / omega, rel=1e-9)
    assert float(run.data["tip"][1]) == pytest.approx(1.0 / omega, rel=1e-9)
    assert float(run.data["tip"][2]) == pytest.approx(0.0, abs=1e-12)
    impulse = 0.5 * half * float(run.data["contact_force"].sum())
    assert impulse == pytest.approx(200.0 * 1.0e6 / 1.01e6, rel=1e-9)
    assert run.first_contact == pytest.approx(0.0, abs=1e-15)


def test_falling_mass(one_mass: OneMass) -> None:
    """Reference: analytic, SDND108: back at 0 with its speed after twice 0.5403124 s and a press
    of 0.3451438 s."""
    stop = PowerContact(stiffness=100.0, exponent=1.0, clearance=2.0).lower()
    fall = (np.sqrt(41.0) - 1.0) / 10.0
    press = 2.0 / 10.0 * (np.pi - np.arctan(np.sqrt(41.0)))
    assert (fall, fall + press) == pytest.approx((0.5403124, 0.8854562), abs=1e-7)
    cycle = 2.0 * fall + press
    run = integrate_events(
        Motion(
            one_mass(1.0, stop, force=-10.0), cycle, output_step=cycle, velocity=np.array([-1.0])
        )
    )
    assert run.first_contact == pytest.approx(fall, rel=1e-11)
    assert float(run.data["tip"][-1]) == pytest.approx(0.0, abs=1e-10)
    assert float(run.data["kinetic_energy"][-1]) == pytest.approx(0.5, rel=1e-10)
    assert run.data.attrs["contact_changes"] == 2


@pytest.mark.parametrize("part", [0.3, 0.8, 1.5, 7.0])
@pytest.mark.parametrize("exponent", [1.0, 2.0])
def test_peak_force_is_that_of_the_interval(
    one_mass: OneMass, exponent: float, part: float
) -> None:
    """Reference: other code, the splitting at a fine step; output intervals from a part of the
    press to more than the whole of it."""
    stop = PowerContact(stiffness=1.0e4, exponent=exponent, clearance=0.1)
    system, start = one_mass(1.0, stop, force=1.0), np.array([1.0])
    press = np.pi * 1.0e-2 if exponent == 1.0 else 0.14
    events, steps = (
        move(Motion(system, 0.4, part * press, velocity=start))
        for move in (Events(), Splitting(1.0e-5))
    )
    expected = steps.data["contact_force_peak"].values
    assert expected.max() > 5.0
    np.testing.assert_allclose(
        events.data["contact_force_peak"].values, expected, rtol=2e-2, atol=1e-2 * expected.max()
    )


@pytest.mark.parametrize(
    ("integrator", "exponent"),
    [
        *((integrate, exponent) for exponent in (1.0, 1.5, 2.0, 3.0)),
        *((integrate_events, exponent) for exponent in (1.0, 2.0, 3.0)),
    ],
)
def test_a_blow_from_velocity_alone_is_resolved(
    one_mass: OneMass, integrator: Callable[..., Trajectory], exponent: float
) -> None:
    """Reference: analytic. No load gives the step a scale here, only the initial velocity."""
    stop = PowerContact(stiffness=1.0e9, exponent=exponent, clearance=0.1)
    run = integrator(Motion(one_mass(1.0, stop), 1.0, 0.01, velocity=np.array([5.0])))
    assert run.data.attrs["contact_changes"] >= 40
    assert run.energy_residual < 1e-3


def test_a_thousand_hard_blows_between_two_stops(one_mass: OneMass) -> None:
    """Reference: analytic. Contacts of some microseconds, none missed, no energy lost; a missed
    one would leave the mass 0.2 m off."""
    law = PowerContact(4.0e12, exponent=1.0, clearance=0.1, stiffness_below=9.0e12)
    period = 2.0 * 0.2 / 20.0 + np.pi / 2.0e6 + np.pi / 3.0e6
    run = integrate_events(
        Motion(one_mass(1.0, law), 500.0 * period, output_step=period, velocity=np.array([20.0]))
    )
    assert run.data.attrs["contact_changes"] == 2000
    np.testing.assert_allclose(run.data["tip"], 0.0, atol=1e-7)
    assert run.energy_residual < 1e-9


def test_linear_stops_are_exact() -> None:
    """Reference: other code, scipy's DOP853, through some ten contacts at once."""
    system = two_modes(1.0)
    run = integrate_events(Motion(system, 3.0, output_step=0.1))
    expected = reference_states(system, run.time)
    assert run.data.attrs["contact_changes"] >= 9
    np.testing.assert_allclose(run.states, expected, atol=1e-7 * np.abs(expected).max())
    assert run.energy_residual < 1e-11


def test_quadratic_stop_at_its_deepest(one_mass: OneMass) -> None:
    """Reference: analytic. A mass m at v sinks in by p = (3 m v² / 2 k)^⅓ under F = k p², after
    Γ(⅓) Γ(½) / (3 Γ(⅚)) p/v, from energy and a Beta integral."""
    stop = PowerContact(stiffness=1.0e6, exponent=2.0, clearance=0.0).upper()
    depth = (3.0 * 100.0 * 2.0**2 / (2.0 * 1.0e6)) ** (1.0 / 3.0)
    half = gamma(1.0 / 3.0) * gamma(0.5) / (3.0 * gamma(5.0 / 6.0)) * depth / 2.0
    run = integrate_events(
        Motion(one_mass(100.0, stop), 2.0 * half, output_step=half, velocity=np.array([20.0]))
    )
    assert float(run.data["tip"][1]) == pytest.approx(depth, rel=1e-9)
    assert float(run.data["contact_force_peak"][1, 0]) == pytest.approx(1.0e6 * depth**2, rel=1e-8)
    assert float(run.data["tip"][2]) == pytest.approx(0.0, abs=1e-9 * depth)
    impulses = half * run.data["contact_force"].values[1:, 0]
    np.testing.assert_allclose(impulses, 100.0 * 2.0, rtol=1e-9)


@pytest.mark.parametrize("exponent", [2.0, 3.0])
def test_errors_follow_the_tolerance(exponent: float) -> None:
    """Reference: other code, scipy's DOP853, through one contact; slope and error."""
    system = two_modes(exponent)
    errors = []
    tolerances = (1e-2, 1e-5, 1e-8)
    for tolerance in tolerances:
        run = integrate_events(Motion(system, 0.6, output_step=0.02), tolerance=tolerance)
        expected = reference_states(system, run.time)
        errors.append(np.abs(run.states - expected).max() / np.abs(expected).max())
    assert run.data.attrs["contact_changes"] == 2
    assert errors[-1] < 1e-8
    assert np.log10(errors[0] / errors[-1]) > 0.7 * np.log10(tolerances[0] / tolerances[-1])


@pytest.mark.parametrize("exponent", [1.0, 2.0, 3.0])
def test_agrees_with_the_splitting(exponent: float) -> None:
    """Reference: other code, the step-by-step integrator at a fine step."""
    system = two_modes(exponent)
    events = integrate_events(Motion(system, 1.5, output_step=0.01))
    steps = integrate(Motion(system, 1.5, output_step=0.01), step=1.0e-5)
    assert events.data.attrs["contact_changes"] == steps.data.attrs["contact_changes"] >= 5
    assert events.first_contact == pytest.approx(steps.first_contact, rel=1e-8)
    names = ("kinetic_energy", "strain_energy", "contact_energy", "work", "gap", "contact_force")
    for name in names:
        size = float(np.abs(steps.data[name]).max())
        np.testing.assert_allclose(events.data[name], steps.data[name], atol=1e-4 * size)


def test_outputs_change_nothing() -> None:
    """Reference: the run with outputs a hundred times as far apart; its series are as long, and
    what they leave out is the same."""
    fine, coarse = (
        integrate_events(Motion(two_modes(2.0), 1.5, output_step=s)) for s in (0.005, 0.5)
    )
    np.testing.assert_allclose(fine.states[::100], coarse.states, atol=1e-11)
    sums = [float(run.data["contact_force"].sum()) * s for run, s in ((fine, 0.005), (coarse, 0.5))]
    assert sums[0] == pytest.approx(sums[1], rel=1e-10)
    peaks = [float(run.data["contact_force_peak"].max()) for run in (fine, coarse)]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-6)


def test_starts_pressed(one_mass: OneMass) -> None:
    """Reference: analytic. Let go 5 mm deep in a linear stop, a mass leaves it after a quarter of
    its period, at the speed that it has then."""
    stop = PowerContact(stiffness=100.0, exponent=1.0, clearance=0.1)
    quarter = 0.5 * np.pi / 10.0
    run = integrate_events(
        Motion(
            one_mass(1.0, stop),
            2.0 * quarter,
            output_step=2.0 * quarter,
            position=np.array([-0.105]),
        )
    )
    assert run.first_contact == 0.0
    assert run.data.attrs["contact_changes"] == 1
    for name in ("contact_force", "contact_force_peak"):
        assert float(run.data[name][0, 0]) == pytest.approx(-0.5, rel=1e-12)
    assert float(run.data["tip"][-1]) == pytest.approx(-0.1 + 0.05 * quarter, rel=1e-12)


def test_without_contact_it_is_the_flow(one_mass: OneMass) -> None:
    """Reference: analytic."""
    run = integrate_events(Motion(one_mass(4.0, spring=100.0, force=30.0), 2.0, output_step=0.1))
    np.testing.assert_allclose(run.data["tip"], 0.3 * (1.0 - np.cos(5.0 * run.time)), atol=1e-13)
    assert np.isnan(run.first_contact)


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (
            {"damping": np.array([0.1, 0.0])},
            "a damped system has no closed form from contact to contact",
        ),
        (
            {"dashpots": np.ones((1, 2))},
            "a damped system has no closed form from contact to contact",
        ),
        (
            {"excitations": [Excitation(np.ones(2), Ramp(1.0))]},
            "loads that change with time leave no closed form from contact to contact",
        ),
        (
            {"frictions": [DryFriction(0.2, 0)], "friction_rows": np.ones((1, 2))},
            "dry friction leaves no closed form from contact to contact",
        ),
        (
            {"laws": [PowerContact(1e3, 2.0, 0.05, damping=0.1)]},
            "contact damping is not analytic where a press ends",
        ),
        (
            {"laws": [PowerContact(1e3, 1.5, 0.05)]},
            "a force of the exponent 1.5 is not analytic where a press begins",
        ),
    ],
)
def test_refuses_what_has_no_closed_form(change: dict[str, Any], what: str) -> None:
    system = replace(two_modes(2.0), **change)
    assert what_hinders(system) == what
    with pytest.raises(ValueError, match=f"^{re.escape(what)}; integrate by splitting$"):
        integrate_events(Motion(system, 1.0))


def test_a_tolerance_that_loses_energy_ends_the_run(one_mass: OneMass) -> None:
    """The load keeps the mass at the stop, where it swings a hundred times."""
    system = one_mass(1.0, PowerContact(1.0e4, 2.0, clearance=0.0), force=100.0)
    assert integrate_events(Motion(system, 5.0)).energy_residual < 1e-8
    with pytest.raises(NumericsError, match=r"at a tolerance of 10; make it smaller$"):
        integrate_events(Motion(system, 5.0), tolerance=10.0)


def test_endless_rattling_ends(one_mass: OneMass) -> None:
    """A mass without play between stops so hard that it turns 1e8 times between two outputs."""
    stop = PowerContact(stiffness=1.0e24, exponent=1.0, clearance=0.0)
    message = "more than 1000000 contacts follow within 0.001 s; make the contact softer"
    with pytest.raises(NumericsError, match=f"^{re.escape(message)}$"):
        integrate_events(Motion(one_mass(1.0, stop, force=1.0), 1.0))


def test_nothing_hinders_the_rest() -> None:
    assert what_hinders(two_modes(3.0)) is None
