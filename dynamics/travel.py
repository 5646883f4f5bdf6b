# SPDX-License-Identifier: LGPL-3.0-or-later
"""Travels: the extension of a segment over time, and the rows that it changes.

A segment that moves along its axis has the inertia m̄ ü at a fixed material point if slopes are
small. So its modes, loads and observers do not change. But contact rows change, since the contact
moves along one of the two segments with the extension.

Rows and axial forces that change with an extension s are piecewise cubics. With cubic shape
functions and a knot where the contact passes a node, the cubics are exact. Otherwise pieces are
halved until the error of the cubics is within a tolerance.

An axial force P_t that moves along a segment compresses the length between its initial and its
current position. It reduces the stiffness by K_G(s) = P_t ∫₀ˢ w′ᵀ w′ ds̃ with the row w′(s̃) of the
slope at the force (second-order theory, Timoshenko and Gere 1961). For rows that are cubic in s
this is exact.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import pairwise
from typing import Literal, get_args

import numpy as np
from scipy.linalg import eigh

from protractile.dynamics.arrays import Array
from protractile.dynamics.excitation import History
from protractile.dynamics.stick_slip import ElasticDrive

# Kinds of rows of a gap system that may change with time, in the order of the compiled loops.
RowKind = Literal["rows", "friction_rows", "dashpots"]
ROW_KINDS: tuple[RowKind, ...] = get_args(RowKind)

# Permitted error of a cubic, as a fraction of the largest entry.
TOLERANCE = 1.0e-9

# Maximum number of halvings of a piece.
_MOST_HALVINGS = 16

# Interpolation points of a cubic in a piece, the matrix of its coefficients (Lagrange), and points
# at which its error is tested.
_POINTS = np.array([0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0])
_COEFFICIENTS = 0.5 * np.array(
    [[2.0, 0.0, 0.0, 0.0], [-11.0, 18.0, -9.0, 2.0], [18.0, -45.0, 36.0, -9.0],
     [-9.0, 27.0, -27.0, 9.0]]
)  # fmt: skip
_TEST_POINTS = np.array([0.15, 0.5, 0.85])

# Minimum relative change of the stiffness of a modal direction by a changing axial force.
_LEAST_CHANGE = 1.0e-5

# i + j + 1, the reciprocals of ∫₀¹ uⁱ uʲ du for the powers in slopes.
_POWERS = 1.0 + np.add.outer(np.arange(3), np.arange(3))


@dataclass(frozen=True, slots=True)
class RowTable:
    """Rows as functions of an extension s.

    >>> table = RowTable.interpolate(lambda s: np.array([[1.0, s**3]]), [0.0, 1.0, 2.0])
    >>> table(1.5)
    array([[1.   , 3.375]])

    Args:
        knots: (num_pieces + 1,) in m, ascending.
        coefficients: (num_pieces, 4, num_rows, num_modes) coefficients of the powers 0 to 3 of the
            position in a piece, as a fraction of the length of the piece.

    Raises:
        ValueError: knots are not ascending, or shapes do not agree.
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
    def interpolate(cls, rows: Callable[[float], Array], breaks: Sequence[float]) -> RowTable:
        """Return the table of the function ``rows``, which is smooth between ``breaks`` in m.

        The function returns the rows (num_rows, num_modes) at an extension s in m.
        """
        # Rows are cached, since pieces have common ends, and halves have points of the whole piece.
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
    def spline(cls, knots: Array, rows: Array) -> RowTable:
        """Return the cubic spline through rows (num_knots, num_rows, num_modes).

        Its third derivative is continuous at the first and the last inner knot.
        """
        from scipy.interpolate import CubicSpline

        lengths = np.diff(knots)[:, None, None]
        powers = CubicSpline(knots, rows).c[::-1]
        pieces = [cubic * lengths**power for power, cubic in enumerate(powers)]
        return cls(knots, np.ascontiguousarray(np.stack(pieces, axis=1)))

    def transform(self, shapes: Array) -> RowTable:
        """Return the table in other coordinates b, with a = Φ b and Φ (num_modes, num_others)."""
        return replace(self, coefficients=self.coefficients @ shapes)

    def __call__(self, s: float) -> Array:
        """Return the rows (num_rows, num_modes) at the extension s in m."""
        piece, part, _ = self.locate(s)
        return _weighted_sum(part ** np.arange(4), self.coefficients[piece])

    def locate(self, s: float) -> tuple[int, float, float]:
        """Return the index of the piece at s in m, the relative position in it, and its length."""
        last = len(self.knots) - 2
        piece = min(max(int(np.searchsorted(self.knots, s, side="right")) - 1, 0), last)
        length = float(self.knots[piece + 1] - self.knots[piece])
        return piece, (s - float(self.knots[piece])) / length, length


