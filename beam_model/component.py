# SPDX-License-Identifier: LGPL-3.0-or-later
"""Components of a segment's motion in finitely many coordinates, and their natural modes.

A segment deflects along z, and in space deflects along y and twists as well. Within a straight
segment of a symmetric section the three are uncoupled.
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

# Deflection along z or along y in m, rotation about x in rad.
Motion = Literal["z", "y", "twist"]


@dataclass(frozen=True, slots=True)
class Component:
    """Equations M q̈ + C q̇ + K q = f, with rows that read the component anywhere.

    Args:
        stiffness, mass, damping: (num_dofs, num_dofs).
        load: (num_dofs,) the segment's own uniform load.
        unit_load: (num_dofs,) a uniform load of one N/m (of one N for the twist).
        inertia_load: (num_dofs,) inertia of the mass per length under an acceleration that makes it
            1 N/m, on average where it tapers; ``unit_load`` unless given.
        at: x in m → (num_dofs,) row that reads the deflection or twist there.
        rotation: x in m → (num_dofs,) row that reads the rotation of the cross-section there, the
            slope of a beam that is rigid in shear; none of a twist.
        curvature: x in m → (num_dofs,) row that reads θ′ of that rotation there; none of a twist,
            and of what does not bend.
        turning: (num_dofs,) the momentum that turning about x = 0 by 1 rad/s gives the mass per
            length and the rotary inertia, in N·s; none of a twist.
        breaks: x in m between which rows are polynomials.
        geometric: (num_dofs, num_dofs) K_G, what the axial force takes from the stiffness; none
            where there is no such force.
        rigid_modes: how many motions the supports leave free of strain.
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
    turning: Array = field(default_factory=lambda: np.zeros(0))
    breaks: Array = field(default_factory=lambda: np.zeros(0))
    geometric: Array | None = None
    inertia_load: Array | None = None

    @property
    def softening(self) -> Array:
        """Geometric stiffness K_G (num_dofs, num_dofs)."""
        return np.zeros_like(self.stiffness) if self.geometric is None else self.geometric

    @property
    def inertia(self) -> Array:
        """Load vector (num_dofs,) of an acceleration of the mass per length, for any component."""
        return self.unit_load if self.inertia_load is None else self.inertia_load

    def rotation_at(self, x: float) -> Array:
        """Return the row (num_dofs,) that reads the rotation of the cross-section at x in m."""
        assert self.rotation is not None
        return self.rotation(x)

    def curvature_at(self, x: float) -> Array:
        """Return the row (num_dofs,) that reads θ′ at x in m."""
        assert self.curvature is not None
        return self.curvature(x)

    @property
    def member(self) -> BeamMember:
        """Segment under loads, which moves along z alone by this component."""
        nothing = np.zeros(len(self.load))
        return BeamMember(lambda motion, rule: rule(self) if motion == "z" else nothing)

    def uniform(self, span: tuple[float, float] | None) -> Array:
        """Return (num_dofs,) a uniform load of 1 N/m between two x in m, or along the segment."""
        if span is None:
            return self.unit_load
        start, end = span
        inside = self.breaks[(self.breaks > start) & (self.breaks < end)]
        # Gauss points are exact for polynomials of each degree that a piece can have.
        points, weights = np.polynomial.legendre.leggauss(
            len(self.load) // max(1, self.breaks.size - 1) + 4
        )
        total = np.zeros(len(self.load))
        for a, b in pairwise([start, *inside, end]):
            for point, weight in zip(points, weights, strict=True):
                x = 0.5 * (a + b + point * (b - a))
                total += 0.5 * (b - a) * weight * self.at(x)
        return total


# Row or load vector of a component: (num_dofs,) of its own.
Rule = Callable[[Component], Array]


@dataclass(frozen=True, slots=True)
class BeamMember:
    """A segment under loads, see :class:`geometry.load.Member`, in any coordinates.

    Args:
        read: (num_coordinates,) the row of a component of a motion by a rule.
    """

    read: Callable[[Motion, Rule], Array]

    def at(self, motion: Motion, x: float) -> Array:
        """Return the row (num_coordinates,) of a deflection in m or the twist in rad at x in m."""
        return self.read(motion, lambda component: component.at(x))

    def force(self, x: float, direction: Direction) -> Array:
        return self.at(direction, x)

    def moment(self, x: float, direction: Direction) -> Array:
        return self.read(direction, lambda component: component.rotation_at(x))

    def torque(self, x: float) -> Array:
        return self.at("twist", x)

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        return self.read(direction, lambda component: component.uniform(span))

    def inertia(self, direction: Direction, force: float) -> Array:
        return force * self.read(direction, lambda component: component.inertia)

    def turning(self, direction: Direction) -> Array:
        return self.read(direction, lambda component: component.turning)


@dataclass(frozen=True, slots=True)
class SegmentModel:
    """Components of a segment: ``z`` alone, or in space ``z``, ``y`` and ``twist``."""

    components: Mapping[Motion, Component]


class Modes(NamedTuple):
    """Mass-normalised modes: ω² in rad²/s², rising, and the shapes (num_dofs, num_modes)."""

    omega2: Array
    shapes: Array


def natural_modes(stiffness: Array, mass: Array, rigid_modes: int) -> Modes:
    """Return all natural modes of (K, M), rigid ones with ω² exactly 0; none if nothing moves."""
    if not mass.size:
        return Modes(np.zeros(0), np.zeros((0, 0)))
    # A common scale per coordinate: rotations and deflections differ by orders of magnitude.
    scale = 1.0 / np.sqrt(np.diag(mass))
    scales = np.outer(scale, scale)
    # The upper triangle: where degrees rise from term to term, the reduction begins with the
    # largest entries and leaves the lowest modes their digits.
    omega2, shapes = eigh(stiffness * scales, mass * scales, lower=False)
    omega2[:rigid_modes] = 0.0
    return Modes(omega2, shapes * scale[:, None])


def products(values: Array, weights: Array) -> Array:
    """Return ∫ f_i f_j dx from values (num_functions, num_points) and weights of the rule in m."""
    return np.asarray((values * weights) @ values.T)
