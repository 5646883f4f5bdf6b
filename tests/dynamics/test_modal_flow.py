# SPDX-License-Identifier: LGPL-3.0-or-later
"""Between contacts the motion of every mode is exact, whatever its damping and the step."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from dynamics.integrators.splitting import integrate
from scipy.linalg import expm

from dynamics.gap_system import GapSystem, Observer
from dynamics.kernels.modal_flow import ModalFlow, tabulate
from dynamics.motion import Motion

# ω² in rad²/s², c in 1/s, load in N/√kg
MODES = {
    "undamped": (40.0, 0.0, 3.0),
    "undamped, slow": (1.0e-6, 0.0, 3.0),
    "damped": (40.0, 0.7, 3.0),
    "critically damped": (2.25, 3.0, 3.0),
    "overdamped": (2.0, 9.0, 3.0),
    "rigid": (0.0, 0.0, 3.0),
    "rigid damped": (0.0, 0.7, 3.0),
    "stiff": (1.0e8, 20.0, 3.0),
    "tipping over": (-2.25, 0.0, 3.0),
    "tipping over, damped": (-2.25, 0.7, 3.0),
}


def modes() -> GapSystem:
    omega2, damping, load = np.array(list(MODES.values())).T
    n = omega2.size
    return GapSystem(
        omega2=omega2,
        load=load,
        rows=np.zeros((0, n)),
        laws=[],
        station_of_row=np.zeros(0, dtype=np.int64),
        stations=[],
        observers={name: Observer(row) for name, row in zip(MODES, np.eye(n), strict=True)},
        damping=damping,
    )


def exact(omega2: float, damping: float, load: float, step: float) -> dict[str, float]:
    """The entries of a flow of one mode, from scipy's matrix exponential.

    Over (a, v, load, ramp / step, mean / step²), the last three the load, one that grows from 0 to
    1, and the integral of that.
    """
    generator = np.zeros((5, 5))
    generator[0, 1] = generator[2, 3] = generator[3, 4] = 1.0
    generator[1] = [-omega2, -damping, 1.0, 0.0, 0.0]
    (aa, av, rise, ramp, mean), (va, vv, _, _, _), _, _, _ = expm(generator * step)
    return {
        "aa": aa, "av": av, "ap": rise * load, "va": va, "vv": vv, "vp": av * load,
        "rise": rise, "ramp": ramp / step, "mean": mean / step**2,
    }  # fmt: skip


def tabulated(system: GapSystem, step: float) -> ModalFlow:
    flow = np.zeros((11, system.num_modes))
    tabulate(flow, system.omega2, system.load, system.damping, step)
    return ModalFlow(*flow[:9])


@pytest.mark.parametrize("flow_over", [ModalFlow.over, tabulated])
@pytest.mark.parametrize("step", [1.0e-2, 1.0])
def test_flow_is_the_matrix_exponential(
    flow_over: Callable[[GapSystem, float], ModalFlow], step: float
) -> None:
    """Reference: other code, scipy.linalg.expm.

    Each entry is held against the size that it has without decay, so that those that are
    small because the step is small are not passed by.
    """
    flow = flow_over(modes(), step)
    for k, (name, numbers) in enumerate(MODES.items()):
        omega = np.sqrt(abs(numbers[0]))
        reach = min(step, 1.0 / omega) if omega > 0.0 else step
        size = {
            "aa": 1.0, "av": reach, "ap": 3.0 * reach**2, "va": omega**2 * reach, "vv": 1.0,
            "vp": 3.0 * reach, "rise": reach**2, "ramp": reach**2, "mean": reach**2,
        }  # fmt: skip
        for entry, expected in exact(*numbers, step).items():
            error = abs(getattr(flow, entry)[k] - expected)
            assert error <= 1e-11 * size[entry], (name, entry)


@pytest.mark.parametrize("flow_over", [ModalFlow.over, tabulated])
@pytest.mark.parametrize("omega2", [0.0, 40.0])
@pytest.mark.parametrize("damping", [0.0, 1.0e-9, 0.7, 9.0])
def test_load_response_of_the_shortest_steps(
    one_mass: Callable[..., GapSystem],
    omega2: float,
    damping: float,
    flow_over: Callable[[GapSystem, float], ModalFlow],
) -> None:
    """Reference: analytic, the series h²/2 − c h³/6 + (c² − ω²) h⁴/24 of ap under a unit load,
    h²/6 − c h³/24 + (c² − ω²) h⁴/120 under one that grows, and the mean of the latter.

    At the steps that contacts need, a difference of two numbers near one leaves few digits of
    it, and a relative error of it acts as one of the load.
    """
    mode = one_mass(1.0, spring=omega2, dashpot=damping, force=1.0)
    for h in (1.0e-4, 1.0e-5, 1.0e-6):
        series = h**2 / 2.0 - damping * h**3 / 6.0 + (damping**2 - omega2) * h**4 / 24.0
        growing = h**2 / 6.0 - damping * h**3 / 24.0 + (damping**2 - omega2) * h**4 / 120.0
        drift = h**2 / 24.0 - damping * h**3 / 120.0 + (damping**2 - omega2) * h**4 / 720.0
        flow = flow_over(mode, h)
        assert flow.ap == pytest.approx(series, rel=1e-9, abs=0.0)
        assert flow.ramp == pytest.approx(growing, rel=1e-9, abs=0.0)
        assert flow.mean == pytest.approx(drift, rel=1e-9, abs=0.0)


def test_steps_add_up() -> None:
    """Reference: analytic, (flow over h)ⁿ = flow over n h; here by the integrator itself."""
    one = integrate(Motion(modes(), 2.0, output_step=0.5))
    many = integrate(Motion(modes(), 2.0, output_step=0.5), step=1.0e-4)
    assert one.data.attrs["steps"] == 4
    # 5000 steps an output, nothing to touch: 9 times 512, 6 times 64 and once 8 at once.
    assert many.data.attrs["steps"] == 4 * (9 + 6 + 1)
    for name in MODES:
        size = float(np.abs(one.data[name]).max())
        np.testing.assert_allclose(many.data[name], one.data[name], rtol=0.0, atol=1e-9 * size)


def test_heavily_damped_mode_creeps(one_mass: Callable[..., GapSystem]) -> None:
    """Reference: analytic. For c ≫ ω the mode creeps as exp(−ω²t/c)."""
    system = one_mass(1.0, spring=1.0e4, dashpot=1.0e5)
    assert ModalFlow.over(system, 1.0).aa == pytest.approx(np.exp(-0.1), rel=1e-5)
