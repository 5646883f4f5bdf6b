# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error of a boom's motion under a hanging load by the straight path of its tip.

A boom at the luffing angle α whose tip deflects by w also becomes shorter, by about 0.6 w²/L for a
cantilever under a force at its tip. So the height of the tip changes by dz = (cos α − κ w) dw with
κ = 1.2 sin α/L, and the rope force T acts on w by −T (cos α − κ w). The models have dz = cos α dw
and the force −T cos α + κ m g w. Their boom is at the same place at rest, but the load lifts off
too early and oscillates too fast. The error is the difference between both motions of one mode.
"""

from __future__ import annotations

from typing import NamedTuple, Self

import numpy as np

from protractile.analysis.states import States
from protractile.dynamics.arrays import Array
from protractile.dynamics.damping import closed_contact_damping, closed_contact_modes
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.hanging_load import HangingLoad
from protractile.runs.case.motions import hanging_load
from protractile.runs.case.schema import Case

# Slope of the shortening of a cantilever under a force at its tip, over w/L: d(0.6 w²/L)/dw.
_SHORTENING = 1.2
# Output times per period, and the largest number of periods, after which errors hardly grow.
_PER_PERIOD, _PERIODS = 50, 100
# Range of the tip, over its deflection by the weight of the load, below which no error matters.
_SMALL = 0.1
# Largest stiffness of the rope over that of the boom. It only limits the computing time.
_RIGID = 50.0


class _Mode(NamedTuple):
    """The mode of a boom with a load on its rope in which the tip is most compliant."""

    omega: float  #: circular frequency in rad/s
    shape: Array  #: modal coordinates (num_modes,) for a deflection of the tip by 1 m
    mass: float  #: in kg, without the load
    stiffness: float  #: in N/m, without the rope
    damping: float  #: in N s/m

    @classmethod
    def of(cls, system: GapSystem, position: Array, load: HangingLoad) -> Self:
        """Return the mode about an equilibrium."""
        omegas, shapes = closed_contact_modes(system, position)
        tips, heights = (system.observers[name].row @ shapes for name in ("tip", "load_height"))
        at = int(np.argmax((tips / omegas) ** 2))
        omega, tip, height = float(omegas[at]), tips[at], heights[at]
        mass = (1.0 - load.mass * height**2) / tip**2
        rope = load.stiffness * load.cosine * (load.cosine - height / tip)
        damping = 2.0 * closed_contact_damping(system, position)[1][at] * omega / tip**2
        return cls(omega, shapes[:, at] / tip, mass, omega**2 * mass - rope, damping)


def straight_path_error(case: Case, beam: States) -> float:
    """Return the largest error of the tip deflection by its straight path, over its range.

    The luffing angle is that at t = 0. The error is 0 without a load that hangs on a rope at rest,
    and if the tip hardly moves across the boom.
    """
    load, gravity = hanging_load(case, beam.boom), case.gravity
    if load is None or gravity is None:
        return 0.0
    hanging = load.slack is None
    step = 0 if hanging else int(np.abs(beam.observed("tip")).argmax())
    at, position, rest = float(beam.time[step]), beam.positions[step], beam.observed("tip")[step]
    system = beam.model.system
    mode = _Mode.of(system.at_time(at), position, load)
    lifted = hanging or system.observers["load_height"].row @ position > 0.0
    if not lifted or mode.stiffness <= 0.0:
        return 0.0
    rope = min(load.stiffness, _RIGID * mode.stiffness)
    kappa = _SHORTENING * gravity.along / gravity.acceleration / beam.boom.length

    periods = min(case.time.duration * mode.omega / (2.0 * np.pi), _PERIODS)
    times = np.linspace(0.0, 2.0 * np.pi * periods / mode.omega, 2 + int(_PER_PERIOD * periods))
    marks = np.append(times, at)
    hoisted = (
        np.zeros_like(marks) if load.hoist is None else load.hoist(marks) - (load.slack or 0.0)
    )
    weights = load.weight * np.ones_like(marks)
    if not hanging:
        weights *= np.clip(hoisted * load.stiffness / load.weight, 0.0, 1.0)
    # The elastic stiffness, and the force without the rope's that leads to the state of rest.
    stiffness = mode.stiffness + kappa * weights[-1]
    forces = sum(
        (
            excitation.load @ mode.shape * excitation.history(marks)
            for excitation in system.excitations
        ),
        np.zeros_like(marks),
    )
    forces += stiffness * rest + weights[-1] * (load.cosine - kappa * rest) - forces[-1]
    curved = np.array([False, True])

    def height(tip: Array) -> Array:
        return load.cosine * tip - 0.5 * kappa * curved * tip**2

    start = np.full(2, (rest if hanging else forces[0] / stiffness) if case.start.at_rest else 0.0)
    taut = height(start) - (load.weight / rope if hanging and case.start.at_rest else 0.0)

    def rate(time: float, state: Array) -> Array:
        tip, speed, lifted, lifting = state.reshape(4, 2)
        length, weight, force = (
            np.interp(time, times, values[:-1]) for values in (hoisted, weights, forces)
        )
        pull = rope * np.maximum(height(tip) - taut - lifted + length, 0.0)
        force += kappa * tip * np.where(curved, pull, weight) - load.cosine * pull
        upwards = pull / load.mass - load.weight / load.mass
        if not hanging:
            upwards = np.where(lifted > 0.0, upwards, np.maximum(upwards, 0.0))
        force -= stiffness * tip + mode.damping * speed
        return np.concatenate([speed, force / mode.mass, lifting, upwards])

    # Imported late, since few cases hoist, and it loads slowly.
    from scipy.integrate import solve_ivp

    initial = np.concatenate([start, np.zeros(6)])
    # Multistep methods do not converge across the kinks of lift-off.
    tips = solve_ivp(rate, times[[0, -1]], initial, t_eval=times, rtol=1e-8, atol=1e-10).y[:2]
    motion = np.ptp(tips[0])
    if motion < _SMALL * load.weight * load.cosine / mode.stiffness:
        return 0.0
    return float(np.abs(tips[1] - tips[0]).max() / motion)