@dataclass(frozen=True)
class MovingAxialForce:
    """Axial force that moves along a segment as it telescopes, and reduces its bending stiffness.

    >>> table = RowTable.interpolate(lambda s: np.array([[3.0 * s]]), [0.0, 1.0])
    >>> MovingAxialForce(2.0, table).geometric_stiffness(0.5)
    array([[9.]])
    """

    force: float  #: P_t in N, positive if it compresses the length between 0 and a positive s
    table: RowTable  #: rows (num_planes, num_modes) of the deflections at the force, over s in m

    def transform(self, shapes: Array) -> MovingAxialForce:
        """Return the force in other coordinates, as :meth:`RowTable.transform`."""
        return replace(self, table=self.table.transform(shapes))

    @cached_property
    def slopes(self) -> Array:
        """The coefficients (num_pieces, 3, num_planes, num_modes) of the powers 0 to 2 in w′."""
        factors = np.arange(1.0, 4.0)[:, None, None]
        lengths = np.diff(self.table.knots)[:, None, None, None]
        return np.asarray(factors * self.table.coefficients[:, 1:] / lengths)

    def slope_products(self, plane: int) -> Array:
        """Return ∫ w′ᵀ w′ ds̃ (num_pieces, num_modes, num_modes) from 0 to each piece's start."""
        slopes, lengths = self.slopes[:, :, plane], np.diff(self.table.knots)
        within = np.einsum("p,ij,pik,pjl->pkl", lengths, 1 / _POWERS, slopes, slopes, optimize=True)
        upto = np.concatenate([np.zeros_like(within[:1]), within.cumsum(axis=0)])
        piece, part, length = self.table.locate(0.0)
        products = length * part**_POWERS / _POWERS
        return np.asarray(upto[:-1] - upto[piece] - slopes[piece].T @ products @ slopes[piece])

    def geometric_stiffness(self, s: float) -> Array:
        """Return the increase of K_G (num_modes, num_modes) in 1/s² from 0 to s in m."""
        (first, start, _), (last, end, _) = (self.table.locate(x) for x in sorted((0.0, s)))
        slopes, lengths = self.slopes[first : last + 1], np.diff(self.table.knots)[first : last + 1]
        begins, ends = np.zeros((lengths.size, 1, 1)), np.ones((lengths.size, 1, 1))
        begins[0], ends[-1] = start, end
        products = lengths[:, None, None] * (ends**_POWERS - begins**_POWERS) / _POWERS
        weighed = np.einsum("pij,pjkl->pikl", products, slopes)
        modes = slopes.shape[3]
        total = slopes.reshape(-1, modes).T @ weighed.reshape(-1, modes)
        return np.asarray(self.force * np.sign(s) * total)


