# SPDX-License-Identifier: LGPL-3.0-or-later
"""Symmetry classes of a segment's motions, each as a quarter or half of its shell on one rank.

The matrices of a class are those of a part of the segment, so they are small, a motion cannot
drift into another class, and the numbers are the same to the last bit whichever rank computes them:
what ranks exchange are forces and shapes, taken apart and put together by sums of fixed order.
Round-off that depended on the number of ranks would not do, since contact amplifies the last bit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple, TypeVar

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from dynamics.failure import NumericsError
from geometry.arrays import Array, Indices
from geometry.boom import Segment
from geometry.plating import PlatedMesh
from geometry.section import COMPONENT, Direction
from shell_model import compat
from shell_model.reduction.mirror import (
    Rows,
    SymmetryClass,
    cell_mesh,
    components,
    image_of,
    matches,
    on_plane,
    rows_of,
    symmetry_classes,
    to_cell,
)
from shell_model.segment.attachments import Attached
from shell_model.segment.segment_shell import SegmentShell
from shell_model.segment.shell import (
    Matrices,
    Plates,
    Shell,
    assemble_plates,
    free_rows,
    hold,
    owned_nodes,
)

_Found = TypeVar("_Found")

# A force with less than this part of its largest value in a class has no part in it.
_NO_PART = 1.0e-9


@dataclass(frozen=True)
class SymmetryCell:
    """Part of a segment, a quarter or half, whose mirror images are the rest.

    Each rank assembles it once for all classes that it computes; its matrices stay there.

    Args:
        segment: the whole segment.
        mirrors: those of its section.
        mesh: that of the part.
    """

    segment: Segment
    mirrors: Sequence[Direction]
    mesh: PlatedMesh

    @property
    def copies(self) -> float:
        """Number of parts that make the segment."""
        return 2.0 ** len(self.mirrors)

    @cached_property
    def plates(self) -> Plates:
        """Plates of the part, on this rank alone."""
        return assemble_plates(MPI.COMM_SELF, self.segment, self.mesh)

    @cached_property
    def nodes(self) -> Sequence[tuple[Array, Indices]]:
        """Places of the displacement nodes and of the rotation nodes, in m."""
        return [owned_nodes(self.plates.space, kind) for kind in (0, 1)]

    @cached_property
    def rows(self) -> Rows:
        """Component of each row, and the mirrors in which the row lies."""
        return rows_of(self.nodes)

    @cached_property
    def _matrices(self) -> dict[Any, _FreeMatrix]:
        """Matrices of the plates without supports, by their forms, as far as they are assembled."""
        return {}

    def matrix(self, form: Any) -> _FreeMatrix:
        """Return the matrix of the whole segment's plates without supports, for all classes."""
        if form not in self._matrices:
            whole = compat.assemble_matrix(form, [], 0.0)
            first, columns, values = whole.getValuesCSR()
            whole.destroy()
            rows = np.repeat(np.arange(first.size - 1, dtype=columns.dtype), np.diff(first))
            kept = (values != 0.0) | (rows == columns)
            self._matrices[form] = _FreeMatrix(
                rows[kept], columns[kept], self.copies * values[kept]
            )
        return self._matrices[form]

    def __reduce__(self) -> tuple[type[SymmetryCell], tuple[Any, ...]]:
        return SymmetryCell, (self.segment, self.mirrors, self.mesh)


class _FreeMatrix(NamedTuple):
    """Entries of a matrix: (num_entries,) each, those of a row together, with its diagonal."""

    row: Indices
    column: Indices
    value: Array


class _ClassMatrices(Matrices):
    """Matrices of a symmetry class on one rank, those of its cell with the class's supports.

    They have none of the zeros in the pattern of their forms: motions of a plane wall in its plane
    and across it do not couple, nor do the masses of different components. Factors would store
    these zeros too.
    """

    def __init__(
        self, cell: SymmetryCell, holds: list[Any], springs: Attached, masses: Attached
    ) -> None:
        super().__init__(MPI.COMM_SELF, cell.plates, holds, springs, masses)
        self._cell = cell

    def _assembled(self, form: Any, diagonal: float, attached: Attached) -> PETSc.Mat:
        row, column, value = self._cell.matrix(form)
        free = free_rows(self.plates.space, self._holds)
        value = np.where(
            free[row], value, np.where(row == column, self._cell.copies * diagonal, 0.0)
        )
        kept = (value != 0.0) & (free[column] | (row == column))
        first = np.cumsum([0, *np.bincount(row[kept], minlength=free.size)], dtype=row.dtype)
        matrix = PETSc.Mat().createAIJ(
            (free.size, free.size), csr=(first, column[kept], value[kept]), comm=self._comm
        )
        attached.add_to(self._comm, matrix)
        return matrix


