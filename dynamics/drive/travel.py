# SPDX-License-Identifier: LGPL-3.0-or-later
"""Travels: the extension of a segment over time, and the rows that it changes.

A segment that moves along its axis has the inertia m̄ ü at a fixed material point if slopes are
small. So its modes, loads and observers do not change. But contact rows change, since the contact
moves along one of the two segments with the extension.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import numpy as np

from dynamics.arrays import Array
from dynamics.drive.row_table import ChangingAxialForce, MovingAxialForce, RowTable
from dynamics.drive.stick_slip import ElasticDrive
from dynamics.excitation import History

# Kinds of rows of a gap system that may change with time, in the order of the compiled loops.
RowKind = Literal["rows", "friction_rows", "dashpots"]
ROW_KINDS: tuple[RowKind, ...] = get_args(RowKind)


@dataclass(frozen=True, slots=True)
class Travel:
    """Extension over time, 0 at t = 0, and the rows that change with the extension.

    Example: the row of a contact decreases with the extension.

    >>> table = RowTable.interpolate(lambda s: np.array([[1.0 - s]]), [0.0, 0.5])
    >>> lift = Travel(pt.SCurve(travel=0.5, duration=1.0), table, (("rows", 0),))
    >>> replace(ball, travels=[lift]).at_time(1.0).rows
    array([[0.5]])

    Args:
        history: extension in m over time.
        table: rows (num_moving, num_modes) over the extension.
        moved_rows: (kind, index) of each row in the gap system.
        suffix: suffix of the names of results; None for no results.
        axial_forces: axial forces that move with the extension, or are proportional to it.
        axial_load: axial load in N of all segments that the drive moves.
        elastic: data of an elastic drive; None for a rigid drive.
        shifts: increase of the displacement of each row per m of extension, as for the rope of a
            winch; none unless given.

    Raises:
        ValueError: the table has another number of rows or shifts, or a history that moves rows
            does not begin with 0.
    """

    history: History
    table: RowTable
    moved_rows: Sequence[tuple[RowKind, int]]
    suffix: str | None = None
    axial_forces: Sequence[MovingAxialForce | ChangingAxialForce] = ()
    axial_load: float = 0.0
    elastic: ElasticDrive | None = None
    shifts: Sequence[float] = ()

    def __post_init__(self) -> None:
        rows = self.table.coefficients.shape[2]
        if rows != len(self.moved_rows):
            raise ValueError(f"the table has {rows} rows, and {len(self.moved_rows)} move")
        if len(self.shifts) not in (0, rows):
            raise ValueError(f"shifts must be none or {rows}, got {len(self.shifts)}")
        start = float(self.history(np.zeros(())))
        if rows and abs(start) > 1.0e-9:
            raise ValueError(f"a travel must be 0 at t = 0, got {start:g} m")

    @property
    def telescopes(self) -> bool:
        """True if the travel moves a segment, not a load or an axial force."""
        return bool(self.moved_rows) and not self.shifts

    def transform(self, shapes: Array) -> Travel:
        """Return the travel in other coordinates b, with a = Φ b and Φ (num_modes, num_others)."""
        forces = [force.transform(shapes) for force in self.axial_forces]
        return replace(self, table=self.table.transform(shapes), axial_forces=forces)
