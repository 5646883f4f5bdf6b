# SPDX-License-Identifier: LGPL-3.0-or-later
"""A load on a rope below the tip: lift-off, hanging, the work of the winch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from dynamics.excitation import SCurve, Stroke
from dynamics.gap_system import GapSystem, Observer
from dynamics.hanging_load import HangingLoad
from dynamics.integrator import FixedStep
from dynamics.motion import build_motion
from dynamics.trajectory import Trajectory
from tests.dynamics.test_telescoping import lossy

MASS, ROPE, GRAVITY, SPEED = 1000.0, 1.0e6, 10.0, 0.5


def mass_on_spring() -> GapSystem:
    """Return a tip of 500 kg on a spring of 2 MN/m, under 2 kN."""
    mass, stiffness = 500.0, 2.0e6
    return GapSystem(
        omega2=np.array([stiffness / mass]),
        load=np.array([-2000.0 / np.sqrt(mass)]),
        rows=np.zeros((0, 1)),
        laws=[],
        station_of_row=np.zeros(0, dtype=np.int64),
        stations=[],
        observers={"tip": Observer(np.array([1.0 / np.sqrt(mass)]))},
    )


def hoisted(load: HangingLoad, system: GapSystem, duration: float, step: float) -> Trajectory:
    """Return the motion of a system's tip and its load from rest."""
    hung = load.attach(system, system.observers["tip"].row, 1.0)
    motion = build_motion(hung, duration, 1.0e-3, at_rest=True)
    return load.separate_rope(FixedStep(step)(motion))


def test_factor_of_a_rigid_boom() -> None:
    """Reference: analytic, φ₂ = 1 + (v/g) √(k/m): a load that leaves the ground at the speed v
    relative to the winch swings about its place on the rope by v √(m/k).
    """
    stiff = replace(mass_on_spring(), omega2=np.array([1.0e16]), load=np.zeros(1))
    load = HangingLoad(MASS, ROPE, GRAVITY, Stroke(3.0, SPEED), slack=0.0)
    motion = hoisted(load, stiff, 1.0, 1.0e-4)
    factor = motion.data["rope_force_peak"].values.max() / load.weight
    # The ground gives way by a hundredth of the rope's stretch.
    assert factor == pytest.approx(1.0 + SPEED / GRAVITY * np.sqrt(ROPE / MASS), rel=1e-3)
    raised = motion.data["rope_force"].values >= load.weight
    assert motion.time[raised.argmax()] == pytest.approx(load.weight / ROPE / SPEED, abs=2e-3)
    assert motion.energy_residual < 1e-12


@pytest.mark.parametrize("cosine", [1.0, 0.5])
def test_an_elastic_boom(cosine: float) -> None:
    """Reference: other code, scipy's DOP853 of tip, load, rope and ground; order 2 in the step."""
    system, slack = mass_on_spring(), 0.02
    load = HangingLoad(MASS, ROPE, GRAVITY, SCurve(0.8, 1.0), cosine, slack)

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        tip, speed, z, rate = state
        wound = float(load.hoist(np.array(time)))
        rope = ROPE * max(cosine * tip - z + wound - slack, 0.0)
        ground = 100.0 * ROPE * max(load.weight / (100.0 * ROPE) - z, 0.0)
        pull = (-2000.0 - 2.0e6 * tip - cosine * rope) / 500.0
        return np.array([speed, pull, rate, (rope + ground - load.weight) / MASS])

    times = 1.0e-3 * np.arange(1001)
    start = [-1.0e-3, 0.0, 0.0, 0.0]
    exact = solve_ivp(
        rates, (0.0, 1.0), start, "DOP853", times, rtol=1e-10, atol=1e-13, max_step=2e-4
    ).y
    errors = []
    for step in (2.5e-4, 1.25e-4):
        motion = hoisted(load, system, 1.0, step)
        found = [motion.data[name].values for name in ("tip", "load_height")]
        errors.append(max(np.abs(found[0] - exact[0]).max(), np.abs(found[1] - exact[2]).max()))
        assert motion.energy_residual < 1e-12
    assert errors[0] < 2e-5
    assert errors[1] < 0.4 * errors[0]


def test_a_hanging_load_rests() -> None:
    """Reference: analytic, the rope bears the weight and stays as long as it is."""
    load = HangingLoad(MASS, ROPE, GRAVITY)
    data = hoisted(load, mass_on_spring(), 0.2, 1.0e-3).data
    assert data["rope_force"].values == pytest.approx(np.full(201, load.weight), rel=1e-5)
    assert data["tip"].values == pytest.approx(np.full(201, -12000.0 / 2.0e6), rel=1e-5)


def test_hoisting_while_a_segment_extends() -> None:
    """Reference: the energy balance, with the works of both drives."""
    system = lossy(SCurve(5.0, 0.4))
    tip = next(iter(system.observers.values())).row
    load = HangingLoad(0.5, 200.0, GRAVITY, SCurve(0.3, 0.3, start=0.05))
    hung = load.attach(system, tip, 1.0)
    motion = FixedStep(1.0e-3)(build_motion(hung, 0.4, 0.01, at_rest=False))
    assert motion.energy_residual < 1e-11
    assert len(hung.travels) == len(system.travels) + 1


@pytest.mark.parametrize("name", ["mass", "stiffness", "gravity"])
def test_numbers_of_no_load(name: str) -> None:
    with pytest.raises(ValueError, match=rf"^{name} must be finite and positive, got 0.0$"):
        HangingLoad(**({"mass": 1.0, "stiffness": 1.0, "gravity": 1.0} | {name: 0.0}))
