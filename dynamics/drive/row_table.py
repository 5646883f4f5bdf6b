# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows and axial forces that change with the extension of a segment, as cubics between places.

If elements have cubic shape functions, and knots lie where nodes pass, the cubics are exact.
Otherwise pieces are halved until the cubics are within a tolerance of the rows.

An axial force that moves along a segment compresses it between its initial and present place. It
reduces the stiffness by K_G(s) = N ∫₀ˢ w′ᵀ w′ dσ of the slopes w′ at the place (second-order
theory, Timoshenko and Gere 1961). For rows that are cubic in s this is exact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import pairwise

import numpy as np

from dynamics.arrays import Array

# Largest error of a cubic, as a part of the largest entry; the motion takes the cubic for the row.
TOLERANCE = 1.0e-9

# Halvings of a piece before it is taken as it is.
_MOST_HALVINGS = 16

# Places in a piece where a cubic meets the rows, its coefficients by the values there (Lagrange),
# and places where it is tested.
_MET = np.array([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0])
_COEFFICIENTS = 0.5 * np.array(
    [[2.0, 0.0, 0.0, 0.0], [-11.0, 18.0, -9.0, 2.0], [18.0, -45.0, 36.0, -9.0],
     [-9.0, 27.0, -27.0, 9.0]]
)  # fmt: skip
_TESTED = np.array([0.15, 0.5, 0.85])

# i + j + 1 of the powers in slopes: ∫₀¹ uⁱ uʲ du is one over it.
_POWERS = 1.0 + np.add.outer(np.arange(3), np.arange(3))


@dataclass(frozen=True, slots=True)
class RowTable:
    """Rows over an extension s.

    >>> table = RowTable.of(lambda s: np.array([[1.0, s**3]]), [0.0, 1.0, 2.0])
    >>> table(1.5)
    array([[1.   , 3.375]])

    Args:
        knots: (num_pieces + 1,) in m, rising.
        coefficients: (num_pieces, 4, num_rows, num_modes) of the powers of the part of the piece
            that s has passed.

    Raises:
        ValueError: knots do not rise, or shapes do not agree.
    """

    knots: Array
    coefficients: Array

    def __post_init__(self) -> None:
        pieces = len(self.knots) - 1
        if pieces < 1 or not (np.diff(self.knots) > 0.0).all():
            raise ValueError("the knots of a table of rows must be two at least, and rise")
        if self.coefficients.ndim != 4 or self.coefficients.shape[:2] != (pieces, 4):
            raise ValueError(
                f"coefficients must have the shape ({pieces}, 4, num_rows, num_modes), got "
                f"{self.coefficients.shape}"
            )
        if not (np.isfinite(self.knots).all() and np.isfinite(self.coefficients).all()):
            raise ValueError("knots and coefficients must be finite")

    @classmethod
    def of(cls, rows: Callable[[float], Array], breaks: Sequence[float]) -> RowTable:
        """Return the table of rows (num_rows, num_modes), smooth between rising breaks in m."""
        # Pieces end where others begin, and halves meet rows where the whole did.
        rows = cache(rows)
        scale = max(float(np.abs(rows(s)).max(initial=0.0)) for s in breaks)
        pieces = [
            piece
            for a, b in pairwise(breaks)
            for piece in _pieces(rows, a, b, TOLERANCE * scale, _MOST_HALVINGS)
        ]
        knots = np.array([*(start for start, _ in pieces), breaks[-1]])
        return cls(knots, np.array([cubic for _, cubic in pieces]))

    @classmethod
    def through(cls, knots: Array, rows: Array) -> RowTable:
        """Return the cubic spline through rows (num_knots, num_rows, num_modes).

        Its third derivative does not jump at the first inner knot nor at the last one.
        """
        from scipy.interpolate import CubicSpline

        lengths = np.diff(knots)[:, None, None]
        powers = CubicSpline(knots, rows).c[::-1]
        pieces = [cubic * lengths**power for power, cubic in enumerate(powers)]
        return cls(knots, np.ascontiguousarray(np.stack(pieces, axis=1)))

    def __call__(self, s: float) -> Array:
        """Return the rows (num_rows, num_modes) at s in m."""
        piece, part, _ = self.place(s)
        return _combined(part ** np.arange(4), self.coefficients[piece])

    def place(self, s: float) -> tuple[int, float, float]:
        """Return the piece at s in m, the part of it that s has passed, and its length in m."""
        last = len(self.knots) - 2
        piece = min(max(int(np.searchsorted(self.knots, s, side="right")) - 1, 0), last)
        length = float(self.knots[piece + 1] - self.knots[piece])
        return piece, (s - float(self.knots[piece])) / length, length


