# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two-node beam elements that are exact at their nodes where nothing acts between them.

Both have the deflection w and the rotation θ as nodal unknowns. With Φ = 12 E J / (G A_s h²)
the shape functions of a plain element solve the homogeneous Timoshenko equations (Friedman and
Kosmatka 1993); at Φ = 0 they are the Hermite cubics with θ = w′. Where a segment tapers, the moment
is straight in the element as well, and the curvature what the local flexibility makes of it
(Eisenberger and Reich 1989).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np
from numpy.polynomial import Polynomial

from beam_model.component import products
from geometry.arrays import Array
from geometry.segment import Segment

Theory = Literal["euler-bernoulli", "timoshenko"]


class Element(Protocol):
    """Its shape functions at the parts ξ = x/h of its length h."""

    def deflection(self, xi: Array) -> tuple[Array, Array]:
        """Shape functions of w and their slopes w′, each (4, num_points)."""

    def rotation(self, xi: Array) -> tuple[Array, Array]:
        """Shape functions of θ and the curvatures θ′, each (4, num_points)."""

    def stiffness(self, xi: Array, weights: Array) -> Array:
        """(4, 4) by a rule of points ξ and weights in m, both (num_points,)."""


def element(segment: Segment, theory: Theory, start: float, h: float) -> Element:
    """That of a segment, or of its part from a node at x = ``start`` on, over h, both in m."""
    if segment.head_section is None:
        return PlainElement(h, segment.bending_stiffness, _shear_number(segment, theory, h))
    places = [segment.local(start + part * h) for part in (0.0, 0.5, 1.0)]
    bending = [1.0 / place.bending_stiffness for place in places]
    shear = [_shear_flexibility(place, theory) for place in places]
    return TaperedElement(h, _parabola(bending), _parabola(shear))


@dataclass(frozen=True, slots=True)
class PlainElement:
    """Of one section.

    Args:
        h: its length in m.
        bending_stiffness: E J in N·m².
        phi: Φ, zero for a beam that is rigid in shear.
    """

    h: float
    bending_stiffness: float
    phi: float

    def deflection(self, xi: Array) -> tuple[Array, Array]:
        h, phi = self.h, self.phi
        w = np.array(
            [
                1.0 - 3.0 * xi**2 + 2.0 * xi**3 + phi * (1.0 - xi),
                h * (xi - 2.0 * xi**2 + xi**3 + 0.5 * phi * (xi - xi**2)),
                3.0 * xi**2 - 2.0 * xi**3 + phi * xi,
                h * (-(xi**2) + xi**3 - 0.5 * phi * (xi - xi**2)),
            ]
        )
        slope = np.array(
            [
                (-6.0 * xi + 6.0 * xi**2 - phi) / h,
                1.0 - 4.0 * xi + 3.0 * xi**2 + 0.5 * phi * (1.0 - 2.0 * xi),
                (6.0 * xi - 6.0 * xi**2 + phi) / h,
                -2.0 * xi + 3.0 * xi**2 - 0.5 * phi * (1.0 - 2.0 * xi),
            ]
        )
        return w / (1.0 + phi), slope / (1.0 + phi)

    def rotation(self, xi: Array) -> tuple[Array, Array]:
        h, phi = self.h, self.phi
        theta = np.array(
            [
                6.0 * (xi**2 - xi) / h,
                1.0 - 4.0 * xi + 3.0 * xi**2 + phi * (1.0 - xi),
                6.0 * (xi - xi**2) / h,
                -2.0 * xi + 3.0 * xi**2 + phi * xi,
            ]
        )
        curvature = np.array(
            [
                6.0 * (2.0 * xi - 1.0) / h**2,
                (-4.0 + 6.0 * xi - phi) / h,
                6.0 * (1.0 - 2.0 * xi) / h**2,
                (-2.0 + 6.0 * xi + phi) / h,
            ]
        )
        return theta / (1.0 + phi), curvature / (1.0 + phi)

    def stiffness(self, xi: Array, weights: Array) -> Array:
        _, slope = self.deflection(xi)
        theta, curvature = self.rotation(xi)
        bending = self.bending_stiffness * products(curvature, weights)
        if self.phi == 0.0:
            return bending
        shear_stiffness = 12.0 * self.bending_stiffness / (self.phi * self.h**2)
        return bending + shear_stiffness * products(slope - theta, weights)


