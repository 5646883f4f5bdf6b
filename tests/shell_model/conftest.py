# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells of the paper's segments, assembled once."""

from dataclasses import replace
from functools import cache

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.geometry.boom import PointMass, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.mesh import mesh_segment
from protractile.geometry.plating import add_thickness
from protractile.geometry.section import Section
from protractile.shell_model.segment.cross_section import Row
from protractile.shell_model.segment.segment_shell import SegmentShell, assemble_segment
from protractile.shell_model.segment.solver import ShiftedSolver
from tests.shell_model.booms import box_segment

BOX = BoxSection(height=0.4889, width=0.3259, flange=0.0065, web=0.0065)
UNEQUAL = BoxSection(0.4889, 0.3259, flange=0.010, web=0.0065, bottom_flange=0.005)


@cache
def box_shell(
    size: float,
    length: float = 10.0,
    supports: tuple[Support, ...] = (),
    masses: tuple[PointMass, ...] = (),
    section: Section = BOX,
) -> SegmentShell:
    """Return a box on [0, length], by default with the plates of the outer segment."""
    segment = replace(box_segment("box", 0.0, length, section, supports=supports), masses=masses)
    breaks = {"start": 0.0, "end": length}
    breaks |= {f"place-{one.x:g}": one.x for one in (*supports, *masses)}
    mesh = add_thickness(segment, mesh_segment(section, breaks, size))
    return assemble_segment(MPI.COMM_WORLD, segment, mesh if MPI.COMM_WORLD.rank == 0 else None)


def compliance(shell: SegmentShell, row: Row) -> float:
    """Return the displacement of a unit force along itself, in m/N.

    It is computed at 0.01 Hz instead of 0, since segments are free along x. This changes the
    compliance of a boom with the lowest frequency 7 Hz by 2e-6.
    """
    force = shell.row(row)
    solve = ShiftedSolver(shell, 0.01)
    moved = float(force @ solve(force[:, None])[:, 0])
    solve.destroy()
    return moved
