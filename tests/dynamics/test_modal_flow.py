# SPDX-License-Identifier: LGPL-3.0-or-later
"""The modal flow of a time step against matrix exponentials, series and energy."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from dynamics.gap_system import GapSystem, Observer
from dynamics.integrator import FixedStep
from dynamics.kernels.modal_flow import compliance, finish_flow, free_flow, modal_flow
from dynamics.motion import Motion
from tests.modal import modal_system

# ω² in rad²/s², c in 1/s, load in N/√kg
MODES = {
    "undamped": (40.0, 0.0, 3.0), "undamped, slow": (1.0e-6, 0.0, 3.0), "damped": (40.0, 0.7, 3.0),
    "critically damped": (2.25, 3.0, 3.0), "overdamped": (2.0, 9.0, 3.0), "rigid": (0.0, 0.0, 3.0),
    "rigid damped": (0.0, 0.7, 3.0), "stiff": (1.0e8, 20.0, 3.0), "tipping over": (-2.25, 0.0, 3.0),
    "tipping over, damped": (-2.25, 0.7, 3.0),
}  # fmt: skip


def modes() -> GapSystem:
    omega2, damping, load = np.array(list(MODES.values())).T
    eye = np.eye(omega2.size)
    observers = {name: Observer(row) for name, row in zip(MODES, eye, strict=True)}
    return modal_system(omega2, load, observers=observers, damping=damping)


@pytest.mark.parametrize("step", [1.0e-2, 1.0])
def test_flow_is_the_matrix_exponential(step: float) -> None:
    """Reference: other code, scipy.linalg.expm of (a, v, load, ramp, mean)."""
    flow = modal_flow(modes(), np.array([2.0 * step, step]))
    for k, (name, (omega2, damping, _)) in enumerate(MODES.items()):
        generator = np.zeros((5, 5))
        generator[0, 1] = generator[2, 3] = generator[3, 4] = 1.0
        generator[1] = [-omega2, -damping, 1.0, 0.0, 0.0]
        _, impulse, rise, ramp, drift = expm(generator * step)[0]
        reach = min(step, 1.0 / np.sqrt(abs(omega2))) if omega2 else step
        expected = {
            "impulse": (impulse, reach), "gain": (rise, reach**2),
            "ramp": (ramp / step, reach**2), "drift": (drift / step**2, reach**2),
        }  # fmt: skip
        for entry, (value, size) in expected.items():
            assert abs(getattr(flow, entry)[1, k] - value) <= 1e-11 * size, (name, entry)


@pytest.mark.parametrize("omega2", [0.0, 40.0])
@pytest.mark.parametrize("damping", [0.0, 1.0e-9, 0.7, 9.0])
def test_load_response_of_the_shortest_steps(
    one_mass: Callable[..., GapSystem], omega2: float, damping: float
) -> None:
    """Reference: analytic, the series r = h²/2 − c h³/6 + (c² − ω²) h⁴/24,
    p = h²/6 − c h³/24 + (c² − ω²) h⁴/120, and likewise u. Differences of numbers near 1 would have
    few digits.
    """
    mode = one_mass(1.0, spring=omega2, dashpot=damping)
    flow = modal_flow(mode, times := np.array([1.0e-4, 1.0e-5, 1.0e-6]))
    for found, first in ((flow.gain, 2), (flow.ramp, 6), (flow.drift, 24)):
        n = {2: 2, 6: 3, 24: 4}[first]
        series = times**2 / first * (
            1.0 - damping * times / (n + 1) + (damping**2 - omega2) * times**2 / (n + 1) / (n + 2)
        )  # fmt: skip
        np.testing.assert_allclose(found[:, 0], series, rtol=1e-9)


@pytest.mark.parametrize("name", MODES)
def test_work_and_loss_of_a_step(name: str) -> None:
    """Reference: other code, scipy's quadrature of the exact motion; and the energy balance."""
    omega2, c, load = MODES[name]
    system, h, change = modes(), 0.3 if omega2 < 1e6 else 3e-4, np.full(len(MODES), 0.8)
    start, speed, force = (np.full(len(MODES), x) for x in (0.2, -0.7, load))
    flow, k = modal_flow(system, np.array([h])), list(MODES).index(name)
    generator = np.array([[0, 1, 0, 0], [-omega2, -c, 1, 0], [0, 0, 0, 0.8 / h], np.zeros(4)])

    def state(time: float) -> np.ndarray:
        return np.asarray(expm(generator * time) @ [0.2, -0.7, load - 0.4, 1.0])

    a, v, end = start.copy(), speed.copy(), np.zeros(len(MODES))
    free_flow(a, v, flow, 0, force, change, end)
    one = np.eye(len(MODES))[k]
    a, v = 0.0 * start + one * start, one * speed
    work, lost = finish_flow(a, v, flow, 0, one * force, one * change, one * end, one * force)
    assert (end[k], v[k]) == pytest.approx(tuple(state(h)[:2]), rel=1e-9)
    power = quad(lambda t: state(t)[1] * state(t)[2], 0.0, h, epsabs=1e-13)[0]
    taken = quad(lambda t: c * state(t)[1] ** 2, 0.0, h, epsabs=1e-13)[0]
    assert (work, lost) == pytest.approx((power, taken), rel=1e-7, abs=1e-11)


def test_steps_add_up() -> None:
    """Reference: analytic. n steps of h are equivalent to one of n h."""
    one, many = (FixedStep(h)(Motion(modes(), 2.0, output_step=0.5)) for h in (0.5, 1.0e-4))
    assert (one.data.attrs["steps"], many.data.attrs["steps"]) == (4, 20_000)
    for name in MODES:
        size = float(np.abs(one.data[name]).max())
        np.testing.assert_allclose(many.data[name], one.data[name], rtol=0.0, atol=1e-9 * size)


def test_heavily_damped_mode_creeps(one_mass: Callable[..., GapSystem]) -> None:
    """Reference: analytic. For c ≫ ω the mode creeps as exp(−ω²t/c)."""
    system = one_mass(1.0, spring=1.0e4, dashpot=1.0e5)
    run = FixedStep(1.0)(Motion(system, 1.0, 1.0, np.ones(1)))
    assert run.states[-1, 0] == pytest.approx(np.exp(-0.1), rel=1e-5)


def test_compliance_is_the_response_of_rows_to_forces() -> None:
    """Reference: analytic, E diag(r) Rᵀ."""
    random = np.random.default_rng(1)
    ends, rows = random.normal(size=(2, 3, len(MODES)))
    rise = modal_flow(modes(), np.array([0.1])).gain[0]
    np.testing.assert_allclose(compliance(ends, rows, rise), ends * rise @ rows.T, rtol=1e-12)
