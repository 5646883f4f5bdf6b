# SPDX-License-Identifier: LGPL-3.0-or-later
"""Excited and hanging loads."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from protractile.dynamics.arrays import Array
from protractile.dynamics.excitation import Excitation, PiecewiseLinear, Ramp, Sine, Step
from protractile.dynamics.frame_motion import FrameAcceleration, FrameMotion
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.hanging_load import HangingLoad, Pendulum
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion, build_motion
from protractile.dynamics.motion_laws import HistorySum, MotionLaw, SCurve, Shaped, Spline, Stroke
from protractile.dynamics.trajectory import Trajectory
from tests.dynamics.reference import slopes
from tests.dynamics.test_telescoping import lossy
from tests.modal import modal_system, one_mass

# ω in rad/s of 1 kg on a spring: free, as slow as a boom, as fast as the plates of a shell.
OMEGAS = (0.0, 2.0, 19.0, 300.0, 5.0e3)

_MANY = np.linspace(0.011, 2.9, 1500)
KINKED: Mapping[str, Ramp | PiecewiseLinear] = {
    "a ramp of 0.71 s": Ramp(0.71),
    "kinks at 0.7 and 1.2 s": PiecewiseLinear((0.0, 0.7, 1.2), (0.5, 1.0, -0.5)),
    "kinks at 0.303, 0.311 and 0.7 s": PiecewiseLinear(
        (0.0, 0.303, 0.311, 0.7), (0.0, 1.0, -2.0, 0.3)
    ),
    "a table of 1500 points": PiecewiseLinear(_MANY.tolist(), np.sin(40.0 * _MANY).tolist()),
    "a rise within 1 ms": PiecewiseLinear((0.507, 0.508), (0.0, 1.0)),
}


def response(omega: float, history: Ramp | PiecewiseLinear, time: Array) -> Array:
    """Return the displacement (num_times,) in m of 1 kg from rest under 1 N times a history.

    A spring of ω² N/m holds the mass. The closed form is the sum of the responses to a constant
    load from t = 0 on, and to a ramp from each kink on with the change of slope at the kink.

    Args:
        omega: ω in rad/s, 0 without a spring.
        history: piecewise linear history from t = 0 on.
        time: (num_times,) in s.
    """
    kinks = np.array(history.kinks)
    values = history(kinks)
    slopes = np.diff(values) / np.diff(kinks)
    way = values[0] * 0.5 * time**2 * np.sinc(0.5 * omega * time / np.pi) ** 2
    for begin, change in zip(kinks, np.diff(slopes, prepend=0.0, append=0.0), strict=True):
        since = np.maximum(time - begin, 0.0)
        if omega == 0.0:
            way = way + change * since**3 / 6.0
        else:
            way = way + change * (since - np.sin(omega * since) / omega) / omega**2
    return np.asarray(way)


def masses(history: Ramp | Sine | PiecewiseLinear) -> GapSystem:
    """Return a system of one mass for each of ``OMEGAS``, under 1 N times a history.

    The name of an output is the ω of its mass.
    """
    n = len(OMEGAS)
    seen = {f"{w:g}": Observer(row) for w, row in zip(OMEGAS, np.eye(n), strict=True)}
    pushed = [Excitation(np.ones(n), history)]
    return modal_system(np.square(OMEGAS), np.zeros(n), observers=seen, excitations=pushed)


def test_histories_by_hand() -> None:
    time = np.array([-0.5, 0.0, 0.5, 1.0, 3.0])
    assert Step()(time).tolist() == [0.0, 1.0, 1.0, 1.0, 1.0]
    assert Ramp(2.0)(time).tolist() == [0.0, 0.0, 0.25, 0.5, 1.0]
    assert Sine(0.5)(time) == pytest.approx([-1.0, 0.0, 1.0, 0.0, 0.0], abs=1e-15)
    assert Sine(0.5, np.pi / 2.0)(time) == pytest.approx([0.0, 1.0, 0.0, -1.0, -1.0], abs=1e-15)
    pulse = Sine(0.5, end=1.0)
    assert pulse(time)[1:] == pytest.approx([0.0, 1.0, 0.0, 0.0], abs=1e-15)
    assert (pulse.kinks, Sine(0.5).kinks) == ((1.0,), ())
    table = PiecewiseLinear((0.0, 1.0, 2.0), (1.0, -3.0, 0.5))
    assert table(time) == pytest.approx([1.0, 1.0, -1.0, -3.0, 0.5], abs=1e-15)
    assert [h.peak for h in (Step(), Ramp(2.0), Sine(0.5), table)] == [1.0, 1.0, 1.0, 3.0]
    assert [h.fastest for h in (Step(), Ramp(2.0), Sine(0.5), table)] == [0.0, 0.0, np.pi, 0.0]
    assert list(Ramp(2.0).kinks) == [0.0, 2.0]
    assert list(table.kinks) == [0.0, 1.0, 2.0]


KINKS = {**KINKED, "a jump": PiecewiseLinear((0.507, 0.507 + 1.0e-6), (0.0, 1.0))}


@pytest.mark.parametrize("step", [2.0e-2, 1.0e-3, 2.0e-5])
@pytest.mark.parametrize("where", KINKS)
def test_kinks_within_steps_are_resolved(where: str, step: float) -> None:
    """Reference: analytic, relative to the range of each mode. A step replaces the history by a
    line with its mean and first moment; the error of a mode that the step resolves is of third
    order in ω h.
    """
    run = FixedStep(step)(Motion(masses(KINKS[where]), 4.0, output_step=0.02))
    for omega in OMEGAS:
        expected = response(omega, KINKS[where], run.time)
        error = np.abs(run.data[f"{omega:g}"].values - expected).max()
        resolved = step == 2.0e-5 and where in KINKED
        allowed = 0.0 if resolved else 0.02 * (omega * step) ** 3
        if omega * step < 2.5:
            assert error < (1e-8 + allowed) * np.ptp(expected), omega


def forced(time: Array, spring: float, dashpot: float, frequency: float, phase: float) -> Array:
    """Return the closed form for 1 kg from rest under 1 N sin(2π f t + φ)."""
    omega = 2.0 * np.pi * frequency
    swing = np.exp(1j * phase) / (spring - omega**2 + 1j * dashpot * omega)
    decay = 0.5 * dashpot
    natural = np.emath.sqrt(spring - decay**2)
    a = -swing.imag
    b = (decay * a - (1j * omega * swing).imag) / natural
    free = np.exp(-decay * time) * (a * np.cos(natural * time) + b * np.sin(natural * time))
    return np.asarray((swing * np.exp(1j * omega * time)).imag + np.real(free))


@pytest.mark.parametrize("dashpot", [0.0, 0.5, 20.0])
def test_a_sine_against_its_closed_form(dashpot: float) -> None:
    """Reference: analytic. Steps replace the sine by lines with its moments: order 4."""
    pushed = [Excitation(np.ones(1), Sine(0.6, 0.4))]
    system = replace(one_mass(1.0, spring=30.0, dashpot=dashpot), excitations=pushed)
    errors = []
    for step in (0.08, 0.04, 0.02):
        run = FixedStep(step)(Motion(system, 8.0, output_step=0.08))
        expected = forced(run.time, 30.0, dashpot, 0.6, 0.4)
        errors.append(np.abs(run.data["tip"].values - expected).max() / np.abs(expected).max())
    assert slopes(np.array(errors)) == pytest.approx(4.0, abs=0.1)
    assert errors[-1] < 1e-6


@dataclass(frozen=True)
class Own:
    """User-defined history: 1, and decreasing from t = 1 s on."""

    kinks: Sequence[float] = (1.0,)
    peak: float = 1.0
    fastest: float = 0.0

    def __call__(self, time: Array) -> Array:
        return np.minimum(1.0, 2.0 - time)


def test_loads_add_up_whoever_wrote_their_histories() -> None:
    """Reference: analytic, superposition over five modes of a constant, a sine, and a history of a
    user's own, which is the same as a table; a step is a constant.
    """
    push = np.linspace(-0.5, 4.0, 5)
    own, table = (
        Excitation(push, history)
        for history in (Own(), PiecewiseLinear((0.0, 1.0, 3.0), (1.0, 1.0, -1.0)))
    )
    system = replace(masses(Sine(1.1)), load=np.linspace(0.3, -0.2, 5), damping=np.full(5, 1.5))
    (sine,), dead = system.excitations, replace(system, load=np.zeros(5))
    together, constant, *single = (
        FixedStep(0.01)(Motion(one, 3.0, 0.1)).states
        for one in (
            replace(system, excitations=[sine, own]),
            replace(dead, excitations=[Excitation(system.load, Step())]),
            *(replace(dead, excitations=[part]) for part in (sine, table)),
        )
    )
    np.testing.assert_allclose(together, constant + sum(single), atol=1e-13)


@pytest.mark.parametrize(
    ("history", "arguments", "message"),
    [
        (Ramp, (0.0,), "duration must be finite and positive, got 0.0 s"),
        (Sine, (-1.0,), "frequency must be finite and positive, got -1.0 Hz"),
        (Sine, (1.0, float("inf")), "phase must be finite, got inf rad"),
        (PiecewiseLinear, ((), ()), "a history needs one value for each time, got 0 for 0"),
        (PiecewiseLinear, ((0.0, 1.0), (1.0,)),
         "a history needs one value for each time, got 1 for 2"),
        (PiecewiseLinear, ((0.0, 0.0), (1.0, 2.0)), "times must rise"),
        (PiecewiseLinear, ((0.0, 1.0), (1.0, float("nan"))),
         "times and values must be finite numbers in two sequences"),
        (Excitation, (np.ones(1), np.cos), "a history needs kinks, peak and fastest beside its "
         "values; give a Step, Ramp, Sine, PiecewiseLinear or other History, got ufunc"),
        (Excitation, (np.ones(1), Own(kinks=(1.0, 0.5))),
         "the kinks of a history must be finite and rise"),
        (Excitation, (np.ones(1), Own(peak=float("nan"))),
         "peak of a history must be finite, not negative, got nan"),
        (Excitation, (np.ones(1), Own(fastest=-1.0)),
         "fastest of a history must be finite, not negative, got -1.0"),
    ],
)  # fmt: skip
def test_bad_values_are_refused(
    history: Callable[..., object], arguments: tuple[object, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        history(*arguments)


MASS, ROPE, GRAVITY, SPEED = 1000.0, 1.0e6, 10.0, 0.5


def mass_on_springs() -> GapSystem:
    """Return a tip of 500 kg on springs of 2 MN/m across and 0.5 MN/m sideways, without loads."""
    tip, aside = (Observer(row) for row in np.eye(2) / np.sqrt(500.0))
    seen = {"tip": tip, "tip_lateral": aside}
    return modal_system([2.0e6 / 500.0, 0.5e6 / 500.0], np.zeros(2), observers=seen)


RIGID = replace(mass_on_springs(), omega2=np.full(2, 1.0e16))


def hoisted(
    load: HangingLoad, system: GapSystem, duration: float, step: float, output: float = 1.0e-3
) -> Trajectory:
    """Return the motion of a system's tip and its load from rest."""
    hung = load.attach(system, system.observers["tip"].row, 1.0)
    motion = build_motion(hung, duration, output, at_rest=True)
    return load.separate_rope(FixedStep(step)(motion))


