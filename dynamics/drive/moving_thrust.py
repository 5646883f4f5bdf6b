# SPDX-License-Identifier: LGPL-3.0-or-later
"""An axial force whose place moves along a segment as another one is drawn out.

Between where it was and where it is the segment is pressed by it, and what that takes from the
stiffness is K_G(s) = N ∫₀ˢ w′ᵀ w′ dσ of the slopes w′ at the place (physics of the second order,
Timoshenko and Gere 1961). Of rows that are cubics in s it is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from dynamics.arrays import Array
from dynamics.drive.row_table import RowTable

# i + j + 1 of the powers in slopes: ∫₀¹ uⁱ uʲ du is one over it.
_POWERS = 1.0 + np.add.outer(np.arange(3), np.arange(3))


@dataclass(frozen=True)
class MovingThrust:
    """A force that moves along with a travel, and softens what it has passed.

    >>> thrust = MovingThrust(2.0, RowTable.of(lambda s: np.array([[3.0 * s]]), [0.0, 1.0]))
    >>> thrust.softening(0.5)
    array([[9.]])

    Args:
        force: N in N, positive where it presses what is passed as s rises.
        table: (num_planes, num_modes) rows of the deflections where it acts, at each s in m.
    """

    force: float
    table: RowTable

    @property
    def planes(self) -> int:
        """In how many it moves."""
        return self.table.coefficients.shape[2]

    @cached_property
    def slopes(self) -> Array:
        """(num_pieces, 3, num_planes, num_modes) of w′ per m, of the powers of a part passed."""
        factors = np.arange(1.0, 4.0)[:, None, None]
        lengths = np.diff(self.table.knots)[:, None, None, None]
        return np.asarray(factors * self.table.coefficients[:, 1:] / lengths)

    def passed(self, plane: int) -> Array:
        """(num_pieces, num_modes, num_modes) ∫ w′ᵀ w′ ds from s = 0 to where each piece begins."""
        slopes, lengths = self.slopes[:, :, plane], np.diff(self.table.knots)
        within = np.einsum("p,ij,pik,pjl->pkl", lengths, 1 / _POWERS, slopes, slopes, optimize=True)
        upto = np.concatenate([np.zeros_like(within[:1]), within.cumsum(axis=0)])
        piece, part, length = self.table.place(0.0)
        products = length * part**_POWERS / _POWERS
        return np.asarray(upto[:-1] - upto[piece] - slopes[piece].T @ products @ slopes[piece])

    def softening(self, s: float) -> Array:
        """(num_modes, num_modes) K_G at s in m, less that at 0, where it is exactly 0."""
        (first, start, _), (last, end, _) = (self.table.place(x) for x in sorted((0.0, s)))
        slopes, lengths = self.slopes[first : last + 1], np.diff(self.table.knots)[first : last + 1]
        begins, ends = np.zeros((lengths.size, 1, 1)), np.ones((lengths.size, 1, 1))
        begins[0], ends[-1] = start, end
        products = lengths[:, None, None] * (ends**_POWERS - begins**_POWERS) / _POWERS
        weighed = np.einsum("pij,pjkl->pikl", products, slopes)
        modes = slopes.shape[3]
        total = slopes.reshape(-1, modes).T @ weighed.reshape(-1, modes)
        return np.asarray(self.force * np.sign(s) * total)
