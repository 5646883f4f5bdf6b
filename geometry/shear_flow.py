# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shear flow q_s along the mid-line of a closed thin wall.

The shear flow follows dq_s/dℓ = −t_w c·r (Jourawski 1856). Here ℓ is the coordinate along the
mid-line, t_w the wall thickness and r the position from the centroid. The constant vector c follows
from the shear force V = ∮ r rᵀ t_w dℓ c. The constant of integration follows from zero twist, ∮
q_s/t_w dℓ = 0 (Bredt 1896). The solution is exact for flat plates, along which q_s is quadratic.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.section import COMPONENT, Direction, Plate

# Gauss points and weights on a plate, exact for q_s².
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_ALONG, _PARTS = 0.5 * (1.0 + _POINTS), 0.5 * _WEIGHTS

# Fraction of the total force below which the shear force of a plate is round-off.
_NO_PART = 1.0e-12


@dataclass(frozen=True, slots=True)
class ShearFlow:
    """Shear flow of a force of 1 N through the shear centre.

    Args:
        flow: q_s (num_plates, num_points) in N/m per N at the Gauss points of plates, positive
            along their tangents.
        lengths, thicknesses: lengths and thicknesses (num_plates,) of the plates in m.
        arms: lever arms (num_plates,) of the tangents about the axis in m.
    """

    flow: Array
    lengths: Array
    thicknesses: Array
    arms: Array

    @classmethod
    def from_plates(cls, plates: Sequence[Plate], direction: Direction) -> ShearFlow:
        """Return the shear flow of a force of 1 N along a direction.

        Args:
            plates: plates of a closed section in order, each from the end of the previous one.
        """
        start = np.array([plate.start for plate in plates])
        side = np.array([plate.end for plate in plates]) - start
        length, thickness = np.array([(plate.length, plate.thickness) for plate in plates]).T
        area, middle = length * thickness, start + 0.5 * side
        start = start - area @ middle / area.sum()
        half = start + 0.5 * side
        moments = (area * half.T) @ half + (area * side.T) @ side / 12.0
        slope = np.linalg.solve(moments, np.eye(2)[COMPONENT[direction] - 1])
        grown = np.outer(start @ slope, _ALONG) + np.outer(side @ slope, 0.5 * _ALONG**2)
        whole = area * (half @ slope)
        opened = (whole - np.cumsum(whole))[:, None] - area[:, None] * grown
        slip = length / thickness
        return cls(
            flow=opened - slip @ opened @ _PARTS / slip.sum(),
            lengths=length,
            thicknesses=thickness,
            arms=(middle[:, 0] * side[:, 1] - middle[:, 1] * side[:, 0]) / length,
        )

    @property
    def shear_area(self) -> float:
        """The shear area 1/∮ q_s²/t_w dℓ in m², which has equal strain energy (Pilkey 2002)."""
        return float(1.0 / (self.lengths / self.thicknesses @ self.flow**2 @ _PARTS))

    @property
    def forces(self) -> Array:
        """The force (num_plates,) of each plate along its tangent, in N per N of shear force."""
        return np.asarray(self.lengths * (self.flow @ _PARTS))

    @property
    def moment(self) -> float:
        """The moment about the axis in N·m per N: the lever arm in m of the shear force."""
        return float(self.arms @ self.forces)


def shear_plates(plates: Sequence[Plate], direction: Direction) -> tuple[tuple[int, float], ...]:
    """Return (index, force in N along the tangent) of the plates under a shear force of 1 N.

    The shear force acts on the axis. The forces of the plates follow from the shear flow, and from
    the torque that shifts the shear force from the shear centre to the axis.
    """
    flow = ShearFlow.from_plates(plates, direction)
    around = flow.moment / (flow.arms @ flow.lengths)
    forces = flow.forces - around * flow.lengths
    return tuple((n, force) for n, force in enumerate(forces.tolist()) if abs(force) > _NO_PART)