def test_factor_of_a_rigid_boom() -> None:
    """Reference: analytic, φ₂ = 1 + (v/g) √(k/m) of a load lifted at the speed v after its slack. A
    load on a rope of constant length rests.
    """
    load, slack = HangingLoad(MASS, ROPE, GRAVITY, Stroke(3.0, SPEED), slack=0.02), 0.02
    motion = hoisted(load, RIGID, 1.0, 1.0e-4)
    factor = motion.data["rope_force_peak"].values.max() / load.weight
    # The ground gives way by a hundredth of the rope's stretch.
    assert factor == pytest.approx(1.0 + SPEED / GRAVITY * np.sqrt(ROPE / MASS), rel=1e-3)
    raised = motion.data["rope_force"].values >= load.weight
    lifted = (load.weight / ROPE + slack) / SPEED
    assert motion.time[raised.argmax()] == pytest.approx(lifted, abs=2e-3)
    assert motion.energy_residual < 1e-12
    data = hoisted(HangingLoad(MASS, ROPE, GRAVITY), mass_on_springs(), 0.2, 1.0e-3).data
    assert data["rope_force"].values == pytest.approx(np.full(201, MASS * GRAVITY), rel=1e-5)
    assert data["tip"].values == pytest.approx(np.full(201, -MASS * GRAVITY / 2.0e6), rel=1e-5)


