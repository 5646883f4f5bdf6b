# SPDX-License-Identifier: LGPL-3.0-or-later
"""The modal coordinates of the whole boom: those of its segments side by side, less the ties."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from mpi4py import MPI
from scipy.linalg import eigh, null_space

from geometry.arrays import Array
from shell_model.cross_section import Reading
from shell_model.reduction.products import exact_product
from shell_model.reduction.segment import ReducedSegment
from shell_model.segment_shell import SegmentShell


class BoomCoordinates:
    """Mass-normalised coordinates a of a boom, in which the tied readings are zero. Collective.

    Args:
        comm: the ranks that share the shells.
        shells, reduced: of the segments.
        ties: what stays at zero.

    Attributes:
        omega2: (num_modes,) in rad²/s², rigid motions exactly 0.
    """

    def __init__(
        self,
        comm: MPI.Comm,
        shells: Sequence[SegmentShell],
        reduced: Sequence[ReducedSegment],
        ties: Sequence[Reading],
    ) -> None:
        self._comm, self._shells, self._reduced = comm, shells, reduced
        self._combination: Array | None = None
        self.omega2 = np.concatenate([segment.omega2 for segment in reduced])
        if ties:
            rows = np.array([self.row(tie) for tie in ties])
            self.omega2, self._combination = comm.bcast(_tied_modes(self.omega2, rows))

    def row(self, reading: Reading) -> Array:
        """(num_modes,) what a reading reads of each mode, the same on every rank."""
        rows = [self.push(number, self._shells[number].row(row)) for number, row in reading.items()]
        return np.asarray(np.sum(rows, axis=0))

    def push(self, number: int, force: Array) -> Array:
        """(num_modes,) modal load of a force on a segment.

        Args:
            number: of the segment.
            force: (num_owned,) this rank's rows of it.
        """
        parts = [np.zeros(segment.omega2.size) for segment in self._reduced]
        parts[number] = exact_product(self._comm, force, self._reduced[number].shapes)
        apart = np.concatenate(parts)
        return apart if self._combination is None else apart @ self._combination

    def of_fields(self, fields: xr.Dataset) -> xr.Dataset:
        """Fields of the segments' own modes as fields of these coordinates."""
        if self._combination is None:
            return fields
        combined = {}
        for name, variable in fields.data_vars.items():
            if "mode" in variable.dims:
                axis = variable.dims.index("mode")
                combination = self._combination.astype(variable.dtype)
                values = np.tensordot(variable.values, combination, axes=([axis], [0]))
                combined[name] = (variable.dims, np.moveaxis(values, -1, axis))
        return fields.assign(combined)


def _tied_modes(omega2: Array, rows: Array) -> tuple[Array, Array]:
    """ω² and combinations (num_modes, num_tied_modes) of modes that keep the rows at zero."""
    free = null_space(rows)
    tied_omega2, combination = eigh(free.T @ (omega2[:, None] * free))
    # What the ties leave of the segments' rigid motions is rigid still.
    rigid = rows[:, omega2 == 0.0]
    left = rigid.shape[1] - int(np.linalg.matrix_rank(rigid)) if rigid.size else 0
    tied_omega2[:left] = 0.0
    return tied_omega2, free @ combination