@dataclass(frozen=True, slots=True)
class ChangingAxialForce:
    """Axial force proportional to the value g_e of a history: K_G = g_e Σ_k λ_k x_kᵀ x_k."""

    factors: Array  #: λ (num_vectors,)
    vectors: Array  #: x (num_vectors, num_modes)

    @classmethod
    def of(cls, geometric: Array, stiffness: Array, peak: float) -> ChangingAxialForce:
        """Return the force with the geometric stiffness ``geometric`` at g_e = 1.

        The sum leaves out directions in which the stiffness changes by less than 1e-5 of itself.

        Args:
            geometric: K_G (num_modes, num_modes) in 1/s².
            stiffness: positive definite stiffness (num_modes, num_modes) in 1/s².
            peak: largest |g_e|.
        """
        factors, shapes = eigh(geometric, stiffness)
        matter = np.abs(factors) * peak > _LEAST_CHANGE
        return cls(factors[matter], np.ascontiguousarray((stiffness @ shapes[:, matter]).T))

    def transform(self, shapes: Array) -> ChangingAxialForce:
        """Return the force in other coordinates, as :meth:`RowTable.transform`."""
        return replace(self, vectors=self.vectors @ shapes)

    def geometric_stiffness(self, s: float) -> Array:
        """Return K_G (num_modes, num_modes) in 1/s² at the value ``s`` of g_e."""
        return np.asarray(s * (self.vectors.T * self.factors) @ self.vectors)


def _weighted_sum(weights: Array, arrays: Array) -> Array:
    """Return a weighted sum of matrices. It avoids BLAS to be bitwise reproducible."""
    return np.asarray((weights[:, None, None] * arrays).sum(axis=0))


def _pieces(
    rows: Callable[[float], Array], a: float, b: float, bound: float, halvings: int
) -> Iterator[tuple[float, Array]]:
    """Yield start in m and coefficients (4, num_rows, num_modes) of each piece from a to b."""
    values = np.array([rows(a + part * (b - a)) for part in _POINTS])
    cubic = np.array([_weighted_sum(weights, values) for weights in _COEFFICIENTS])
    errors = [
        float(np.abs(_weighted_sum(part ** np.arange(4), cubic) - rows(a + part * (b - a))).max())
        for part in _TEST_POINTS
    ]
    if halvings == 0 or max(errors) <= bound:
        yield a, cubic
        return
    middle = 0.5 * (a + b)
    yield from _pieces(rows, a, middle, bound, halvings - 1)
    yield from _pieces(rows, middle, b, bound, halvings - 1)


@dataclass(frozen=True, slots=True)
class Travel:
    """Extension over time, 0 at t = 0, and the rows that change with the extension.

    Example: the row of a contact decreases with the extension.

    >>> table = RowTable.interpolate(lambda s: np.array([[1.0 - s]]), [0.0, 0.5])
    >>> lift = Travel(pt.SCurve(travel=0.5, duration=1.0), table, (("rows", 0),))
    >>> replace(ball, travels=[lift]).at_time(1.0).rows
    array([[0.5]])

    Args:
        history: extension in m over time.
        table: rows (num_moving, num_modes) over the extension.
        moved_rows: (kind, index) of each row in the gap system.
        suffix: suffix of the names of results; None for no results.
        axial_forces: axial forces that move with the extension, or are proportional to it.
        axial_load: axial load in N of all segments that the drive moves.
        elastic: data of an elastic drive; None for a rigid drive.
        shifts: increase of the displacement of each row per m of extension, as for the rope of a
            winch; none unless given.

    Raises:
        ValueError: the table has another number of rows, or a history that moves rows does not
            begin with 0.
    """

    history: History
    table: RowTable
    moved_rows: Sequence[tuple[RowKind, int]]
    suffix: str | None = None
    axial_forces: Sequence[MovingAxialForce | ChangingAxialForce] = ()
    axial_load: float = 0.0
    elastic: ElasticDrive | None = None
    shifts: Sequence[float] = ()

    def __post_init__(self) -> None:
        rows = self.table.coefficients.shape[2]
        if rows != len(self.moved_rows):
            raise ValueError(f"the table has {rows} rows, and {len(self.moved_rows)} move")
        start = float(self.history(np.zeros(())))
        if rows and abs(start) > 1.0e-9:
            raise ValueError(f"a travel must be 0 at t = 0, got {start:g} m")

    @property
    def telescopes(self) -> bool:
        """True if the travel moves a segment, not a load or an axial force."""
        return bool(self.moved_rows) and not self.shifts

    def transform(self, shapes: Array) -> Travel:
        """Return the travel in other coordinates b, with a = Φ b and Φ (num_modes, num_others)."""
        forces = [force.transform(shapes) for force in self.axial_forces]
        return replace(self, table=self.table.transform(shapes), axial_forces=forces)
