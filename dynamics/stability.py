# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of a boom that its closed contacts hold, with their compliance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from protractile.dynamics.arrays import Array
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.second_order import buckling_factor

# Fraction of the largest ω² below which an ω² is round-off.
_ROUND_OFF = 1.0e-13

# Force across the tip that closes contacts, as a fraction of all loads.
_CLOSING = 1.0e-3


def closing_loads(system: GapSystem, load: Array) -> Iterator[Array]:
    """Yield a load (num_modes,) in N/√kg with a small force across the tip in each direction.

    It closes the contacts that the load does not press, such as those of a column. Forces in both
    directions at once would press contacts at right angles, each of which may then open: a softer
    boom than one without forces.
    """
    size = float(np.linalg.norm(load)) or 1.0
    for name in ("tip", "tip_lateral"):
        if name in system.observers:
            row = system.observers[name].row
            yield load + _CLOSING * size / np.linalg.norm(row) * row


def closed_contact_factor(system: GapSystem, geometric: Array, rest: Array) -> float:
    """Return the buckling factor of the axial forces with the contacts that are closed at rest.

    Closed contacts have their stiffness at rest, and stations without one are bonded, see
    :func:`.damping.closed_contact_modes`. The factor is infinite if the boom does not buckle.

    Args:
        system: gap system under the axial forces.
        geometric: their geometric stiffness K_G (num_modes, num_modes) in 1/s².
        rest: equilibrium (num_modes,) in √kg·m.
    """
    omega2, turn = eigh(system.stiffness + geometric)
    omega2[np.abs(omega2) <= _ROUND_OFF * np.abs(omega2).max(initial=0.0)] = 0.0
    # The axial forces are taken away, so that the modes with closed contacts are stable.
    unloaded = replace(system.transform(omega2, turn), travels=())
    omega, shapes = closed_contact_modes(unloaded, rest @ turn)
    modes = turn @ shapes
    return buckling_factor(np.diag(omega**2), modes.T @ geometric @ modes)
