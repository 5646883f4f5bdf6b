# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows that read the corners of a box along a length.

A force at one point of a fold has no compliance: it grows with the logarithm of the mesh. One that
is spread along the fold has. The rows are exact for any mesh, whose lines need not lie at their
ends.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from geometry.boom import Direction
from geometry.contact_places import Stretch
from geometry.section import BoxSection
from shell_model.cross_section import COMPONENT, ON_WALL, Row, combine, quadratic, row_of
from shell_model.segment_shell import SegmentShell

Array = npt.NDArray[np.float64]

# Signs of y and z.
Corner = tuple[int, int]
_CORNERS: tuple[Corner, ...] = ((-1, -1), (1, -1), (1, 1), (-1, 1))


class _Line(NamedTuple):
    """Displacement nodes along a corner, ends and middles of its edges in turn.

    Args:
        x: (num_nodes,) in m, rising.
        dofs: (num_nodes, 3) global rows of the displacement components.
    """

    x: Array
    dofs: npt.NDArray[np.int64]

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
        return row_of(self.dofs[nodes, COMPONENT[direction]].ravel(), weights.ravel())


class CornerLines:
    """The four corners of a segment's box. Collective."""

    def __init__(self, shell: SegmentShell) -> None:
        self._section: BoxSection = shell.section
        half = 0.5 * np.array([shell.section.width, shell.section.height])
        self._lines: Mapping[Corner, _Line] = {}
        for corner in _CORNERS:
            off = np.abs(shell.nodes[:, 1:] - corner * half).max(axis=1)
            on = off < ON_WALL * shell.section.height
            x = np.concatenate(shell.comm.allgather(shell.nodes[on, 0]))
            dofs = np.concatenate(shell.comm.allgather(shell.node_dofs[on]))
            order = np.argsort(x)
            self._lines[corner] = _Line(x[order], dofs[order])

    def deflection(self, stretch: Stretch, direction: Direction, y: float, z: float) -> Row:
        """u_z of a flange or u_y of a web in m, on the straight line through its two corners.

        A force there goes to the corners by the law of the lever, as through a flange that its
        webs carry; no plate bows under it, and a turn of the section is read exactly.

        Args:
            stretch: of the corners that is read.
            direction: what is read.
            y, z: offsets from the axis in m. Along z the sign of ``z`` tells which flange is read,
                along y the sign of ``y`` tells which web.
        """
        b, h = 0.5 * self._section.width, 0.5 * self._section.height
        if direction == "z":
            wall, along = int(np.sign(z)), y / b
            first, last = self._lines[-1, wall], self._lines[1, wall]
        else:
            wall, along = int(np.sign(y)), z / h
            first, last = self._lines[wall, -1], self._lines[wall, 1]
        return combine(
            (0.5 * (1.0 - along), first.mean(stretch, direction)),
            (0.5 * (1.0 + along), last.mean(stretch, direction)),
        )