def test_load_under_a_boom_at_constant_slewing_speed() -> None:
    """Reference: analytic. The load swings with √(g/l) ± ψ̇ about ψ̇² R l/(g − ψ̇² l) outwards."""
    rate, own = np.deg2rad(10.0), np.sqrt(GRAVITY / 3.0)
    frame = FrameMotion(slew=Stroke(900.0, 10.0, 10.0), radius=-1.0)
    load = HangingLoad(MASS, ROPE, GRAVITY, pendulum=Pendulum(3.0, frame, 11.0, HistorySum(())))
    data = hoisted(load, RIGID, 25.0, 5.0e-3, output=0.02).data
    late = data["time"].values > 10.0
    time = data["time"].values[late]
    waves = [wave((own + sign * rate) * time) for sign in (-1.0, 1.0) for wave in (np.cos, np.sin)]
    fit = np.column_stack([np.ones(time.size), *waves])
    out = rate**2 * 10.0 * 3.0 / (GRAVITY - rate**2 * 3.0)
    for name, place in (("swing_out", out), ("swing_aside", 0.0)):
        swung = data[name].values[late]
        (found, *_), *_ = np.linalg.lstsq(fit, swung, rcond=None)
        assert found == pytest.approx(place, abs=1e-3 * out)
        assert np.ptp(swung) > 0.1 * out


