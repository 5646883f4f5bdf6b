# SPDX-License-Identifier: LGPL-3.0-or-later
"""A mass that a spring pulls against dry friction: cycles, speeds, energy, order."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from protractile.dynamics.arrays import Array
from protractile.dynamics.excitation import PiecewiseLinear
from protractile.dynamics.motion_laws import SCurve, Stroke
from protractile.dynamics.stick_slip import DriveMotion, ElasticDrive, move_segment
from protractile.runs.pipeline.drives import critical_speed

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


@pytest.mark.parametrize("ratio", [0.01, 0.1, 0.5])
def test_above_a_critical_speed_nothing_sticks(ratio: float) -> None:
    """Reference: analytic, the speed that a damped vibration just reaches again."""
    pulled = damped(ratio)
    critical = critical_speed(pulled, FRICTION)
    for part, sticks in ((0.9999, True), (1.0001, False)):
        speed = part * critical
        duration = 5.0 * FRICTION / STIFFNESS / speed + 40.0 * np.pi / OMEGA
        assert (drawn(pulled, speed, duration, 2000).results.sticks > 1) == sticks


def test_little_damping_and_much_of_it() -> None:
    """Reference: analytic. Small damping takes 4πζ of the energy per period. Without damping the
    mass sticks at every speed. An overdamped mass never sticks again.
    """
    small = 1.0e-6
    limit = 0.5 * FRICTION / np.sqrt(4.0 * np.pi * small * STIFFNESS * MASS)
    assert critical_speed(damped(small), FRICTION) == pytest.approx(limit, rel=1e-3)
    assert critical_speed(damped(0.0), FRICTION) == np.inf
    assert critical_speed(damped(1.0), FRICTION) == 0.0
    assert critical_speed(damped(0.99), FRICTION) == 0.0
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
    about m_b a/k. The axial load has no further effect.
    """
    lift = Stroke(travel=2.0, speed=1.0, ramp=1.0)
    pulled = replace(ROPE, thrust=300.0, coupled_drives=((0.4 * MASS, lift),))
    time = np.linspace(0.0, 0.9, 901)
    found = move_segment(pulled, SCurve(1e-9, 1.0, start=5.0), time, np.zeros(time.size))
    behind = 0.4 * MASS / STIFFNESS * (1.0 - np.cos(OMEGA * time))
    assert found.series["drive_lag"] == pytest.approx(behind, abs=2e-3 * behind.max())
    assert found.results.peak == pytest.approx(300.0 + 0.8 * MASS, rel=1e-3)
    assert found.series["drive_force"][0] == 300.0


@pytest.mark.parametrize("start", [0.0, 0.1])
def test_sudden_start_of_another_drive(start: float) -> None:
    """Reference: analytic. A jump to v gives the impulse m_b v, and a swing by m_b v/(m ω)."""
    pulled = replace(ROPE, coupled_drives=((0.4 * MASS, Stroke(2.0, 1.0, start=start)),))
    time = np.linspace(0.0, 0.9, 901)
    found = move_segment(pulled, SCurve(1e-9, 1.0, start=5.0), time, np.zeros(time.size))
    behind = 0.4 / OMEGA * np.sin(OMEGA * np.maximum(time - start, 0.0))
    assert found.series["drive_lag"] == pytest.approx(behind, abs=0.01 * behind.max())


Friction = Callable[[Array | float], Array]


def stops(_: float, y: Array, sign: float) -> float:
    """Return the event at the end of a slip."""
    return float(sign * y[1] + (1e-14 if y[1] == 0.0 else 0.0))


stops.terminal, stops.direction = True, -1


def by_runge_kutta(
    pulled: ElasticDrive, way: SCurve, end: float, friction: Friction
) -> tuple[float, int]:
    """Return s in m at the end in s, and the number of times it sticks, from event to event."""

    def force(t: Array | float, s: Array | float, v: Array | float) -> Array:
        angle = 2.0 * np.pi * np.asarray(t) / way.duration
        rate = way.travel / way.duration * (1.0 - np.cos(angle))
        return np.asarray(pulled.stiffness * (way(np.asarray(t)) - s) + pulled.dashpot * (rate - v))

    def slides(t: float, y: Array, sign: float) -> list[float]:
        return [y[1], float(force(t, *y) - sign * friction(t)) / pulled.mass]

    time, place, sticks = 0.0, 0.0, 0
    while time < end:

        def spare(t: Array | float, place: float = place) -> Array:
            return pulled.sticking * friction(t) - np.abs(force(t, place, 0.0))

        ticks = np.linspace(time, end, 2001)
        beyond = np.flatnonzero(spare(ticks[1:]) < 0.0)
        if beyond.size == 0:
            break
        time = brentq(spare, ticks[beyond[0]], ticks[beyond[0] + 1], xtol=1e-15)
        sign = float(np.sign(force(time, place, 0.0)))
        run = solve_ivp(
            slides, (time, end), [place, 0.0],
            args=(sign,), events=stops, rtol=1e-11, atol=1e-13, max_step=0.01,
        )  # fmt: skip
        time, place = float(run.t[-1]), float(run.y[0, -1])
        sticks += run.t_events[0].size
    return place, sticks


def missed(ratio: float, friction: Friction, counts: Array) -> list[float]:
    """Return the errors in m at the end of a drive of 0.1 m for several numbers of outputs."""
    pulled, way = replace(damped(ratio), sticking=1.3), SCurve(travel=0.1, duration=8.0)
    place, sticks = by_runge_kutta(pulled, way, 7.0, friction)
    off = []
    for count in counts.tolist():
        time = np.linspace(0.0, 7.0, count + 1)
        within = time[1:, None] - (0.5 + np.arange(20)) / 20.0 * time[1]
        means = friction(within).mean(axis=1)
        found = move_segment(pulled, way, time, np.concatenate([means[:1], means]))
        assert found.results.sticks == sticks > 5
        assert found.results.energy_residual < 1e-12
        off.append(abs(float(way(time[-1])) - found.series["drive_lag"][-1] - place))
    return off


def test_order_in_the_step() -> None:
    """Reference: other code, Runge and Kutta's method from event to event: the order is 2."""
    counts = np.array([1000, 1300, 1700, 2200, 8000, 11_000, 14_000, 20_000])
    off = missed(0.0, lambda t: FRICTION + 0.0 * np.asarray(t), counts)
    assert (np.array(off) * counts**2).max() < 0.15
    assert max(off[4:]) < max(off[:4]) / 30.0


def test_variable_friction() -> None:
    """Reference: other code, as above; slips are up to 4 mm. Friction is constant within an output
    interval, so that slip begins with an error of an interval, and the order is 1.
    """
    counts = np.array([1000, 2200, 14_000])
    off = missed(0.05, lambda t: FRICTION * (1.0 + 0.6 * np.sin(2.1 * np.asarray(t))), counts)
    assert (np.array(off) * counts).max() < 0.1


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
