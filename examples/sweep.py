# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sweep in Python: rebound speed of a mass from a stop with a damping for a restitution."""

import numpy as np

import protractile as pt
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import simulate

SPEED = 2.0


def rebound(restitution: float) -> float:
    """Return the ratio of the speed after the impact to that before it."""
    damping = pt.restitution_damping(restitution, SPEED)
    law = pt.PowerContact(1.0e6, 1.5, damping=damping).upper().with_clearance(0.01)
    one, place = np.ones(1), np.array([0])
    seen = {"place": Observer(one)}
    mass = GapSystem(0.0 * one, 0.0 * one, one[None], [law], place, [0.0], seen)
    path = simulate(mass, 0.1, 1.0e-4, velocity=[SPEED]).data["place"].values
    return float((path[-2] - path[-1]) / (1.0e-4 * SPEED))


if __name__ == "__main__":
    for gap in np.linspace(0.2, 1.0, 5):
        print(f"{gap:.1f}: {rebound(gap):.4f}")