def test_load_swings_during_slewing_and_luffing() -> None:
    """Reference: other code, scipy's DOP853 with Coriolis, Euler and centrifugal terms. Order 2."""
    frame = FrameMotion(SCurve(80.0, 2.0), Stroke(-20.0, 15.0, 0.5), 50.0, 0.5, 0.3, -1.0)
    place, out, length = 9.0, SCurve(1.0, 2.0), 3.0
    wind = Ramp(0.5)
    swing = Pendulum(length, frame, place, out, [("y", 300.0, wind)])
    load = HangingLoad(MASS, ROPE, GRAVITY, pendulum=swing)

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        (w, v, z, r, t), speeds = state[:5], state[5:]
        now = np.array(time)
        luffed = frame.luff_angle(now)
        slewed, turn, faster = (frame.slew_angle(now, order) for order in range(3))
        along, aside, across = frame.accelerations(now, place, out)
        radial = along * np.cos(luffed) - across * np.sin(luffed)
        up = along * np.sin(luffed) + across * np.cos(luffed)
        # The tip's deflection is so small that the frame does not accelerate it further.
        rope = ROPE * max(w * np.cos(luffed) - z, 0.0)
        pull = MASS * GRAVITY / length * np.array([r + w * np.sin(luffed), t - v])
        blown = 300.0 * wind(now) * np.array([np.sin(slewed), np.cos(slewed)])
        turned = [
            2.0 * turn * speeds[4] + faster * t + turn**2 * r - radial,
            -2.0 * turn * speeds[3] - faster * r + turn**2 * t - aside,
        ]
        forces = [
            (-2.0e6 * w - np.cos(luffed) * rope - np.sin(luffed) * pull[0]) / 500.0,
            (-0.5e6 * v + pull[1]) / 500.0,
            rope / MASS - GRAVITY - up,
            *((blown - pull) / MASS + turned),
        ]
        return np.concatenate([speeds, forces])

    sagged = -MASS * GRAVITY * np.cos(np.deg2rad(50.0)) / 2.0e6
    stretched = sagged * np.cos(np.deg2rad(50.0)) - MASS * GRAVITY / ROPE
    start = [sagged, 0.0, stretched, -sagged * np.sin(np.deg2rad(50.0)), 0.0, *np.zeros(5)]
    times = 1.0e-2 * np.arange(251)
    exact = solve_ivp(rates, (0.0, 2.5), start, "DOP853", times, rtol=1e-8, atol=1e-10).y
    swung = exact[3] + exact[0] * np.sin(frame.luff_angle(times)), exact[4] - exact[1]
    errors = []
    for step in (2.0e-3, 1.0e-3):
        motion = hoisted(load, mass_on_springs(), 2.5, step, output=0.01)
        found = [motion.data[name].values for name in ("swing_out", "swing_aside", "tip")]
        pairs = zip(found, (*swung, exact[0]), strict=True)
        errors.append(max(np.abs(one - other).max() for one, other in pairs))
        assert motion.energy_residual < 1e-11
    assert np.abs(swung).max() > 0.5
    assert errors[0] < 1e-3
    assert errors[1] < 0.3 * errors[0]


def test_hoisting_while_a_segment_extends() -> None:
    """Reference: the energy balance, including the work of both drives."""
    system = lossy(SCurve(5.0, 0.4))
    tip = next(iter(system.observers.values())).row
    load = HangingLoad(0.5, 200.0, GRAVITY, SCurve(0.3, 0.3, start=0.05))
    hung = load.attach(system, tip, 1.0)
    motion = FixedStep(1.0e-3)(build_motion(hung, 0.4, 0.01, at_rest=False))
    assert motion.energy_residual < 1e-11
    assert len(hung.travels) == len(system.travels) + 1


