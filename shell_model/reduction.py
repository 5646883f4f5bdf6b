# SPDX-License-Identifier: LGPL-3.0-or-later
"""Few coordinates for a shell: a block rational Krylov basis on its loads and contact points.

The space holds (K + σ M)⁻¹ F and its moments for several shifts σ > 0, so the response to a
contact force is right from statics to the frequencies of the shifts, its local flexibility
included; natural modes alone would need thousands of vectors for the latter (Ruhe 1984;
Craig and Hurty's static modes are the case σ = 0, one moment). Rigid motions are kept apart,
which leaves their frequency exactly zero.

Each family of mirrored motions has a basis of its own, and each shift goes on from the newest
vectors of the shift before, which spans the same space as to start again from F would, but from
vectors that are not nearly dependent. Both keep round-off from growing: the coordinates are the
same on any number of ranks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from petsc4py import PETSc
from scipy.linalg import eigh

from dynamics.failure import NumericsError
from shell_model.mirror import FAMILIES, Family, Mirrors
from shell_model.products import gram, times
from shell_model.segment_shell import SegmentShell

Array = npt.NDArray[np.float64]

# A direction that is left with less than this part of its length is in the space already.
_DEPENDENT = 1.0e-9


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
        omega2: (num_modes,) in rad²/s², rising, rigid motions first and exactly 0.
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
            # Springs and point masses couple nodes that the shell does not.
            structure=PETSc.Mat.Structure.DIFFERENT_NONZERO_PATTERN,
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
        inputs: (num_owned, num_inputs) forces that act on it, in any order; zero and dependent
            ones cost nothing.
        options: shifts and moments.
        progress: called with the part done, 0 to 1.

    Raises:
        NumericsError: a compliance is not finite, the shell does not mirror itself, or all inputs
            are zero.
    """
    stages = len(options.shifts) * options.moments + 1
    mirrors = Mirrors(shell)
    rigid = shell.rigid_motions()
    bases = [
        _Basis(shell, mirrors, family, inputs, rigid, stages - 1)
        for family in FAMILIES
        if _belongs(shell, mirrors.part(inputs, family), inputs)
    ]
    if not bases:
        raise NumericsError("nothing acts on a segment, and it has no motion: give it a load")
    for k, frequency in enumerate(options.shifts):
        solve = ShiftedSolver(shell, frequency)
        for moment in range(options.moments):
            for basis in bases:
                basis.grow(solve)
            if progress is not None:
                progress((k * options.moments + moment + 1) / stages)
        solve.destroy()
    mirrors.destroy()

    modes = [basis.modes() for basis in bases]
    omega2 = np.concatenate([omega2 for omega2, _ in modes])
    shapes = np.hstack([shapes for _, shapes in modes])
    order = np.argsort(omega2, kind="stable")
    reduced = ReducedSegment(omega2[order], shapes[:, order], np.nan, np.nan)
    errors = _errors(shell, reduced, [basis.inputs for basis in bases], options)
    if progress is not None:
        progress(1.0)
    return replace(reduced, compliance_error=errors[0], frequency_limit=errors[1])


def _belongs(shell: SegmentShell, part: Array, whole: Array) -> bool:
    """Whether any input has a part in a family that is not round-off."""
    lengths = [np.sqrt(gram(shell.comm, block, block).diagonal()) for block in (part, whole)]
    return bool((lengths[0] > _DEPENDENT * lengths[1]).any())


