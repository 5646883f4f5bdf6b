# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a coarse model of a boom does not give way, added to it as springs without mass.

With B the rows of contacts, friction and dashpots and C = B Ω⁻² Bᵀ over the elastic modes, the
residual compliance of a coarse model beside a fine one is D = C_fine − C_coarse (MacNeal 1971).
Both have the same rigid motions, so forces that no support bears are borne by inertia alike, and D
is what pressed places alone give way. Its positive part D = Σ g gᵀ is as many springs, each a
coordinate with the rows ω_s g and a frequency ω_s well above the motion.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from dynamics.arrays import Array
from dynamics.gap_system import GapSystem

# ω_s/2π in Hz: the swing of a boom is slower by a factor of ten and more.
SPRING_FREQUENCY = 400.0

# A pattern of forces that gives way by less than this part of what others do, does not.
_NOTHING = 1.0e-3


def elastic_compliance(system: GapSystem) -> Array:
    """(num_resisting, num_resisting) B Ω⁻² Bᵀ in m/N of rows, friction rows, then dashpots."""
    elastic = system.omega2 > 0.0
    rows = _resisting(system)[:, elastic]
    return np.asarray(rows / system.omega2[elastic] @ rows.T)


def residual_compliance(coarse: GapSystem, fine: GapSystem) -> Array:
    """(num_resisting, num_resisting) D in m/N, not made positive.

    Raises:
        ValueError: they do not touch, rub and drag in as many places.
    """
    if _resisting(coarse).shape[0] != _resisting(fine).shape[0]:
        raise ValueError("both models must touch, rub and drag in the same places")
    return elastic_compliance(fine) - elastic_compliance(coarse)


def with_springs(system: GapSystem, residual: Array) -> GapSystem:
    """The system with the positive part of a (num_resisting, num_resisting) residual as springs.

    That is in m/N.
    """
    sizes = np.sqrt(np.abs(np.diag(residual)))
    sizes[sizes == 0.0] = 1.0
    # Normalised, since friction rows, pads and dashpots differ by orders of magnitude.
    amounts, patterns = np.linalg.eigh(residual / np.outer(sizes, sizes))
    kept = amounts > _NOTHING * max(amounts.max(initial=0.0), 0.0)
    spring = 2.0 * np.pi * SPRING_FREQUENCY
    rows = spring * sizes[:, None] * patterns[:, kept] * np.sqrt(amounts[kept])
    return with_coordinates(system, np.full(rows.shape[1], spring**2), rows)


def with_coordinates(system: GapSystem, omega2: Array, rows: Array) -> GapSystem:
    """The system with coordinates that contacts, friction and dashpots alone move.

    Args:
        system: none of its rows moves.
        omega2: (num_added,) in rad²/s².
        rows: (num_resisting, num_added) in 1/√kg, of dashpots in 1/√s.
    """
    touching, rubbing, dragged = np.split(
        rows, np.cumsum([len(system.laws), len(system.frictions)])
    )
    wider = system.transformed(
        np.concatenate([system.omega2, omega2]),
        np.eye(system.num_modes, system.num_modes + omega2.size),
    )
    return replace(
        wider,
        rows=np.hstack([system.rows, touching]),
        friction_rows=np.hstack([system.friction_rows, rubbing]),
        dashpots=np.hstack([system.dashpots, dragged]),
    )


def _resisting(system: GapSystem) -> Array:
    return np.vstack([system.rows, system.friction_rows, system.dashpots])