LAWS: list[MotionLaw] = [
    SCurve(30.0, 2.0, 0.3),
    Stroke(30.0, 12.0, 0.8, 0.2),
    HistorySum((SCurve(30.0, 2.0), Stroke(-10.0, 5.0, 1.0))),
    Spline((0.1, 0.9, 2.0, 2.6), (0.0, 3.0, -2.0, 7.0)),
    Shaped(Stroke(30.0, 12.0, 0.8, 0.2), 1.7, 0.1),
]
TIME = np.linspace(0.013, 3.013, 61)


@pytest.mark.parametrize("law", LAWS)
def test_rates(law: MotionLaw) -> None:
    """Reference: central differences."""
    h = 1.0e-4
    # Differences across a jump of the second derivative are no reference.
    time = TIME[np.abs(np.subtract.outer(TIME, np.array(law.kinks))).min(axis=1) > h]
    before, now, after = (law(time + shift) for shift in (-h, 0.0, h))
    assert law.rate(time, 1) == pytest.approx((after - before) / (2.0 * h), abs=1e-5)
    assert law.rate(time, 2) == pytest.approx((after - 2.0 * now + before) / h**2, abs=1e-4)


@pytest.mark.parametrize("depth", [0.0, 0.6])
def test_accelerations(depth: float) -> None:
    """Reference: second differences of the position in fixed axes, with both angles; analytic for
    the components of the weight.
    """
    frame = FrameMotion(LAWS[0], LAWS[1], 35.0, foot=0.5, depth=depth, radius=-1.2)
    extension, x, h = SCurve(2.0, 2.5), 9.0, 1.0e-4
    time = TIME[np.abs(np.subtract.outer(TIME, np.array(LAWS[1].kinks))).min(axis=1) > h]

    def position(time: Array) -> Array:
        (out, up), turn = frame.position(time, x, extension), frame.slew_angle(time)
        return np.array([out * np.cos(turn), out * np.sin(turn), up])

    start = frame.position(np.zeros(1), x, extension)
    turned = complex(8.5, depth) * np.exp(1j * np.deg2rad(35.0))
    assert np.concatenate(start) == pytest.approx([turned.real - 1.2, turned.imag])
    places = [position(time + shift) for shift in (-h, 0.0, h)]
    one, two, three = (places[2] - 2.0 * places[1] + places[0]) / h**2
    slew, luff = frame.slew_angle(time), frame.luff_angle(time)
    out = one * np.cos(slew) + two * np.sin(slew)
    sideways = two * np.cos(slew) - one * np.sin(slew)
    expected = [
        out * np.cos(luff) + three * np.sin(luff), sideways,
        three * np.cos(luff) - out * np.sin(luff),
    ]  # fmt: skip
    assert frame.accelerations(time, x, extension) == pytest.approx(np.array(expected), abs=1e-5)
    # Weight: g cos α across and g sin α along the boom, less those at t = 0.
    frame = FrameMotion(luff=SCurve(50.0, 1.0), angle=20.0, gravity=10.0)
    parts: tuple[tuple[Literal["x", "z"], np.ufunc], ...] = ("x", np.sin), ("z", np.cos)
    for direction, function in parts:
        change = 10.0 * (function(np.deg2rad(70.0)) - function(np.deg2rad(20.0)))
        history = FrameAcceleration(frame, direction, 3.0)
        assert history(np.array([0.0, 2.0])) == pytest.approx([0.0, change])


@pytest.mark.parametrize("depth", [0.0, 0.6])
def test_drives_do_the_work_of_a_mass_on_the_boom(depth: float) -> None:
    """Reference: the change of kinetic and potential energy over their power, by differences."""
    frame = FrameMotion(LAWS[0], LAWS[1], 35.0, 0.5, depth, -1.2, gravity=10.0)
    resting, x, h = HistorySum(()), 9.0, 1.0e-4
    kinks = np.array([*LAWS[0].kinks, *LAWS[1].kinks])
    time = TIME[np.abs(np.subtract.outer(TIME, kinks)).min(axis=1) > 3.0 * h]

    def energy(at: Array) -> Array:
        def place(at: Array) -> Array:
            (out, up), turn = frame.position(at, x, resting), frame.slew_angle(at)
            return np.array([out * np.cos(turn), out * np.sin(turn), up])

        speed = (place(at + h) - place(at - h)) / (2.0 * h)
        return 3.0 * (0.5 * (speed**2).sum(axis=0) + 10.0 * place(at)[2])

    rates = frame.slew_angle(time, 1), frame.luff_angle(time, 1)
    power = (frame.drive_moments(time, x, 3.0, resting) * np.array(rates)).sum(axis=0)
    change = (energy(time + h) - energy(time - h)) / (2.0 * h)
    assert power == pytest.approx(change, abs=1.0e-4)