class _Basis:
    """M-orthonormal vectors of one family, distributed by rows.

    ``inputs`` (num_owned, num_inputs) are independent forces of the family, of unit length.
    """

    def __init__(
        self,
        shell: SegmentShell,
        mirrors: Mirrors,
        family: Family,
        inputs: Array,
        rigid: Array,
        blocks: int,
    ) -> None:
        self.shell = shell
        self._mirrors, self._family = mirrors, family
        self.inputs = self._independent(inputs)
        rigid = self._independent(rigid)
        self._columns = np.empty(
            (shell.free.size, rigid.shape[1] + blocks * self.inputs.shape[1]), order="F"
        )
        self._size = 0
        self._append(rigid)
        self._rigid = self._size
        self._pushes = self.inputs

    def grow(self, solve: ShiftedSolver) -> None:
        """Add the next block."""
        block = self._append(self._mirrors.part(solve(self._pushes), self._family))
        self._pushes = self._mass_times(block)

    def modes(self) -> tuple[Array, Array]:
        """ω² and shapes in the space, rigid motions first."""
        shell, vectors = self.shell, self._vectors
        elastic = vectors[:, self._rigid :]
        stiffness = gram(shell.comm, elastic, times(shell.stiffness, elastic) * shell.free[:, None])
        mass = gram(shell.comm, elastic, self._mass_times(elastic))
        # One rank decides, for all.
        omega2, combination = shell.comm.bcast(eigh(stiffness, mass))
        # The slide along x has to be in the basis, or round-off would find it; but nothing
        # moves it.
        rigid = vectors[:, : self._rigid]
        moved = np.abs(gram(shell.comm, rigid, self.inputs)).max(axis=1) > _DEPENDENT
        shapes = np.hstack([rigid[:, moved], elastic @ combination])
        return np.concatenate([np.zeros(moved.sum()), omega2]), shapes * self._signs(shapes)

    def _signs(self, shapes: Array) -> Array:
        """Signs with which every shape goes along with an input that moves it much."""
        gains = gram(self.shell.comm, shapes, self.inputs)
        much = np.abs(gains) > 0.5 * np.abs(gains).max(axis=1, keepdims=True)
        first = gains[np.arange(len(gains)), much.argmax(axis=1)]
        return np.where(first < 0.0, -1.0, 1.0)

    @property
    def _vectors(self) -> Array:
        return self._columns[:, : self._size]

    def _mass_times(self, block: Array) -> Array:
        return times(self.shell.mass, block)

    def _append(self, block: Array) -> Array:
        """Add what is new in a block, column by column; gives the orthonormal new part."""
        before = self._size
        for column in block.T[:, :, None]:
            length = self._length(column)
            for _ in range(2):  # twice is enough (Kahan; Parlett 1980)
                column = column - self._vectors @ gram(
                    self.shell.comm, self._vectors, self._mass_times(column)
                )
            left = self._length(column)
            if left > _DEPENDENT * length:
                self._columns[:, self._size] = column[:, 0] / left
                self._size += 1
        return self._vectors[:, before:]

    def _length(self, column: Array) -> float:
        return float(np.sqrt(gram(self.shell.comm, column, self._mass_times(column))[0, 0]))

    def _independent(self, block: Array) -> Array:
        """Orthonormal basis of the family's part of a block, column by column."""
        comm = self.shell.comm
        lengths = np.sqrt(gram(comm, block, block).diagonal())
        block = self._mirrors.part(block[:, lengths > 0.0] / lengths[lengths > 0.0], self._family)
        found = np.empty((len(block), 0))
        for column in block.T[:, :, None]:
            for _ in range(2):
                column = column - found @ gram(comm, found, column)
            left = float(np.sqrt(gram(comm, column, column)[0, 0]))
            if left > _DEPENDENT:
                found = np.hstack([found, column / left])
        return found


def _errors(
    shell: SegmentShell,
    reduced: ReducedSegment,
    inputs: Sequence[Array],
    options: KrylovOptions,
) -> tuple[float, float]:
    """Compliance error between the shifts, and the frequency up to which modes are right."""
    shifts = sorted(options.shifts)
    tests = np.sqrt(np.array(shifts[:-1]) * np.array(shifts[1:])) if len(shifts) > 1 else shifts
    worst = limit = 0.0
    for frequency in tests:
        sigma = (2.0 * np.pi * frequency) ** 2
        solve = ShiftedSolver(shell, frequency)
        for block in inputs:
            gains = gram(shell.comm, reduced.shapes, block)
            full = gram(shell.comm, block, solve(block))
            approximate = gains.T @ (gains / (reduced.omega2 + sigma)[:, None])
            scale = np.sqrt(np.outer(np.diag(full), np.diag(full)))
            worst = float(np.maximum(worst, np.abs((approximate - full) / scale).max()))
        if frequency == tests[-1]:
            limit = _frequency_limit(shell, reduced, solve, sigma)
        solve.destroy()
    if not np.isfinite(worst):
        raise NumericsError("the reduced compliance is not finite; check the mesh and the material")
    return worst, limit


def _frequency_limit(
    shell: SegmentShell, reduced: ReducedSegment, solve: ShiftedSolver, sigma: float
) -> float:
    """Hz up to which each ω is within 0.1 % of a natural one.

    With the residual r = (K − ω² M) x of a mass-normalised x, some eigenvalue λ satisfies
    (λ − ω²)² / (λ + σ) ≤ rᵀ (K + σ M)⁻¹ r (expand r in eigenvectors). It is a bound: the
    error itself is of the order of its square.
    """
    limit = 0.0
    for i in np.flatnonzero(reduced.omega2 > 0.0):
        shape = reduced.shapes[:, i : i + 1]
        residual = times(shell.stiffness, shape) - reduced.omega2[i] * times(shell.mass, shape)
        residual[~shell.free] = 0.0
        bound2 = float(gram(shell.comm, residual, solve(residual))[0, 0])
        if np.sqrt(max(bound2, 0.0) * (reduced.omega2[i] + sigma)) > 2.0e-3 * reduced.omega2[i]:
            break
        limit = float(np.sqrt(reduced.omega2[i]) / (2.0 * np.pi))
    return limit