@dataclass(frozen=True)
class MovingAxialForce:
    """An axial force that moves with a travel and softens the segment behind it.

    >>> force = MovingAxialForce(2.0, RowTable.of(lambda s: np.array([[3.0 * s]]), [0.0, 1.0]))
    >>> force.softening(0.5)
    array([[9.]])

    Args:
        force: N in N, positive where it compresses the passed length as s rises.
        table: (num_planes, num_modes) rows of the deflections where it acts, at each s in m.
    """

    force: float
    table: RowTable

    @property
    def planes(self) -> int:
        """Number of planes of bending."""
        return self.table.coefficients.shape[2]

    @cached_property
    def slopes(self) -> Array:
        """Slopes w′ (num_pieces, 3, num_planes, num_modes) per m, by powers of a part passed."""
        factors = np.arange(1.0, 4.0)[:, None, None]
        lengths = np.diff(self.table.knots)[:, None, None, None]
        return np.asarray(factors * self.table.coefficients[:, 1:] / lengths)

    def passed(self, plane: int) -> Array:
        """Return ∫ w′ᵀ w′ ds (num_pieces, num_modes, num_modes) from s = 0 to each piece."""
        slopes, lengths = self.slopes[:, :, plane], np.diff(self.table.knots)
        within = np.einsum("p,ij,pik,pjl->pkl", lengths, 1 / _POWERS, slopes, slopes, optimize=True)
        upto = np.concatenate([np.zeros_like(within[:1]), within.cumsum(axis=0)])
        piece, part, length = self.table.place(0.0)
        products = length * part**_POWERS / _POWERS
        return np.asarray(upto[:-1] - upto[piece] - slopes[piece].T @ products @ slopes[piece])

    def softening(self, s: float) -> Array:
        """Return K_G (num_modes, num_modes) at s in m, less that at 0."""
        (first, start, _), (last, end, _) = (self.table.place(x) for x in sorted((0.0, s)))
        slopes, lengths = self.slopes[first : last + 1], np.diff(self.table.knots)[first : last + 1]
        begins, ends = np.zeros((lengths.size, 1, 1)), np.ones((lengths.size, 1, 1))
        begins[0], ends[-1] = start, end
        products = lengths[:, None, None] * (ends**_POWERS - begins**_POWERS) / _POWERS
        weighed = np.einsum("pij,pjkl->pikl", products, slopes)
        modes = slopes.shape[3]
        total = slopes.reshape(-1, modes).T @ weighed.reshape(-1, modes)
        return np.asarray(self.force * np.sign(s) * total)


def _combined(weights: Array, arrays: Array) -> Array:
    """Return a weighted sum; no BLAS product, whose last bits depend on addresses in memory."""
    return np.asarray((weights[:, None, None] * arrays).sum(axis=0))


def _pieces(
    rows: Callable[[float], Array], a: float, b: float, bound: float, halvings: int
) -> Iterator[tuple[float, Array]]:
    """Yield the start in m and the coefficients (4, num_rows, num_modes) of each piece."""
    met = np.array([rows(a + part * (b - a)) for part in _MET])
    cubic = np.array([_combined(weights, met) for weights in _COEFFICIENTS])
    missed = [
        float(np.abs(_combined(part ** np.arange(4), cubic) - rows(a + part * (b - a))).max())
        for part in _TESTED
    ]
    if halvings == 0 or max(missed) <= bound:
        yield a, cubic
        return
    middle = 0.5 * (a + b)
    yield from _pieces(rows, a, middle, bound, halvings - 1)
    yield from _pieces(rows, middle, b, bound, halvings - 1)
