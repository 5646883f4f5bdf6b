# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static quantities for verification only."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.polygon import ShearFlow
from protractile.geometry.section import Offset, Plate


def static_response(system: GapSystem, force: Array) -> Array:
    """Return the static position (num_modes,) of a system without contact.

    The modal force (num_modes,) is in N/√kg.

    Raises:
        ValueError: the system has rigid modes.
    """
    if (system.omega2 <= 0.0).any():
        raise ValueError("a system with rigid modes has no static response")
    if system.geometric_stiffness.size:
        return np.asarray(np.linalg.solve(system.stiffness, force))
    return force / system.omega2


def shear_centre(plates: Sequence[Plate]) -> Offset:
    """Return the shear centre (y, z) in m from the axis; forces through it cause no twist."""
    return ShearFlow.from_plates(plates, "z").moment, -ShearFlow.from_plates(plates, "y").moment
