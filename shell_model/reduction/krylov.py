# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduction of one symmetry class: its Krylov basis, errors and coordinates."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, repeat
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc
from scipy.linalg import block_diag, eigh

from protractile.dynamics.failure import NumericsError
from protractile.geometry.arrays import Array, Mask
from protractile.geometry.probe_responses import PROBE_FREQUENCY
from protractile.shell_model.reduction.symmetry import Job, SymmetryCell
from protractile.shell_model.segment.shell import ShellMatrices
from protractile.shell_model.segment.solver import ShiftedSolver, times

# Fraction of a vector's length below which the part beyond the basis is round-off.
_DEPENDENT = 1.0e-9

# Number of modes that are tested together: a block of solutions takes a third of the time.
_BATCH = 16

# Maximum number of blocks at each shift; more blocks do not reduce the error.
_MAX_MOMENTS = 12


@dataclass(frozen=True, slots=True)
class KrylovOptions:
    """Shifts and moments of a Krylov basis, or its permitted error."""

    #: frequencies f in Hz of the shifts σ = (2π f)², at which moments match
    shifts: tuple[float, ...] = (5.0, 50.0, 300.0, 1500.0)
    moments: int = 3  #: number of matched moments (derivatives with respect to ω²) at each shift
    #: permitted relative error of the contact compliance and of the response of outputs. If it is
    #: given, the number of moments increases until the error is permitted.
    tolerance: float | None = None
    #: maximum number of coordinates of a segment. Each symmetry class keeps its rigid motions and
    #: at least one further coordinate.
    most: int | None = None

    @property
    def order(self) -> Iterator[float]:
        """The shifts of successive blocks in Hz.

        Successive blocks at the same shift need only one factorisation. But with ``tolerance`` or
        ``most`` the basis may end early, so that the first blocks have different shifts.
        """
        if self.tolerance is None and self.most is None:
            return chain.from_iterable(repeat(shift, self.moments) for shift in self.shifts)
        if self.tolerance is None:
            return chain.from_iterable(repeat(self.shifts, self.moments))
        # Rounds alternate in direction, since successive blocks at one shift share a factorisation.
        both = self.shifts[::-1], self.shifts
        return chain.from_iterable(both[number % 2] for number in range(_MAX_MOMENTS))

    @property
    def tests(self) -> Sequence[float]:
        """The frequencies in Hz at which errors are measured: between the shifts, descending."""
        shifts = np.sort(self.shifts)
        between = np.sqrt(shifts[:-1] * shifts[1:]) if shifts.size > 1 else shifts
        return [float(frequency) for frequency in between[::-1]]


@dataclass(frozen=True, slots=True)
class Coordinates:
    """Mass-normalised coordinates of a symmetry class or of a segment."""

    omega2: Array  #: ω² (num_modes,) in rad²/s², ascending, rigid motions first and exactly 0
    shapes: Array  #: this rank's rows (num_rows, num_modes) of the shapes in 1/√kg
    #: largest relative error of the contact compliance at frequencies between the shifts
    compliance_error: float
    #: largest error of the response of outputs to inputs, relative to the geometric mean of both
    #: compliances
    output_error: float
    #: largest error (num_inputs,) in m/N of the compliance of each input. The error for a pair of
    #: inputs is at most the geometric mean of their errors (Galerkin).
    lost_compliance: Array
    geometric: Array  #: geometric stiffness K_G (num_modes, num_modes) in 1/s²
    #: orthonormal coefficients (num_modes, num_coarser) of a coarser basis within this one
    coarser: Array
    #: compliance (num_probes, num_probes) of the full model to probes, at ``PROBE_FREQUENCY``
    probe_compliance: Array


@dataclass(frozen=True, slots=True)
class ClassCoordinates(Coordinates):
    """Coordinates of a symmetry class on the rows of its cell."""

    accurate: Mask  #: mask (num_modes,) of modes with a natural frequency within 0.1 %


