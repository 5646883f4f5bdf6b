# SPDX-License-Identifier: LGPL-3.0-or-later
"""Dry friction: sticking, sliding, cycles, energy, order."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.excitation import Excitation, PiecewiseLinear, Sine
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import SCurve, Stroke
from protractile.dynamics.stick_slip import DriveMotion, ElasticDrive, move_segment
from protractile.runs.pipeline.drives import critical_speed
from tests.modal import modal_system, one_mass


def rubbing(system: GapSystem, friction: DryFriction) -> GapSystem:
    """Return the system with friction on its tip, at one station."""
    rows = system.observers["tip"].row.reshape(1, -1)
    at_tip = {"stations": [0.0], "station_directions": ("z",)}
    return replace(system, friction_rows=rows, frictions=[friction], **at_tip)


def modes(omega: Array, load: Array, rows: Array, limits: Array, **more: Any) -> GapSystem:
    """Return loaded modes that are coupled by friction rows with prescribed μ N."""
    frictions = [DryFriction(0.25, j % 2, 4.0 * limit) for j, limit in enumerate(limits)]
    more |= {"observers": {"first": Observer(np.eye(omega.size)[0])}, "stations": [0.0, 1.0]}
    return modal_system(omega**2, load, friction_rows=rows, frictions=frictions, **more)


def test_a_mass_on_a_spring_comes_to_rest() -> None:
    """Reference: analytic. Only a force above μ N causes sliding, with (F − μ N)/m. Each half cycle
    lasts π √(m/k) and reduces the amplitude by 2 μN/k, until a turning point is within μN/k. Then
    the mass stays at rest.
    """
    for force in (4.999, -4.999, 5.001):
        system = rubbing(one_mass(2.0, force=force), DryFriction(0.5, 0, 10.0))
        run = FixedStep(0.01)(Motion(system, 1.0, output_step=0.1))
        moved = max(0.0, abs(force) - 5.0) / 2.0 * run.time**2 / 2.0
        np.testing.assert_allclose(run.data["tip"], moved, rtol=1e-9, atol=1e-15)
    mass, spring, limit = 2.0, 50.0, 3.0
    system = rubbing(one_mass(mass, spring=spring), DryFriction(0.3, 0, limit / 0.3))
    half = np.pi * np.sqrt(mass / spring)
    stick = limit / spring
    start = 9.4 * stick
    motion = Motion(system, 8.0 * half, half / 100.0, np.array([start * np.sqrt(mass)]))
    run = FixedStep(half / 100.0)(motion)
    tip = run.data["tip"].values
    turns = np.array([(9.4 - 2.0 * k) * (-1) ** k * stick for k in range(6)])
    np.testing.assert_allclose(tip[:501:100], turns, atol=1e-6 * start)
    assert abs(turns[-1]) < stick
    assert np.ptp(tip[501:]) <= 1e-16
    lost = 0.5 * spring * (start**2 - tip[-1] ** 2)
    assert float(run.data["friction_loss"][-1]) == pytest.approx(lost, rel=1e-12)
    # At rest friction is what the spring is; sliding it is μ N against the motion.
    force = run.data["friction_force"].values[:, 0]
    assert force[-1] == pytest.approx(spring * tip[-1], rel=1e-9)
    assert force[1:100] == pytest.approx(limit, rel=1e-12)
    assert force[101:200] == pytest.approx(-limit, rel=1e-12)


def motion_of_stiff_equations(
    system: GapSystem, limits: Array, velocity: Array, times: Array
) -> Array:
    """Return states (num_times, num_modes) by scipy's BDF; friction rises within 1 µm/s."""
    rows, n = system.friction_rows, system.num_modes

    def rate(_: float, state: Array) -> Array:
        friction = limits * np.tanh(rows @ state[n:] / 1.0e-6)
        pull = system.load - system.omega2 * state[:n] - rows.T @ friction
        return np.concatenate([state[n:], pull])

    start = np.concatenate([np.zeros(n), velocity])
    found = solve_ivp(rate, times[[0, -1]], start, "BDF", times, rtol=1e-7, atol=1e-9)
    return np.asarray(found.y[:n].T)


LIMITS, THROWN = np.array([0.525, 0.375]), np.array([1.0, 0.3, -0.5])
ROWS = np.array([[0.8, 0.5, -0.3], [0.5, -0.6, 0.4]])


