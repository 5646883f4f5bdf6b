# SPDX-License-Identifier: LGPL-3.0-or-later
"""Gap systems derived from others: in fewer coordinates, in more, without play.

**Condensed.** Some modes stay unchanged: a few as the slowest, the others as those whose inertia
responds most to loads. Under a load b a mode deflects by b²/ω², its inertia by b²/ω⁴. Of the rest,
the motions that forces excite are kept. They match ``MOMENTS`` derivatives at rest, so that statics
is exact and the inertia of local deformation is accurate to the first orders (MacNeal 1971; Rubin
1975, whose residual modes are the first block).

**Bonded.** Contacts that press at rest are held where they touch without play; at stations where
none does, all contacts are held. Under pressure they still deform, as with play: the wall of a
shell, say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh, null_space

from dynamics.arrays import Array, Indices
from dynamics.gap_system import GapSystem

# Number of blocks Ω⁻²ᵏ Bᵀ of the load vectors.
MOMENTS = 2
# Blocks take no more than this part of the coordinates, unless one alone does.
_OF_ALL = 1.0 / 3.0
# Fraction of the coordinates for the slowest modes, whether loaded or not.
_SLOWEST = 1.0 / 8.0
# A load vector with a remainder below this fraction of its size is in the space already.
_DEPENDENT = 1.0e-6
# Fraction of the least ω² of the segments: motions below it are rigid.
_RIGID = 1.0e-6


def condensed(system: GapSystem, most: int) -> tuple[GapSystem, Array]:
    """Return the system in ``most`` coordinates at most, and their shapes.

    The shapes are (num_modes, num_coordinates). More coordinates remain where loads and rows alone
    need them.

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
    """Return ω² (num_shapes,) and shapes (num_modes, num_shapes) of a reduced system.

    Args:
        omega2: (num_modes,) in rad²/s², positive of the rest.
        pushes: (num_pushes, num_modes) forces to whose motions the rest is reduced.
        kept, rest: positions of modes.
        moments: derivatives at rest that are matched.
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
    """Return positions (num_modes,): the slowest, then by b²/ω⁴ over a push's whole b²/ω²."""
    elastic = omega2 > 0.0
    gives = np.where(elastic, pushes**2 / np.where(elastic, omega2, 1.0), 0.0)
    whole = gives.sum(axis=1, keepdims=True)
    parts = (gives / np.where(whole > 0.0, whole, 1.0)).max(axis=0)
    told = np.where(elastic, parts / np.where(elastic, omega2, 1.0), np.inf)
    told[np.argsort(omega2, kind="stable")[:slowest]] = np.inf
    return np.asarray(np.lexsort((omega2, -told)))


def _pushes(system: GapSystem) -> Array:
    """Return all forces (num_pushes, num_modes) that can act."""
    constant = [system.load, system.released, system.thrown]
    excited = [excitation.load for excitation in system.excitations]
    return np.vstack([system.rows, system.friction_rows, system.dashpots, *constant, *excited])


def _independent(block: Array) -> Array:
    """Return an orthonormal basis (num_modes, rank) of the columns, scaled to the same size."""
    sizes = np.linalg.norm(block, axis=0)
    kept = sizes > _DEPENDENT**2 * sizes.max(initial=0.0)
    basis, values, _ = np.linalg.svd(block[:, kept] / sizes[kept], full_matrices=False)
    return np.asarray(basis[:, values > _DEPENDENT * values.max(initial=0.0)])


def with_coordinates(system: GapSystem, omega2: Array, rows: Array) -> GapSystem:
    """Return the system with coordinates added that only contacts, friction and dashpots move.

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


def resisting_rows(system: GapSystem) -> Array:
    """Return rows (num_resisting, num_modes) of contacts, friction and dashpots."""
    return np.vstack([system.rows, system.friction_rows, system.dashpots])


def bonded_system(system: GapSystem, rests: Sequence[Array]) -> tuple[GapSystem, Array]:
    """Return the bonded system and its shapes (num_modes, num_tied_modes).

    Its stations are those of the ground.

    >>> from dynamics.reduction import bonded_system
    >>> pair = replace(ball, omega2=np.array([0.0, 4.0]), load=np.zeros(2), stations=[1.0],
    ...     rows=np.array([[1.0, -1.0]]), observers={}, damping=np.zeros(2),
    ...     released=np.zeros(2), thrown=np.zeros(2), dashpots=np.zeros((0, 2)),
    ...     friction_rows=np.zeros((0, 2)))
    >>> bonded_system(pair, [np.zeros(2)])[0].omega2.round(6)
    array([2.])

    Args:
        system: with its contacts.
        rests: (num_modes,) rest positions under the loads that count.
    """
    on_ground = np.isin(system.station_of_row, system.grounded)
    pressing = np.zeros(len(system.laws), dtype=bool)
    for rest in rests:
        gaps = system.rows @ rest
        pressing |= [bool(law.force(y)) for law, y in zip(system.laws, gaps, strict=True)]
    pressed = np.isin(system.station_of_row, system.station_of_row[pressing])
    held = system.rows[~on_ground & (pressing | ~pressed)]
    free = null_space(held) if held.size else np.eye(system.num_modes)
    omega2, shapes = eigh(free.T @ system.stiffness @ free)
    least = _RIGID * min(system.omega2[system.omega2 > 0.0], default=0.0)
    omega2[np.abs(omega2) <= least] = 0.0
    basis = free @ shapes
    grounded = list(system.grounded)
    stays = np.flatnonzero(on_ground)
    found = replace(
        system.transformed(omega2, basis),
        rows=system.rows[stays] @ basis,
        laws=[system.laws[row] for row in stays],
        station_of_row=np.array(
            [grounded.index(system.station_of_row[row]) for row in stays], dtype=np.int64
        ),
        stations=[system.stations[station] for station in grounded],
        station_directions=[system.station_directions[station] for station in grounded],
        grounded=range(len(grounded)),
        friction_rows=np.zeros((0, omega2.size)),
        frictions=(),
    )
    return found, basis
