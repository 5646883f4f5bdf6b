# SPDX-License-Identifier: LGPL-3.0-or-later
"""Finite strip method for the buckling of prismatic thin-walled members (Cheung 1976).

Supports keep the shape of the ends of a member, and permit warping and rotation. The member buckles
in m half-waves along x: transverse displacements are proportional to sin(mπx/L), axial
displacements to cos(mπx/L). Across a strip in-plane displacements are linear, the deflection is
cubic, and the plate is a Kirchhoff plate. The method shares neither mesh nor interpolation nor
plate theory with the shell.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from scipy.linalg import eigh

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Material
from protractile.geometry.section import Section

# Normal stress along x in Pa, positive in tension, at y and z (num_places,) in m.
StressField = Callable[[Array, Array], Array]

# Gauss's rule across a strip, exact for products of cubics and a linear stress.
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(5)


class Strips(NamedTuple):
    """Finite strips of a closed section."""

    #: (num_strips, 2) positions (y, z) of the edges in m; the last edge is the next strip's first.
    first: Array
    last: Array
    thickness: Array  #: (num_strips,) in m
    material: Material

    @classmethod
    def of(cls, section: Section, material: Material, count: int = 12) -> Strips:
        """Create strips of the plates of a section, with a number of strips per plate."""
        lines = np.concatenate(
            [np.linspace(plate.start, plate.end, count + 1)[:-1] for plate in section.plates]
        )
        walls = np.repeat([plate.thickness for plate in section.plates], count)
        return cls(lines, np.roll(lines, -1, axis=0), walls, material)

    def factor(self, length: float, waves: int, stress: StressField) -> float:
        """Return the lowest load factor for a number of half-waves over a length in m."""
        size = 4 * len(self.first)
        stiffness, geometric_stiffness = np.zeros((2, size, size))
        for i in range(len(self.first)):
            dofs = np.add.outer(4 * np.array([i, (i + 1) % len(self.first)]), np.arange(4)).ravel()
            for total, part in zip(
                (stiffness, geometric_stiffness),
                self._strip(i, waves * np.pi / length, stress),
                strict=True,
            ):
                total[np.ix_(dofs, dofs)] += part
        (inverse,) = eigh(
            geometric_stiffness, stiffness, eigvals_only=True, subset_by_index=[size - 1] * 2
        )
        return float(1.0 / inverse)

    def lowest(self, length: float, waves: Iterable[int], stress: StressField) -> float:
        """Return the lowest load factor over several numbers of half-waves."""
        return min(self.factor(length, m, stress) for m in waves)

    def _strip(self, i: int, k: float, stress: StressField) -> tuple[Array, Array]:
        """Return stiffness and −K_G (8, 8) of a strip, divided by half its length.

        The degrees of freedom of each edge are the displacements along x, y and z, and the rotation
        about x; k is mπ/L.
        """
        t, young, nu = self.thickness[i], self.material.youngs_modulus, self.material.poissons_ratio
        across = self.last[i] - self.first[i]
        width = float(np.linalg.norm(across))
        c, s = across / width
        # Degrees of freedom of an edge: along x, in the plane of the strip, normal to it, rotation.
        one = np.array([[1.0, 0, 0, 0], [0, c, s, 0], [0, -s, c, 0], [0, 0, 0, 1.0]])
        turn = np.kron(np.eye(2), one)
        plane = young / (1.0 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, 0.5 * (1 - nu)]])
        stiffness, geometric_stiffness = np.zeros((2, 8, 8))
        for point, weight in zip(0.5 * (1.0 + _POINTS), 0.5 * width * _WEIGHTS, strict=True):
            u, v, w, dw, ddw = _shapes(point, width)
            du, dv = ((np.roll(one, 4) - one) / width for one in (_row(0), _row(1)))
            membrane = np.array([-k * u, dv, du + k * v])
            bending = np.array([k**2 * w, -ddw, 2.0 * k * dw])
            stiffness += weight * (
                t * membrane.T @ plane @ membrane + t**3 / 12.0 * bending.T @ plane @ bending
            )
            y, z = self.first[i] + point * across
            force = t * stress(np.array([y]), np.array([z]))[0]
            slopes = k * np.array([u, v, w])
            geometric_stiffness -= weight * force * slopes.T @ slopes
        return turn.T @ stiffness @ turn, turn.T @ geometric_stiffness @ turn


def _row(dof: int) -> Array:
    return np.asarray(np.eye(8)[dof])


def _shapes(p: float, width: float) -> tuple[Array, Array, Array, Array, Array]:
    """Return rows (8,) of u, v, w, w′ and w″ at a fraction p of the width of a strip."""
    u, v = ((1.0 - p) * _row(n) + p * _row(n + 4) for n in (0, 1))
    # Hermite's cubics, in which the rotation about x is the slope of the deflection.
    w = np.zeros((3, 8))
    w[:, 2] = 1 - 3 * p**2 + 2 * p**3, (6 * p**2 - 6 * p) / width, (12 * p - 6) / width**2
    w[:, 3] = width * (p - 2 * p**2 + p**3), 1 - 4 * p + 3 * p**2, (6 * p - 4) / width
    w[:, 6] = 3 * p**2 - 2 * p**3, (6 * p - 6 * p**2) / width, (6 - 12 * p) / width**2
    w[:, 7] = width * (p**3 - p**2), 3 * p**2 - 2 * p, (6 * p - 2) / width
    return u, v, w[0], w[1], w[2]
