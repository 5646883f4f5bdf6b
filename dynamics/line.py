# SPDX-License-Identifier: LGPL-3.0-or-later
"""Lines: rows of deflections and section forces along a segment."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from protractile.dynamics.arrays import Array

# Quantities along a segment in m, rad, N and N·m. Section forces act on the part of smaller x,
# along and across the straight axis. A positive normal force is tension; a positive moment causes
# tension at larger z, a lateral one at larger y. So the slope of a moment is the shear force less
# the normal force times the slope of the deflection.
LineQuantity = Literal[
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
    """Rows of quantities along one segment."""

    #: positions (num_places,) in m, ascending; a position with a possible jump occurs twice
    x: Array
    rows: Mapping[LineQuantity, Array]  #: rows (num_places, num_modes) of each available quantity
    paired: bool  #: True if positions are both ends of each element, False if they are midpoints

    @property
    def deflections(self) -> Iterator[tuple[Literal["y", "z"], tuple[Array, Array]]]:
        """Each direction, with ascending x (num_places,) in m, and rows (num_places, num_modes)."""
        x, index = np.unique(self.x, return_index=True)
        names: dict[LineQuantity, Literal["y", "z"]] = {"deflection": "z", "lateral": "y"}
        for name, direction in names.items():
            if name in self.rows:
                yield direction, (x, self.rows[name][index])

    def read(self, states: Array) -> dict[LineQuantity, Array]:
        """Return each quantity (..., num_places) for modal coordinates (..., num_modes).

        Further coordinates, such as the coordinate of a load on a rope, are ignored.
        """
        return {name: states[..., : row.shape[1]] @ row.T for name, row in self.rows.items()}

    def transform(self, basis: Array) -> Line:
        """Return the line in other coordinates b, with a = Φ b and Φ (num_modes, num_others).

        Rows of Φ for further coordinates, as in :meth:`read`, are ignored.
        """
        rows = {name: row @ basis[: row.shape[1]] for name, row in self.rows.items()}
        return replace(self, rows=rows)

    def extend(self, num_modes: int) -> Line:
        """Return the line of a model with further coordinates, on which it does not depend."""
        rows = {
            name: np.pad(row, ((0, 0), (0, num_modes - row.shape[1])))
            for name, row in self.rows.items()
        }
        return replace(self, rows=rows)

    def one_sided_row(self, name: LineQuantity, x: float, side: int) -> Array:
        """Return the row (num_modes,) of a quantity at x from one side; 0 outside the segment.

        Args:
            x: position of a jump in m.
            side: −1 for the limit from smaller x, 1 for the limit from larger x.
        """
        places, rows = self.x, self.rows[name]
        if self.paired:
            # A jump is at the ends of elements: of those on this side the nearest, if it is x.
            near, far = (slice(side < 0, None, 2), slice(side > 0, None, 2))
            k = int(np.abs(places[near] - x).argmin())
            at_x = abs(places[near][k] - x) < abs(places[far][k] - x)
            return np.asarray(at_x * rows[near][k])
        there = np.flatnonzero(side * (places - x) > 0.0)
        if there.size == 0:
            return np.zeros(rows.shape[1])
        first, *more = there[np.abs(places[there] - x).argsort()][:2]
        if not more:
            return np.asarray(rows[first])
        part = (x - places[first]) / (places[more[0]] - places[first])
        return np.asarray(rows[first] + part * (rows[more[0]] - rows[first]))
