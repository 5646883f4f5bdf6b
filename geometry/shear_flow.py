# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shear flow q along the mid-line of a closed thin wall.

The flow follows dq/ds = −t a·r (Jourawski 1856), with r from the centroid of the mid-lines. The
vector a makes the flow's resultant, ∮ r rᵀ t ds a, equal to the force. The remaining constant of a
closed cell follows from the condition of no twist, ∮ q/t ds = 0 (Bredt 1896). The solution is exact
for flat plates: q is quadratic along each.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.section import COMPONENT, Direction, Offset, Plate

# Gauss's rule on a plate, exact for q².
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_ALONG, _PARTS = 0.5 * (1.0 + _POINTS), 0.5 * _WEIGHTS

# A plate with a smaller fraction of the force counts as carrying none.
_NO_PART = 1.0e-12


@dataclass(frozen=True, slots=True)
class ShearFlow:
    """Shear flow of a force of 1 N that does not twist the section.

    Args:
        flow: (num_plates, num_points) q in 1/m along the tangent of each plate, at Gauss's points.
        lengths, thicknesses: (num_plates,) of the plates in m.
        arms: (num_plates,) of their tangents about the axis, in m.
    """

    flow: Array
    lengths: Array
    thicknesses: Array
    arms: Array

    @classmethod
    def of(cls, plates: Sequence[Plate], direction: Direction) -> ShearFlow:
        """Return the flow of a force along a direction.

        Args:
            plates: once around, each beginning where the one before ends.
            direction: direction of the force.
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
        """Area 1/∮ q²/t ds in m²: with it G γ does the same work as the flow (Pilkey 2002)."""
        return float(1.0 / (self.lengths / self.thicknesses @ self.flow**2 @ _PARTS))

    @property
    def forces(self) -> Array:
        """Force (num_plates,) of each plate along its tangent."""
        return np.asarray(self.lengths * (self.flow @ _PARTS))

    @property
    def moment(self) -> float:
        """Moment about the axis in m: the lever arm of the force."""
        return float(self.arms @ self.forces)


def shear_centre(plates: Sequence[Plate]) -> Offset:
    """Return the shear centre (y, z) in m from the axis: forces through it do not twist.

    >>> box = pt.BoxSection(0.6, 0.4, flange=0.02, web=0.02, left_web=0.01)
    >>> print(f"{1e3 * shear_centre(box.plates)[0]:.1f} mm to the thicker web's side")
    50.0 mm to the thicker web's side
    """
    return ShearFlow.of(plates, "z").moment, -ShearFlow.of(plates, "y").moment


def shear_plates(plates: Sequence[Plate], direction: Direction) -> tuple[tuple[int, float], ...]:
    """Return the plates that carry a unit force through the axis: number, force along the tangent.

    This is the flow of the force, and that of the moment which moves it from the shear centre to
    the axis.
    """
    carried = ShearFlow.of(plates, direction)
    around = carried.moment / (carried.arms @ carried.lengths)
    forces = carried.forces - around * carried.lengths
    return tuple((n, force) for n, force in enumerate(forces.tolist()) if abs(force) > _NO_PART)
