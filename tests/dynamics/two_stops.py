# SPDX-License-Identifier: LGPL-3.0-or-later
"""A small system that is chaotic by impacts, and the linear system without its stops."""

from dynamics.contact import PowerContact
from tests.modal import modal_system

NUMBERS = {"omega2": [4.0, 31.0], "load": [2.0, 3.0], "tip": [1.0, 0.4]}
LINEAR = modal_system(**NUMBERS)
# Both modes in turn press one row against its two stops, about twice a second.
LAW = PowerContact(stiffness=1.0e6, exponent=2.0).with_clearance(0.02)
CHAOTIC = modal_system(**NUMBERS, rows=[0.8, -0.6], laws=[LAW])
