# SPDX-License-Identifier: LGPL-3.0-or-later
"""Condensation of shells to a number of coordinates as small as that of a beam.

The condensed system keeps the lowest modes, and modes i with a large inertial response Q_i²/ω_i⁴ to
a load Q relative to the static response Σ Q_i²/ω_i². Responses to forces represent the other modes,
and preserve two moments at zero frequency. So statics is exact, and the inertia of local
deformation is accurate to first order (MacNeal 1971; Rubin 1975, whose residual modes are the first
block).
"""

from __future__ import annotations

import numpy as np

from dynamics.gap_system import GapSystem
from dynamics.reduction import independent_columns, reduce_modes
from geometry.arrays import Array, Indices

# Number of blocks Ω⁻²ᵏ Bᵀ of responses to the rows B of forces, which is the number of moments.
MOMENTS = 2
# Maximum fraction of the coordinates for blocks, unless a single block needs more.
_BLOCK_FRACTION = 1.0 / 3.0
# Fraction of the coordinates for the lowest modes.
_LOWEST_FRACTION = 1.0 / 8.0


def condense(system: GapSystem, most: int) -> tuple[GapSystem, Array]:
    """Return the system in fewer coordinates, and the shapes (num_modes, num_coordinates).

    Args:
        system: gap system without modal damping, which a case adds later.
        most: maximum number of coordinates of all segments; more if loads and rows need them.

    Raises:
        ValueError: the system has modal damping.
    """
    if system.damping.any():
        raise ValueError("a system is condensed before it is damped")
    if system.num_modes <= most:
        return system, np.eye(system.num_modes)
    pushes = _forces(system)
    order = _order_modes(system.omega2, pushes, round(_LOWEST_FRACTION * most))
    count = len(independent_columns((pushes * (system.omega2 > 0.0)).T).T)
    moments = int(np.clip(_BLOCK_FRACTION * most // max(count, 1), 1, MOMENTS))
    kept, rest = np.split(order, [max(most - moments * count, (system.omega2 <= 0.0).sum())])
    kept, rest = (part[np.argsort(system.omega2[part], kind="stable")] for part in (kept, rest))
    omega2, shapes = reduce_modes(system.omega2, pushes, kept, rest, moments)
    return system.transform(omega2, shapes), shapes


def _order_modes(omega2: Array, pushes: Array, slowest: int) -> Indices:
    """Return the order (num_modes,) of modes: the lowest, then by their inertial response."""
    elastic = omega2 > 0.0
    static = np.where(elastic, pushes**2 / np.where(elastic, omega2, 1.0), 0.0)
    whole = static.sum(axis=1, keepdims=True)
    parts = (static / np.where(whole > 0.0, whole, 1.0)).max(axis=0)
    weights = np.where(elastic, parts / np.where(elastic, omega2, 1.0), np.inf)
    weights[np.argsort(omega2, kind="stable")[:slowest]] = np.inf
    return np.asarray(np.lexsort((omega2, -weights)))


def _forces(system: GapSystem) -> Array:
    """Return the rows and load vectors (num_forces, num_modes) of all forces on a system."""
    constant = [system.load, system.released_load, system.initial_impulse]
    excited = [excitation.load for excitation in system.excitations]
    return np.vstack([system.all_rows, *constant, *excited])
