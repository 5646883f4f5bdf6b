# SPDX-License-Identifier: LGPL-3.0-or-later
"""Springs and masses that act on a displacement of a section, such as its mean deflection.

A spring k on the displacement with the row r adds k r rᵀ to the stiffness. The row distributes the
force over the section; other motions of the section stay free.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from geometry.arrays import Array
from geometry.boom import Direction, Segment
from shell_model.segment.cross_section import Row, SectionNodes

# Stiffness of a rigid rotational restraint, relative to G J_t / L or E J / L of its segment.
RIGID_TURN = 1.0e5


class Attachments(NamedTuple):
    """Springs or masses with the rows of their displacements."""

    rows: Array  #: this rank's parts (num_owned, num_attached) of the rows
    factors: Array  #: stiffnesses (num_attached,) in N/m or N·m, or masses in kg

    @classmethod
    def from_rows(
        cls, rows: Sequence[Array], factors: Sequence[float], num_owned: int
    ) -> Attachments:
        """Return the attachments with these rows (num_owned,) and factors."""
        return cls(np.array(rows).reshape(-1, num_owned).T, np.array(factors, dtype=np.float64))

    def add_to(self, comm: MPI.Comm, matrix: PETSc.Mat) -> None:
        """Add factor · r rᵀ for each row r to a matrix that is distributed by rows. Collective."""
        for row, factor in zip(self.rows.T, self.factors, strict=True):
            _add_outer_product(comm, matrix, row, float(factor))


def springs(segment: Segment) -> Iterator[tuple[float, Callable[[SectionNodes], Row], float]]:
    """Yield (x in m, function that returns the row, stiffness) of the springs of supports."""
    for support in segment.supports:
        section = segment.section_at(support.x)
        torsion = segment.material.shear_modulus * section.torsion_constant
        bending: Mapping[Direction, float] = {
            "z": segment.material.youngs_modulus * section.second_moment_of_area,
            "y": segment.material.youngs_modulus * section.lateral_second_moment_of_area,
        }
        if support.stiffness is not None:
            yield support.x, partial(SectionNodes.wall_deflection, direction="z"), support.stiffness
            yield support.x, partial(SectionNodes.wall_deflection, direction="y"), support.stiffness
            yield support.x, SectionNodes.twist, RIGID_TURN * torsion / segment.length
        for direction, stiffness in bending.items():
            turn = partial(SectionNodes.rotation, direction=direction)
            if support.holds_slope(direction) and not support.clamped:
                yield support.x, turn, RIGID_TURN * stiffness / segment.length
            elif support.rotation_stiffness is not None:
                yield support.x, turn, support.rotation_stiffness


def masses(segment: Segment) -> Iterator[tuple[float, Callable[[SectionNodes], Row], float]]:
    """Yield (x in m, function that returns the row, mass in kg) of point masses."""
    for mass in segment.masses:
        yield mass.x, partial(SectionNodes.mean_displacement, component=0), mass.mass
        yield mass.x, partial(SectionNodes.wall_deflection, direction="y"), mass.mass
        yield mass.x, partial(SectionNodes.wall_deflection, direction="z"), mass.mass


def _add_outer_product(comm: MPI.Comm, matrix: PETSc.Mat, local: Array, factor: float) -> None:
    first, _ = matrix.getOwnershipRange()
    mine = np.flatnonzero(local)
    columns = np.concatenate(comm.allgather(mine + first))
    values = np.concatenate(comm.allgather(local[mine]))
    counts = np.zeros(local.size + 1, dtype=PETSc.IntType)
    counts[mine + 1] = columns.size
    product = PETSc.Mat().createAIJ(
        matrix.getSizes(),
        csr=(
            np.cumsum(counts, dtype=PETSc.IntType),
            np.tile(columns, mine.size).astype(PETSc.IntType),
            factor * np.outer(local[mine], values).ravel(),
        ),
        comm=comm,
    )
    matrix.axpy(1.0, product, structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN)
    product.destroy()
