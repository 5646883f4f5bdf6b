# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is read of a boom's shells at places along the way that its joints are drawn out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from mpi4py import MPI

from dynamics.drive.travel import KINDS, Kind
from dynamics.gap_builder import GapBuilder
from geometry.arrays import Array, Mask
from geometry.boom import Boom
from geometry.drawing import Course, courses
from shell_model.boom_shell import BoomShell
from shell_model.reduction.coordinates import BoomCoordinates
from shell_model.segment.cross_section import Reading
from shell_model.segment.segment_shell import SegmentShell

# Places along a way, however short it is.
_FEWEST = 4


@dataclass(frozen=True, slots=True)
class Passage:
    """Rows of a boom at places along a way.

    Args:
        course: what draws them; None of those that stay.
        moving: kind and position of each of the rows in the gap system.
        ways: (num_ways,) in m, rising.
        touching: what is read at each.
    """

    course: Course | None
    moving: Sequence[tuple[Kind, int]]
    ways: Array
    touching: Sequence[GapBuilder[Reading]]

    @property
    def start(self) -> int:
        """Position of the way 0."""
        return int(np.abs(self.ways).argmin())

    @property
    def count(self) -> int:
        """Of the rows at all ways."""
        return self.ways.size * len(self.moving)

    def columns(self, shell: SegmentShell, number: int, step: int = 1) -> Array:
        """(num_owned, num_ways · num_moving) what is read of a segment, at every so many ways."""
        nothing = np.zeros(shell.free.size)

        def read(reading: Reading) -> Array:
            return shell.row(reading[number]) if number in reading else nothing

        rows = [one.some_rows(self.moving, read) for one in self.touching[::step]]
        return np.asarray(np.concatenate(rows).T)

    def told_apart(self, comm: MPI.Comm, columns: Array) -> tuple[Mask, Mask]:
        """(num_ways · num_moving) whether rows read other places of a segment as they are drawn,
        and the first of each of those that read the same place. Collective.
        """
        rows = columns.T.reshape(self.ways.size, len(self.moving), -1)
        same = comm.allreduce((rows[0] == rows[-1]).all(axis=1), MPI.LAND)
        here = comm.allreduce(rows[0].any(axis=1), MPI.LOR)
        first = np.arange(self.count) < len(self.moving)
        return np.tile(~same, self.ways.size), np.tile(same & here, self.ways.size) & first

    def rows(self, coordinates: BoomCoordinates) -> Array:
        """(num_ways, num_moving, num_modes)."""
        return np.array([one.some_rows(self.moving, coordinates.row) for one in self.touching])


def passages(boom: Boom, full: BoomShell, size: float) -> list[Passage]:
    """All rows of a boom, at places as far apart as the rings of a mesh of this size in m."""
    found = []
    for course in courses(boom):
        moving, ways = full.rows.moving(course.stations), _rings(course.reach, size)
        touching = [full.touching.rows(course.ways(way)) for way in ways.tolist()]
        found.append(Passage(course, moving, ways, touching))
    moved = {row for passage in found for row in passage.moving}
    counts = len(full.rows.contacts), len(full.rows.frictions), len(full.rows.dashpots)
    every = [(kind, row) for kind, count in zip(KINDS, counts, strict=True) for row in range(count)]
    still = [row for row in every if row not in moved]
    return [*found, Passage(None, still, np.zeros(1), [full.rows])] if still else found


def _rings(reach: tuple[float, float], size: float) -> Array:
    """Ways in m at which stations pass the rings of meshes that begin where these start."""
    pieces = [
        np.linspace(start, end, max(round((end - start) / size), _FEWEST) + 1)
        for start, end in pairwise(sorted({*reach, 0.0}))
    ]
    return np.asarray(np.unique(np.concatenate(pieces)))
