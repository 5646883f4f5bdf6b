# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lines: rows of deflections and section forces along a segment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from dynamics.arrays import Array

# Quantities along a segment in m, rad, N and N·m. Section forces act from the part beyond the
# section on the part before it, along and across the straight axis. A positive normal force is
# tension; a positive moment causes tension at larger z, a lateral one at larger y. So the slope of
# a moment is the shear force less the normal force times the slope of the deflection.
Quantity = Literal[
    "deflection",
    "normal",
    "shear",
    "moment",
    "lateral",
    "lateral_shear",
    "lateral_moment",
    "twist",
    "torque",
]


@dataclass(frozen=True, slots=True)
class Line:
    """Rows that read quantities along one segment.

    Args:
        x: (num_places,) in m, ascending; a place with a possible jump occurs twice.
        rows: rows (num_places, num_modes) of each available quantity.
        paired: whether places are the two ends of each piece, and not the middles of pieces.
    """

    x: Array
    rows: Mapping[Quantity, Array]
    paired: bool

    def read(self, states: Array) -> dict[Quantity, Array]:
        """Return each quantity (..., num_places) for modal coordinates (..., num_modes).

        Coordinates of a load on a rope may follow those of the boom.
        """
        return {name: states[..., : row.shape[1]] @ row.T for name, row in self.rows.items()}

    def on(self, basis: Array) -> Line:
        """Return the line in other coordinates b of a = Φ b, with Φ (num_modes, num_others)."""
        return replace(self, rows={name: row @ basis for name, row in self.rows.items()})

    def beside(self, name: Quantity, x: float, side: int) -> Array:
        """Return the row (num_modes,) of a quantity beside x in m; 0 off the segment.

        Args:
            name: name of the quantity.
            x: place with a jump.
            side: −1 before it, 1 behind it.
        """
        places, rows = self.x, self.rows[name]
        if self.paired:
            places, rows = 0.5 * (places[::2] + places[1::2]), 0.5 * (rows[::2] + rows[1::2])
        there = np.flatnonzero(side * (places - x) > 0.0)
        if there.size == 0:
            return np.zeros(rows.shape[1])
        first, *more = there[np.abs(places[there] - x).argsort()][:2]
        if not more:
            return np.asarray(rows[first])
        part = (x - places[first]) / (places[more[0]] - places[first])
        return np.asarray(rows[first] + part * (rows[more[0]] - rows[first]))