def reduce_class(
    cell: SymmetryCell,
    job: Job,
    options: KrylovOptions,
    progress: Callable[[float], None] = lambda _: None,
) -> ClassCoordinates:
    """Return the coordinates of a reduced symmetry class on the rank that computes it.

    Args:
        cell, job: the cell of the segment, and the data of the class.
        options: options; ``most`` is for this class.
        progress: callback that receives the completed fraction, 0 to 1.

    Raises:
        NumericsError: a compliance is not finite, or the tolerance is not met.
    """
    shell = job.shell(cell)
    inputs, rows, probes = (
        columns * shell.free[:, None] for columns in (job.forces, job.outputs, job.probes)
    )
    forces, rows = _independent(inputs), rows[:, rows.any(axis=0)]
    order, tests = list(options.order), options.tests
    stages = len(order) + len(tests)
    basis = _KrylovBasis(shell, forces, options.most)
    solve = ShiftedSolver(shell, PROBE_FREQUENCY)
    probe_compliance = probes.T @ solve(probes)
    if options.tolerance is not None:
        full = [_FullResponse.at(frequency, solve, forces, rows) for frequency in tests]
    missed = False
    for done, frequency in enumerate(order, start=1):
        solve.move(frequency)
        has_grown = basis.grow(solve)
        progress(done / stages)
        if options.tolerance is not None:
            missed = max(basis.errors(full, rows)) > options.tolerance
        if not has_grown or (options.tolerance is not None and not missed):
            break
    if shell.geometric is not None:
        # These vectors come last, since each block follows from the previous block.
        solve.move(min(order))
        basis.add_axial_responses(shell.geometric, solve)
    if options.tolerance is None:
        full = [_FullResponse.at(frequency, solve, forces, rows) for frequency in tests]
    errors = basis.errors(full, rows)
    if not np.isfinite(errors).all():
        raise NumericsError("the reduced compliance is not finite; check the mesh and the material")
    if missed:
        raise NumericsError(
            f"a segment's reduction errs by {max(errors):.1e} with {basis.size} coordinates in one "
            f"of its planes, and {options.tolerance:.1e} is asked for; give a larger tolerance, or "
            "a coarser mesh, whose round-off is less"
        )
    lost = basis.compliance_error(full, forces.T @ inputs)
    omega2, shapes, coarser = basis.modes(len(options.shifts))
    solve.move(min(order))
    accurate = _find_accurate(shell, omega2, shapes, solve)
    solve.destroy()
    progress(1.0)
    geometric = np.zeros((omega2.size, omega2.size))
    if shell.geometric is not None:
        geometric = shapes.T @ times(shell.geometric, shapes)
    return ClassCoordinates(
        omega2, shapes, *errors, lost, geometric, coarser, probe_compliance, accurate
    )


class _FullResponse(NamedTuple):
    """Responses of the full model at a shift, with the scales of their errors."""

    sigma: float  #: shift σ in rad²/s²
    compliance: Array  #: compliance (num_forces, num_forces) of the forces
    scale: Array  #: geometric means of pairs of diagonal entries of ``compliance``
    transfer: Array  #: responses (num_outputs, num_forces) of outputs to forces
    transfer_scale: Array  #: geometric means of the compliances of outputs and forces

    @classmethod
    def at(
        cls, frequency: float, solve: ShiftedSolver, forces: Array, rows: Array
    ) -> _FullResponse:
        solve.move(frequency)
        displacements = solve(forces)
        compliance = forces.T @ displacements
        of_forces = np.diag(compliance)
        of_rows = np.einsum("ij,ij->j", rows, solve(rows))
        return cls(
            solve.sigma,
            compliance,
            np.sqrt(np.outer(of_forces, of_forces)),
            rows.T @ displacements,
            np.sqrt(np.outer(of_rows, of_forces)),
        )


