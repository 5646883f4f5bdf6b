# SPDX-License-Identifier: LGPL-3.0-or-later
"""Small systems that are chaotic by impacts, and a linear system without stops."""

import numpy as np

from protractile.dynamics.contact import PowerContact
from tests.modal import modal_system

NUMBERS = {"omega2": [4.0, 31.0], "load": [2.0, 3.0], "tip": [1.0, 0.4]}
LINEAR = modal_system(**NUMBERS)
# Both modes in turn press one row against its two stops, about twice a second.
LAW = PowerContact(stiffness=1.0e6, exponent=2.0).with_clearance(0.02)
CHAOTIC = modal_system(**NUMBERS, rows=[0.8, -0.6], laws=[LAW])

# Eight modes rattle between the stops of two rows, about 500 times a second.
_MODES = np.arange(1, 9)
RATTLING = modal_system(
    omega2=16.0 * _MODES**4,
    load=[30.0, *np.zeros(7)],
    tip=np.cos(_MODES),
    rows=[np.sin(1.1 * _MODES), np.cos(0.7 * _MODES)],
    laws=2 * [PowerContact(stiffness=1.0e6, exponent=1.0).with_clearance(0.001)],
)
