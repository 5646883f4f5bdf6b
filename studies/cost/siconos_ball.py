# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ball that falls on a cantilever, in Siconos: ``python siconos_ball.py < GIVEN.json``.

The interpreter needs Siconos, but not this project. For each step, the script prints the motion of
ball and tip, and the wall time in s.
"""

from __future__ import annotations

import json
import sys
from time import perf_counter
from typing import Any

import numpy as np
from siconos import kernel


def move(given: dict[str, Any], step: float) -> dict[str, Any]:
    """Return the positions of ball and tip in m, and the wall time in s, for a step in s.

    The scheme is Moreau-Jean with θ = ½ and a coefficient of restitution of 0.
    """
    mass, stiffness = (np.array(given[name]) for name in ("mass", "stiffness"))
    n = len(mass)
    beam = kernel.LagrangianLinearTIDS(np.zeros(n), np.zeros(n), mass, stiffness, 0.0 * mass)
    ball = kernel.LagrangianLinearTIDS([given["height"]], [given["speed"]], np.array([[1.0]]))
    gap = np.zeros((1, n + 1))
    gap[0, 0], gap[0, n] = -1.0, 1.0
    contact = kernel.Interaction(kernel.NewtonImpactNSL(0.0), kernel.LagrangianLinearTIR(gap))
    system = kernel.NonSmoothDynamicalSystem(0.0, given["duration"])
    for one in (beam, ball):
        system.insertDynamicalSystem(one)
    system.link(contact, beam, ball)
    simulation = kernel.TimeStepping(
        system, kernel.TimeDiscretisation(0.0, step), kernel.MoreauJeanOSI(0.5), kernel.LCP()
    )
    every = round(given["output_step"] / step)
    places, count = [[given["height"], 0.0]], 0
    start = perf_counter()
    while simulation.hasNextEvent():
        simulation.computeOneStep()
        count += 1
        if count % every == 0:
            places.append([float(ball.q()[0]), float(beam.q()[0])])
        simulation.nextStep()
    seconds = perf_counter() - start
    return {"step": step, "seconds": seconds, "places": places}


if __name__ == "__main__":
    given = json.load(sys.stdin)
    print(json.dumps([move(given, step) for step in given["steps"]]))
