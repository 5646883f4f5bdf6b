# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cubic Hermite functions between nodes on an axis, and their integrals."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.polynomial.polynomial import polyder, polyint, polyval
from scipy.sparse import csc_matrix

from protractile.geometry.arrays import Array, Indices

# Gauss points and weights, exact for products of two cubics.
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(4)
# Coefficients of 1, t, t², t³ of the four functions of an element of unit length, in rows: value
# and slope at its start, value and slope at its end.
_FUNCTIONS = np.array([[1.0, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]])
# Coefficients of their derivatives, in columns, by order; −1 is the integral from the start.
_POWERS = {order: polyder(_FUNCTIONS, order, axis=1).T for order in range(3)}
_POWERS[-1] = polyint(_FUNCTIONS, axis=1).T


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
        self._lengths = np.diff(nodes)
        self._num_dofs = 2 * (nodes.size - closed)
        elements = np.arange(nodes.size - 1)
        #: values and slopes at both ends of each element (num_elements, 4)
        self._dofs = (2 * elements[:, None] + np.arange(4)) % self._num_dofs
        whole = self._rows(elements, self._values(elements, np.ones(elements.size), -1))
        self._sums = np.concatenate([np.zeros((1, self._num_dofs)), np.cumsum(whole, axis=0)])

    def integrals(self, weights: Array) -> list[Array]:
        """Return ∫ φφ, ∫ φ′φ′, ∫ φ″φ″ and ∫ φφ″ of the functions φ, each (num_dofs, num_dofs).

        Args:
            weights: factors (num_elements,) of the elements.
        """
        value, slope, curvature = self._at_gauss_points
        scale = 0.5 * (self._lengths * weights)[:, None] * _WEIGHTS
        at = self._dofs[:, :, None], self._dofs[:, None, :]
        pairs = (value, value), (slope, slope), (curvature, curvature), (value, curvature)
        integrals = np.zeros((len(pairs), self._num_dofs, self._num_dofs))
        for total, (left, right) in zip(integrals, pairs, strict=True):
            np.add.at(total, at, (scale * left).transpose(1, 0, 2) @ right.transpose(1, 2, 0))
        return list(integrals)

    @cached_property
    def _at_gauss_points(self) -> list[Array]:
        """The functions and their first two derivatives, each (4, num_elements, num_points)."""
        elements = np.repeat(np.arange(self._lengths.size), _PLACES.size)
        part = np.tile(0.5 * (1.0 + _PLACES), self._lengths.size)
        shape = 4, self._lengths.size, _PLACES.size
        return [self._values(elements, part, order).reshape(shape) for order in range(3)]

    def mean(self, start: float, end: float) -> Array:
        """Return the row (num_dofs,) of the mean value between two positions in m."""
        elements, parts = self._place(np.array([start, end]))
        within = self._rows(elements, self._values(elements, parts, -1))
        low, high = self._sums[elements] + within
        return np.asarray((high - low) / (end - start))

    def at(self, place: float) -> Array:
        """Return the row (num_dofs,) of the value at a position in m."""
        elements, parts = self._place(np.array([place]))
        return np.asarray(self._rows(elements, self._values(elements, parts, 0))[0])

    def _place(self, x: Array) -> tuple[Indices, Array]:
        """Return element and relative position in it of positions (num_places,) in m."""
        after = np.searchsorted(self.nodes, x, "right") - 1
        elements = np.clip(after, 0, self._lengths.size - 1)
        return elements, (x - self.nodes[elements]) / self._lengths[elements]

    def _values(self, elements: Indices, parts: Array, order: int) -> Array:
        """Return a derivative (4, num_places) of the functions of elements at relative positions.

        The ``order`` −1 is the integral from the start of the element.
        """
        lengths = self._lengths[elements]
        values = polyval(parts, _POWERS[order]) / lengths**order
        # Slopes are unknowns per metre.
        values[1::2] *= lengths
        return np.asarray(values)

    def _rows(self, elements: Indices, values: Array) -> Array:
        """Return the rows (num_places, num_dofs) of values (4, num_places) in elements."""
        rows = np.zeros((elements.size, self._num_dofs))
        rows[np.arange(elements.size)[:, None], self._dofs[elements]] = values.T
        return rows
