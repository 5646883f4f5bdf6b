# SPDX-License-Identifier: LGPL-3.0-or-later
"""Components of the motion of a segment, and their natural modes.

The components are deflection along z, in 3-D booms also deflection along y and twist. They are
uncoupled in a straight segment with a symmetric section.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Literal, NamedTuple

import numpy as np
from scipy.linalg import eigh

from geometry.arrays import Array
from geometry.section import Direction

# Motions: deflection along z or y in m, rotation about x in rad.
Motion = Literal["z", "y", "twist"]


@dataclass(frozen=True, slots=True)
class Component:
    """Component of the motion of a segment: its matrices, load vectors, and rows at any x.

    Args:
        stiffness, mass, damping: matrices (num_dofs, num_dofs).
        load: load vector (num_dofs,) of the uniform load of the segment.
        unit_load: load vector (num_dofs,) of a uniform load of 1 N/m (1 N for twist).
        at: function of x in m that returns the row (num_dofs,) of the deflection or twist.
        rigid_modes: number of rigid modes.
        rotation: function of x in m that returns the row (num_dofs,) of the rotation β of the
            cross-section; None for twist.
        curvature: function of x in m that returns the row (num_dofs,) of β′; None for twist or a
            rigid segment.
        rotation_load: load vector (num_dofs,) of an angular acceleration of 1 rad/s² about
            x = 0; empty for twist.
        breaks: x in m between which rows are polynomials.
        geometric: geometric stiffness K_G (num_dofs, num_dofs) of the axial force; None without it.
        inertia_load: inertia load (num_dofs,) of a uniform acceleration that causes a mean load of
            1 N/m; ``unit_load`` unless given.
    """

    stiffness: Array
    mass: Array
    damping: Array
    load: Array
    unit_load: Array
    at: Callable[[float], Array]
    rigid_modes: int
    rotation: Callable[[float], Array] | None = None
    curvature: Callable[[float], Array] | None = None
    rotation_load: Array = field(default_factory=lambda: np.zeros(0))
    breaks: Array = field(default_factory=lambda: np.zeros(0))
    geometric: Array | None = None
    inertia_load: Array | None = None

    @property
    def geometric_stiffness(self) -> Array:
        """The geometric stiffness K_G (num_dofs, num_dofs), which reduces the stiffness."""
        return np.zeros_like(self.stiffness) if self.geometric is None else self.geometric

    @property
    def inertia(self) -> Array:
        """The inertia load (num_dofs,) of a uniform acceleration, as ``inertia_load``."""
        return self.unit_load if self.inertia_load is None else self.inertia_load

    def rotation_at(self, x: float) -> Array:
        """Return the row (num_dofs,) of the rotation β of the cross-section at x in m."""
        assert self.rotation is not None
        return self.rotation(x)

    def curvature_at(self, x: float) -> Array:
        """Return the row (num_dofs,) of β′ at x in m."""
        assert self.curvature is not None
        return self.curvature(x)

    @property
    def beam(self) -> BeamSegment:
        """The rows and load vectors of a segment with this component only, along z."""
        nothing = np.zeros(len(self.load))
        return BeamSegment(lambda motion, rule: rule(self) if motion == "z" else nothing)

    def uniform(self, span: tuple[float, float] | None) -> Array:
        """Return the load vector (num_dofs,) of 1 N/m between both x in m of ``span``.

        The load acts along the whole segment if ``span`` is None.
        """
        if span is None:
            return self.unit_load
        start, end = span
        inside = self.breaks[(self.breaks > start) & (self.breaks < end)]
        # The number of Gauss points is sufficient for the polynomials between breaks.
        points, weights = np.polynomial.legendre.leggauss(
            len(self.load) // max(1, self.breaks.size - 1) + 4
        )
        total = np.zeros(len(self.load))
        for a, b in pairwise([start, *inside, end]):
            for point, weight in zip(points, weights, strict=True):
                x = 0.5 * (a + b + point * (b - a))
                total += 0.5 * (b - a) * weight * self.at(x)
        return total


# Function that returns a row or load vector (num_dofs,) of a component.
Rule = Callable[[Component], Array]


@dataclass(frozen=True, slots=True)
class BeamSegment:
    """Rows and load vectors of a segment, a :class:`geometry.load.LoadedSegment`."""

    #: function (motion, row of a component) that returns the row (num_coordinates,); the second
    #: argument is a function that returns the row of a :class:`Component`
    read: Callable[[Motion, Rule], Array]

    def at(self, motion: Motion, x: float) -> Array:
        """Return the row (num_coordinates,) of a deflection, or of the twist, at x in m."""
        return self.read(motion, lambda component: component.at(x))

    def unit_load_vector(self, x: float, direction: Direction) -> Array:
        return self.at(direction, x)

    def moment(self, x: float, direction: Direction) -> Array:
        return self.read(direction, lambda component: component.rotation_at(x))

    def torque(self, x: float) -> Array:
        return self.at("twist", x)

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        return self.read(direction, lambda component: component.uniform(span))

    def inertia(self, direction: Direction, force: float) -> Array:
        return force * self.read(direction, lambda component: component.inertia)

    def rotation_load(self, direction: Direction) -> Array:
        return self.read(direction, lambda component: component.rotation_load)


@dataclass(frozen=True, slots=True)
class SegmentModel:
    """Components of a segment: ``z``, in 3-D booms also ``y`` and ``twist``."""

    components: Mapping[Motion, Component]


class Modes(NamedTuple):
    """Mass-normalised modes: ascending ω² in rad²/s², and shapes (num_dofs, num_modes)."""

    omega2: Array
    shapes: Array


def natural_modes(stiffness: Array, mass: Array, rigid_modes: int) -> Modes:
    """Return all natural modes of a stiffness and a mass matrix, with ω² = 0 for rigid modes."""
    if not mass.size:
        return Modes(np.zeros(0), np.zeros((0, 0)))
    # Coordinates are scaled, since rotations and deflections differ by orders of magnitude.
    scale = 1.0 / np.sqrt(np.diag(mass))
    scales = np.outer(scale, scale)
    # With the upper triangle, LAPACK reduces the largest entries of a series first, which preserves
    # the digits of the lowest modes.
    omega2, shapes = eigh(stiffness * scales, mass * scales, lower=False)
    omega2[:rigid_modes] = 0.0
    return Modes(omega2, shapes * scale[:, None])


def products(values: Array, weights: Array) -> Array:
    """Return ∫ f_i f_j dx for values (num_functions, num_points), weights (num_points,) in m."""
    return np.asarray((values * weights) @ values.T)
