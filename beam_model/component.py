# SPDX-License-Identifier: LGPL-3.0-or-later
"""Components of the motion of a segment, and their natural modes.

The components are deflection along z, in 3-D booms also deflection along y and twist. They are
uncoupled in a straight segment with a symmetric section.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import pairwise
from typing import Literal, NamedTuple, Protocol

import numpy as np
from scipy.linalg import eigh, null_space

from protractile.geometry.arrays import Array
from protractile.geometry.section import Direction

# Round-off, and the relative error by it above which the lowest ω² is computed from its compliance.
_EPS, _ACCURATE = float(np.finfo(np.float64).eps), 1.0e-4

# Motions: deflection along z or y in m, rotation about x in rad.
Motion = Literal["z", "y", "twist"]


class RowAt(Protocol):
    """Row (num_dofs,) of a component at x in m, for the order 0, 1 or 2."""

    def __call__(self, x: float, order: int = 0) -> Array: ...


@dataclass(frozen=True, slots=True, eq=False)
class Component:
    """Component of the motion of a segment: its matrices, load vectors, and rows at any x.

    Args:
        stiffness, mass, damping: matrices (num_dofs, num_dofs).
        load: load vector (num_dofs,) of the uniform load of the segment.
        at: function that returns the row (num_dofs,) of the deflection or twist (order 0), and for
            bending of the rotation β of the cross-section (order 1) and of β′ (order 2).
        rigid_modes: number of rigid modes.
        geometric_stiffness: K_G (num_dofs, num_dofs) of the axial force, which reduces the
            stiffness.
        unit_load: load vector (num_dofs,) of a uniform load of 1 N/m; empty for twist.
        slopes: w′ (num_points, num_dofs) at the Gauss points of elements; empty without elements.
        points: x and weights (2, num_points) in m of the Gauss points.
        rotation_load: load vector (num_dofs,) of an angular acceleration of 1 rad/s² about
            x = 0; empty for twist.
        inertia_load: inertia load (num_dofs,) of a uniform acceleration that causes a mean load of
            1 N/m; empty for twist.
        breaks: x in m between which rows are polynomials.
        bends: False for a rigid segment.
    """

    stiffness: Array
    mass: Array
    damping: Array
    load: Array
    at: RowAt
    rigid_modes: int
    geometric_stiffness: Array
    unit_load: Array = field(default_factory=lambda: np.zeros(0))
    rotation_load: Array = field(default_factory=lambda: np.zeros(0))
    inertia_load: Array = field(default_factory=lambda: np.zeros(0))
    breaks: Array = field(default_factory=lambda: np.zeros(0))
    slopes: Array = field(default_factory=lambda: np.zeros((0, 0)))
    points: Array = field(default_factory=lambda: np.zeros((2, 0)))
    bends: bool = True

    @property
    def beam(self) -> BeamSegment:
        """The rows and load vectors of a segment with this component only, along z."""
        nothing = np.zeros(len(self.load))
        return BeamSegment(lambda motion, rule: rule(self) if motion == "z" else nothing)

    def uniform(self, span: tuple[float, float] | None) -> Array:
        """Return the load vector (num_dofs,) of 1 N/m, see :class:`.load.LoadedSegment`."""
        if span is None:
            return self.unit_load
        return _partial_load(self, *span)


@lru_cache(maxsize=256)
def _partial_load(component: Component, start: float, end: float) -> Array:
    """Return the load vector (num_dofs,) of 1 N/m between two x in m, which kept models ask again.

    It is read-only.
    """
    inside = component.breaks[(component.breaks > start) & (component.breaks < end)]
    # The number of Gauss points is sufficient for the polynomials between breaks.
    points, weights = np.polynomial.legendre.leggauss(
        len(component.load) // max(1, component.breaks.size - 1) + 4
    )
    total = np.zeros(len(component.load))
    for a, b in pairwise([start, *inside, end]):
        for point, weight in zip(points, weights, strict=True):
            x = 0.5 * (a + b + point * (b - a))
            total += 0.5 * (b - a) * weight * component.at(x)
    total.flags.writeable = False
    return total


# Function that returns a row or load vector (num_dofs,) of a component.
Rule = Callable[[Component], Array]


@dataclass(frozen=True, slots=True)
class BeamSegment:
    """Rows and load vectors of a segment, a :class:`.geometry.load.LoadedSegment`."""

    #: function (motion, row of a component) that returns the row (num_coordinates,); the second
    #: argument is a function that returns the row of a :class:`Component`
    read: Callable[[Motion, Rule], Array]
    #: rows that were read: states of one boom ask for the same places again
    _rows: dict[tuple[Motion, float, int], Array] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def at(self, motion: Motion, x: float, order: int = 0) -> Array:
        """Return the row (num_coordinates,) at x in m of :attr:`Component.at`; it is read-only."""
        place = motion, x, order
        if place not in self._rows:
            row = self.read(motion, lambda component: component.at(x, order))
            row.flags.writeable = False
            self._rows[place] = row
        return self._rows[place]

    def unit_load_vector(self, x: float, direction: Direction) -> Array:
        return self.at(direction, x)

    def moment(self, x: float, direction: Direction) -> Array:
        return self.at(direction, x, 1)

    def torque(self, x: float) -> Array:
        return self.at("twist", x)

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        return self.read(direction, lambda component: component.uniform(span))

    def inertia(self, direction: Direction, force: float) -> Array:
        return force * self.read(direction, lambda component: component.inertia_load)

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
    shapes *= scale[:, None]
    elastic = omega2[rigid_modes:]
    if elastic.size and not _EPS * elastic[-1] < _ACCURATE * elastic[0]:
        omega2[rigid_modes:], shapes[:, rigid_modes:] = _elastic_modes(
            stiffness, mass, shapes[:, :rigid_modes]
        )
    return Modes(omega2, shapes)


def _elastic_modes(stiffness: Array, mass: Array, rigid: Array) -> tuple[Array, Array]:
    """Return ω² and shapes of the elastic modes from their compliance, not their stiffness.

    Round-off of the largest ω², which very short elements have, spoils the lowest modes of the
    stiffness. Here it spoils the largest ω² alone; the sum of the compliances φ φᵀ/ω² is accurate.

    Args:
        rigid: shapes (num_dofs, num_rigid_modes), orthonormal with the mass.
    """
    scale = 1.0 / np.sqrt(np.diag(mass))
    basis = null_space((scale[:, None] * mass @ rigid).T) if rigid.size else np.eye(len(mass))
    basis = scale[:, None] * basis
    own_stiffness, own_mass = basis.T @ stiffness @ basis, basis.T @ mass @ basis
    compliances, shapes = eigh(own_mass, own_stiffness)
    compliances = np.maximum(compliances, _EPS * compliances[-1])[::-1]
    return 1.0 / compliances, basis @ shapes[:, ::-1] / np.sqrt(compliances)


def products(values: Array, weights: Array) -> Array:
    """Return ∫ f_i f_j dx for values (num_functions, num_points), weights (num_points,) in m."""
    return np.asarray((values * weights) @ values.T)
