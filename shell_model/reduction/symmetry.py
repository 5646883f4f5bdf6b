# SPDX-License-Identifier: LGPL-3.0-or-later
"""Symmetry reduction: one rank computes each symmetry class of motions, on a symmetry cell.

A symmetry cell is a quarter or half of the shell of a segment. So matrices are small, round-off
does not mix classes, and results are bitwise equal on any rank. Ranks exchange only forces and
shapes, in sums of fixed order. Contact amplifies round-off, which therefore must not depend on the
number of ranks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Future
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any, NamedTuple, TypeVar

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array, Indices, Mask
from protractile.geometry.boom import Segment
from protractile.geometry.plating import PlatedMesh
from protractile.geometry.section import COMPONENT, Direction
from protractile.shell_model import compat
from protractile.shell_model.reduction.mirror import (
    SymmetryClass,
    cell_mesh,
    image_of,
    match_points,
    mirror_to_cell,
    on_plane,
    symmetry_classes,
)
from protractile.shell_model.segment.segment_shell import SegmentShell
from protractile.shell_model.segment.shell import (
    Attachments,
    Plates,
    ShellMatrices,
    assemble_plates,
    dirichlet_condition,
)

_Result = TypeVar("_Result")

# Components of the displacement, and of the rotation.
_COMPONENTS = np.arange(6).reshape(2, 3)

# Work of a factorisation, in solutions for one load vector: about as much as for a box section.
_FACTORISATION = 20

# Fraction of the largest value of a column below which its part in a class is round-off.
_ROUND_OFF = 1.0e-9


@dataclass(frozen=True)
class SymmetryCell:
    """Quarter or half of a segment, whose mirror images complete the segment.

    Each rank assembles its matrices once for all classes.
    """

    segment: Segment  #: the whole segment
    mirrors: Sequence[Direction]  #: normals of the mirror planes
    mesh: PlatedMesh  #: mesh of the cell

    @cached_property
    def plates(self) -> Plates:
        """The plates of the cell on this rank.

        Matrices of the cell are multiplied by the number of cells in the segment.
        """
        copies = 2.0 ** len(self.mirrors)
        return assemble_plates(MPI.COMM_SELF, self.segment, self.mesh, copies)

    @cached_property
    def component(self) -> Indices:
        """The component (num_rows,) of each row: 0 to 2 displacement, 3 to 5 rotation."""
        component = np.empty(sum(rows.size for _, rows in self.plates.nodes), dtype=np.int64)
        for (_, rows), components in zip(self.plates.nodes, _COMPONENTS, strict=True):
            component[rows] = components
        return component

    def in_mirror(self, axis: int) -> Mask:
        """Return the mask (num_rows,) of rows in the mirror plane of an axis."""
        within = np.empty(self.component.size, dtype=bool)
        for places, rows in self.plates.nodes:
            within[rows] = on_plane(places, axis)[:, None]
        return within

    @cached_property
    def _matrices(self) -> dict[Any, _FreeMatrix]:
        """The cache of assembled matrices, by form."""
        return {}

    def matrix(self, form: Any) -> _FreeMatrix:
        """Return the matrix of a form without supports, with the energy of the whole segment."""
        if form not in self._matrices:
            whole = compat.assemble_matrix(form, [], 0.0)
            first, columns, values = whole.getValuesCSR()
            whole.destroy()
            rows = np.repeat(np.arange(first.size - 1, dtype=columns.dtype), np.diff(first))
            kept = (values != 0.0) | (rows == columns)
            values = self.plates.copies * values[kept]
            self._matrices[form] = _FreeMatrix(rows[kept], columns[kept], values)
        return self._matrices[form]

    def __reduce__(self) -> tuple[type[SymmetryCell], tuple[Any, ...]]:
        return SymmetryCell, (self.segment, self.mirrors, self.mesh)


class _FreeMatrix(NamedTuple):
    """Sparse matrix: entries (num_entries,) sorted by row, and the diagonal."""

    row: Indices
    column: Indices
    value: Array


@dataclass(frozen=True)
class _ClassShell(ShellMatrices):
    """Shell of a symmetry class on one rank, with the matrices of its cell.

    Matrices omit zeros in the sparsity pattern of their forms, since factors would store them.
    """

    cell: SymmetryCell

    def _assemble(self, form: Any, diagonal: float, attached: Attachments) -> PETSc.Mat:
        (row, column, value), free = self.cell.matrix(form), self.free
        fixed = np.where(row == column, self.plates.copies * diagonal, 0.0)
        value = np.where(free[row], value, fixed)
        kept = (value != 0.0) & (free[column] | (row == column))
        first = np.cumsum([0, *np.bincount(row[kept], minlength=free.size)], dtype=row.dtype)
        matrix = PETSc.Mat().createAIJ(
            (free.size, free.size), csr=(first, column[kept], value[kept]), comm=self.comm
        )
        attached.add_to(self.comm, matrix)
        return matrix


@dataclass(frozen=True, slots=True)
class Job:
    """Data of a symmetry class for the rank that computes it.

    Args:
        forces, outputs, probes: load vectors, output rows and loads of probes
            (num_rows, num_columns) on the cell, sums over all images.
        springs, masses: springs and masses of the segment on the rows of the cell.
    """

    symmetry_class: SymmetryClass
    forces: Array
    outputs: Array
    probes: Array
    springs: Attachments
    masses: Attachments

    @property
    def num_forces(self) -> int:
        """The number of load vectors that are not zero in this class."""
        return int(np.count_nonzero(self.forces.any(axis=0)))

    @property
    def work(self) -> int:
        """The work of the reduction, in solutions for one row of one load vector."""
        return len(self.forces) * (_FACTORISATION + self.num_forces)

    def shell(self, cell: SymmetryCell) -> ShellMatrices:
        """Return the shell of a cell in this symmetry class, with the energy of the segment."""
        conditions = [
            dirichlet_condition(cell.plates.space, kind, component, partial(on_plane, axis=axis))
            for axis in (COMPONENT[mirror] for mirror in cell.mirrors)
            for kind, component in self.symmetry_class.fixed_components(axis)
        ]
        conditions = [*cell.plates.supports, *conditions]
        return _ClassShell(MPI.COMM_SELF, cell.plates, conditions, self.springs, self.masses, cell)


class SymmetryReduction:
    """Map from the distributed rows of a segment to the rows of its symmetry cell. Collective.

    Attributes:
        cell: symmetry cell, assembled on each rank that computes a class.

    Raises:
        NumericsError: the segment is not symmetric.
    """

    def __init__(self, shell: SegmentShell) -> None:
        self.shell, self._comm, self._mirrors = shell, shell.comm, shell.segment.mirrors

        def of_mesh() -> SymmetryCell | None:
            if shell.mesh is None:
                return None
            cell = SymmetryCell(shell.segment, self._mirrors, cell_mesh(shell.mesh, self._mirrors))
            # The plates are assembled here, so that an error is raised on all ranks.
            assert cell.plates.nodes
            return cell

        cell_of_mesh = run_collectively(self._comm, of_mesh)
        sent: SymmetryCell = self._comm.bcast(cell_of_mesh)
        self.cell = cell_of_mesh or sent
        first, _ = shell.owned
        self._row, self._image_of_row, self._component = np.empty(
            (3, shell.free.size), dtype=np.int64
        )
        for part, (nodes, dofs) in enumerate(shell.plates.nodes):
            gathered = self._comm.gather(mirror_to_cell(nodes, self._mirrors))
            rows_of_nodes: Sequence[Any] = []
            if gathered is not None:
                places, rows = self.cell.plates.nodes[part]
                rows_of_nodes = [rows[match_points(some, places)] for some in gathered]
            self._row[dofs - first] = self._comm.scatter(rows_of_nodes)
            self._image_of_row[dofs - first] = image_of(nodes, self._mirrors)[:, None]
            self._component[dofs - first] = _COMPONENTS[part]

    def jobs(self, inputs: Array, outputs: Array, probes: Array) -> list[Job]:
        """Return a job for each symmetry class that inputs or probes excite, on rank 0. Collective.

        Load vectors ``inputs``, output rows ``outputs`` and load vectors ``probes`` are
        (num_owned, num_columns) on the whole segment.
        """
        shell = self.shell
        blocks = inputs, outputs, probes, shell.springs.rows, shell.masses.rows
        gathered = [self._gather(block) for block in blocks]
        if self._comm.rank != 0:
            return []
        images = [self._images(entries) for entries in gathered if entries is not None]
        largest = [np.abs(image).max(axis=(0, 1), initial=0.0) for image in images]
        jobs = []
        for symmetry_class in symmetry_classes(self._mirrors):
            signs = symmetry_class.signs[:, self.cell.component]
            forces, rows, loads, springs, masses = (
                _sum_of_class(image, signs, size)
                for image, size in zip(images, largest, strict=True)
            )
            if forces.any() or loads.any():
                attached_springs = Attachments(springs, shell.springs.factors)
                attached = attached_springs, Attachments(masses, shell.masses.factors)
                jobs.append(Job(symmetry_class, forces, rows, loads, *attached))
        return jobs

    def sum_classes(
        self, columns: Array, total: Array, compute: Callable[[int, Job], Array]
    ) -> Array:
        """Add the results of all classes to ``total``, and return it. Collective.

        ``columns`` (num_owned, num_columns) are the forces of jobs. ``compute`` returns the result
        of a class from its index and job.
        """
        jobs = self.jobs(columns, columns[:, :0], columns[:, :0])
        for root, part in share_jobs(self._comm, jobs, compute):
            total += self._comm.bcast(part, root)
        return total

    def expand(self, shapes: Array | None, symmetry_class: SymmetryClass, root: int) -> Array:
        """Return shapes (num_owned, num_shapes) of a class on the whole segment. Collective.

        ``shapes`` are (num_rows, num_shapes) on the cell, on rank ``root``; None elsewhere.
        """
        comm = self._comm
        count = comm.bcast(None if shapes is None else shapes.shape[1], root)
        rows = comm.gather(self._row, root)
        every = sizes = None
        if rows is not None:
            every, sizes = np.concatenate(rows), [row.size for row in rows]
        signs = symmetry_class.signs[self._image_of_row, self._component]
        expanded = np.empty((self._row.size, count), order="F")
        for column in range(count):
            # Columns are sent one by one, so that no rank needs memory for the whole block.
            whole = None if shapes is None else shapes[every, column]
            if comm.size == 1:
                # A message of Open MPI to its own process would take ten times as long.
                expanded[:, column] = whole
            else:
                comm.Scatterv(None if whole is None else (whole, sizes), expanded[:, column], root)
            expanded[:, column] *= signs
        return expanded

    def _gather(self, block: Array) -> list[_Entries] | None:
        """Gather the nonzero entries of a block on rank 0."""
        row, column = np.nonzero(block)
        value, columns = block[row, column], block.shape[1]
        mine = _Entries(self._row[row], self._image_of_row[row], column, value, columns)
        return self._comm.gather(mine)

    def _images(self, gathered: list[_Entries]) -> Array:
        """Return the entries (4, num_rows, num_columns) of a block in each image of the cell.

        An entry on a mirror plane is divided equally between the images on both sides.
        """
        images = np.zeros((4, self.cell.component.size, gathered[0].columns))
        for entries in gathered:
            images[entries.image, entries.row, entries.column] = entries.value
        for axis in self._mirrors:
            within = self.cell.in_mirror(COMPONENT[axis])
            for here, there in _IMAGES[axis]:
                images[here, within] *= 0.5
                images[there, within] = images[here, within]
        return images


def share_jobs(
    comm: MPI.Comm,
    jobs: Sequence[Job],
    compute: Callable[[int, Job], _Result],
    submit: Callable[[int, Job], Future[Any]] | None = None,
) -> Iterator[tuple[int, _Result | None]]:
    """Compute the jobs of rank 0 on all ranks, and yield (rank, result) of each. Collective.

    On all other ranks the result is None. ``submit`` sends the jobs after :func:`first_half` to
    another process.
    """
    roots = [number % comm.size for number in range(comm.bcast(len(jobs)))]
    mine = {
        number: job for number, job in enumerate(_distribute(comm, jobs, roots)) if job is not None
    }
    futures: dict[int, Future[Any]] = {}
    if submit is not None:
        # If the other process has ended, this process computes its jobs.
        with suppress(BrokenExecutor):
            futures |= {n: submit(n, mine[n]) for n in list(mine)[first_half([*mine.values()]) :]}

    def work() -> dict[int, _Result]:
        here = {n: compute(n, job) for n, job in mine.items() if n not in futures}
        there = {
            n: result_or_compute(future, partial(compute, n, mine[n]))
            for n, future in futures.items()
        }
        return here | there

    results = run_collectively(comm, work)
    for number, root in enumerate(roots):
        yield root, results.pop(number, None)


def first_half(jobs: Sequence[Job]) -> int:
    """Return how many of the first jobs make about half of the work.

    Jobs of the same segment stay together, as each process assembles the cells of its jobs.
    """
    work = np.cumsum([job.work for job in jobs])
    return int(np.abs(work - 0.5 * work[-1]).argmin()) + 1


def result_or_compute(future: Future[Any] | None, compute: Callable[[], _Result]) -> _Result:
    """Return the result of another process, or compute it here if that process has ended."""
    with suppress(BrokenExecutor):
        if future is not None:
            result: _Result = future.result()
            return result
    return compute()


def run_collectively(comm: MPI.Comm, work: Callable[[], _Result]) -> _Result:
    """Return the result of ``work``, which must not communicate, on each rank. Collective.

    Raises:
        NumericsError: the work of a rank raises this error or needs too much memory; it is raised
            on every rank.
    """
    results: list[_Result] = []
    problem = ""
    try:
        results.append(work())
    except NumericsError as error:
        problem = str(error)
    except (MemoryError, PETSc.Error) as error:
        problem = f"the direct solver failed ({error}); give it more memory, or a coarser mesh"
    problems = [message for message in comm.allgather(problem) if message]
    if problems:
        raise NumericsError(problems[0])
    return results[0]


def _distribute(comm: MPI.Comm, jobs: Sequence[Job], roots: Sequence[int]) -> Iterator[Job | None]:
    """Send the jobs of rank 0 to other ranks; yield a job on its rank, None on the others."""
    for number, root in enumerate(roots):
        if comm.rank == 0 and root != 0:
            comm.send(jobs[number], root)
            yield None
        elif comm.rank == root:
            yield jobs[number] if root == 0 else comm.recv(source=0)
        else:
            yield None


class _Entries(NamedTuple):
    """Nonzero entries of a block, (num_entries,) each, and its number of columns."""

    row: Indices
    image: Indices
    column: Indices
    value: Array
    columns: int


# Pairs of images that meet in the mirror plane of an axis.
_IMAGES: Mapping[Direction, Sequence[tuple[int, int]]] = {
    "y": ((0, 1), (2, 3)),
    "z": ((0, 2), (1, 3)),
}


def _sum_of_class(images: Array, signs: Array, largest: Array) -> Array:
    """Return the part (num_rows, num_columns) of images in the symmetry class with these signs.

    Columns that are only round-off are zero; ``largest`` (num_columns,) are the largest values.
    """
    part = np.zeros(images.shape[1:])
    for image, sign in zip(images, signs, strict=True):
        part += sign[:, None] * image
    part[:, np.abs(part).max(axis=0, initial=0.0) <= _ROUND_OFF * largest] = 0.0
    return part
