# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads that change with time: their histories, and the motions that they make."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from dynamics.integrators.integrator import Events, suited
from dynamics.integrators.splitting import integrate
from dynamics.integrators.step import contact_step

from dynamics.arrays import Array
from dynamics.contact import PowerContact
from dynamics.excitation import Excitation, History, Ramp, Sine, Step, Table, followed
from dynamics.friction import DryFriction
from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from runs.studies.histories import KINKED, OMEGAS, masses, response

OneMass = Callable[..., GapSystem]


def driven(system: GapSystem, force: float, history: History) -> GapSystem:
    """The system under a force in N at its tip that follows a history."""
    load = force * system.observers["tip"].row
    return replace(system, excitations=[*system.excitations, Excitation(load, history)])


def test_histories_by_hand() -> None:
    time = np.array([-0.5, 0.0, 0.5, 1.0, 3.0])
    assert Step()(time).tolist() == [0.0, 1.0, 1.0, 1.0, 1.0]
    assert Ramp(2.0)(time).tolist() == [0.0, 0.0, 0.25, 0.5, 1.0]
    assert Sine(0.5)(time) == pytest.approx([-1.0, 0.0, 1.0, 0.0, 0.0], abs=1e-15)
    assert Sine(0.5, np.pi / 2.0)(time) == pytest.approx([0.0, 1.0, 0.0, -1.0, -1.0], abs=1e-15)
    table = Table((0.0, 1.0, 2.0), (1.0, -3.0, 0.5))
    assert table(time) == pytest.approx([1.0, 1.0, -1.0, -3.0, 0.5], abs=1e-15)
    assert [h.peak for h in (Step(), Ramp(2.0), Sine(0.5), table)] == [1.0, 1.0, 1.0, 3.0]
    assert [h.fastest for h in (Step(), Ramp(2.0), Sine(0.5), table)] == [0.0, 0.0, np.pi, 0.0]
    assert list(Ramp(2.0).kinks) == [0.0, 2.0]
    assert list(table.kinks) == [0.0, 1.0, 2.0]


def test_what_is_followed_has_both_ends() -> None:
    """Reference: analytic; kinks too near to an end to tell a slope from are beside it."""
    kinks = (1.0e-9, 2.5 + 1.0e-9, 5.0 - 1.0e-9)
    times = followed([Table(kinks, (0.0, 1.0, 0.0))], 5.0)
    assert times[[0, 1, -2, -1]].tolist() == [0.0, kinks[0], kinks[2], 5.0]
    assert kinks[1] in times
    assert 2.5 not in times


def test_a_step_is_a_load(one_mass: OneMass) -> None:
    """Reference: other code path, the same load as a constant."""
    plain = one_mass(3.0, PowerContact(1.0e4, 2.0, 0.02), spring=40.0, force=7.0, dashpot=0.8)
    stepped = driven(replace(plain, load=np.zeros(1)), 7.0, Step())
    one, two = (integrate(Motion(s, 2.0, output_step=0.01), step=2e-4) for s in (plain, stepped))
    assert one.data.attrs["contact_changes"] >= 4
    assert two.data.identical(one.data)
    undamped = replace(stepped, damping=np.zeros(1))
    assert isinstance(suited(Motion(undamped, 2.0, 0.01)), Events)
    moved = Events()(Motion(undamped, 2.0, 0.01))
    again = Events()(Motion(replace(plain, damping=np.zeros(1)), 2.0, 0.01))
    assert moved.data.identical(again.data)


@pytest.mark.parametrize("frictions", [0, 1])
@pytest.mark.parametrize("step", [2.0e-2, 1.0e-3])
@pytest.mark.parametrize("where", KINKED)
def test_kinks_are_followed_wherever_they_are(where: str, step: float, frictions: int) -> None:
    """Reference: analytic, for each mode by its range, with friction that holds nothing or without;
    the work is all the energy that there is."""
    system = replace(
        masses(KINKED[where]),
        friction_rows=np.ones((frictions, len(OMEGAS))),
        frictions=[DryFriction(0.2, 0, 1.0e-30)] * frictions,
    )
    run = integrate(Motion(system, 4.0, output_step=0.02), step=step)
    for omega in OMEGAS:
        expected = response(omega, KINKED[where], run.time)
        error = np.abs(run.data[f"{omega:g}"].values - expected).max()
        assert error < 1e-9 * np.ptp(expected), omega
    assert run.energy_residual < 1e-11


def test_a_jump_within_a_step() -> None:
    """Reference: analytic, the load let on 0.507 s later, as a table that rises within 1 ns."""
    run = integrate(
        Motion(masses(Table((0.507, 0.507 + 1.0e-9), (0.0, 1.0))), 2.0, output_step=0.02)
    )
    since = np.maximum(run.time - 0.507 - 0.5e-9, 0.0)
    for omega in OMEGAS:
        expected = 0.5 * since**2 * np.sinc(0.5 * omega * since / np.pi) ** 2
        error = np.abs(run.data[f"{omega:g}"].values - expected).max()
        assert error < 1e-8 * np.ptp(expected), omega


