# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduction and extension of the coordinates of a gap system.

A shell is condensed to a number of coordinates as small as that of a beam. The condensed system
keeps the lowest modes, and modes i with a large inertial response Q_i²/ω_i⁴ to a load Q relative to
the static response Σ Q_i²/ω_i². Responses to forces represent the other modes, and preserve two
moments at zero frequency. So statics is exact, and the inertia of local deformation is accurate to
first order (MacNeal 1971; Rubin 1975, whose residual modes are the first block).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from protractile.dynamics.arrays import Array, Indices
from protractile.dynamics.gap_system import GapSystem

# Fraction of a load vector's size below which its remainder is round-off.
_DEPENDENT = 1.0e-6


# Number of blocks Ω⁻²ᵏ Bᵀ of responses to the rows B of forces, which is the number of moments.
MOMENTS = 2
# Maximum fraction of the coordinates for blocks, unless a single block needs more.
_BLOCK_FRACTION = 1.0 / 3.0
# Fraction of the coordinates for the lowest modes.
_LOWEST_FRACTION = 1.0 / 8.0


def reduce_modes(
    omega2: Array, pushes: Array, kept: Indices, rest: Indices, moments: int
) -> tuple[Array, Array]:
    """Return ω² (num_shapes,) in rad²/s² and shapes (num_modes, num_shapes) of a reduced system.

    Args:
        omega2: ω² (num_modes,) in rad²/s², positive for the modes ``rest``.
        pushes: forces (num_pushes, num_modes) that excite the modes.
        kept, rest: indices of the modes to keep, and of the modes to reduce.
        moments: number of moments of the response at zero frequency that the reduction preserves.
    """
    elastic = omega2[rest, None]
    blocks = [independent_columns(pushes[:, rest].T)]
    for _ in range(moments):
        blocks.append(independent_columns(blocks[-1] / elastic))
    basis = independent_columns(np.hstack(blocks[1:]))
    stiffness, turn = eigh(basis.T @ (elastic * basis))
    shapes = np.zeros((omega2.size, kept.size + stiffness.size))
    shapes[kept, np.arange(kept.size)] = 1.0
    shapes[rest, kept.size :] = basis @ turn
    return np.concatenate([omega2[kept], stiffness]), shapes


def restrict(system: GapSystem, basis: Array) -> GapSystem:
    """Return the system in the coordinates of a basis that includes all rigid motions.

    Args:
        system: gap system whose ``omega2`` includes all axial forces.
        basis: orthonormal coefficients (num_modes, num_coordinates).
    """
    omega2, turn = eigh(basis.T @ (system.omega2[:, None] * basis))
    omega2[np.argsort(np.abs(omega2))[: np.count_nonzero(system.omega2 == 0.0)]] = 0.0
    return system.transform(omega2, basis @ turn)


def independent_columns(block: Array) -> Array:
    """Return an orthonormal basis (num_modes, rank) of the columns (num_modes, num_columns)."""
    sizes = np.linalg.norm(block, axis=0)
    kept = sizes > _DEPENDENT**2 * sizes.max(initial=0.0)
    basis, values, _ = np.linalg.svd(block[:, kept] / sizes[kept], full_matrices=False)
    return np.asarray(basis[:, values > _DEPENDENT * values.max(initial=0.0)])


def with_coordinates(system: GapSystem, omega2: Array, rows: Array) -> GapSystem:
    """Return the system with coordinates that only contacts, friction and dashpots excite.

    Args:
        system: gap system without travels.
        omega2: ω² (num_added,) in rad²/s².
        rows: entries (num_rows, num_added) of all rows, in 1/√kg; entries of dashpots are in 1/√s.
    """
    contacts, frictions, dashpots = np.split(
        rows, np.cumsum([len(system.laws), len(system.frictions)])
    )
    return replace(
        system.extend(omega2),
        rows=np.hstack([system.rows, contacts]),
        friction_rows=np.hstack([system.friction_rows, frictions]),
        dashpots=np.hstack([system.dashpots, dashpots]),
    )


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
    # Rows and load vectors (num_forces, num_modes) of all forces.
    constant = [system.load, system.released_load, system.initial_impulse]
    excited = [excitation.load for excitation in system.excitations]
    pushes: Array = np.vstack([system.all_rows, *constant, *excited])
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
