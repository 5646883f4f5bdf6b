# SPDX-License-Identifier: LGPL-3.0-or-later
"""Few coordinates for a shell: a block rational Krylov basis on its loads and contact points.

The space holds (K + σ M)⁻¹ F and its moments for several shifts σ > 0, so the response to a
contact force is right from statics to the frequencies of the shifts, its local flexibility
included; natural modes alone would need thousands of vectors for the latter (Ruhe 1984;
Craig and Hurty's static modes are the case σ = 0, one moment). Rigid motions are kept apart,
which leaves their frequency exactly zero.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from petsc4py import PETSc
from scipy.linalg import eigh

from dynamics.failure import NumericsError
from shell_model.segment_shell import SegmentShell

Array = npt.NDArray[np.float64]

# A direction that is left with less than this part of its length is in the space already.
_DEPENDENT = 1.0e-9

# Modes that no input moves by this part of the mode it moves most are there by round-off
# alone: lateral and torsional ones, which loads in the plane of bending leave at rest.
_UNEXCITED = 1.0e-6


@dataclass(frozen=True, slots=True)
class KrylovOptions:
    """Shifts and moments of the basis.

    Args:
        shifts: frequencies in Hz at which the response is matched.
        moments: how many derivatives with respect to ω² are matched at each.
    """

    shifts: tuple[float, ...] = (5.0, 50.0, 300.0, 1500.0)
    moments: int = 3


@dataclass(frozen=True, slots=True)
class ReducedSegment:
    """Mass-normalised coordinates of one segment.

    Args:
        omega2: (num_modes,) in rad²/s², rigid motions first and exactly 0.
        shapes: (num_owned, num_modes) this rank's rows of each shape, in 1/√kg.
        compliance_error: largest relative error of the contact compliance matrix at the test
            frequencies between the shifts, against full solves.
        frequency_limit: Hz up to which every natural frequency is right within 0.1 %.
    """

    omega2: Array
    shapes: Array
    compliance_error: float
    frequency_limit: float


class ShiftedSolver:
    """(K + σ M)⁻¹, factorised once."""

    def __init__(self, shell: SegmentShell, frequency: float) -> None:
        self.matrix = shell.stiffness.copy()
        self.matrix.axpy(
            (2.0 * np.pi * frequency) ** 2,
            shell.mass,
            structure=PETSc.Mat.Structure.SAME_NONZERO_PATTERN,
        )
        self.matrix.setOption(PETSc.Mat.Option.SPD, True)
        self.solver = PETSc.KSP().create(shell.comm)
        self.solver.setOperators(self.matrix)
        self.solver.setType(PETSc.KSP.Type.PREONLY)
        factor = self.solver.getPC()
        factor.setType(PETSc.PC.Type.CHOLESKY)
        factor.setFactorSolverType("mumps")
        self.solver.setUp()
        self.right, self.left = self.matrix.createVecs()

    def __call__(self, block: Array) -> Array:
        solution = np.empty_like(block)
        for column in range(block.shape[1]):
            self.right.array[:] = block[:, column]
            self.solver.solve(self.right, self.left)
            solution[:, column] = self.left.array
        return solution

    def destroy(self) -> None:
        for thing in (self.right, self.left, self.solver, self.matrix):
            thing.destroy()


def reduce_segment(
    shell: SegmentShell,
    inputs: Array,
    options: KrylovOptions,
    progress: Callable[[float], None] | None = None,
) -> ReducedSegment:
    """Reduce a segment to the space that its inputs excite. Collective.

    Args:
        shell: the full model.
        inputs: (num_owned, num_inputs) forces that act on it: contact rows, then the load.
        options: shifts and moments.
        progress: called with the part done, 0 to 1.

    Raises:
        NumericsError: a compliance is not finite.
    """
    stages = len(options.shifts) * options.moments + 1
    rigid = shell.rigid_motions()
    basis = _Basis(shell, capacity=rigid.shape[1] + (stages - 1) * inputs.shape[1])
    basis.append(rigid)
    rigid_modes = basis.size
    for k, frequency in enumerate(options.shifts):
        solve = ShiftedSolver(shell, frequency)
        block = solve(inputs)
        for moment in range(options.moments):
            block = basis.append(block)
            if progress is not None:
                progress((k * options.moments + moment + 1) / stages)
            if moment + 1 < options.moments:
                block = solve(basis.mass_times(block))
        solve.destroy()

    elastic = basis.vectors[:, rigid_modes:]
    stiffness = basis.gram(elastic, _times(shell.stiffness, elastic) * shell.free[:, None])
    mass = basis.gram(elastic, basis.mass_times(elastic))
    # One rank decides on signs and on the bases of multiple modes, for all.
    omega2, combination = shell.comm.bcast(eigh(stiffness, mass))
    omega2 = np.concatenate([np.zeros(rigid_modes), omega2])
    shapes = np.hstack([basis.vectors[:, :rigid_modes], elastic @ combination])
    gains = np.abs(basis.gram(shapes, inputs))
    excited = (gains > _UNEXCITED * gains.max(axis=0)).any(axis=1)
    reduced = ReducedSegment(omega2[excited], shapes[:, excited], np.nan, np.nan)
    errors = _errors(shell, basis, reduced, inputs, options)
    if progress is not None:
        progress(1.0)
    return replace(reduced, compliance_error=errors[0], frequency_limit=errors[1])


class _Basis:
    """M-orthonormal vectors, distributed by rows, at most ``capacity`` of them."""

    def __init__(self, shell: SegmentShell, capacity: int) -> None:
        self.shell = shell
        self.size = 0
        self._columns = np.empty((shell.free.size, capacity), order="F")

    @property
    def vectors(self) -> Array:
        return self._columns[:, : self.size]

    def mass_times(self, block: Array) -> Array:
        return _times(self.shell.mass, block)

    def gram(self, left: Array, right: Array) -> Array:
        product = np.ascontiguousarray(left.T @ right)
        self.shell.comm.Allreduce(MPI.IN_PLACE, product)
        return product

    def append(self, block: Array) -> Array:
        """Add what is new in a block, column by column; gives the orthonormal new part."""
        before = self.size
        for column in block.T[:, :, None]:
            length = self.length(column)
            for _ in range(2):  # twice is enough (Kahan; Parlett 1980)
                column = column - self.vectors @ self.gram(self.vectors, self.mass_times(column))
            left = self.length(column)
            if left > _DEPENDENT * length:
                self._columns[:, self.size] = column[:, 0] / left
                self.size += 1
        return self.vectors[:, before:]

    def length(self, column: Array) -> float:
        return float(np.sqrt(self.gram(column, self.mass_times(column))[0, 0]))


def _times(matrix: PETSc.Mat, block: Array) -> Array:
    right, left = matrix.createVecs()
    product = np.empty_like(block)
    for column in range(block.shape[1]):
        right.array[:] = block[:, column]
        matrix.mult(right, left)
        product[:, column] = left.array
    right.destroy()
    left.destroy()
    return product


def _errors(
    shell: SegmentShell,
    basis: _Basis,
    reduced: ReducedSegment,
    inputs: Array,
    options: KrylovOptions,
) -> tuple[float, float]:
    """Compliance error between the shifts, and the frequency up to which modes are right."""
    shifts = sorted(options.shifts)
    tests = np.sqrt(np.array(shifts[:-1]) * np.array(shifts[1:])) if len(shifts) > 1 else shifts
    # A segment without load has an empty input, which no error is relative to.
    inputs = inputs[:, basis.gram(inputs, inputs).diagonal() > 0.0]
    gains = basis.gram(reduced.shapes, inputs)
    worst = 0.0
    for frequency in tests:
        sigma = (2.0 * np.pi * frequency) ** 2
        solve = ShiftedSolver(shell, frequency)
        full = basis.gram(inputs, solve(inputs))
        approximate = gains.T @ (gains / (reduced.omega2 + sigma)[:, None])
        scale = np.sqrt(np.outer(np.diag(full), np.diag(full)))
        worst = float(np.maximum(worst, np.abs((approximate - full) / scale).max(initial=0.0)))
        if frequency == tests[-1]:
            limit = _frequency_limit(shell, basis, reduced, solve, sigma)
        solve.destroy()
    if not np.isfinite(worst):
        raise NumericsError("the reduced compliance is not finite; check the mesh and the material")
    return worst, limit


def _frequency_limit(
    shell: SegmentShell,
    basis: _Basis,
    reduced: ReducedSegment,
    solve: ShiftedSolver,
    sigma: float,
) -> float:
    """Hz up to which each ω is within 0.1 % of a natural one.

    With the residual r = (K − ω² M) x of a mass-normalised x, some eigenvalue λ satisfies
    (λ − ω²)² / (λ + σ) ≤ rᵀ (K + σ M)⁻¹ r (expand r in eigenvectors). It is a bound: the
    error itself is of the order of its square.
    """
    limit = 0.0
    for i in np.flatnonzero(reduced.omega2 > 0.0):
        shape = reduced.shapes[:, i : i + 1]
        residual = _times(shell.stiffness, shape) - reduced.omega2[i] * basis.mass_times(shape)
        residual[~shell.free] = 0.0
        bound2 = float(basis.gram(residual, solve(residual))[0, 0])
        if np.sqrt(max(bound2, 0.0) * (reduced.omega2[i] + sigma)) > 2.0e-3 * reduced.omega2[i]:
            break
        limit = float(np.sqrt(reduced.omega2[i]) / (2.0 * np.pi))
    return limit
