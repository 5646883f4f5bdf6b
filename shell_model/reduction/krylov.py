# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduction of one symmetry class: its Krylov basis, errors and coordinates."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain, repeat
from typing import NamedTuple

import numpy as np
from petsc4py import PETSc
from scipy.linalg import eigh

from dynamics.failure import NumericsError
from geometry.arrays import Array, Mask
from shell_model.segment.shell import Shell
from shell_model.segment.solver import ShiftedSolver, times

# Fraction of a vector's length below which its new part is round-off.
_DEPENDENT = 1.0e-9

# Maximum number of blocks at each shift; more blocks do not reduce the error.
_MAX_MOMENTS = 12


@dataclass(frozen=True, slots=True)
class KrylovOptions:
    """Shifts and moments of the basis, or its permitted error.

    Args:
        shifts: frequencies in Hz at which the response is matched.
        moments: number of moments (derivatives with respect to ω²) that are matched at each shift.
        tolerance: permitted relative error of the contact compliance and of the transfer to the
            readings. With it, moments are added at the shifts in turn until the error is small
            enough.
        most: maximum number of coordinates of a segment; each symmetry class keeps its rigid
            motions and at least one coordinate.
    """

    shifts: tuple[float, ...] = (5.0, 50.0, 300.0, 1500.0)
    moments: int = 3
    tolerance: float | None = None
    most: int | None = None

    @property
    def order(self) -> Iterator[float]:
        """The shifts of the blocks, in order.

        Several blocks at a shift need only one factorisation. A basis with a tolerance may end
        early, and therefore starts with one block at each shift.
        """
        if self.tolerance is None and self.most is None:
            return chain.from_iterable(repeat(shift, self.moments) for shift in self.shifts)
        rounds = self.moments if self.tolerance is None else _MAX_MOMENTS
        return chain.from_iterable(repeat(self.shifts, rounds))

    @property
    def tests(self) -> Sequence[float]:
        """The test frequencies in Hz between the shifts, in descending order."""
        shifts = np.sort(self.shifts)
        between = np.sqrt(shifts[:-1] * shifts[1:]) if shifts.size > 1 else shifts
        return [float(frequency) for frequency in between[::-1]]


class ClassCoordinates(NamedTuple):
    """Mass-normalised coordinates of a symmetry class.

    Args:
        omega2: ω² (num_modes,) in rad²/s², ascending, rigid motions first and exactly 0.
        shapes: shapes (num_rows, num_modes) in 1/√kg.
        compliance_error, reading_error, lost_compliance: errors as in ``ReducedSegment``.
        accurate: (num_modes,) whether a natural frequency is within 0.1 %.
        geometric: K_G (num_modes, num_modes), which axial forces subtract from diag(ω²).
    """

    omega2: Array
    shapes: Array
    compliance_error: float
    reading_error: float
    lost_compliance: Array
    accurate: Mask
    geometric: Array


