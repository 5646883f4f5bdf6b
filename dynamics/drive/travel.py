# SPDX-License-Identifier: LGPL-3.0-or-later
"""The extension of a segment over time, and the rows that it changes.

In material coordinates nothing else changes: a segment that moves along its own axis has the
inertia m̄ ü at each of its points if slopes are small. Modes, loads and observers of one segment
stay the same. A row that reads two segments at one place reads one of them at another place as the
segment extends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from dynamics.drive.row_table import MovingAxialForce, RowTable
from dynamics.drive.stick_slip import ElasticDrive
from dynamics.excitation import History

# The rows of a gap system that may change with time, in the order in which loops stack them.
Kind = Literal["rows", "friction_rows", "dashpots"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, slots=True)
class Travel:
    """Rows that follow the history of an extension, from 0 at t = 0.

    A row that reads less of the ball as a segment extends:

    >>> table = RowTable.of(lambda s: np.array([[1.0 - s]]), [0.0, 0.5])
    >>> lift = Travel(pt.SCurve(travel=0.5, duration=1.0), table, (("rows", 0),))
    >>> replace(ball, travels=[lift]).at_time(1.0).rows
    array([[0.5]])

    Args:
        history: history in m.
        table: (num_moving, num_modes) rows over the extension.
        moving: kind and position of each row in the gap system.
        suffix: suffix of the names of its results; there are none where it is None.
        axial_forces: those that move with the extension.
        axial_load: axial load of all moved segments in N, against which the drive works.
        elastic: the elastic drive; a rigid one where it is None.

    Raises:
        ValueError: the number of rows of the table differs, or the history does not begin with 0.
    """

    history: History
    table: RowTable
    moving: Sequence[tuple[Kind, int]]
    suffix: str | None = None
    axial_forces: Sequence[MovingAxialForce] = ()
    axial_load: float = 0.0
    elastic: ElasticDrive | None = None

    def __post_init__(self) -> None:
        rows = self.table.coefficients.shape[2]
        if rows != len(self.moving):
            raise ValueError(f"the table has {rows} rows, and {len(self.moving)} move")
        start = float(self.history(np.zeros(())))
        if abs(start) > 1.0e-9:
            raise ValueError(f"a travel must be 0 at t = 0, got {start:g} m")
