# SPDX-License-Identifier: LGPL-3.0-or-later
"""Terms of contact laws in compiled loops: force, energy, slope and discrete gradient.

The formulas of force, energy and slope are in :mod:`dynamics.contact_term`. It does not import
numba, since this takes longer than the check of a case.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.contact_term import Terms, energy_of, force_of, slope_of
from dynamics.kernels.compiled import LOOP

term_force, term_energy, term_slope = (
    njit(**LOOP, inline="always")(of_term) for of_term in (force_of, energy_of, slope_of)
)

# Relative change of a penetration below which the difference quotient is round-off.
_CLOSE = 1.0e-3


@njit(**LOOP)
def contact_energy(y: Array, terms: Terms) -> float:
    """Return the elastic energy in J of all contacts at displacements y (num_rows,) in m."""
    energy = 0.0
    for t in range(terms.size):
        energy += term_energy(terms[t], y[terms[t]["row"]])
    return energy


@njit(**LOOP)
def discrete_gradient(term: np.void, before: float, after: float) -> tuple[float, float]:
    """Return (U(y₁) − U(y₀))/(y₁ − y₀) of a term's energy U in N, and its derivative by y₁ in N/m.

    Both are free of cancellation for y₁ near y₀ (Gonzalez 1996). The derivative, which only
    Newton's method uses, is a midpoint value for y₁ near y₀ unless the exponent is 1 or 2.

    Args:
        before, after: relative displacements y₀ and y₁ in m.
    """
    side, k, n = term["side"], term["stiffness"], term["exponent"]
    p, q = side * before - term["onset"], side * after - term["onset"]
    if p <= 0.0 and q <= 0.0:
        return 0.0, 0.0
    if p <= 0.0:
        force = k * q**n
        mean = force * q / ((n + 1.0) * (q - p))
        return side * mean, (force - mean) / (q - p)
    if q <= 0.0:
        mean = k * p ** (n + 1.0) / ((n + 1.0) * (p - q))
        return side * mean, mean / (p - q)
    if n == 1.0:
        return side * 0.5 * k * (p + q), 0.5 * k
    if n == 2.0:
        return side * k * (p * p + p * q + q * q) / 3.0, k * (p + 2.0 * q) / 3.0
    change = (q - p) / p
    mean = k * p**n
    if change != 0.0:
        mean *= np.expm1((n + 1.0) * np.log1p(change)) / ((n + 1.0) * change)
    if abs(change) < _CLOSE:
        return side * mean, 0.5 * n * k * ((p + 2.0 * q) / 3.0) ** (n - 1.0)
    return side * mean, (k * q**n - mean) / (q - p)