def coupled(rows: Array, limits: Array) -> GapSystem:
    return modes(np.array([1.3, 2.9, 7.1]), np.array([0.9, 0.4, 2.0]), rows, limits)


def test_two_coupled_rows_against_stiff_equations() -> None:
    """Reference: other code, scipy's BDF with a steep law; the order is 1. Doubled rows of parts
    of the limits have the same motion, and sums of forces.
    """
    system = coupled(ROWS, LIMITS)
    times = np.linspace(0.0, 12.0, 121)
    expected = motion_of_stiff_equations(system, LIMITS, THROWN, times)
    slips = np.diff(expected @ ROWS.T, axis=0)
    # The motion has it all: sliding both ways, and rest.
    for kind in (slips > 1e-3, slips < -1e-3, np.abs(slips) < 1e-6):
        assert (kind.sum(axis=0) > 10).all()
    errors = []
    motion = Motion(system, 12.0, output_step=0.1, velocity=THROWN)
    for step in (steps := 0.05 / 2.0 ** np.arange(6)):
        run = FixedStep(step)(motion)
        errors.append(np.abs(run.states - expected).max() / np.abs(expected).max())
    assert (np.array(errors) < 0.2 * steps).all()
    run = AdaptiveStep(1e-3)(motion)
    error = np.abs(run.states[:, 0] - expected[:, 0]).max() / np.ptp(expected[:, 0])
    assert error < run.data.attrs["step_error"] < 1e-3
    parts = np.array([0.5, 0.3, 0.5, 0.7]) * LIMITS[[0, 1, 0, 1]]
    doubled = replace(motion, system=coupled(ROWS[[0, 1, 0, 1]], parts))
    one, two = (
        FixedStep(0.01)(replace(each, duration=9.0, output_step=0.01)) for each in (motion, doubled)
    )
    np.testing.assert_allclose(two.states, one.states, atol=1e-9)
    np.testing.assert_allclose(two.data["friction_force"], one.data["friction_force"], atol=1e-6)


def test_sticking_places_do_not_creep() -> None:
    """In 30 000 steps of vibrating modes, friction keeps two points at rest to the last digits."""
    generator = np.random.default_rng(4)
    rows = generator.normal(size=(2, 8))
    system = modes(
        omega=np.concatenate([[0.0], np.linspace(2.0, 60.0, 7)]),
        load=generator.normal(size=8),
        rows=rows,
        limits=np.array([60.0, 60.0]),
        excitations=[Excitation(generator.normal(size=8), Sine(1.7))],
        damping=np.linspace(0.0, 0.3, 8),
        dashpots=0.2 * generator.normal(size=(1, 8)),
    )
    run = FixedStep(1e-4)(Motion(system, 3.0, output_step=0.01))
    assert np.ptp(run.data["first"].values) > 0.05
    assert np.abs(run.states @ rows.T).max() < 1e-15
    assert np.abs(run.data["friction_force"].values).max() < 50.0
    assert float(run.data["friction_loss"][-1]) < 1e-8 * float(run.data["work"][-1])


def sled(friction: DryFriction) -> GapSystem:
    """Return 2 kg that slides (mode 0) on a floor under its weight (mode 1), 2 kg · 10 m/s²."""
    root = np.sqrt(2.0)
    along, floor = np.array([1.0 / root, 0.0]), PowerContact(1.0e6, 1.0).lower()
    rubbing = {"friction_rows": along[None], "frictions": [friction]}
    load, row = [0.0, -10.0 * root], [0.0, 1.0 / root]
    return modal_system(
        [0.0, 0.0], load, row, [floor], observers={"way": Observer(along)}, **rubbing
    )


def test_sled_stops_by_friction_under_its_weight() -> None:
    """Reference: analytic, v²/(2 μ g) under the weight, v²/(2 μ (g + N/m)) under N more."""
    rest = np.array([0.0, -20.0 / 1.0e6 * np.sqrt(2.0)])
    for extra in (0.0, 8.0):
        system = sled(DryFriction(0.5, 0, extra, (0,)))
        velocity = np.array([3.0 * np.sqrt(2.0), 0.0])
        run = FixedStep(1e-3)(Motion(system, 1.0, 0.01, rest, velocity))
        slowing = 0.5 * (10.0 + extra / 2.0)
        way = run.data["way"].values
        assert way[-1] == pytest.approx(9.0 / (2.0 * slowing), rel=5e-6)
        assert np.ptp(way[run.time > 3.0 / slowing + 0.01]) < 1e-14
        assert float(run.data["friction_loss"][-1]) == pytest.approx(9.0, rel=5e-6)
        assert float(run.data["friction_force"][10, 0]) == pytest.approx(-2.0 * slowing, rel=1e-9)


