# SPDX-License-Identifier: LGPL-3.0-or-later
"""One segment alone as a shell, and what it gives way at rest."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpi4py import MPI

from geometry.arrays import Array
from geometry.mesh import collar_breaks, diaphragm_breaks, mesh_segment
from geometry.plating import plated
from geometry.segment import Segment
from shell_model.segment.cross_section import Row
from shell_model.segment.segment_shell import SegmentShell, assemble_segment
from shell_model.segment.solver import ShiftedSolver, gram

# In Hz, in place of zero, where nothing holds a segment along x: far below all elastic modes.
STATIC = 0.01


def shell_alone(segment: Segment, size: float, places: Sequence[float] = ()) -> SegmentShell:
    """On this process, with edges of a size in m, and mesh lines at its ends, its supports, its
    stiffeners, and at places x in m.
    """
    assert segment.section is not None
    plates = diaphragm_breaks(segment)
    breaks = {"start": segment.start, "end": segment.end} | plates | collar_breaks(segment)
    lines = [*places, *(support.x for support in segment.supports)]
    breaks |= {f"place-{k}": x for k, x in enumerate(lines, start=1)}
    mesh = mesh_segment(segment.section, breaks, size, closed=tuple(plates))
    return assemble_segment(MPI.COMM_SELF, segment, plated(segment, mesh))


def at_rest(shell: SegmentShell, forces: Array) -> Array:
    """(num_dofs, num_forces) displacements under forces of the same shape in N."""
    solve = ShiftedSolver(shell, STATIC)
    moved = solve(forces)
    solve.destroy()
    return moved


def compliances(shell: SegmentShell, *rows: Row) -> list[float]:
    """What a unit force on each row moves its own reading by, in m/N."""
    forces = np.column_stack([shell.row(row) for row in rows])
    moved = at_rest(shell, forces)
    return [
        float(gram(shell.comm, force[:, None], way[:, None])[0, 0])
        for force, way in zip(forces.T, moved.T, strict=True)
    ]
