# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two-node beam elements, which are exact at their nodes if no load acts between them.

The nodal unknowns are the deflection w and the rotation β of the cross-section. The shape functions
of a prismatic element of length ℓ_e solve the homogeneous Timoshenko equations (Friedman and
Kosmatka 1993). The shear parameter is Φ_s = 12 E J / (G A_s ℓ_e²); for Φ_s = 0 they are the Hermite
cubics with β = w′. In a tapered element, the moment is also linear, and the curvature follows from
the local flexibility (Eisenberger and Reich 1989).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Literal

import numpy as np
from numpy.polynomial import Polynomial

from protractile.beam_model.component import products
from protractile.geometry.arrays import Array
from protractile.geometry.segment import Segment

Theory = Literal["euler-bernoulli", "timoshenko"]

# Gauss points and weights from ξ = 0 to 1, exact for products of two cubics.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(4)
GAUSS = 0.5 * (_POINTS + 1.0), 0.5 * _WEIGHTS


def element(segment: Segment, theory: Theory, start: float, h: float) -> Element:
    """Return the element of a segment from x = ``start`` over the length ``h``, both in m."""
    places = [segment]
    if segment.head_section is not None:
        places = [segment.prismatic_at(start + part * h) for part in (0.0, 0.5, 1.0)]
    stiffnesses = [
        None if theory == "euler-bernoulli" else place.shear_stiffness for place in places
    ]
    if segment.head_section is None:
        shear, bending = stiffnesses[0], segment.bending_stiffness
        return PrismaticElement(h, bending, 12.0 * bending / (shear * h**2) if shear else 0.0)
    flexibilities = [1.0 / shear if shear else 0.0 for shear in stiffnesses]
    bent = _parabola([1.0 / place.bending_stiffness for place in places])
    return TaperedElement(h, bent, _parabola(flexibilities))


@lru_cache(maxsize=256)
def quadrature(element: Element) -> tuple[Array, Array, Array, Array, Array]:
    """Return the weights in m and the shape functions of w, w′ and β (4, num_points) at the Gauss
    points, and the stiffness (4, 4). Equal elements share them.
    """
    xi, weights = GAUSS[0], element.h * GAUSS[1]
    shapes = element.deflection(xi), element.slope(xi), element.rotation(xi)
    return weights, *shapes, element.stiffness(xi, weights)


@dataclass(frozen=True, slots=True)
class PrismaticElement:
    """Shape functions of a prismatic element at ξ = x/ℓ_e, with x from its first node."""

    h: float  #: length in m
    bending_stiffness: float  #: E J in N·m²
    phi: float  #: Φ_s, zero for an Euler–Bernoulli beam

    def deflection(self, xi: Array) -> Array:
        """Return the shape functions (4, num_points) of w."""
        h, phi, (one, square, cube) = self.h, self.phi, _powers(xi)
        shear_part = 0.5 * phi * (one - square)
        w = np.array(
            [
                1.0 - 3.0 * square + 2.0 * cube + phi * (1.0 - one),
                h * (one - 2.0 * square + cube + shear_part),
                3.0 * square - 2.0 * cube + phi * one,
                h * (-square + cube - shear_part),
            ]
        )
        return w / (1.0 + phi)

    def slope(self, xi: Array) -> Array:
        """Return the derivatives w′ (4, num_points) of the shape functions."""
        h, phi, (one, square, _) = self.h, self.phi, _powers(xi)
        shear_part = 0.5 * phi * (1.0 - 2.0 * one)
        slope = np.array(
            [
                (-6.0 * one + 6.0 * square - phi) / h,
                1.0 - 4.0 * one + 3.0 * square + shear_part,
                (6.0 * one - 6.0 * square + phi) / h,
                -2.0 * one + 3.0 * square - shear_part,
            ]
        )
        return slope / (1.0 + phi)

    def rotation(self, xi: Array) -> Array:
        """Return the shape functions (4, num_points) of β."""
        h, phi, (one, square, _) = self.h, self.phi, _powers(xi)
        theta = np.array(
            [
                6.0 * (square - one) / h,
                1.0 - 4.0 * one + 3.0 * square + phi * (1.0 - one),
                6.0 * (one - square) / h,
                -2.0 * one + 3.0 * square + phi * one,
            ]
        )
        return theta / (1.0 + phi)

    def curvature(self, xi: Array) -> Array:
        """Return the derivatives β′ (4, num_points) of the shape functions."""
        h, phi, (one, _, _) = self.h, self.phi, _powers(xi)
        curvature = np.array(
            [
                6.0 * (2.0 * one - 1.0) / h**2,
                (-4.0 + 6.0 * one - phi) / h,
                6.0 * (1.0 - 2.0 * one) / h**2,
                (-2.0 + 6.0 * one + phi) / h,
            ]
        )
        return curvature / (1.0 + phi)

    def stiffness(self, xi: Array, weights: Array) -> Array:
        """Return the stiffness (4, 4) by quadrature with points ξ and weights in m."""
        bending = self.bending_stiffness * products(self.curvature(xi), weights)
        if self.phi == 0.0:
            return bending
        shear_stiffness = 12.0 * self.bending_stiffness / (self.phi * self.h**2)
        return bending + shear_stiffness * products(self.slope(xi) - self.rotation(xi), weights)