def reduce_class(
    shell: Shell,
    inputs: Array,
    readings: Array,
    options: KrylovOptions,
    progress: Callable[[float], None],
) -> ClassCoordinates:
    """Reduce a shell that is stored on this rank only.

    Args:
        shell: the full model.
        inputs: forces (num_rows, num_inputs) in any order; they may be zero or dependent.
        readings: rows (num_rows, num_readings).
        options: options; ``most`` counts the coordinates of this shell.
        progress: callback that receives the completed fraction, 0 to 1.

    Raises:
        NumericsError: a compliance is not finite, or the tolerance is not met.
    """
    inputs = inputs * shell.free[:, None]
    forces = _independent(inputs)
    rows = readings * shell.free[:, None]
    rows = rows[:, rows.any(axis=0)]
    order, tests = list(options.order), options.tests
    stages = len(order) + len(tests)
    basis = _Basis(shell, forces, options.most)
    solve = ShiftedSolver(shell, order[0] if options.tolerance is None else tests[0])
    if options.tolerance is not None:
        full = [_FullResponse.at(frequency, solve, forces, rows) for frequency in tests]
    for done, frequency in enumerate(order, start=1):
        solve.move(frequency)
        grown = basis.grow(solve)
        progress(done / stages)
        if not grown or (
            options.tolerance is not None and max(basis.errors(full, rows)) <= options.tolerance
        ):
            break
    if shell.geometric is not None:
        # These vectors come last, since blocks build on the vectors of the previous block.
        solve.move(order[0])
        basis.add_axial_responses(shell.geometric, solve)
    if options.tolerance is None:
        full = [_FullResponse.at(frequency, solve, forces, rows) for frequency in tests]
    errors = basis.errors(full, rows)
    if not np.isfinite(errors).all():
        raise NumericsError("the reduced compliance is not finite; check the mesh and the material")
    if options.tolerance is not None and max(errors) > options.tolerance:
        raise NumericsError(
            f"a segment's reduction errs by {max(errors):.1e} with {basis.size} coordinates in one "
            f"of its planes, and {options.tolerance:.1e} is asked for; give a larger tolerance, or "
            "a coarser mesh, whose round-off is less"
        )
    lost = basis.lost(full, forces.T @ inputs)
    omega2, shapes = basis.modes()
    solve.move(tests[-1])
    accurate = _find_accurate(shell, omega2, shapes, solve)
    solve.destroy()
    progress(1.0)
    geometric = np.zeros((omega2.size, omega2.size))
    if shell.geometric is not None:
        geometric = shapes.T @ times(shell.geometric, shapes)
    return ClassCoordinates(omega2, shapes, *errors, lost, accurate, geometric)


class _FullResponse(NamedTuple):
    """Responses of the full model at a frequency, with their scales.

    Args:
        sigma: (2π frequency)² in rad²/s².
        compliance: compliance (num_inputs, num_inputs) of the forces.
        scale: geometric means of pairs of its diagonal entries.
        transfer: responses (num_readings, num_inputs) of the readings to the forces.
        transfer_scale: geometric means of both compliances.
    """

    sigma: float
    compliance: Array
    scale: Array
    transfer: Array
    transfer_scale: Array

    @classmethod
    def at(
        cls, frequency: float, solve: ShiftedSolver, forces: Array, rows: Array
    ) -> _FullResponse:
        solve.move(frequency)
        moved = solve(forces)
        compliance = forces.T @ moved
        of_forces = np.diag(compliance)
        of_rows = np.einsum("ij,ij->j", rows, solve(rows))
        return cls(
            solve.sigma,
            compliance,
            np.sqrt(np.outer(of_forces, of_forces)),
            rows.T @ moved,
            np.sqrt(np.outer(of_rows, of_forces)),
        )


