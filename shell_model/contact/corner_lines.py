# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows that read the corners of a section along a length.

A force at one point of a fold has no compliance: it grows with the logarithm of the mesh. One that
is spread along the fold has. The rows are exact for any mesh, whose lines need not lie at their
ends.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geometry.arrays import Array, Indices
from geometry.contact_places import Stretch
from geometry.section import COMPONENT, Direction
from geometry.walls_along import WallsAlong
from shell_model.segment.cross_section import Row, quadratic
from shell_model.segment.segment_shell import SegmentShell


class _Line(NamedTuple):
    """Displacement nodes along a corner, ends and middles of its edges in turn.

    Args:
        x: (num_nodes,) in m, rising.
        dofs: (num_nodes, 3) global rows of the displacement components.
    """

    x: Array
    dofs: Indices

    def mean(self, stretch: Stretch, direction: Direction) -> Row:
        """Displacement weighed by a unit force's density; Simpson's rule is exact for it."""
        left, right = self.x[:-2:2], self.x[2::2]
        low, high = np.maximum(left, stretch.start), np.minimum(right, stretch.end)
        (edges,) = np.nonzero(low < high)
        left, right, low, high = (ends[edges, None] for ends in (left, right, low, high))
        places = low + (high - low) * [0.0, 0.5, 1.0]
        forces = (high - low) * [1 / 6, 4 / 6, 1 / 6] * stretch.density(places)
        weights = np.einsum("ep,epn->en", forces, quadratic((places - left) / (right - left)))
        nodes = 2 * edges[:, None] + np.arange(3)
        return Row.of(self.dofs[nodes, COMPONENT[direction]].ravel(), weights.ravel())


class CornerLines:
    """The corners of a segment's section. Collective."""

    def __init__(self, shell: SegmentShell) -> None:
        self._segment = shell.segment
        self._lines: list[_Line] = []
        along = WallsAlong(shell.segment, shell.nodes[:, 0])
        for number in range(len(shell.section.plates)):
            off = np.abs(shell.nodes[:, 1:] - along.starts(number)).max(axis=1)
            on = off < along.near
            x = np.concatenate(shell.comm.allgather(shell.nodes[on, 0]))
            dofs = np.concatenate(shell.comm.allgather(shell.node_dofs[on]))
            order = np.argsort(x)
            self._lines.append(_Line(x[order], dofs[order]))

    def deflection(self, stretch: Stretch, direction: Direction, y: float, z: float) -> Row:
        """u_z or u_y of a face in m, on the straight line through its two corners.

        A force there goes to the corners by the law of the lever, as through a flange that its
        webs carry; no plate bows under it, and a turn of the section is read exactly.

        Args:
            stretch: of the corners that is read.
            direction: what is read.
            y, z: offsets from the axis in m. Along z the sign of ``z`` tells which face is read,
                along y the sign of ``y`` tells which one.
        """
        side, across = (z, y) if direction == "z" else (y, z)
        section = self._segment.section_at(stretch.station)
        face = section.face(direction, side)
        plate, after = section.plates[face.plate], (face.plate + 1) % len(section.plates)
        first, last = face.plate, after
        if plate.end < plate.start:
            first, last = last, first
        middle, half = 0.5 * (face.low + face.high), 0.5 * face.width
        along = (across - middle) / half
        low, high = (self._lines[end].mean(stretch, direction) for end in (first, last))
        return 0.5 * (1.0 - along) * low + 0.5 * (1.0 + along) * high
