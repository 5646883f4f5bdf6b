# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduction and extension of the coordinates of a gap system."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.linalg import eigh

from dynamics.arrays import Array, Indices
from dynamics.gap_system import GapSystem

# Fraction of a load vector's size below which its remainder is round-off.
_DEPENDENT = 1.0e-6


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
    wider = system.transform(
        np.concatenate([system.omega2, omega2]),
        np.eye(system.num_modes, system.num_modes + omega2.size),
    )
    return replace(
        wider,
        rows=np.hstack([system.rows, contacts]),
        friction_rows=np.hstack([system.friction_rows, frictions]),
        dashpots=np.hstack([system.dashpots, dashpots]),
    )
