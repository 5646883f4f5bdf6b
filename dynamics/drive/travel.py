# SPDX-License-Identifier: LGPL-3.0-or-later
"""Travels: the extension of a segment over time, and the rows that it changes.

Nothing else changes in material coordinates: a segment that moves along its own axis has the
inertia m̄ ü at each of its points if slopes are small. Modes, loads and observers of a segment stay
the same. A row that reads two segments at a contact reads one of them at a place that moves with
the extension.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from dynamics.drive.row_table import MovingAxialForce, RowTable
from dynamics.drive.stick_slip import ElasticDrive
from dynamics.excitation import History

# Kinds of rows of a gap system that may change with time, in the order of the compiled loops.
Kind = Literal["rows", "friction_rows", "dashpots"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, slots=True)
class Travel:
    """Rows that follow the history of an extension, from 0 at t = 0.

    Example: a row that reads less of the ball's displacement as a segment extends.

    >>> table = RowTable.of(lambda s: np.array([[1.0 - s]]), [0.0, 0.5])
    >>> lift = Travel(pt.SCurve(travel=0.5, duration=1.0), table, (("rows", 0),))
    >>> replace(ball, travels=[lift]).at_time(1.0).rows
    array([[0.5]])

    Args:
        history: history in m.
        table: rows (num_moving, num_modes) over the extension.
        moving: kind and index of each row in the gap system.
        suffix: suffix of the names of its results; None for no results.
        axial_forces: axial forces that move with the extension.
        axial_load: axial load of all moved segments in N, against which the drive works.
        elastic: data of an elastic drive; None for a rigid drive.
        shifts: growth of the displacement of each row per m of extension, as for a rope that is
            wound up; none unless given.

    Raises:
        ValueError: the table has another number of rows or shifts, or the history does not begin
            with 0.
    """

    history: History
    table: RowTable
    moving: Sequence[tuple[Kind, int]]
    suffix: str | None = None
    axial_forces: Sequence[MovingAxialForce] = ()
    axial_load: float = 0.0
    elastic: ElasticDrive | None = None
    shifts: Sequence[float] = ()

    def __post_init__(self) -> None:
        rows = self.table.coefficients.shape[2]
        if rows != len(self.moving):
            raise ValueError(f"the table has {rows} rows, and {len(self.moving)} move")
        if len(self.shifts) not in (0, rows):
            raise ValueError(f"shifts must be none or {rows}, got {len(self.shifts)}")
        start = float(self.history(np.zeros(())))
        if abs(start) > 1.0e-9:
            raise ValueError(f"a travel must be 0 at t = 0, got {start:g} m")
