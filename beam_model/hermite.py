# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cubic Hermite functions between nodes on an axis, and their integrals."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.sparse import csc_matrix

from protractile.geometry.arrays import Array

# Gauss points and weights, exact for products of two cubics.
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


class HermiteAxis:
    """Cubic Hermite functions between nodes in m; the end nodes of a closed axis coincide."""

    def __init__(self, nodes: Array, closed: bool) -> None:
        self.nodes = nodes
        num_dofs = 2 * (self.nodes.size - closed)
        identity = np.eye(num_dofs)[np.arange(2 * self.nodes.size) % num_dofs]
        self._shapes = CubicHermiteSpline(self.nodes, identity[::2], identity[1::2])
        self._sums = self._shapes.antiderivative()

    def integrals(self, weights: Array) -> list[csc_matrix]:
        """Return ∫ φφ, ∫ φ′φ′, ∫ φ″φ″ and ∫ φφ″ of the functions φ, each (num_dofs, num_dofs).

        Args:
            weights: factors (num_elements,) of the elements.
        """
        lengths = np.diff(self.nodes)[:, None]
        x = (self.nodes[:-1, None] + 0.5 * lengths * (1.0 + _PLACES)).ravel()
        scale = (0.5 * lengths * weights[:, None] * _WEIGHTS).ravel()[:, None]
        value, slope, curvature = (self._shapes(x, order) for order in range(3))
        pairs = (value, value), (slope, slope), (curvature, curvature), (value, curvature)
        return [csc_matrix((scale * left).T @ right) for left, right in pairs]

    def mean(self, start: float, end: float) -> Array:
        """Return the row (num_dofs,) of the mean value between two positions in m."""
        return np.asarray((self._sums(end) - self._sums(start)) / (end - start))

    def at(self, place: float) -> Array:
        """Return the row (num_dofs,) of the value at a position in m."""
        return np.asarray(self._shapes(place))