def test_a_bounce_takes_its_impulse_times_friction() -> None:
    """Reference: analytic. The floor's impulse is 2 m u, and that of friction μ times this."""
    system = replace(sled(DryFriction(0.3, 0, 0.0, (0,))), load=np.zeros(2))
    start, velocity = np.array([0.0, 0.1]), np.array([3.0, -1.0]) * np.sqrt(2.0)
    errors = []
    for step in (2e-5, 1e-5):
        run = FixedStep(step)(Motion(system, 0.2, 0.01, start, velocity))
        speed = float(np.diff(run.data["way"].values)[-1]) / 0.01
        errors.append(abs(speed - (3.0 - 0.3 * 2.0)))
        assert run.data.attrs["contact_changes"] == 2
        loss = 0.5 * 2.0 * (9.0 - 2.4**2)
        assert float(run.data["friction_loss"][-1]) == pytest.approx(loss, rel=1e-4)
    assert max(errors) < 1e-4
    impulse = 0.01 * float(run.data["friction_force"].sum())
    assert impulse == pytest.approx(-0.3 * 0.01 * float(np.abs(run.data["contact_force"]).sum()))


MASS, STIFFNESS, FRICTION = 500.0, 1.0e5, 1000.0
OMEGA = np.sqrt(STIFFNESS / MASS)
ROPE = ElasticDrive(MASS, STIFFNESS, sticking=1.5)


def damped(ratio: float) -> ElasticDrive:
    return replace(ROPE, dashpot=2.0 * ratio * np.sqrt(STIFFNESS * MASS))


def drawn(pulled: ElasticDrive, speed: float, duration: float, outputs: int) -> DriveMotion:
    """Return the motion at a constant speed against constant friction."""
    time = np.linspace(0.0, duration, outputs + 1)
    friction = np.full(time.size, FRICTION)
    return move_segment(pulled, Stroke(2.0 * speed * duration, speed), time, friction)


@pytest.mark.parametrize("speed", [0.01, 0.05, 0.3])
def test_cycles_of_sticking_and_slipping(speed: float) -> None:
    """Reference: analytic. It sticks until the spring is 2 d longer, d = (R_s − R)/k. In the phase
    plane it slips along a circle of the radius A = √(d² + v²/ω²) by the angle
    2 (π − atan(d ω/v)).
    """
    slack = 0.5 * FRICTION / STIFFNESS
    radius = np.hypot(slack, speed / OMEGA)
    period = 2.0 * slack / speed + 2.0 / OMEGA * (np.pi - np.arctan(slack * OMEGA / speed))
    first = 1.5 * FRICTION / STIFFNESS / speed
    duration = first + 4.99 * period
    found = drawn(ROPE, speed, duration, 11_000)
    time = np.linspace(0.0, duration, 11_001)
    begins = time[1:][
        (found.series["extension_speed"][:-1] == 0.0) & (found.series["extension_speed"][1:] > 0.0)
    ]
    assert begins[0] == pytest.approx(first, abs=2.0 * time[1])
    assert (begins[4] - begins[0]) / 4.0 == pytest.approx(period, rel=6e-4)
    told = found.results
    assert told.sticks == 5
    assert told.peak == pytest.approx(FRICTION + STIFFNESS * radius, rel=1e-5)
    assert told.speed == pytest.approx(speed + OMEGA * radius, rel=1e-5)
    assert told.acceleration == pytest.approx(radius * OMEGA**2, rel=1e-3)
    assert told.slip == pytest.approx(2.0 * radius, rel=1e-5)
    assert told.energy_residual < 1e-10


