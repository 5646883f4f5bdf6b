# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cubic Hermite functions between nodes on an axis, and their integrals."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.sparse import csc_matrix

from protractile.geometry.arrays import Array

# Gauss points and weights, exact for products of two cubics.
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


def sum_of_products(lefts: Sequence[Array], rights: Sequence[Array], free: Array) -> csc_matrix:
    """Return the sum of Kronecker products of sparse matrices, with the free unknowns alone.

    Args:
        lefts: matrices (num_lefts, num_lefts).
        rights: a matrix (num_rights, num_rights) for each of ``lefts``.
        free: whether each unknown (num_lefts · num_rights,) is free.
    """
    left, right = np.array(lefts), np.array(rights)
    of_left, of_right = left.any(axis=0).nonzero(), right.any(axis=0).nonzero()
    values = left[:, *of_left].T @ right[:, *of_right]
    number = np.where(free, np.cumsum(free) - 1, -1).reshape(left.shape[1], right.shape[1])
    row, column = (
        number[left[:, None], other].ravel() for left, other in zip(of_left, of_right, strict=True)
    )
    kept = (row >= 0) & (column >= 0)
    shape = (np.count_nonzero(free),) * 2
    return csc_matrix((values.ravel()[kept], (row[kept], column[kept])), shape)


class HermiteAxis:
    """Cubic Hermite functions between nodes in m; the end nodes of a closed axis coincide."""

    def __init__(self, nodes: Array, closed: bool) -> None:
        self.nodes = nodes
        num_dofs = 2 * (self.nodes.size - closed)
        identity = np.eye(num_dofs)[np.arange(2 * self.nodes.size) % num_dofs]
        self._shapes = CubicHermiteSpline(self.nodes, identity[::2], identity[1::2])
        self._sums = self._shapes.antiderivative()

    def integrals(self, weights: Array) -> list[Array]:
        """Return ∫ φφ, ∫ φ′φ′, ∫ φ″φ″ and ∫ φφ″ of the functions φ, each (num_dofs, num_dofs).

        Args:
            weights: factors (num_elements,) of the elements.
        """
        lengths = np.diff(self.nodes)[:, None]
        scale = (0.5 * lengths * weights[:, None] * _WEIGHTS).ravel()[:, None]
        value, slope, curvature = self._at_gauss_points
        pairs = (value, value), (slope, slope), (curvature, curvature), (value, curvature)
        return [np.asarray((scale * left).T @ right) for left, right in pairs]

    @cached_property
    def _at_gauss_points(self) -> list[Array]:
        """The functions and their first two derivatives, each (num_points, num_dofs)."""
        lengths = np.diff(self.nodes)[:, None]
        x = (self.nodes[:-1, None] + 0.5 * lengths * (1.0 + _PLACES)).ravel()
        return [self._shapes(x, order) for order in range(3)]

    def mean(self, start: float, end: float) -> Array:
        """Return the row (num_dofs,) of the mean value between two positions in m."""
        return np.asarray((self._sums(end) - self._sums(start)) / (end - start))

    def at(self, place: float) -> Array:
        """Return the row (num_dofs,) of the value at a position in m."""
        return np.asarray(self._shapes(place))
