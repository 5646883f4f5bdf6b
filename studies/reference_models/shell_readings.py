# SPDX-License-Identifier: LGPL-3.0-or-later
"""Outputs of shells for verification only."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from protractile.geometry.arrays import Array
from protractile.geometry.section import COMPONENT
from protractile.shell_model.segment.cross_section import Row, SectionNodes, quadratic


def flange_deflection(outline: SectionNodes, side: float, y: float) -> Row:
    """Return the row of the mean u_z in m at (±y) on the top (side 1) or bottom flange (−1)."""
    face = outline.section.face("z", side)
    nodes, along = outline.along(outline.section.plates[face.plate])
    rows = []
    for place in (y, -y):
        # Nodes 2k, 2k+1, 2k+2 are the ends and the middle of edge k.
        edge = int(np.clip(np.searchsorted(along[::2], place) - 1, 0, nodes.size // 2 - 1))
        left, _, right = along[2 * edge : 2 * edge + 3]
        shapes = quadratic(np.asarray((place - left) / (right - left)))
        dofs = outline.dofs[nodes[2 * edge : 2 * edge + 3], COMPONENT["z"]]
        rows.append(Row.from_weights(dofs, shapes))
    return 0.5 * rows[0] + 0.5 * rows[1]


def quadratic_form(matrix: PETSc.Mat, vector: Array) -> float:
    """Return uᵀ A u of a vector (num_owned,), for example twice an energy in J. Collective."""
    right, left = matrix.createVecs()
    right.array[:] = vector
    matrix.mult(right, left)
    form = float(right.dot(left))
    right.destroy()
    left.destroy()
    return form