class _KrylovBasis:
    """M-orthonormal basis, rigid motions first, and the projected stiffness."""

    def __init__(self, shell: ShellMatrices, forces: Array, most: int | None) -> None:
        self._shell, self._forces = shell, forces
        rigid = _independent(shell.rigid_motions() * shell.free[:, None])
        self._most = shell.free.size if most is None else max(most, rigid.shape[1] + 1)
        self._vectors = np.empty((shell.free.size, 0), order="F")
        self._stiffness = np.zeros((0, 0))
        self._append(rigid)
        self._rigid = self.size
        self._ends = [self.size]  # numbers of vectors after each block
        self._pushes = forces
        self._pushed = forces.shape[1]

    @property
    def size(self) -> int:
        return int(self._vectors.shape[1])

    def grow(self, solve: ShiftedSolver) -> bool:
        """Add the next block, and return whether it has new vectors."""
        block = self._append(solve(self._pushes))
        self._pushes = times(self._shell.mass, block)
        self._ends.append(self.size)
        return bool(block.shape[1])

    def add_axial_responses(self, geometric: PETSc.Mat, solve: ShiftedSolver) -> None:
        """Add the responses to K_G times the rigid motions and the first block."""
        pushes = times(geometric, self._vectors[:, : self._rigid + self._pushed])
        sizes = np.linalg.norm(pushes, axis=0)
        # K_G times a translation or a twist is round-off.
        self._append(solve(pushes[:, sizes > _DEPENDENT * sizes.max(initial=0.0)]))

    def errors(self, full: Sequence[_FullResponse], rows: Array) -> tuple[float, float]:
        """Return the largest relative errors of the compliance and of the response at outputs.

        Args:
            full: responses of the full model at several shifts.
            rows: output rows (num_rows, num_outputs).
        """
        gains, read = self._vectors.T @ self._forces, self._vectors.T @ rows
        compliance = transfer = 0.0
        for response in full:
            shifted = self._stiffness + response.sigma * np.eye(self.size)
            reduced = np.linalg.solve(shifted, gains)
            error = np.abs(gains.T @ reduced - response.compliance) / response.scale
            compliance = float(np.maximum(compliance, error.max(initial=0.0)))
            error = np.abs(read.T @ reduced - response.transfer) / response.transfer_scale
            transfer = float(np.maximum(transfer, error.max(initial=0.0)))
        return compliance, transfer

    def compliance_error(self, full: Sequence[_FullResponse], parts: Array) -> Array:
        """Return the largest error (num_inputs,) of each input's compliance in m/N.

        Args:
            full: responses of the full model.
            parts: coefficients (num_forces, num_inputs) of the inputs in the basis of forces.
        """
        gains = self._vectors.T @ self._forces @ parts
        lost = np.zeros(parts.shape[1])
        for response in full:
            shifted = self._stiffness + response.sigma * np.eye(self.size)
            compliance = np.einsum("ij,ij->j", parts, response.compliance @ parts)
            reduced = np.einsum("ij,ij->j", gains, np.linalg.solve(shifted, gains))
            lost = np.maximum(lost, compliance - reduced)
        return lost

    def modes(self, dropped: int) -> tuple[Array, Array, Array]:
        """Return ω² (num_modes,), shapes (num_rows, num_modes) and the coarser basis.

        Rigid motions are first. The coarser basis (num_modes, num_coarser) lacks the last
        ``dropped`` blocks.
        """
        if self._forces.shape[1] == 0:
            # Only probes excite this class.
            return np.zeros(0), self._vectors[:, :0], np.zeros((0, 0))
        rigid, elastic = self._vectors[:, : self._rigid], self._vectors[:, self._rigid :]
        omega2, combination = eigh(self._stiffness[self._rigid :, self._rigid :])
        # Rigid motions that no force excites, such as translation along x, are omitted. The basis
        # contains them so that round-off does not add them to other modes.
        excited = np.abs(rigid.T @ self._forces).max(axis=1, initial=0.0) > _DEPENDENT
        shapes = np.hstack([rigid[:, excited], elastic @ combination])
        # Signs are such that an input with a large modal load has a positive one.
        gains = shapes.T @ self._forces
        much = np.abs(gains) > 0.5 * np.abs(gains).max(axis=1, keepdims=True)
        first = gains[np.arange(len(gains)), much.argmax(axis=1)]
        signs = np.where(first < 0.0, -1.0, 1.0)
        # A coarser basis has at least the responses at the first shift.
        first_dropped = self._ends[max(len(self._ends) - 1 - dropped, 1)] - self._rigid
        kept = np.delete(combination.T, slice(first_dropped, self._ends[-1] - self._rigid), axis=1)
        coarser = block_diag(np.eye(excited.sum()), kept) * signs[:, None]
        return np.concatenate([np.zeros(excited.sum()), omega2]), shapes * signs, coarser

    def _append(self, block: Array) -> Array:
        """Append a block to the basis, and return the new vectors (num_rows, num_new)."""
        before = self.size
        vectors = np.empty((len(block), before + block.shape[1]), order="F")
        vectors[:, :before] = self._vectors
        size = before
        for column in block.T:
            if size == self._most:
                break
            weighed = self._weighed(column)
            length = np.sqrt(column @ weighed)
            for _ in range(2):  # two passes suffice (Kahan; Parlett 1980)
                column = column - vectors[:, :size] @ (vectors[:, :size].T @ weighed)
                weighed = self._weighed(column)
            remainder = np.sqrt(column @ weighed)
            if remainder > _DEPENDENT * length:
                vectors[:, size] = column / remainder
                size += 1
        self._vectors = vectors[:, :size]
        new = self._vectors[:, before:]
        part = self._vectors.T @ (times(self._shell.stiffness, new) * self._shell.free[:, None])
        stiffness = np.empty((size, size))
        stiffness[:before, :before] = self._stiffness
        stiffness[:, before:] = part
        stiffness[before:, :] = part.T
        self._stiffness = stiffness
        return new

    def _weighed(self, column: Array) -> Array:
        return times(self._shell.mass, column[:, None])[:, 0]