@dataclass(frozen=True, slots=True)
class TaperedElement:
    """Of sections between two: under the moments 1 and ξ its curvature is f and ξ f, its shear
    strain 0 and −g/h, which integrated make θ and w.

    Args:
        h: its length in m.
        bending: f = 1/(E J) over ξ in 1/(N·m²).
        shear: g = 1/(G A_s) over ξ in 1/N, zero for a beam that is rigid in shear.
    """

    h: float
    bending: Polynomial
    shear: Polynomial

    def deflection(self, xi: Array) -> tuple[Array, Array]:
        zero, one = np.zeros_like(xi), np.ones_like(xi)
        _, slopes, deflections = self._of_moments()
        bent = _at(deflections, xi), _at(slopes, xi)
        w = np.array([one, self.h * xi, zero, zero]) + self._moments().T @ bent[0]
        return w, np.array([zero, one, zero, zero]) + self._moments().T @ bent[1]

    def rotation(self, xi: Array) -> tuple[Array, Array]:
        zero, one = np.zeros_like(xi), np.ones_like(xi)
        rotations, _, _ = self._of_moments()
        theta = np.array([zero, one, zero, zero]) + self._moments().T @ _at(rotations, xi)
        return theta, self._moments().T @ (self.bending(xi) * np.array([one, xi]))

    def stiffness(self, xi: Array, weights: Array) -> Array:
        moments = np.array([np.ones_like(xi), xi])
        sheared = np.array([[0.0, 0.0], [0.0, (self.shear(xi) / self.h**2) @ weights]])
        flexibility = products(moments, self.bending(xi) * weights) + sheared
        return np.asarray(self._moments().T @ flexibility @ self._moments())

    def _of_moments(self) -> tuple[_Pair, _Pair, _Pair]:
        """Rotations, slopes and deflections under the moments 1 and ξ, clamped at ξ = 0."""
        first, second = (self.h * (self.bending * m).integ() for m in (_ONE, _XI))
        slopes = first, second - self.shear / self.h
        return (first, second), slopes, (self.h * slopes[0].integ(), self.h * slopes[1].integ())

    def _moments(self) -> Array:
        """(2, 4) the moments 1 and ξ that unit displacements of the nodes make."""
        rotations, _, deflections = self._of_moments()
        ends = np.array([[p(1.0) for p in pair] for pair in (rotations, deflections)])
        moved = np.array([[0.0, -1.0, 0.0, 1.0], [-1.0, -self.h, 1.0, 0.0]])
        return np.asarray(np.linalg.solve(ends, moved))


_Pair = tuple[Polynomial, Polynomial]
_ONE, _XI = Polynomial([1.0]), Polynomial([0.0, 1.0])


def _at(pair: _Pair, xi: Array) -> Array:
    return np.array([one(xi) for one in pair])


def _parabola(values: list[float]) -> Polynomial:
    """Through values at ξ = 0, 1/2 and 1."""
    start, middle, end = values
    return Polynomial([start, 4.0 * middle - 3.0 * start - end, 2.0 * (start + end) - 4.0 * middle])


def _shear_flexibility(segment: Segment, theory: Theory) -> float:
    """1/(G A_s) in 1/N, zero for a beam that is rigid in shear."""
    if theory == "euler-bernoulli" or segment.section is None:
        return 0.0
    return 1.0 / (segment.material.shear_modulus * segment.section.shear_area)


def _shear_number(segment: Segment, theory: Theory, h: float) -> float:
    """Φ = 12 E J / (G A_s h²), zero for a beam that is rigid in shear."""
    shear_stiffness = segment.shear_stiffness
    if theory == "euler-bernoulli" or shear_stiffness is None:
        return 0.0
    return 12.0 * segment.bending_stiffness / (shear_stiffness * h**2)