def test_above_a_critical_speed_nothing_sticks() -> None:
    """Reference: analytic, the speed that a damped vibration just reaches again. Small damping
    takes 4πζ of the energy per period. Without damping the mass sticks at every speed. An
    overdamped mass never sticks again.
    """
    for ratio in (0.01, 0.5):
        critical = critical_speed(damped(ratio), FRICTION)
        for part, sticks in ((0.9999, True), (1.0001, False)):
            speed = part * critical
            duration = 5.0 * FRICTION / STIFFNESS / speed + 40.0 * np.pi / OMEGA
            assert (drawn(damped(ratio), speed, duration, 2000).results.sticks > 1) == sticks
    small = 1.0e-6
    limit = 0.5 * FRICTION / np.sqrt(4.0 * np.pi * small * STIFFNESS * MASS)
    assert critical_speed(damped(small), FRICTION) == pytest.approx(limit, rel=1e-3)
    speeds = [critical_speed(damped(ratio), FRICTION) for ratio in (0.0, 0.99, 1.0)]
    assert speeds == [np.inf, 0.0, 0.0]
    assert critical_speed(replace(ROPE, sticking=1.0), FRICTION) == 0.0
    assert drawn(damped(1.0), 0.01, 30.0, 3000).results.sticks == 0


def test_a_stiff_drive_follows() -> None:
    """Reference: analytic. The force is friction plus m s̈, and the lag is this force over k."""
    way = SCurve(travel=2.0, duration=4.0)
    time = np.linspace(0.0, 4.0, 401)
    friction = np.full(time.size, FRICTION)
    asked = MASS * np.diff(np.pi * (1.0 - np.cos(0.5 * np.pi * time)) / (2.0 * np.pi)) / time[1]
    inside = slice(20, 380)
    off = []
    for stiffness in (1.0e8, 1.0e9):
        pulled = ElasticDrive(MASS, stiffness, dashpot=0.4 * np.sqrt(MASS * stiffness))
        found = move_segment(pulled, way, time, friction)
        off.append(np.abs(found.series["drive_force"][1:] - FRICTION - asked)[inside].max())
        lag = found.series["drive_force"][1:] / stiffness
        assert found.series["drive_lag"][1:][inside] == pytest.approx(lag[inside], rel=0.02)
    assert off[0] < 2e-3 * FRICTION
    assert off[1] < 1e-4 * FRICTION


def test_other_drives_push() -> None:
    """Reference: analytic. If another drive accelerates by a, the mass m_b that both move vibrates
    about m_b a/k. The axial load has no further effect. A jump to v gives the impulse m_b v, and a
    swing by m_b v/(m ω).
    """
    lift = Stroke(travel=2.0, speed=1.0, ramp=1.0)
    pulled = replace(ROPE, thrust=300.0, coupled_drives=((0.4 * MASS, lift),))
    time = np.linspace(0.0, 0.9, 901)
    found = move_segment(pulled, SCurve(1e-9, 1.0, start=5.0), time, np.zeros(time.size))
    behind = 0.4 * MASS / STIFFNESS * (1.0 - np.cos(OMEGA * time))
    assert found.series["drive_lag"] == pytest.approx(behind, abs=2e-3 * behind.max())
    assert found.results.peak == pytest.approx(300.0 + 0.8 * MASS, rel=1e-3)
    assert found.series["drive_force"][0] == 300.0
    for start in (0.0, 0.1):
        pulled = replace(ROPE, coupled_drives=((0.4 * MASS, Stroke(2.0, 1.0, start=start)),))
        found = move_segment(pulled, SCurve(1e-9, 1.0, start=5.0), time, np.zeros(time.size))
        behind = 0.4 / OMEGA * np.sin(OMEGA * np.maximum(time - start, 0.0))
        assert found.series["drive_lag"] == pytest.approx(behind, abs=0.01 * behind.max())


def test_reversing_drive() -> None:
    """Reference: analytic. In slow motion the lag is R/k outwards and −R/k inwards. If static and
    sliding friction are equal, the mass does not overshoot.
    """
    way = PiecewiseLinear((0.0, 10.0, 20.0), (0.0, 0.5, 0.0))
    time = np.linspace(0.0, 20.0, 4001)
    found = move_segment(
        replace(damped(0.3), sticking=1.0), way, time, np.full(time.size, FRICTION)
    )
    assert found.series["drive_lag"][1900] == pytest.approx(FRICTION / STIFFNESS, rel=1e-6)
    assert found.results.behind == pytest.approx(-FRICTION / STIFFNESS, rel=1e-6)
    assert found.results.mean == pytest.approx(FRICTION, rel=0.03)