def _independent(block: Array) -> Array:
    """Return an orthonormal basis (num_rows, rank) of the columns of a block."""
    lengths = np.linalg.norm(block, axis=0)
    basis = np.empty((len(block), 0))
    for column in (block[:, lengths > 0.0] / lengths[lengths > 0.0]).T[:, :, None]:
        for _ in range(2):
            column = column - basis @ (basis.T @ column)
        remainder = float(np.linalg.norm(column))
        if remainder > _DEPENDENT:
            basis = np.hstack([basis, column / remainder])
    return basis


def _find_accurate(
    shell: ShellMatrices, omega2: Array, shapes: Array, solve: ShiftedSolver
) -> Mask:
    """Return the mask (num_modes,) of modes with ω within 0.1 % of a natural frequency.

    Modes above the first inaccurate one are not tested.

    A mass-normalised mode φ has the residual r = (K − ω² M) φ. Expanded in eigenvectors, r shows
    that some eigenvalue λ satisfies (λ − ω²)² / (λ + σ) ≤ rᵀ (K + σ M)⁻¹ r. The error itself is of
    the order of the square of this bound.
    """
    accurate = np.asarray(omega2 == 0.0)
    elastic = np.flatnonzero(~accurate)
    for batch in np.split(elastic, range(_BATCH, elastic.size, _BATCH)):
        residuals = times(shell.stiffness, shapes[:, batch])
        residuals -= omega2[batch] * times(shell.mass, shapes[:, batch])
        residuals[~shell.free] = 0.0
        bounds2 = np.einsum("ij,ij->j", residuals, solve(residuals))
        off = np.sqrt(np.maximum(bounds2, 0.0) * (omega2[batch] + solve.sigma))
        accurate[batch] = np.logical_and.accumulate(off <= 2.0e-3 * omega2[batch])
        if not accurate[batch].all():
            break
    return accurate