def test_a_table_that_knocks_takes_long_strides(one_mass: OneMass) -> None:
    """Reference: the same run by single steps, as friction that holds nothing makes them."""
    stop = PowerContact(stiffness=1.0e5, exponent=1.0, clearance=0.05)
    table = Table((0.0, 0.403, 0.9, 2.2), (0.0, 1.0, -0.4, 0.8))
    system = driven(one_mass(2.0, stop, spring=50.0), 5.0, table)
    step = contact_step(system, 0.01) / 20.0
    run = integrate(Motion(system, 4.0, output_step=0.01), step=step)
    rubbed = replace(
        system,
        friction_rows=system.rows,
        frictions=[DryFriction(1.0, 0, 1.0e-30)],
    )
    single = integrate(Motion(rubbed, 4.0, output_step=0.01), step=step)
    assert run.data.attrs["contact_changes"] == single.data.attrs["contact_changes"] > 4
    assert run.data.attrs["steps"] < 0.1 * single.data.attrs["steps"]
    size = np.ptp(run.data["tip"].values)
    np.testing.assert_allclose(run.data["tip"], single.data["tip"], atol=1e-4 * size)
    assert run.energy_residual < 1e-6


@pytest.mark.parametrize("damping", [0.0, 0.3])
@pytest.mark.parametrize("spring", [0.0, 1.0e-6, 40.0, 4.0e8])
def test_a_ramp_is_followed_exactly(one_mass: OneMass, spring: float, damping: float) -> None:
    """Reference: analytic. t³/6 per unit of mass and slope for ω = c = 0; else the particular
    solution (t − c/k)/k and a free motion. The shortest and the longest step agree."""
    system = driven(one_mass(1.0, spring=spring, dashpot=damping), 6.0, Ramp(2.0))
    coarse = integrate(Motion(system, 2.0, output_step=0.25), step=0.25)
    fine = integrate(Motion(system, 2.0, output_step=0.25), step=1e-4)
    if spring == damping == 0.0:
        np.testing.assert_allclose(coarse.data["tip"], coarse.time**3 / 2.0, rtol=1e-13)
    elif spring == 40.0:
        t, decay = coarse.time, damping / 2.0
        omega = np.sqrt(spring - decay**2)
        # x = 3 (t − c/k + e^{−δt}(A cos + B sin))/k with x = ẋ = 0 at first
        a = damping / spring
        b = (decay * a - 1.0) / omega
        free = np.exp(-decay * t) * (a * np.cos(omega * t) + b * np.sin(omega * t))
        np.testing.assert_allclose(coarse.data["tip"], 3.0 * (t - a + free) / spring, atol=1e-13)
    size = float(np.abs(fine.data["tip"]).max())
    np.testing.assert_allclose(coarse.data["tip"], fine.data["tip"], atol=1e-10 * size)
    assert coarse.energy_residual < (1e-13 if damping else 1e-3)


def forced(time: Array, spring: float, dashpot: float, frequency: float, phase: float) -> Array:
    """Closed form for 1 kg from rest under 1 N sin(2π f t + φ)."""
    omega = 2.0 * np.pi * frequency
    swing = np.exp(1j * phase) / (spring - omega**2 + 1j * dashpot * omega)
    decay = 0.5 * dashpot
    natural = np.emath.sqrt(spring - decay**2)
    a = -swing.imag
    b = (decay * a - (1j * omega * swing).imag) / natural
    free = np.exp(-decay * time) * (a * np.cos(natural * time) + b * np.sin(natural * time))
    return np.asarray((swing * np.exp(1j * omega * time)).imag + np.real(free))


@pytest.mark.parametrize("dashpot", [0.0, 0.5, 20.0])
def test_a_sine_against_its_closed_form(one_mass: OneMass, dashpot: float) -> None:
    """Reference: analytic. Between steps the sine is a line, an error of second order in it."""
    system = driven(one_mass(1.0, spring=30.0, dashpot=dashpot), 1.0, Sine(0.6, 0.4))
    errors, residuals = [], []
    for step in (0.04, 0.02, 0.01):
        run = integrate(Motion(system, 8.0, output_step=0.04), step=step)
        expected = forced(run.time, 30.0, dashpot, 0.6, 0.4)
        errors.append(np.abs(run.data["tip"].values - expected).max() / np.abs(expected).max())
        residuals.append(run.energy_residual)
    slopes = np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
    assert slopes == pytest.approx(2.0, abs=0.02)
    assert errors[-1] < (2.0 * np.pi * 0.6 * 0.01) ** 2 / 6.0
    # The work is of fourth order; with a damped mode what it took is the rest of the ledger.
    assert max(residuals) < 1e-5
    assert residuals[-1] < 1e-7


