# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells of the paper's segments, assembled once."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from geometry.boom import Material, Segment
from geometry.mesh import mesh_segment
from geometry.section import BoxSection
from shell_model.segment_shell import SegmentShell, assemble_segment

STEEL = Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
BOX = BoxSection(height=0.4889, width=0.3259, flange=0.0065, web=0.0065)


@cache
def box_shell(
    size: float, length: float = 10.0, supports: tuple[float, ...] = (), load: float = 0.0
) -> SegmentShell:
    """A box of the outer segment's plates on [0, length]."""
    segment = Segment(
        name="box",
        start=0.0,
        end=length,
        material=STEEL,
        mass_per_length=BOX.mass_per_length(STEEL.density),
        second_moment_of_area=BOX.second_moment_of_area,
        rotary_inertia=STEEL.density * BOX.second_moment_of_area,
        section=BOX,
        load=load,
        supports=supports,
    )
    breaks = {"start": 0.0, "end": length} | {f"support-{x:g}": x for x in supports}
    mesh = mesh_segment(BOX, breaks, size)
    return assemble_segment(MPI.COMM_WORLD, segment, mesh if MPI.COMM_WORLD.rank == 0 else None)


@pytest.fixture(name="box_shell")
def _box_shell() -> Callable[..., SegmentShell]:
    return box_shell
