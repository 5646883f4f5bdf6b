# SPDX-License-Identifier: LGPL-3.0-or-later
"""The modal flow of a time step against matrix exponentials, series and energy."""

from collections.abc import Mapping

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.kernels.modal_flow import finish_flow, free_flow, modal_flow
from tests.modal import modal_system

# ω² in rad²/s², c in 1/s, load in N/√kg
MODES = {
    "undamped": (40.0, 0.0, 3.0), "undamped, slow": (1.0e-6, 0.0, 3.0), "damped": (40.0, 0.7, 3.0),
    "critically damped": (2.25, 3.0, 3.0), "overdamped": (2.0, 9.0, 3.0), "rigid": (0.0, 0.0, 3.0),
    "rigid damped": (0.0, 0.7, 3.0), "stiff": (1.0e8, 20.0, 3.0), "tipping over": (-2.25, 0.0, 3.0),
    "tipping over, damped": (-2.25, 0.7, 3.0),
}  # fmt: skip


# Differences of numbers near 1 would have few digits.
NEARLY_UNDAMPED = {
    "hardly damped": (40.0, 1.0e-9, 3.0), "rigid, hardly damped": (0.0, 1.0e-9, 3.0),
    "heavily damped": (1.0e4, 1.0e5, 3.0),
}  # fmt: skip


def modes(numbers: Mapping[str, tuple[float, float, float]] = MODES) -> GapSystem:
    omega2, damping, load = np.array(list(numbers.values())).T
    return modal_system(omega2, load, damping=damping)


@pytest.mark.parametrize("step", [1.0e-6, 1.0e-5, 1.0e-4, 1.0e-2, 1.0])
def test_flow_is_the_matrix_exponential(step: float) -> None:
    """Reference: other code, scipy.linalg.expm of (a, v, load, ramp, mean) in units of the step."""
    numbers = MODES | NEARLY_UNDAMPED
    flow = modal_flow(modes(numbers), np.array([2.0 * step, step]))
    for k, (name, (omega2, damping, _)) in enumerate(numbers.items()):
        generator = np.eye(5, k=1)
        generator[1] = [-omega2 * step**2, -damping * step, 1.0, 0.0, 0.0]
        _, impulse, *responses = expm(generator)[0]
        reach = min(step, 1.0 / np.sqrt(abs(omega2))) if omega2 else step
        assert abs(flow.impulse[1, k] - impulse * step) <= 1e-11 * reach, name
        for entry, value in zip((flow.gain, flow.ramp, flow.drift), responses, strict=True):
            assert abs(entry[1, k] - value * step**2) <= 1e-11 * reach**2, name


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