def test_work_and_damping_loss_of_a_steady_swing(one_mass: OneMass) -> None:
    """Reference: analytic. In the steady state both gain c ω² X²/2 per time."""
    spring, dashpot, frequency = 30.0, 2.0, 0.8
    system = driven(one_mass(1.0, spring=spring, dashpot=dashpot), 1.0, Sine(frequency))
    period = 1.0 / frequency
    run = integrate(Motion(system, 30.0 * period, output_step=period / 100.0))
    omega = 2.0 * np.pi * frequency
    square = 1.0 / ((spring - omega**2) ** 2 + (dashpot * omega) ** 2)
    power = 0.5 * dashpot * omega**2 * square
    last = run.data.isel(time=[-501, -1])
    for name in ("work", "damping_loss"):
        gain = float(np.diff(last[name])[0])
        assert gain == pytest.approx(power * 5.0 * period, rel=1e-4), name


def test_excitations_add_up() -> None:
    """Reference: analytic, superposition over two modes and three loads."""
    n = 2
    system = GapSystem(
        omega2=np.array([5.0, 300.0]),
        load=np.array([0.3, -0.2]),
        rows=np.zeros((0, n)),
        laws=[],
        station_of_row=np.zeros(0, dtype=np.int64),
        stations=[],
        observers={},
        damping=np.array([0.0, 1.5]),
    )
    parts = [
        Excitation(np.array([1.0, 2.0]), Sine(1.1)),
        Excitation(np.array([-0.5, 4.0]), Table((0.0, 0.7, 0.9), (0.0, 1.0, -0.4))),
    ]
    dead = replace(system, load=np.zeros(n))
    together = integrate(Motion(replace(system, excitations=parts), 3.0, 0.1), step=0.01)
    alone = [
        integrate(Motion(replace(dead, excitations=[part]), 3.0, 0.1), step=0.01) for part in parts
    ]
    alone.append(integrate(Motion(system, 3.0, 0.1), step=0.01))
    np.testing.assert_allclose(together.states, sum(run.states for run in alone), atol=1e-13)


def test_a_shaken_mass_knocks_with_a_closed_ledger(one_mass: OneMass) -> None:
    stop = PowerContact(stiffness=1.0e5, exponent=1.0, clearance=0.02)
    system = driven(one_mass(2.0, stop, spring=50.0), 5.0, Sine(1.3))
    run = integrate(Motion(system, 4.0, output_step=0.01))
    assert run.data.attrs["contact_changes"] > 10
    assert run.energy_residual < 1e-3
    finer = integrate(Motion(system, 4.0, output_step=0.01), step=run.data.attrs["step"] / 4.0)
    assert finer.energy_residual < run.energy_residual / 8.0


@dataclass(frozen=True)
class Own:
    """A history that is none of ours: 1 and from t = 1 s on falling."""

    kinks: Sequence[float] = (1.0,)
    peak: float = 1.0
    fastest: float = 0.0

    def __call__(self, time: Array) -> Array:
        return np.minimum(1.0, 2.0 - time)


def test_a_history_of_one_s_own() -> None:
    """Reference: the same as a table."""
    system = masses(Table((0.0, 1.0, 3.0), (1.0, 1.0, -1.0)))
    own = replace(system, excitations=[Excitation(np.ones(len(OMEGAS)), Own())])
    runs = [integrate(Motion(one, 2.0, 0.03)) for one in (own, system)]
    np.testing.assert_allclose(runs[0].states, runs[1].states, rtol=1e-12, atol=1e-14)


@pytest.mark.parametrize(
    ("history", "arguments", "message"),
    [
        (Ramp, (0.0,), "duration must be finite and positive, got 0.0 s"),
        (Sine, (-1.0,), "frequency must be finite and positive, got -1.0 Hz"),
        (Sine, (1.0, float("inf")), "phase must be finite, got inf rad"),
        (Table, ((), ()), "a table needs one value for each time, got 0 for 0"),
        (Table, ((0.0, 1.0), (1.0,)), "a table needs one value for each time, got 1 for 2"),
        (Table, ((0.0, 0.0), (1.0, 2.0)), "times must rise"),
        (Table, ((0.0, 1.0), (1.0, float("nan"))), "times and values must be finite"),
        (
            Excitation,
            (np.ones(1), np.cos),
            "a history needs kinks, peak and fastest beside its values; give a Step, Ramp, Sine, "
            "Table or other History, got ufunc",
        ),
        (
            Excitation,
            (np.ones(1), Own(kinks=(1.0, 0.5))),
            "the kinks of a history must be finite and rise",
        ),
        (
            Excitation,
            (np.ones(1), Own(peak=float("nan"))),
            "peak of a history must be finite, not negative, got nan",
        ),
        (
            Excitation,
            (np.ones(1), Own(fastest=-1.0)),
            "fastest of a history must be finite, not negative, got -1.0",
        ),
    ],
)
def test_refuses_what_has_no_meaning(
    history: Callable[..., object], arguments: tuple[object, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        history(*arguments)
