# SPDX-License-Identifier: LGPL-3.0-or-later
"""A small system that impacts make chaotic, and the linear one that it is without its stops."""

import numpy as np

from dynamics.contact import PowerContact
from dynamics.gap_system import GapSystem, Observer

LINEAR = GapSystem(
    omega2=np.array([4.0, 31.0]),
    load=np.array([2.0, 3.0]),
    rows=np.zeros((0, 2)),
    laws=[],
    station_of_row=np.zeros(0, dtype=np.int64),
    stations=[],
    observers={"tip": Observer(np.array([1.0, 0.4]))},
)
# Both modes in turn press one row against its two stops, about twice a second.
CHAOTIC = GapSystem(
    omega2=LINEAR.omega2,
    load=LINEAR.load,
    rows=np.array([[0.8, -0.6]]),
    laws=[PowerContact(stiffness=1.0e6, exponent=2.0).behind(0.02)],
    station_of_row=np.array([0]),
    stations=[0.0],
    observers=LINEAR.observers,
)
