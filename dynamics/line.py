# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is read along a segment of a gap system: deflections and section forces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from dynamics.arrays import Array

# In m, rad, N and N·m. Forces are those of the part beyond the section on the part before it;
# moments pull at larger z, lateral ones at larger y. So the slope of a moment is its shear force.
Quantity = Literal[
    "deflection", "shear", "moment", "lateral", "lateral_shear", "lateral_moment", "twist", "torque"
]


@dataclass(frozen=True, slots=True)
class Line:
    """Rows that read along one segment.

    Args:
        x: (num_places,) in m, rising; a place where something may jump stands twice.
        rows: (num_places, num_modes) of each quantity that the model knows.
    """

    x: Array
    rows: Mapping[Quantity, Array]

    def read(self, states: Array) -> dict[Quantity, Array]:
        """(..., num_places) of modal coordinates (..., num_modes)."""
        return {name: states @ row.T for name, row in self.rows.items()}
