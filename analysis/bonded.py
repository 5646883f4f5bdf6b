# SPDX-License-Identifier: LGPL-3.0-or-later
"""A model without play: its contacts are bonded."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.linalg import eigh, null_space

from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array

# Modes with ω² below this fraction of the smallest positive ω² of the segments count as rigid.
_RIGID_FRACTION = 1.0e-6


def bonded_system(system: GapSystem, rests: Sequence[Array]) -> tuple[GapSystem, Array]:
    """Return the bonded system, and its modes (num_modes, num_bonded_modes) in those of ``system``.

    Contacts that are closed in a static state are bonded. At a station without closed contacts, all
    contacts are bonded. So are those of a lateral station, since walls that bulge under vertical
    pads press on both lateral pads. Local compliance, for example of a shell's walls, remains. The
    contacts of stops on the ground are kept.

    >>> from protractile.analysis.bonded import bonded_system
    >>> pair = replace(ball, omega2=np.array([0.0, 4.0]), load=np.zeros(2), stations=[1.0],
    ...     rows=np.array([[1.0, -1.0]]), observers={}, damping=np.zeros(2),
    ...     released_load=np.zeros(2), initial_impulse=np.zeros(2), dashpots=np.zeros((0, 2)),
    ...     friction_rows=np.zeros((0, 2)))
    >>> bonded_system(pair, [np.zeros(2)])[0].omega2.round(6)
    array([2.])

    Args:
        system: gap system with its contacts; no segment telescopes.
        rests: equilibria (num_modes,); contacts that are closed in one of them are bonded.
    """
    on_ground = np.isin(system.station_of_row, system.grounded)
    closed_contacts = np.zeros(len(system.laws), dtype=bool)
    for rest in rests:
        gaps = system.rows @ rest
        closed_contacts |= [bool(law.force(y)) for law, y in zip(system.laws, gaps, strict=True)]
    closed_stations = np.isin(system.station_of_row, system.station_of_row[closed_contacts])
    lateral = np.array(system.station_directions)[system.station_of_row] == "y"
    bonded_rows = system.rows[~on_ground & (closed_contacts | ~closed_stations | lateral)]
    free = null_space(bonded_rows) if bonded_rows.size else np.eye(system.num_modes)
    omega2, shapes = eigh(free.T @ system.stiffness @ free)
    least = _RIGID_FRACTION * min(system.omega2[system.omega2 > 0.0], default=0.0)
    omega2[np.abs(omega2) <= least] = 0.0
    basis = free @ shapes
    grounded = list(system.grounded)
    stays = np.flatnonzero(on_ground)
    moved, place_of = system.transform(omega2, basis), {row: k for k, row in enumerate(stays)}
    bonded = replace(
        moved,
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
        travels=[
            replace(travel, moved_rows=[("rows", place_of[row]) for _, row in travel.moved_rows])
            for travel in moved.travels
        ],
    )
    return bonded, basis
