# SPDX-License-Identifier: LGPL-3.0-or-later
"""Terms of contact laws, made part of the loops that import them.

Their formulas stand in :mod:`dynamics.contact_term`, which is read without numba: it takes longer
to load than a case to check.
"""

from __future__ import annotations

from numba import njit

from dynamics.arrays import Array
from dynamics.contact_term import OfTerm, Terms, energy_of, force_of, slope_of
from dynamics.kernels.compiled import LOOP

term_force, term_energy, term_slope = (
    njit(**LOOP, inline="always")(of_term) for of_term in (force_of, energy_of, slope_of)
)

COMPILED: dict[OfTerm, OfTerm] = {
    force_of: term_force,
    energy_of: term_energy,
    slope_of: term_slope,
}


@njit(nogil=True, error_model="numpy")
def add_terms(of_term: OfTerm, terms: Terms, y: Array, total: Array) -> None:
    """Add to ``total`` (num_gaps,) what each term of one law says of each gap."""
    for t in range(terms.size):
        for i in range(y.size):
            total[i] += of_term(terms[t], y[i])
