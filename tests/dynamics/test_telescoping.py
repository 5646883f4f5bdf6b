# SPDX-License-Identifier: LGPL-3.0-or-later
"""Moving rows and moving axial forces: matrices, energy balance, symmetry and histories."""

import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import ContactLaw, DryFriction, PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Excitation, History, PiecewiseLinear, Ramp
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import HistorySum, SCurve, Stroke
from protractile.dynamics.travel import MovingAxialForce, RowTable, Travel
from tests.dynamics.reference import (
    end_of,
    errors_in_the_step,
    runge_kutta,
    slopes,
    table_slope,
    with_rates,
)
from tests.modal import modal_system

# Sines of a beam of 10 m, from its middle on, in two planes that share no mode.
WAVES = np.pi * np.arange(1, 4) / 10.0
FORCE = 100.0


def slope(s: float) -> np.ndarray:
    """Return the slopes (2, 6) in both planes at an extension in m."""
    own = WAVES * np.cos(WAVES * (5.0 + s))
    return np.array([[*own, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, *(2.0 * own)]])


def thrust() -> MovingAxialForce:
    def rows(s: float) -> np.ndarray:
        own = np.sin(WAVES * (5.0 + s))
        return np.array([[*own, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, *(2.0 * own)]])

    return MovingAxialForce(FORCE, RowTable.interpolate(rows, [-1.0, 0.5, 2.0]))


def softer(s: float) -> np.ndarray:
    """Return N ∫ w′ᵀ w′ dσ by Gauss's rule over the whole extension."""
    points, weights = np.polynomial.legendre.leggauss(30)
    slopes = [slope(0.5 * s * (point + 1.0)) for point in points]
    total = sum(w * one.T @ one for w, one in zip(weights, slopes, strict=True))
    return np.asarray(0.5 * s * FORCE * total)


def pressed_along(history: SCurve | PiecewiseLinear) -> GapSystem:
    """Return six modes on a soft contact with a constant row."""
    row = np.array([[0.1, -0.2, 0.3, 0.2, 0.1, -0.3]])
    table = RowTable(np.array([-1.0, 2.0]), np.array([[row, 0 * row, 0 * row, 0 * row]]))
    return modal_system(
        [200.0, 300.0, 900.0, 400.0, 2000.0, 5000.0],
        [1.0, -2.0, 0.5, 1.0, 0.2, 0.1],
        row,
        [PowerContact(1e4, 1.0).with_clearance(1e-4)],
        tip=row[0],
        damping=np.array([0.1, 0.2, 0.3, 0.1, 0.2, 0.3]),
        travels=[Travel(history, table, (("rows", 0),), "", (thrust(),))],
    )


@pytest.mark.parametrize("s", [-0.3, 1.7])
def test_thrust_softens_the_passed_length(s: float) -> None:
    """Reference: analytic, the integral over the extension by Gauss's rule; 0 to the last bit for
    any knots. Only passed pieces are integrated, or matrices would need 0.16 GB.
    """
    assert thrust().geometric_stiffness(s) == pytest.approx(softer(s), rel=1e-6, abs=1e-6 * FORCE)
    for ends in ([-1.0, -0.4, 1.0], [-2.0, 0.0], [0.0, 1.0]):
        own = RowTable.interpolate(lambda s: np.sin(WAVES * (5.0 + s))[None], ends)
        assert not MovingAxialForce(FORCE, own).geometric_stiffness(0.0).any()
    modes, knots = 200, np.linspace(-1.0, 1.0, 501)
    piece = np.diff(knots)[0] * np.eye(4)[1][:, None, None]
    table = RowTable(knots, np.tile(piece, (500, 1, 1, modes)))
    tracemalloc.start()
    found = MovingAxialForce(2.0, table).geometric_stiffness(0.0105)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert found == pytest.approx(np.full((modes, modes), 0.021), rel=1e-12)
    assert most < 50e6


def test_as_it_stands_its_own_modes_are_those_of_the_softer_boom() -> None:
    """Reference: analytic, the eigenvalues of diag(ω²) − K_G. The equilibrium is the same."""
    stands = pressed_along(SCurve(2.0, 1.0)).at_time(1.0)
    own = stands.in_own_modes()
    expected = eigh(np.diag(stands.omega2) - softer(2.0), eigvals_only=True)
    assert own.omega2 == pytest.approx(expected, rel=1e-6)
    assert (np.abs(own.omega2 - np.sort(stands.omega2)) > 10.0).any()
    rests = [float(one.observers["tip"].row @ equilibrium(one, one.load)) for one in (stands, own)]
    assert rests[0] == pytest.approx(rests[1], rel=1e-8)
    assert own.in_own_modes() is own
    message = "^a system with geometric_stiffness must be transformed by in_own_modes$"
    with pytest.raises(ValueError, match=message):
        Motion(stands, 1.0)


