# SPDX-License-Identifier: LGPL-3.0-or-later
"""The Kantorovich (semi-discrete Ritz) beam: w(x, t) = Σ a_i(t) φ_i(x), (12) of the paper.

The function spaces are (29)–(31) of the paper. The paper's functions are powers of x, which are
numerically dependent from about ten terms on. Here products of the lowest function and Legendre
polynomials span the same spaces. The complete basis has all polynomials that the supports admit.
Its rigid motions alone describe a segment as a rigid body on elastic supports and contacts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from operator import attrgetter
from typing import Literal

import numpy as np
from numpy.polynomial import Legendre, Polynomial
from scipy.linalg import null_space, rq

from protractile.beam_model.component import Component, Motion, SegmentModel, products
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, BoomError, Segment
from protractile.geometry.compression import Compression

# Number of additional quadrature points for tapered segments.
_TAPERING = 6

Base = Literal["as printed", "pinned", "complete"]


def kantorovich_segments(
    boom: Boom, terms: Sequence[int], base: Base, rotary_inertia: bool
) -> list[SegmentModel]:
    """Return the models of all segments of a boom; ``terms`` is the number of terms of each.

    Other arguments as in :func:`kantorovich_segment`.

    Raises:
        BoomError: the basis does not admit the boom's supports or cylinders.
    """
    check_base(boom, base)
    return [
        kantorovich_segment(segment, count, base, rotary_inertia)
        for segment, count in zip(boom.segments, terms, strict=True)
    ]


def check_base(boom: Boom, base: Base) -> None:
    """Check that a basis admits the supports of the boom.

    Raises:
        BoomError: clamped or elastic supports, or a cylinder, require the complete basis.
    """
    for segment in boom.segments:
        _check_supports(segment, base)
        if boom.spatial:
            _check_supports(segment.turned(), base)
    if boom.cylinders and base != "complete":
        raise _unsupported(boom.segments[boom.cylinders[0].segment], "a cylinder", base)


def _check_supports(segment: Segment, base: Base) -> None:
    elastic = (
        support.kind == "clamped" or (support.stiffness, support.rotation_stiffness) != (None, None)
        for support in segment.supports
    )
    if base != "complete" and any(elastic):
        raise _unsupported(segment, "clamped or elastic supports", base)


def _unsupported(segment: Segment, feature: str, base: Base) -> BoomError:
    return BoomError(
        "segment",
        f"{segment.name!r} has {feature}, for which the functions {base!r} have no form; use base ="
        " 'complete'",
    )


def kantorovich_segment(
    segment: Segment, terms: int, base: Base, rotary_inertia: bool
) -> SegmentModel:
    """Return the model of a segment in the function spaces of the paper.

    Args:
        segment: segment; with lateral properties the model includes deflection along y in the same
            spaces, and twist.
        terms: number of functions of each component.
        base: basis functions of (29) and (31); twist always uses the complete basis.
        rotary_inertia: whether the mass matrix includes I_p of (3) and (9); (21) neglects it.

    Raises:
        BoomError: clamped or elastic supports require the complete basis.
    """
    components: dict[Motion, Component] = {
        "z": kantorovich_bending(segment, terms, base, rotary_inertia)
    }
    if segment.lateral is not None:
        components["y"] = kantorovich_bending(segment.turned(), terms, base, rotary_inertia)
        components["twist"] = kantorovich_twist(segment, terms)
    return SegmentModel(components)


def kantorovich_bending(
    segment: Segment, terms: int, base: Base, rotary_inertia: bool
) -> Component:
    """Return the component of deflection along z, with the matrices (23)–(26).

    Arguments as in :func:`kantorovich_segment`.
    """
    basis = _SegmentBasis(segment, bending_basis(segment, terms, base))
    # The basis as printed also fixes the slope at the first support.
    printed = int(bool(segment.supports) and base == "as printed")
    stiffness_weights, mass_weights, rotary_weights = (
        basis.weights * segment.property_ratio(attrgetter(number), basis.x)
        for number in ("bending_stiffness", "mass_per_length", "rotary_inertia")
    )
    stiffness = segment.bending_stiffness * products(basis.curvature, stiffness_weights)
    mass = segment.mass_per_length * products(basis.value, mass_weights)
    rotation_load = segment.mass_per_length * basis.value @ (basis.x * mass_weights)
    if rotary_inertia:
        mass += segment.rotary_inertia * products(basis.slope, rotary_weights)
        rotation_load += segment.rotary_inertia * basis.slope @ rotary_weights
    for support in segment.supports:
        if support.stiffness is not None:
            row = basis.at(support.x)
            stiffness += support.stiffness * np.outer(row, row)
        if support.rotation_stiffness is not None:
            row = basis.at(support.x, 1)
            stiffness += support.rotation_stiffness * np.outer(row, row)
    for point in (*segment.masses, *segment.stiffener_masses):
        row = basis.at(point.x)
        mass += point.mass * np.outer(row, row)
    inertia_load = basis.value @ mass_weights
    for point in segment.stiffener_masses:
        row = basis.at(point.x)
        rotation_load += point.mass * point.x * row
        inertia_load += point.mass / segment.mass_per_length * row
    return Component(
        stiffness=stiffness,
        mass=mass,
        damping=segment.viscous_damping * products(basis.value, basis.weights),
        load=segment.load * basis.integral,
        unit_load=basis.integral,
        at=basis.at,
        rigid_modes=min(max(0, segment.rigid_modes - printed), terms),
        geometric_stiffness=_geometric(segment.compression, basis.functions),
        rotation_load=rotation_load,
        inertia_load=inertia_load,
    )


def _geometric(compression: Compression, functions: Sequence[Legendre]) -> Array:
    """Return K_G = ∫ P φ_i′ φ_j′ dx (num_functions, num_functions), for piecewise linear P."""
    total = np.zeros((len(functions), len(functions)))
    slopes = [function.deriv() for function in functions]
    nodes, weights = np.polynomial.legendre.leggauss(max(f.degree() for f in functions) + 1)
    for a, b in pairwise(compression.places):
        x = a + 0.5 * (b - a) * (nodes + 1.0)
        slope = np.array([function(x) for function in slopes])
        total += products(slope, 0.5 * (b - a) * weights * compression(x))
    return total


def kantorovich_twist(segment: Segment, terms: int) -> Component:
    """Return the component of twist of a segment; supports prevent twist."""
    lateral = segment.lateral
    assert lateral is not None
    conditions = [(support.x, 0) for support in segment.supports]
    basis = _SegmentBasis(segment, complete_basis(segment, conditions, terms))
    twisting_stiffness = segment.material.shear_modulus * lateral.torsion_constant
    stiffness_weights, mass_weights = (
        basis.weights * segment.property_ratio(attrgetter(f"lateral.{number}"), basis.x)
        for number in ("torsion_constant", "polar_inertia")
    )
    return Component(
        stiffness=twisting_stiffness * products(basis.slope, stiffness_weights),
        mass=lateral.polar_inertia * products(basis.value, mass_weights),
        damping=np.zeros((terms, terms)),
        load=np.zeros(terms),
        at=basis.at,
        rigid_modes=segment.rigid_twists,
        geometric_stiffness=np.zeros((terms, terms)),
    )


def bending_basis(segment: Segment, terms: int, base: Base) -> list[Legendre]:
    """Return the functions of the deflection in one interpretation of (29)–(31).

    With supports x0, x1, …, functions other than the complete ones vanish at the supports and span
    (29): φ_i = x^i (x − x0)(x − x1) with i = 1 … terms as printed, where also the slope vanishes at
    x0, and i = 0 … terms − 1 otherwise. A free segment from x2 to x4 has (30), (31): the rigid
    motions 1 and x − x2, then (x − x2)^(i−1) (x − x4). This basis is incomplete: with all
    functions, the deflection at x4 lies on the tangent at x2, so that the series does not converge
    to a free beam.

    Raises:
        BoomError: clamped or elastic supports require the complete basis.
    """
    if base == "complete":
        conditions = [
            (support.x, order)
            for support in segment.supports
            for order, rigid in enumerate((support.stiffness is None, support.kind == "clamped"))
            if rigid
        ]
        return complete_basis(segment, conditions, terms)
    _check_supports(segment, base)
    if segment.supports:
        supports = sorted(support.x for support in segment.supports)
        roots = [supports[0], *supports] if base == "as printed" else supports
        return _times_legendre(segment, Polynomial.fromroots(roots), terms)
    rigid = _times_legendre(segment, Polynomial([1.0]), min(terms, 2))
    bending = Polynomial.fromroots([segment.start, segment.start, segment.end])
    return rigid + _times_legendre(segment, bending, terms - 2)


def complete_basis(
    segment: Segment, conditions: Sequence[tuple[float, int]], terms: int
) -> list[Legendre]:
    """Return orthonormal polynomials of increasing degree with zero values or slopes at supports.

    Args:
        segment: segment; polynomials are orthonormal over its length.
        conditions: (x in m, order) of each condition; the order is 0 for a value, 1 for a slope.
        terms: number of polynomials.
    """
    domain = [segment.start, segment.end]
    count = terms + len(conditions)
    # Legendre polynomials of unit norm, since ∫ P_k² dx = L/(2k + 1).
    whole = [
        np.sqrt((2 * k + 1) / segment.length) * Legendre.basis(k, domain=domain)
        for k in range(count)
    ]
    admitted = np.eye(count)
    if conditions:
        rows = np.array(
            [[(f.deriv() if order else f)(x) for f in whole] for x, order in conditions]
        )
        admitted = null_space(rows / np.linalg.norm(rows, axis=1)[:, None])
        # An orthogonal transform makes degrees increase by one from function to function. This
        # preserves the digits of low modes, since functions of high degree are much stiffer.
        _, turn = rq(admitted[len(conditions) :])
        admitted = np.triu(admitted @ turn.T, -len(conditions))
    coefficients = np.array([f.coef[-1] for f in whole])
    return [Legendre(coefficients * column, domain=domain) for column in admitted.T]


class _SegmentBasis:
    """Functions on a segment, and their values at quadrature points.

    Attributes:
        x: points (num_points,) in m.
        value, slope, curvature: values and derivatives (num_functions, num_points).
        weights: weights (num_points,) in m.
        integral: ∫ φ_i dx (num_functions,).
    """

    def __init__(self, segment: Segment, functions: Sequence[Legendre]) -> None:
        self.functions = functions
        # A Gauss rule with degree + 1 points is exact for products of two functions.
        degree = max(function.degree() for function in functions)
        tapering = _TAPERING if segment.head_section is not None else 0
        nodes, weights = np.polynomial.legendre.leggauss(degree + 1 + tapering)
        self.x = segment.start + 0.5 * segment.length * (nodes + 1.0)
        self.weights = 0.5 * segment.length * weights
        slopes, curvatures = ([function.deriv(order) for function in functions] for order in (1, 2))
        self._derived = functions, slopes, curvatures
        self.value, self.slope, self.curvature = (
            np.array([function(self.x) for function in derived]) for derived in self._derived
        )
        self.integral = self.value @ self.weights

    def at(self, x: float, order: int = 0) -> Array:
        """Return the values, or derivatives of the order 1 or 2, (num_functions,) at x in m."""
        return np.array([function(x) for function in self._derived[order]])


def _times_legendre(segment: Segment, seed: Polynomial, terms: int) -> list[Legendre]:
    """Return products of a polynomial and the first Legendre polynomials, normalised."""
    domain = [segment.start, segment.end]
    lowest = seed.convert(kind=Legendre, domain=domain)
    functions = [lowest * Legendre.basis(k, domain=domain) for k in range(terms)]
    return [function / np.abs(function.coef).max() for function in functions]


def rigid_segment(segment: Segment) -> SegmentModel:
    """Return the model of a segment that moves without deformation.

    It has the rigid motions that rigid supports admit, possibly none, with the stiffness of elastic
    supports and the inertia of point masses.
    """
    components: dict[Motion, Component] = {"z": _rigid_motion(segment)}
    if segment.lateral is not None:
        components["y"] = _rigid_motion(segment.turned())
        turns = segment.rigid_twists
        components["twist"] = kantorovich_twist(segment, turns) if turns else _no_motion()
    return SegmentModel(components)


def count_rigid_motions(segment: Segment) -> int:
    """Return the number of rigid motions along z that rigid supports admit."""
    held = sum((s.stiffness is None) + (s.kind == "clamped") for s in segment.supports)
    return max(0, 2 - held)


def _rigid_motion(segment: Segment) -> Component:
    motions = count_rigid_motions(segment)
    if motions == 0:
        return _no_motion()
    straight = kantorovich_bending(segment, motions, "complete", rotary_inertia=True)
    return replace(straight, bends=False)


def _no_motion() -> Component:
    none, empty = np.zeros(0), np.zeros((0, 0))
    return Component(empty, empty, empty, none, lambda x, order=0: none, 0, empty, bends=False)