@dataclass(frozen=True, slots=True)
class Job:
    """Data for the rank that computes a symmetry class.

    Args:
        symmetry_class: the symmetry class.
        forces, readings: (num_rows, num_columns) on that part's rows, images added up.
        springs, masses: of the segment, on these rows.
    """

    symmetry_class: SymmetryClass
    forces: Array
    readings: Array
    springs: Attached
    masses: Attached

    def shell(self, part: SymmetryCell) -> Shell:
        """Return the shell of the part of a segment, with the energies of the whole one."""
        plates, mirrors = part.plates, part.mirrors
        holds = [
            *plates.holds,
            *(
                hold(plates.space, kind, component, partial(on_plane, axis=axis))
                for axis in (COMPONENT[mirror] for mirror in mirrors)
                for kind, component in self.symmetry_class.held(axis)
            ),
        ]
        (nodes, node_dofs), (rotation_nodes, rotation_dofs) = part.nodes
        return Shell(
            comm=MPI.COMM_SELF,
            matrices=_ClassMatrices(part, holds, self.springs, self.masses),
            free=free_rows(plates.space, holds),
            springs=self.springs,
            nodes=nodes,
            node_dofs=node_dofs,
            rotation_nodes=rotation_nodes,
            rotation_dofs=rotation_dofs,
            space=plates.space,
        )


def _part_of(shell: SegmentShell) -> SymmetryCell:
    """Assemble the part of a segment on each rank; rank 0 reduces by symmetry. Collective."""
    mirrors, comm = shell.section.mirrors, shell.comm

    def of_mesh() -> SymmetryCell | None:
        if shell.mesh is None:
            return None
        part = SymmetryCell(shell.segment, mirrors, cell_mesh(shell.mesh, mirrors))
        # Assembled here, where all ranks receive an error.
        assert part.nodes
        return part

    found = together(comm, of_mesh)
    sent: SymmetryCell = comm.bcast(found)
    return found or sent


class SymmetryReduction:
    """Map between the distributed rows of a segment and those of its quarter. Collective.

    Args:
        shell: that of the whole segment.

    Raises:
        NumericsError: it is not its own mirror image.
    """

    def __init__(self, shell: SegmentShell) -> None:
        self.shell, self._comm, self._mirrors = shell, shell.comm, shell.section.mirrors
        self.part = _part_of(shell)
        parts = (shell.nodes, shell.node_dofs), (shell.rotation_nodes, shell.rotation_dofs)
        first, _ = shell.owned
        shape = 3, shell.free.size
        self._row, self._image_of_row, self._component = np.empty(shape, dtype=np.int64)
        for number, (nodes, dofs) in enumerate(parts):
            gathered = self._comm.gather(to_cell(nodes, self._mirrors))
            found: Sequence[Any] = []
            if gathered is not None:
                places, rows = self.part.nodes[number]
                found = [rows[matches(some, places)] for some in gathered]
            self._row[dofs - first] = self._comm.scatter(found)
            self._image_of_row[dofs - first] = image_of(nodes, self._mirrors)[:, None]
            self._component[dofs - first] = components(number)

    def jobs(self, inputs: Array, readings: Array) -> list[Job]:
        """Return a job for each class that an input excites, on rank 0; none elsewhere. Collective.

        Inputs and readings are (num_owned, num_columns) of the whole segment.
        """
        shell = self.shell
        blocks = inputs, readings, shell.springs.rows, shell.masses.rows
        gathered = [self._gather(block) for block in blocks]
        if self._comm.rank != 0:
            return []
        images = [self._images(entries) for entries in gathered if entries is not None]
        jobs = []
        for symmetry_class in symmetry_classes(self._mirrors):
            signs = symmetry_class.signs[:, self.part.rows.component]
            forces, read, springs, masses = (_added_up(image, signs) for image in images)
            if forces.any():
                attached = (
                    Attached(springs, shell.springs.factors),
                    Attached(masses, shell.masses.factors),
                )
                jobs.append(Job(symmetry_class, forces, read, *attached))
        return jobs

    def sum_classes(
        self, columns: Array, total: Array, compute: Callable[[int, Job], Array]
    ) -> Array:
        """Add the results of each class that columns (num_owned, num_columns) excite.

        ``total`` holds the sum. Collective.
        """
        jobs = self.jobs(columns, columns[:, :0])
        for root, found in shared(self._comm, jobs, compute):
            total += self._comm.bcast(found, root)
        return total

    def expand(self, shapes: Array | None, symmetry_class: SymmetryClass, root: int) -> Array:
        """Return shapes (num_owned, num_shapes) of a class on the whole segment. Collective.

        On the quarter they are (num_rows, num_shapes) on the rank ``root``, None elsewhere.
        """
        comm = self._comm
        count = comm.bcast(None if shapes is None else shapes.shape[1], root)
        rows = comm.gather(self._row, root)
        every = sizes = None
        if rows is not None:
            every, sizes = np.concatenate(rows), [one.size for one in rows]
        signs = symmetry_class.signs[self._image_of_row, self._component]
        unfolded = np.empty((self._row.size, count), order="F")
        for column in range(count):
            # One after another, so that no rank holds the whole block.
            whole = None if shapes is None else shapes[every, column]
            if comm.size == 1:
                # Open MPI takes ten times as long to send a column to its own process.
                unfolded[:, column] = whole
            else:
                comm.Scatterv(None if whole is None else (whole, sizes), unfolded[:, column], root)
            unfolded[:, column] *= signs
        return unfolded

    def _gather(self, block: Array) -> list[_Entries] | None:
        """Gather the nonzero entries of a block on rank 0."""
        row, column = np.nonzero(block)
        value, columns = block[row, column], block.shape[1]
        mine = _Entries(self._row[row], self._image_of_row[row], column, value, columns)
        return self._comm.gather(mine)

    def _images(self, gathered: list[_Entries]) -> Array:
        """Return a block in each quarter (4, num_rows, num_columns), halved on mirror planes."""
        in_mirrors = self.part.rows.in_mirrors
        images = np.zeros((4, self.part.rows.component.size, gathered[0].columns))
        for entries in gathered:
            images[entries.quarter, entries.row, entries.column] = entries.value
        for axis in self._mirrors:
            within = in_mirrors[COMPONENT[axis] - 1]
            for here, there in _IMAGES[axis]:
                images[here, within] *= 0.5
                images[there, within] = images[here, within]
        return images