def test_a_motion_by_an_integration_of_its_own() -> None:
    """Reference: other code, scipy's DOP853 with the matrix: order 2, error, and effect of the
    force. The energy balance verifies the work of the drive.
    """
    drawn = pressed_along(SCurve(2.0, 1.0))
    motion = Motion(replace(drawn, damping=np.zeros(6)), 1.0, 1e-2)
    expected = runge_kutta(motion, 5e-3)
    errors = errors_in_the_step(motion, expected, np.array([2e-3, 1e-3, 5e-4]))
    assert slopes(errors) == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < 4e-4
    plain = replace(motion.system, travels=[replace(drawn.travels[0], axial_forces=())])
    (off,) = errors_in_the_step(replace(motion, system=plain), expected, np.array([5e-4]))
    assert off > 0.05
    assert FixedStep(5e-4)(motion).energy_residual < 1e-11


# A simply supported beam: length in m, E J in N·m², mass per length in kg/m.
LENGTH, STIFFNESS, MASS = 10.0, 1.0e7, 100.0


def sines(x: float, count: int) -> Array:
    """Return the mass-normalised modes of the beam at x in m."""
    k = np.arange(1, count + 1)
    return np.asarray(np.sqrt(2.0 / (MASS * LENGTH)) * np.sin(k * np.pi * x / LENGTH))


def frequencies(count: int) -> Array:
    """ω of these modes in rad/s."""
    k = np.arange(1, count + 1)
    return np.asarray((k * np.pi / LENGTH) ** 2 * np.sqrt(STIFFNESS / MASS))


def rider(
    history: History,
    law: ContactLaw,
    *,
    mass: float,
    weight: float,
    count: int = 8,
    start: float = 0.0,
    **changes: Any,
) -> GapSystem:
    """Return a mass in kg that moves along the beam from a start, under its weight in N.

    Contact row, friction row and dashpot have the displacement of the mass relative to the beam.
    """

    def row(way: float) -> Array:
        return np.append(-sines(start + way, count), 1.0 / np.sqrt(mass))

    numbers: dict[str, Any] = {
        "omega2": np.append(frequencies(count) ** 2, 0.0),
        "load": np.append(np.zeros(count), -weight / np.sqrt(mass)), "rows": row(0.0)[None],
        "laws": [law], "station_of_row": np.array([0]), "stations": [start],
        "observers": {"tip": Observer(np.append(sines(0.5 * LENGTH, count), 0.0))}, **changes,
    }  # fmt: skip
    scales = {"rows": 1.0}
    if numbers.get("frictions"):
        scales["friction_rows"] = 1.0
    if "drag" in numbers:
        scales["dashpots"] = np.sqrt(numbers.pop("drag"))
    numbers |= {kind: scale * row(0.0)[None] for kind, scale in scales.items()}
    table = RowTable.interpolate(
        lambda way: np.array([scale * row(way) for scale in scales.values()]),
        np.linspace(-start, LENGTH - start, 3).tolist(),
    )
    moving: Any = tuple((kind, 0) for kind in scales)
    return GapSystem(**numbers, travels=[Travel(history, table, moving, "")])


def lossy(history: History, **changes: Any) -> GapSystem:
    """Return a mass that moves along the beam, with friction, dampers, a ramped load and play."""
    law = PowerContact(1.0e6, 1.5, damping=0.5).with_clearance(1.0e-4)
    rubbing = DryFriction(0.3, 0, normal_force=400.0)
    system = rider(history, law, mass=20.0, weight=2.0e3, start=2.0, frictions=[rubbing], drag=50.0)
    load = Excitation(np.append(300.0 * sines(3.0, 8), 0.0), Ramp(0.1))
    return replace(system, damping=np.full(9, 0.5), excitations=[load], **changes)


def test_a_moving_force_on_a_beam() -> None:
    """Reference: analytic, a constant force on a simply supported beam (Frýba 1972)."""
    force, speed, count, stiffness, mass = 1.0e3, 20.0, 30, 1.0e7, 0.01
    law = PowerContact(stiffness, 1.0).lower()
    assert law is not None
    system = rider(Stroke(LENGTH, speed), law, mass=mass, weight=force, count=count)
    pressed = np.append(np.zeros(count), -force / stiffness * np.sqrt(mass))
    run = FixedStep(1.0e-4)(Motion(system, LENGTH / speed, 1.0e-3, position=pressed))
    k, omega = np.arange(1, count + 1)[:, None], frequencies(count)[:, None]
    passing = k * np.pi * speed / LENGTH
    time = run.time[None]
    swings = np.sin(passing * time) - passing / omega * np.sin(omega * time)
    modes = -2.0 * force / (MASS * LENGTH) * swings / (omega**2 - passing**2)
    series = (modes * np.sin(0.5 * k * np.pi)).sum(axis=0)
    assert np.abs(run.data["tip"].values - series).max() < 1.0e-4 * np.abs(series).max()


