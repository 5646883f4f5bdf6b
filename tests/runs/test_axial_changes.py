# SPDX-License-Identifier: LGPL-3.0-or-later
"""Axial forces that change with time in slewing and luffing."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp, trapezoid

from beam_model.lines import lines
from dynamics.excitation import SCurve, Stroke
from dynamics.frame_motion import FrameMotion
from dynamics.gap_system import GapSystem
from dynamics.integrator import FixedStep
from dynamics.motion import build_motion
from geometry.boom import Boom, Material, PointMass, Segment
from geometry.support import Support
from runs.case.kinds.finite_element import BeamElements
from runs.case.turning import turning_changes, turning_loads
from runs.pipeline.models import axial_travels

LENGTH, MASS, SECOND_MOMENT = 10.0, 100.0, 1.0e-4
UNIT = np.sqrt(2.1e11 * SECOND_MOMENT / MASS) / LENGTH**2


def turning_beam(frame: FrameMotion, tip: float = 0.0) -> tuple[GapSystem, GapSystem]:
    """Return a clamped beam with a tip mass in kg in a frame, without and with axial forces."""
    beam = Segment(
        "beam", 0.0, LENGTH, Material(2.1e11, 0.3, 7850.0), MASS, SECOND_MOMENT, 0.0,
        supports=(Support(0.0, "clamped"),), masses=(PointMass(LENGTH, tip),) if tip else (),
    )  # fmt: skip
    changes = tuple(turning_changes(frame, (beam,), (), 0.0))
    loads = tuple(load for load in turning_loads(frame, (beam,), ()) if load.direction == "z")
    boom = Boom((beam,), (), loads, axial_changes=changes)
    model = BeamElements(boom, element_length=0.5, theory="euler-bernoulli", rotary_inertia=False)
    system = model.system()
    travels = axial_travels(system, boom, lines(boom, model.segments(boom)))
    return system, replace(system, travels=[*travels])


@pytest.mark.parametrize(
    ("speed", "flapping"), [(1.0, 3.6816), (2.0, 4.1373), (3.0, 4.7973), (6.0, 7.3604)]
)
@pytest.mark.parametrize("key", ["slew", "luff"])
def test_frequency_of_a_rotating_cantilever(key: str, speed: float, flapping: float) -> None:
    """Reference: published, Wright et al. (1982), in √(E J/m̄)/L²; f² less speed² in the plane."""
    rate = np.rad2deg(speed * UNIT)
    system, moving = turning_beam(FrameMotion(**{key: Stroke(20.0 * rate, rate, 1.0)}))
    found = np.sqrt(moving.at_time(10.0).in_own_modes().omega2.min()) / UNIT
    expected = flapping if key == "slew" else np.sqrt(flapping**2 - speed**2)
    assert found == pytest.approx(expected, rel=1e-3)
    assert abs(np.sqrt(system.omega2.min()) / UNIT - 3.5160) < 1e-3


def test_luffing_beam_column() -> None:
    """Reference: other code, scipy's LSODA, three modes; the weight rises to P_crit/6."""
    frame = FrameMotion(luff=SCurve(80.0, 1.0), gravity=10.0)
    system, moving = turning_beam(frame, tip=2.0e4)
    motion = FixedStep(5.0e-4)(build_motion(moving, 2.0, 0.01, at_rest=False))
    assert motion.energy_residual < 1e-11
    x = np.linspace(0.0, LENGTH, 2001)
    # Polynomials of a clamped end, with their masses, stiffnesses and axial forces by quadrature.
    powers = np.arange(2, 7)[:, None]
    w, slope = (x / LENGTH) ** powers, powers * (x / LENGTH) ** (powers - 1) / LENGTH
    bent = powers * (powers - 1) * (x / LENGTH) ** (powers - 2) / LENGTH**2

    def integral(one: np.ndarray, other: np.ndarray) -> np.ndarray:
        return np.asarray(trapezoid(one[:, None] * other, x, axis=-1))

    mass = MASS * integral(w, w) + 2.0e4
    stiffness = 2.1e11 * SECOND_MOMENT * integral(bent, bent)
    beyond = MASS * (LENGTH - x) + 2.0e4, 0.5 * MASS * (LENGTH**2 - x**2) + 2.0e4 * LENGTH
    pressed = [integral(force * slope, slope) for force in beyond]
    first = MASS * trapezoid(w * x, x) + 2.0e4 * LENGTH
    even = MASS * trapezoid(w, x) + 2.0e4

    def rates(time: float, state: np.ndarray) -> np.ndarray:
        angle, speed, faster = (frame.luff_angle(np.array(time), order) for order in range(3))
        softer = 10.0 * np.sin(angle) * pressed[0] + speed**2 * (mass - pressed[1])
        load = -10.0 * np.cos(angle) * even - faster * first
        # The loads of the model leave out the weight at t = 0.
        load += 10.0 * even
        pull = load - (stiffness - softer) @ state[:5]
        return np.concatenate([state[5:], np.linalg.solve(mass, pull)])

    exact = solve_ivp(rates, (0.0, 2.0), np.zeros(10), "LSODA", motion.time, rtol=1e-7, atol=1e-9)
    tip = exact.y[:5].sum(axis=0)
    assert motion.tip.values == pytest.approx(tip, abs=2e-3 * np.abs(tip).max())
    plain = FixedStep(5.0e-4)(build_motion(system, 2.0, 0.01, at_rest=False))
    assert np.abs(plain.tip.values - tip).max() > 0.05 * np.abs(tip).max()
