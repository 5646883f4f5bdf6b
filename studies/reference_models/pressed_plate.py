# SPDX-License-Identifier: LGPL-3.0-or-later
"""A rectangular plate under a patch of uniform pressure: as a shell, and by plate theory.

The wall of a box under a slide pad is such a plate, between simply supported and clamped edges.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.polynomial import legendre

from geometry.arrays import Array
from studies.reference_models.benchmarks import X, Y, Z, grid
from studies.reference_models.plates import STEEL, rectangle, rigidities
from studies.reference_models.static_shell import StaticShell, hold

Edges = Literal["simply supported", "clamped"]

# Polynomials of each field along each side: eight more change the compliance by 1e-3 at most.
DEGREES = 20


@dataclass(frozen=True, slots=True)
class PressedPlate:
    """A plate of steel on [0, length] × [0, width], pressed across.

    Args:
        length, width: in m.
        thickness: in m.
        start, end: (x, y) in m of the patch's corners.
        edges: all four; simple supports are hard ones, which keep the direction of an edge.
    """

    length: float
    width: float
    thickness: float
    start: tuple[float, float]
    end: tuple[float, float]
    edges: Edges

    def shell(self, size: float) -> float:
        """Mean deflection of the patch under a unit force spread over it, in m/N, by the shell.

        Args:
            size: edge length in m, of which sides and places of the patch are whole multiples.
        """
        sides = (self.length, self.width)
        points, triangles = grid(rectangle(*sides), *(round(side / size) for side in sides))
        shell = StaticShell(points, triangles, self.thickness, STEEL)
        middles = points[triangles].mean(axis=1)[:, :2]
        pressed = ((middles > self.start) & (middles < self.end)).all(axis=1)
        area = (self.end[0] - self.start[0]) * (self.end[1] - self.start[1])
        load = shell.surface_load(np.array([0.0, 0.0, 1.0 / area]), on=pressed)
        held = hold(shell.node_dofs[:, [X, Y]])
        for axis, side in ((X, self.length), (Y, self.width)):
            for edge in (0.0, side):
                turned = [X, Y] if self.edges == "clamped" else [axis]
                held |= shell.hold_at(axis, edge, [Z], turned)
        held |= hold(shell.rotation_dofs[:, Z])
        return float(load @ shell.solve(held, load))

    def theory(self) -> float:
        """The same of the plate of Reissner and Mindlin, by Ritz's method (1909).

        Deflection and slopes are polynomials that keep the supports.
        """
        nu, (plate, shear) = STEEL.poissons_ratio, rigidities(self.thickness)
        (x, along), (y, over) = (_gauss(0.0, side) for side in (self.length, self.width))
        free = self.edges == "simply supported"
        deflection = _Field.of(self, x, y, (False, False))
        slope_x, slope_y = (_Field.of(self, x, y, ends) for ends in ((free, False), (False, free)))
        none = np.zeros_like(deflection.values)
        curved_x = np.concatenate([none, slope_x.along_x, none])
        curved_y = np.concatenate([none, none, slope_y.along_y])
        twisted = np.concatenate([none, slope_x.along_y, slope_y.along_x])
        sheared_x = np.concatenate([deflection.along_x, -slope_x.values, none])
        sheared_y = np.concatenate([deflection.along_y, none, -slope_y.values])
        weights = np.outer(along, over).ravel()
        stiffness = sum(
            modulus * (one * weights) @ other.T
            for modulus, one, other in (
                (plate, curved_x, curved_x + nu * curved_y),
                (plate, curved_y, curved_y + nu * curved_x),
                (0.5 * (1.0 - nu) * plate, twisted, twisted),
                (shear, sheared_x, sheared_x),
                (shear, sheared_y, sheared_y),
            )
        )
        (x, along), (y, over) = map(_gauss, self.start, self.end)
        pressed = _Field.of(self, x, y, (False, False)).values @ np.outer(along, over).ravel()
        load = np.concatenate([pressed, np.zeros(2 * pressed.size)]) / (along.sum() * over.sum())
        return float(load @ np.linalg.solve(stiffness, load))

    def navier(self, terms: int = 400) -> float:
        """The same on simple supports, as a double series of sines (Navier 1823; with the shear of
        Reissner and Mindlin, whose plate bends alike between such supports).
        """
        plate, shear = rigidities(self.thickness)
        waves = np.pi * np.arange(1, terms + 1)
        means = [
            (np.cos(waves * first / side) - np.cos(waves * last / side)) * side
            / (waves * (last - first))
            for side, first, last in zip(
                (self.length, self.width), self.start, self.end, strict=True
            )
        ]  # fmt: skip
        k2 = np.add.outer((waves / self.length) ** 2, (waves / self.width) ** 2)
        given = 4.0 / (self.length * self.width) * (1.0 / (plate * k2**2) + 1.0 / (shear * k2))
        return float((given * np.outer(*means) ** 2).sum())


class _Field(NamedTuple):
    """Products of polynomials and their slopes, (num_functions, num_points) each."""

    values: Array
    along_x: Array
    along_y: Array

    @classmethod
    def of(cls, plate: PressedPlate, x: Array, y: Array, free: tuple[bool, bool]) -> _Field:
        """At places (num_x,) and (num_y,); zero at the ends of a side that are not free."""
        (f, df), (g, dg) = (
            _polynomials(places, side, ends)
            for places, side, ends in zip((x, y), (plate.length, plate.width), free, strict=True)
        )
        return cls(np.kron(f, g), np.kron(df, g), np.kron(f, dg))


def flange(edges: Edges) -> PressedPlate:
    """Nearly the outer flange of the paper's boom, 0.3 m wide, under a pad beside its web."""
    return PressedPlate(0.6, 0.3, 6.64e-3, (0.25, 0.025), (0.35, 0.075), edges)


def _polynomials(places: Array, side: float, free: bool) -> tuple[Array, Array]:
    """(num_polynomials, num_places) values and slopes of Legendre's, or of differences of these
    that vanish at both ends.
    """
    ones = np.eye(DEGREES + 2)
    coefficients = ones[:-2] if free else ones[2:] - ones[:-2]
    at = 2.0 * places / side - 1.0
    slopes = legendre.legder(coefficients, axis=1)
    return legendre.legval(at, coefficients.T), 2.0 / side * legendre.legval(at, slopes.T)


def _gauss(start: float, end: float) -> tuple[Array, Array]:
    """Places and weights of Gauss's rule, exact for products of the polynomials."""
    nodes, weights = legendre.leggauss(DEGREES + 2)
    half = 0.5 * (end - start)
    return start + half * (nodes + 1.0), half * weights
