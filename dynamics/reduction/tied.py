# SPDX-License-Identifier: LGPL-3.0-or-later
"""A system whose contacts between segments are ties: the same boom without its play.

Contacts that press at rest are held where they would touch without play, and at stations where none
does all of them. What they press still gives way, as it does with play: the wall of a shell, say.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh, null_space

from dynamics.arrays import Array
from dynamics.gap_system import GapSystem

# Of the least of the segments' own ω²: motions below it are rigid.
_RIGID = 1.0e-6


def tied_system(system: GapSystem, rests: Sequence[Array]) -> tuple[GapSystem, Array]:
    """The tied system, whose stations are those of the ground, and (num_modes, num_tied_modes) what
    its coordinates are in those of the other.

    >>> from dynamics.reduction.tied import tied_system
    >>> pair = replace(ball, omega2=np.array([0.0, 4.0]), load=np.zeros(2), stations=[1.0],
    ...     rows=np.array([[1.0, -1.0]]), observers={}, damping=np.zeros(2),
    ...     released=np.zeros(2), thrown=np.zeros(2), dashpots=np.zeros((0, 2)),
    ...     friction_rows=np.zeros((0, 2)))
    >>> tied_system(pair, [np.zeros(2)])[0].omega2.round(6)
    array([2.])

    Args:
        system: with its contacts.
        rests: (num_modes,) where it rests under the loads that count.
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
