# SPDX-License-Identifier: LGPL-3.0-or-later
"""Histories of loads, and motions under them."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from protractile.dynamics.arrays import Array
from protractile.dynamics.excitation import Excitation, PiecewiseLinear, Ramp, Sine, Step
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from tests.dynamics.reference import slopes
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