class _Basis:
    """M-orthonormal basis, rigid motions first, with the stiffness in its space."""

    def __init__(self, shell: Shell, forces: Array, most: int | None) -> None:
        self._shell, self._forces = shell, forces
        rigid = _independent(shell.rigid_motions() * shell.free[:, None])
        self._most = shell.free.size if most is None else max(most, rigid.shape[1] + 1)
        self._vectors = np.empty((shell.free.size, 0), order="F")
        self._stiffness = np.zeros((0, 0))
        self._append(rigid)
        self._rigid = self.size
        self._pushes = forces
        self._pushed = forces.shape[1]

    @property
    def size(self) -> int:
        return int(self._vectors.shape[1])

    def grow(self, solve: ShiftedSolver) -> bool:
        """Add the next block; return whether the basis grew."""
        block = self._append(solve(self._pushes))
        self._pushes = times(self._shell.mass, block)
        return bool(block.shape[1])

    def add_axial_responses(self, geometric: PETSc.Mat, solve: ShiftedSolver) -> None:
        """Add the responses of the rigid motions and the first block to axial forces."""
        pushes = times(geometric, self._vectors[:, : self._rigid + self._pushed])
        sizes = np.linalg.norm(pushes, axis=0)
        # Translations and twist are excited by round-off only.
        self._append(solve(pushes[:, sizes > _DEPENDENT * sizes.max(initial=0.0)]))

    def errors(self, full: Sequence[_FullResponse], rows: Array) -> tuple[float, float]:
        """Return the relative errors of the compliance and of the transfer to the readings."""
        gains, read = self._vectors.T @ self._forces, self._vectors.T @ rows
        compliance = transfer = 0.0
        for response in full:
            shifted = self._stiffness + response.sigma * np.eye(self.size)
            moved = np.linalg.solve(shifted, gains)
            off = np.abs(gains.T @ moved - response.compliance) / response.scale
            compliance = float(np.maximum(compliance, off.max()))
            off = np.abs(read.T @ moved - response.transfer) / response.transfer_scale
            transfer = float(np.maximum(transfer, off.max(initial=0.0)))
        return compliance, transfer

    def lost(self, full: Sequence[_FullResponse], parts: Array) -> Array:
        """Return the largest loss of compliance (num_inputs,) against the full model in m/N.

        Args:
            full: responses of the full model.
            parts: components (num_forces, num_inputs) of the inputs in the forces.
        """
        gains = self._vectors.T @ self._forces @ parts
        lost = np.zeros(parts.shape[1])
        for response in full:
            shifted = self._stiffness + response.sigma * np.eye(self.size)
            own = np.einsum("ij,ij->j", parts, response.compliance @ parts)
            reduced = np.einsum("ij,ij->j", gains, np.linalg.solve(shifted, gains))
            lost = np.maximum(lost, own - reduced)
        return lost

    def modes(self) -> tuple[Array, Array]:
        """Return ω² and the shapes in the basis, rigid motions first."""
        rigid, elastic = self._vectors[:, : self._rigid], self._vectors[:, self._rigid :]
        omega2, combination = eigh(self._stiffness[self._rigid :, self._rigid :])
        # The translation along x must be in the basis, where round-off would otherwise add it; no
        # force excites it.
        moved = np.abs(rigid.T @ self._forces).max(axis=1, initial=0.0) > _DEPENDENT
        shapes = np.hstack([rigid[:, moved], elastic @ combination])
        # The sign of every shape is positive for an input that excites it strongly.
        gains = shapes.T @ self._forces
        much = np.abs(gains) > 0.5 * np.abs(gains).max(axis=1, keepdims=True)
        first = gains[np.arange(len(gains)), much.argmax(axis=1)]
        signs = np.where(first < 0.0, -1.0, 1.0)
        return np.concatenate([np.zeros(moved.sum()), omega2]), shapes * signs

    def _append(self, block: Array) -> Array:
        """Append the new directions of a block to the basis; return them orthonormalised."""
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
            left = np.sqrt(column @ weighed)
            if left > _DEPENDENT * length:
                vectors[:, size] = column / left
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
    """Return an orthonormal basis of a block, column by column."""
    lengths = np.linalg.norm(block, axis=0)
    found = np.empty((len(block), 0))
    for column in (block[:, lengths > 0.0] / lengths[lengths > 0.0]).T[:, :, None]:
        for _ in range(2):
            column = column - found @ (found.T @ column)
        left = float(np.linalg.norm(column))
        if left > _DEPENDENT:
            found = np.hstack([found, column / left])
    return found


def _find_accurate(shell: Shell, omega2: Array, shapes: Array, solve: ShiftedSolver) -> Mask:
    """Return whether each ω is within 0.1 % of a natural frequency, up to the first failure.

    With the residual r = (K − ω² M) x of a mass-normalised x, some eigenvalue λ satisfies
    (λ − ω²)² / (λ + σ) ≤ rᵀ (K + σ M)⁻¹ r (expand r in eigenvectors). The error itself is of the
    order of the square of this bound.
    """
    accurate = np.asarray(omega2 == 0.0)
    for i in np.flatnonzero(~accurate):
        shape = shapes[:, i : i + 1]
        residual = times(shell.stiffness, shape) - omega2[i] * times(shell.mass, shape)
        residual[~shell.free] = 0.0
        bound2 = float((residual.T @ solve(residual))[0, 0])
        off = np.sqrt(max(bound2, 0.0) * (omega2[i] + solve.sigma))
        accurate[i] = off <= 2.0e-3 * omega2[i]
        if not accurate[i]:
            break
    return accurate
