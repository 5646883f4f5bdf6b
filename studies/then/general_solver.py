# SPDX-License-Identifier: LGPL-3.0-or-later
"""A gap system by a general solver of differential equations, held to so many steps.

It stands for the NDSolve of Mathematica 2.2, with which the paper has moved its series: steps
follow from a tolerance, and nothing is known of where contacts close or friction turns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.integrate import LSODA, RK45

from dynamics.arrays import Array
from dynamics.gap_system import GapSystem
from studies.cost.generic_solvers import array_rates

METHODS = {"LSODA": LSODA, "RK45": RK45}
# In m: a deflection of half the boom's length ends it.
AWAY = 10.0


@dataclass(frozen=True, slots=True)
class Solved:
    """What a solver has reached."""

    time: Array  #: (num_steps + 1,) in s
    #: (num_steps + 1, num_modes).
    states: Array
    velocities: Array


def solve(system: GapSystem, duration: float, method: str, tolerance: float, most: int) -> Solved:
    """Move a system from rest until ``duration`` in s, or for as many steps as are allowed.

    Args:
        system: under constant loads, without damping.
        duration: in s.
        method: of ``METHODS``.
        tolerance: relative, and absolute in the units of a and ȧ.
        most: steps.
    """
    start = np.zeros(2 * system.num_modes)
    within = {"rtol": tolerance, "atol": tolerance}
    solver = METHODS[method](array_rates(system), 0.0, start, duration, **within)
    time, states = [0.0], [start]
    tip = system.observers["tip"].row
    while solver.status == "running" and len(time) <= most:
        solver.step()
        time.append(solver.t)
        states.append(solver.y.copy())
        if not abs(tip @ solver.y[: tip.size]) < AWAY:
            break
    whole = np.array(states)
    return Solved(np.array(time), *np.split(whole, 2, axis=1))