@pytest.mark.parametrize("drawn", [lossy, pressed_along])
def test_constant_travel_equals_no_travel_to_the_bit(drawn: Callable[[History], GapSystem]) -> None:
    """Reference: non-regression, the same system without a travel."""
    moving = drawn(PiecewiseLinear([0.0, 1.0], [0.0, 0.0]))
    resting = replace(moving, travels=())
    runs = [FixedStep(5.0e-5)(Motion(system, 0.3, 1.0e-3)) for system in (moving, resting)]
    assert np.array_equal(runs[0].states, runs[1].states)
    assert runs[0].data.identical(runs[1].data)


def test_it_runs_back_as_it_came() -> None:
    """Reference: analytic, time reversibility in contact and under the drive."""
    law = PowerContact(1.0e6, 1.5).with_clearance(1.0e-4)
    there = rider(SCurve(5.0, 0.2), law, mass=20.0, weight=2.0e3, start=2.0)
    out = FixedStep(1.0e-4)(Motion(with_rates(there), 0.2, 1.0e-3))
    assert out.data.attrs["contact_changes"] > 0
    place, speed = end_of(out)
    back = rider(SCurve(-5.0, 0.2), law, mass=20.0, weight=2.0e3, start=7.0)
    home = FixedStep(1.0e-4)(Motion(back, 0.2, 1.0e-3, place, -speed))
    assert np.abs(home.states[::-1] - out.states).max() < 1.0e-9 * np.abs(out.states).max()


def test_drive_friction_force() -> None:
    """Reference: analytic, μ Σ|N| sign(ṡ) of the contact and the prescribed normal force."""
    system = lossy(Stroke(-1.0, 5.0, ramp=0.05, start=0.1))
    run = FixedStep(1.0e-4)(Motion(system, 0.5, 1.0e-3))
    force = np.abs(run.data["contact_force"].values[:, 0])
    moving = np.sign(np.diff(run.data["extension"].values, prepend=0.0))
    assert run.data["drive_friction"].values == pytest.approx(moving * 0.3 * (force + 400.0))
    assert moving[[50, 200, 450]].tolist() == [0.0, -1.0, 0.0]
    ways = np.diff(run.data["extension"].values, prepend=0.0)
    work = run.data["drive_work"].values[-1] + (run.data["drive_friction"].values * ways).sum()
    assert 1.0e-3 * run.data["drive_power"].values.sum() == pytest.approx(work)


@pytest.mark.parametrize(
    ("history", "way", "speed"),
    [
        (SCurve(4.0, 5.0, start=1.0), 4.0, 1.6),
        (SCurve(-4.0, 5.0), -4.0, -1.6),
        (Stroke(4.0, 1.0, ramp=0.5, start=1.0), 4.0, 1.0),
        (Stroke(-1.3, 0.3, ramp=0.37, start=0.1), -1.3, -0.3),
        (HistorySum((SCurve(4.0, 5.0), Stroke(1.0, 0.5))), 5.0, 1.947),
    ],
)
def test_histories_of_a_drive(history: History, way: float, speed: float) -> None:
    """Reference: analytic, travel, largest speed, and rest before and after it to the last bit."""
    time = np.linspace(0.0, 8.0, 80001)
    ways = history(time)
    rates = np.gradient(ways, time)
    assert ways[0] == 0.0
    assert ways[-1] == pytest.approx(way)
    assert rates[np.abs(rates).argmax()] == pytest.approx(speed, rel=2e-4)
    assert np.abs(ways).max() <= history.peak * (1.0 + 1e-12)
    assert history(np.array(history.kinks[-1])) == pytest.approx(way)
    assert not history(np.array([history.kinks[0]])).any()
    assert not np.diff(ways[time > history.kinks[-1]]).any()


def test_tables_hold_cubics_and_come_near_to_the_rest() -> None:
    """Reference: analytic, a cubic between knots, a sine within the tolerance."""

    def rows(way: float) -> Array:
        return np.array([[(way - 1.0) ** 3 if way > 1.0 else 0.0], [np.sin(way)]])

    cubic = RowTable.interpolate(lambda way: rows(way)[:1], [0.0, 1.0, 3.0])
    assert len(cubic.knots) == 3
    sine = RowTable.interpolate(rows, [0.0, 1.0, 3.0])
    for way in np.linspace(0.0, 3.0, 101):
        assert cubic(way)[0] == pytest.approx(rows(way)[0], abs=1e-13)
        assert sine(way)[1] == pytest.approx(rows(way)[1], abs=1e-8)
        assert table_slope(sine, way)[1] == pytest.approx(np.cos(way), abs=1e-5)
