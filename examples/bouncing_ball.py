# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ball on an elastic floor: a user-defined gap system."""

import numpy as np

import protractile as pt
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import simulate

HEIGHT, GRAVITY, STIFFNESS = 0.5, 9.81, 1.0e6


def fall() -> pt.Trajectory:
    """Return one second of the motion of a ball of 1 kg, released at rest."""
    ball = GapSystem(
        omega2=np.array([0.0]),
        load=np.array([-GRAVITY]),
        rows=np.array([[1.0]]),
        laws=[pt.PowerContact(STIFFNESS, 1.0).lower()],
        station_of_row=np.array([0]),
        stations=[0.0],
        observers={"height": Observer(np.array([1.0]))},
    )
    return simulate(ball, 1.0, 1.0e-3, position=[HEIGHT])


if __name__ == "__main__":
    motion = fall()
    print(f"touches at {motion.first_contact:.6f} s, energy within {motion.energy_residual:.1e}")
    motion.data["height"].plot()