@dataclass(frozen=True, eq=False)
class TaperedElement:
    """Element with a varying section, with the methods of :class:`PrismaticElement`.

    The moments 1 and ξ cause the curvatures f and ξ f and the shear strains 0 and −g/ℓ_e, with the
    flexibilities f and g. Integration gives β and w.
    """

    h: float  #: length in m
    bending: Polynomial  #: f = 1/(E J) as a function of ξ in 1/(N·m²)
    shear: Polynomial  #: g = 1/(G A_s) as a function of ξ in 1/N, zero for an Euler–Bernoulli beam

    def deflection(self, xi: Array) -> Array:
        return self._shapes((1.0, self.h * xi), self._of_moments[2], xi)

    def slope(self, xi: Array) -> Array:
        return self._shapes((0.0, 1.0), self._of_moments[1], xi)

    def rotation(self, xi: Array) -> Array:
        return self._shapes((0.0, 1.0), self._of_moments[0], xi)

    def curvature(self, xi: Array) -> Array:
        return np.asarray(self._moments.T @ (self.bending(xi) * np.array([np.ones_like(xi), xi])))

    def stiffness(self, xi: Array, weights: Array) -> Array:
        moments = np.array([np.ones_like(xi), xi])
        shear_flexibility = np.array([[0.0, 0.0], [0.0, (self.shear(xi) / self.h**2) @ weights]])
        flexibility = products(moments, self.bending(xi) * weights) + shear_flexibility
        unit_moments = self._moments
        return np.asarray(unit_moments.T @ flexibility @ unit_moments)

    def _shapes(self, rigid: tuple[float | Array, ...], bent: _Pair, xi: Array) -> Array:
        """Return shape functions (4, num_points): rigid motion of the first node, plus bending."""
        rigid_motion = np.array(
            [np.broadcast_to(component, xi.shape) for component in (*rigid, 0.0, 0.0)]
        )
        return np.asarray(
            rigid_motion + self._moments.T @ np.array([bending(xi) for bending in bent])
        )

    @cached_property
    def _of_moments(self) -> tuple[_Pair, _Pair, _Pair]:
        """The rotation, slope and deflection under the moments 1 and ξ, clamped at ξ = 0."""
        first, second = (self.h * (self.bending * m).integ() for m in (_ONE, _XI))
        slopes = first, second - self.shear / self.h
        return (first, second), slopes, (self.h * slopes[0].integ(), self.h * slopes[1].integ())

    @cached_property
    def _moments(self) -> Array:
        """The factors (2, 4) of the moments 1 and ξ for unit displacements of the nodes."""
        rotations, _, deflections = self._of_moments
        ends = np.array([[p(1.0) for p in pair] for pair in (rotations, deflections)])
        displacements = np.array([[0.0, -1.0, 0.0, 1.0], [-1.0, -self.h, 1.0, 0.0]])
        return np.asarray(np.linalg.solve(ends, displacements))


def _powers(xi: Array) -> tuple[Any, Any, Any]:
    """Return ξ, ξ² and ξ³, for a single ξ as Python numbers, which are faster."""
    powers = xi, xi**2, xi**3
    return powers if xi.ndim else (xi.item(), powers[1].item(), powers[2].item())


Element = PrismaticElement | TaperedElement

_Pair = tuple[Polynomial, Polynomial]
_ONE, _XI = Polynomial([1.0]), Polynomial([0.0, 1.0])


def _parabola(values: list[float]) -> Polynomial:
    """Return the parabola through values at ξ = 0, 1/2 and 1."""
    start, middle, end = values
    return Polynomial([start, 4.0 * middle - 3.0 * start - end, 2.0 * (start + end) - 4.0 * middle])