def shared(
    comm: MPI.Comm, jobs: Sequence[Job], compute: Callable[[int, Job], _Found]
) -> Iterator[tuple[int, _Found | None]]:
    """Compute each job of rank 0 on one rank; yield the rank and its result. Collective."""
    roots = [number % comm.size for number in range(comm.bcast(len(jobs)))]
    mine = {number: job for number, job in enumerate(_sent(comm, jobs, roots)) if job is not None}
    found = together(comm, lambda: {number: compute(number, job) for number, job in mine.items()})
    for number, root in enumerate(roots):
        yield root, found.pop(number, None)


def together(comm: MPI.Comm, work: Callable[[], _Found]) -> _Found:
    """Return each rank's result of its own work. Collective, but the work must not communicate.

    Raises:
        NumericsError: on every rank, if the work of any raises it, or its memory does not suffice.
    """
    results: list[_Found] = []
    problem = ""
    try:
        results.append(work())
    except NumericsError as error:
        problem = str(error)
    except (MemoryError, PETSc.Error) as error:
        problem = f"the direct solver failed ({error}); give it more memory, or a coarser mesh"
    problems = [told for told in comm.allgather(problem) if told]
    if problems:
        raise NumericsError(problems[0])
    return results[0]


def _sent(comm: MPI.Comm, jobs: Sequence[Job], roots: Sequence[int]) -> Iterator[Job | None]:
    """Send every job of rank 0 in turn to the rank that computes it; None on the others."""
    for number, root in enumerate(roots):
        if comm.rank == 0 and root != 0:
            comm.send(jobs[number], root)
            yield None
        elif comm.rank == root:
            yield jobs[number] if root == 0 else comm.recv(source=0)
        else:
            yield None


class _Entries(NamedTuple):
    """Entries of a block: (num_entries,) each, and the number of columns of the block."""

    row: Indices
    quarter: Indices
    column: Indices
    value: Array
    columns: int


# Quarters that meet in the mirror of an axis.
_IMAGES: Mapping[Direction, Sequence[tuple[int, int]]] = {
    "y": ((0, 1), (2, 3)),
    "z": ((0, 2), (1, 3)),
}


def _added_up(images: Array, signs: Array) -> Array:
    """Return the part (num_rows, num_columns) of a symmetry class; exactly 0 if it has none."""
    part = np.zeros(images.shape[1:])
    for image, sign in zip(images, signs, strict=True):
        part += sign[:, None] * image
    largest = np.abs(images).max(axis=(0, 1), initial=0.0)
    part[:, np.abs(part).max(axis=0, initial=0.0) <= _NO_PART * largest] = 0.0
    return part
