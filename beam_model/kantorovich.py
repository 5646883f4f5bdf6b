# SPDX-License-Identifier: LGPL-3.0-or-later
"""The Kantorovich (semi-discrete Ritz) beam: w(x, t) = Σ a_i(t) φ_i(x), (12) of the paper.

The function spaces are the paper's (29)–(31). Their printed bases are powers of x, singular
to working precision from about ten terms on; here the same spaces are spanned by Legendre
polynomials times the lowest function, and the modes come out the same.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
import numpy.typing as npt
from numpy.polynomial import Legendre, Polynomial

from beam_model.segment_model import SegmentModel
from geometry.boom import Segment

Array = npt.NDArray[np.float64]
Base = Literal["as printed", "pinned", "complete"]


def outer_basis(segment: Segment, terms: int, base: Base) -> list[Legendre]:
    """Functions that vanish at the supports, spanning (29): φ_i = x^i (x − x0)(x − x1).

    Args:
        segment: its supports are x0, x1, …; x counts from the first of them, as in the paper
            where x0 = 0.
        terms: how many: i = 1 … terms as printed, i = 0 … terms − 1 otherwise.
        base: as printed, the slope vanishes at x0 too; the others leave it free.
    """
    supports = sorted(segment.supports)
    roots = [supports[0], *supports] if base == "as printed" else supports
    return _times_legendre(segment, Polynomial.fromroots(roots), terms)


def inner_basis(segment: Segment, terms: int, base: Base) -> list[Legendre]:
    """Functions of a free segment, (30), (31): 1, x − x2, then (x − x2)^(i−1) (x − x4).

    The printed functions lack one: all of them keep x4 on the tangent at x2, and the series does
    not converge to a free beam however many terms it has. One power less makes them complete.

    Args:
        segment: runs from x2 to x4.
        terms: how many; the first two are the rigid motions.
        base: complete, the powers of x − x2 behind the rigid motions start at one; otherwise at
            two, as printed.
    """
    rigid = _times_legendre(segment, Polynomial([1.0]), min(terms, 2))
    powers = 1 if base == "complete" else 2
    bending = Polynomial.fromroots([segment.start] * powers + [segment.end])
    return rigid + _times_legendre(segment, bending, terms - 2)


def kantorovich_segment(
    segment: Segment, terms: int, base: Base, rotary_inertia: bool
) -> SegmentModel:
    """Matrices (23)–(26) of one segment in the paper's function space.

    Args:
        segment: a beam.
        terms: number of functions.
        base: which reading of (29) and (31).
        rotary_inertia: keep I_p of (3) and (9), or drop it as (21) does.
    """
    functions = outer_basis if segment.supports else inner_basis
    basis = functions(segment, terms, base)
    # Gauss's rule with as many points as the highest degree is exact for products of two.
    degree = max(function.degree() for function in basis)
    nodes, weights = np.polynomial.legendre.leggauss(degree + 1)
    x = segment.start + 0.5 * segment.length * (nodes + 1.0)
    weights = 0.5 * segment.length * weights
    value, slope, curvature = (
        np.array([function.deriv(order)(x) if order else function(x) for function in basis])
        for order in (0, 1, 2)
    )
    # The printed base holds the slope at the first support too.
    held = len(segment.supports) + int(bool(segment.supports) and base == "as printed")
    mass = segment.mass_per_length * _products(value, weights)
    if rotary_inertia:
        mass = mass + segment.rotary_inertia * _products(slope, weights)
    return SegmentModel(
        stiffness=segment.bending_stiffness * _products(curvature, weights),
        mass=mass,
        damping=segment.viscous_damping * _products(value, weights),
        load=segment.load * (value @ weights),
        deflection=lambda place: np.array([function(place) for function in basis]),
        rigid_modes=min(max(0, 2 - held), terms),
    )


def _times_legendre(segment: Segment, seed: Polynomial, terms: int) -> list[Legendre]:
    """The seed times each of the first Legendre polynomials of the segment, scaled to one."""
    domain = [segment.start, segment.end]
    lowest = seed.convert(kind=Legendre, domain=domain)
    functions = [lowest * Legendre.basis(k, domain=domain) for k in range(terms)]
    return [function / np.abs(function.coef).max() for function in functions]


def _products(values: Array, weights: Array) -> Array:
    """∫ f_i f_j dx from values at quadrature points."""
    return (values * weights) @ values.T
