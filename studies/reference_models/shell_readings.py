# SPDX-License-Identifier: LGPL-3.0-or-later
"""Outputs of shells for verification only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from protractile.geometry.arrays import Array
from protractile.geometry.section import COMPONENT
from protractile.shell_model.segment.cross_section import Row, SectionNodes, quadratic
from protractile.shell_model.stress.stresses import ShellStress, linear_stress_weights


@dataclass(frozen=True, slots=True)
class WallForces:
    """Forces of one wall at a cross-section."""

    axial: float  #: force along x in N, positive in tension
    #: in-plane force in N on the part nearer the base, along y if the slope of the wall is below
    #: 45°, else along z
    shear: float
    #: moment in N·m of the axial stresses of the wall about the y-axis of the section, positive for
    #: tension at the top
    moment: float


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


def wall_forces(shell: ShellStress, t: float, segment: int, x: float) -> dict[str, WallForces]:
    """Return the forces of each wall at t in s, as means over the triangles around x in m."""
    row, step = shell.row(segment, x), int(np.abs(shell.time - t).argmin())
    ((_, fields),) = shell.over_time(row, slice(step, step + 1))
    length = shell.spans[row, 1].max() - shell.spans[row, 0].min()
    forces = {}
    for number, name in enumerate(shell.plates[segment]):
        mine = shell.wall[row] == number
        part = row[mine]
        width = shell.areas[part] / length
        membrane, bending = fields.membrane[0, mine], fields.bending[0, mine]
        strength = shell.thickness[part] * width
        z, sigma = shell.centroids[part, 2], membrane[:, 0]
        _, across, up = shell.outward[part].mean(axis=0).round(12)
        bending_moment = up * (shell.thickness[part] * strength / 6.0) @ bending[:, 0]
        reach, whole = np.array([abs(across) * width.sum()]), np.zeros(part.size, dtype=np.int64)
        moment = (strength * z + linear_stress_weights(whole, reach, strength, z)) @ sigma
        # The coordinate s runs along -z on the right and along -y on the bottom.
        sense = np.sign(up if abs(up) > abs(across) else -across)
        forces[name] = WallForces(
            axial=float(strength @ sigma),
            shear=float(sense * strength @ membrane[:, 2]),
            moment=float(moment + bending_moment),
        )
    return forces
