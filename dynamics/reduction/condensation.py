# SPDX-License-Identifier: LGPL-3.0-or-later
"""A gap system in fewer coordinates: some of its modes, and what else gives way at a push.

Some of the modes stay as they are: a few as the slowest, the others as those whose inertia
answers most to what pushes. Under a push b a mode gives way by b²/ω², its inertia by b²/ω⁴. Of the
rest the motions that forces excite are kept, matched with ``MOMENTS`` derivatives at rest, so that
statics is exact and the inertia of what gives way is right to the first orders (MacNeal 1971; Rubin
1975, whose residual modes are the first block).
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from dynamics.arrays import Array, Indices
from dynamics.gap_system import GapSystem

# Blocks Ω⁻²ᵏ Bᵀ of what is pushed.
MOMENTS = 2
# Blocks take no more than this part of the coordinates, unless one alone does.
_OF_ALL = 1.0 / 3.0
# Of the coordinates, the slowest modes whether anything pushes them or not.
_SLOWEST = 1.0 / 8.0
# A push that is left with less than this part of its size is in the space already.
_DEPENDENT = 1.0e-6


def condensed(system: GapSystem, most: int) -> tuple[GapSystem, Array]:
    """The system in ``most`` coordinates at most, unless what is pushed alone takes more, and
    (num_modes, num_coordinates) what these are in its own.

    Args:
        system: without modal damping, which a case adds later.
        most: of all segments together.

    Raises:
        ValueError: the system has modal damping.
    """
    if system.damping.any():
        raise ValueError("a system is condensed before it is damped")
    if system.num_modes <= most:
        return system, np.eye(system.num_modes)
    pushes = _pushes(system)
    order = _telling_first(system.omega2, pushes, round(_SLOWEST * most))
    count = len(_independent((pushes * (system.omega2 > 0.0)).T).T)
    moments = int(np.clip(_OF_ALL * most // max(count, 1), 1, MOMENTS))
    kept, rest = np.split(order, [max(most - moments * count, (system.omega2 <= 0.0).sum())])
    kept, rest = (part[np.argsort(system.omega2[part], kind="stable")] for part in (kept, rest))
    omega2, shapes = fewer(system.omega2, pushes, kept, rest, moments)
    return system.transformed(omega2, shapes), shapes


def fewer(
    omega2: Array, pushes: Array, kept: Indices, rest: Indices, moments: int
) -> tuple[Array, Array]:
    """(num_shapes,) ω² and (num_modes, num_shapes) of modes kept, and of what else is pushed.

    Args:
        omega2: (num_modes,) in rad²/s², positive of the rest.
        pushes: (num_pushes, num_modes) that the rest answers by few of its motions.
        kept, rest: positions of modes.
        moments: of what the rest answers, in statics, that are taken along.
    """
    elastic = omega2[rest, None]
    blocks = [_independent(pushes[:, rest].T)]
    for _ in range(moments):
        blocks.append(_independent(blocks[-1] / elastic))
    basis = _independent(np.hstack(blocks[1:]))
    stiffness, turn = eigh(basis.T @ (elastic * basis))
    shapes = np.zeros((omega2.size, kept.size + stiffness.size))
    shapes[kept, np.arange(kept.size)] = 1.0
    shapes[rest, kept.size :] = basis @ turn
    return np.concatenate([omega2[kept], stiffness]), shapes


def _telling_first(omega2: Array, pushes: Array, slowest: int) -> Indices:
    """(num_modes,) positions: so many of the slowest, then by b²/ω⁴ over a push's whole b²/ω²."""
    elastic = omega2 > 0.0
    gives = np.where(elastic, pushes**2 / np.where(elastic, omega2, 1.0), 0.0)
    whole = gives.sum(axis=1, keepdims=True)
    parts = (gives / np.where(whole > 0.0, whole, 1.0)).max(axis=0)
    told = np.where(elastic, parts / np.where(elastic, omega2, 1.0), np.inf)
    told[np.argsort(omega2, kind="stable")[:slowest]] = np.inf
    return np.asarray(np.lexsort((omega2, -told)))


def _pushes(system: GapSystem) -> Array:
    """(num_pushes, num_modes) all that can act."""
    constant = [system.load, system.released, system.thrown]
    excited = [excitation.load for excitation in system.excitations]
    return np.vstack([system.rows, system.friction_rows, system.dashpots, *constant, *excited])


def _independent(block: Array) -> Array:
    """(num_modes, rank) an orthonormal basis of what the columns span, each of the same size."""
    sizes = np.linalg.norm(block, axis=0)
    kept = sizes > _DEPENDENT**2 * sizes.max(initial=0.0)
    basis, values, _ = np.linalg.svd(block[:, kept] / sizes[kept], full_matrices=False)
    return np.asarray(basis[:, values > _DEPENDENT * values.max(initial=0.0)])
