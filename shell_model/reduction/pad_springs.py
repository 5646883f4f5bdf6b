# SPDX-License-Identifier: LGPL-3.0-or-later
"""Springs that move with pads: the compliance of walls beyond the modes of segments.

At the extension x, pad forces cause the response B(x) (K + σ M)⁻¹ B(x)ᵀ. Modes with frequencies ω_k
and rows b_k(x) give Σ_k b_k(x) b_k(x)ᵀ / (ω_k² + σ) of it. The difference R(x, σ) is a compliance
of walls, with small inertia up to about 1000 Hz. Springs with the frequencies W^½ and the rows
L(x) = R^½ Q (W + σ)^½ represent it: L (W + σ)⁻¹ Lᵀ = R for all x at one shift σ (residual
flexibility; MacNeal 1971). W and the orthogonal Q represent the inertia R′ = −dR/dσ (Rubin 1975)
by the mean of R^−½ R′ R^−½ = Q (W + σ)⁻¹ Qᵀ over all extensions. The symmetric root is smooth.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from shell_model.reduction.symmetry import Job, SymmetryReduction
from shell_model.segment.solver import ShiftedSolver, times

# Frequencies in Hz: the shift σ, between rigid and residual modes, and the maximum of springs.
SLOW, _FASTEST = 50.0, 10000.0

# Fraction of the largest compliance below which the compliance of a force pattern is neglected.
_NEGLIGIBLE = 1.0e-4


class PadResponses(NamedTuple):
    """Responses (num_columns, num_columns) of a full segment to pad forces."""

    compliance: Array  #: B (K + σ M)⁻¹ Bᵀ in m/N at the shift of springs
    inertia: Array  #: B (K + σ M)⁻¹ M (K + σ M)⁻¹ Bᵀ in m s²/N, the negative derivative by σ
    tested: Array  #: compliance in m/N at another shift


def pad_responses(symmetry: SymmetryReduction, columns: Array, test: float) -> PadResponses:
    """Return the responses to columns (num_owned, num_columns); ``test`` is in Hz. Collective."""

    def of_class(_: int, job: Job) -> Array:
        shell = job.shell(symmetry.cell)
        solve = ShiftedSolver(shell, SLOW)
        # Pads press on few nodes, so that columns are sparse.
        pressed = np.flatnonzero((job.forces != 0.0).any(axis=1))
        forces = job.forces[pressed]
        moved = solve(job.forces)
        slow = forces.T @ moved[pressed], moved.T @ times(shell.mass, moved)
        solve.move(test)
        tested = forces.T @ solve(job.forces)[pressed]
        solve.destroy()
        return np.array([*slow, tested])

    start = np.zeros((3, columns.shape[1], columns.shape[1]))
    return PadResponses(*symmetry.sum_classes(columns, start, of_class))


def springs(residual: Array, inertia: Array) -> tuple[Array, Array]:
    """Return ω² (num_springs,) and rows (num_extensions, num_rows, num_springs) of springs.

    ω² is in rad²/s², rows in 1/√kg. The residual R (num_extensions, num_rows, num_rows) is in m/N,
    its inertia R′ in m s²/N.
    """
    sizes = np.sqrt(np.einsum("wjj->j", residual) / len(residual))
    scale = np.outer(sizes, sizes)
    values, patterns = np.linalg.eigh(residual / scale)
    values[values < _NEGLIGIBLE * values.max()] = 0.0
    inverse = np.divide(1.0, np.sqrt(values), out=np.zeros_like(values), where=values > 0.0)
    root, back = (
        np.einsum("wij,wj,wkj->wik", patterns, one, patterns) for one in (np.sqrt(values), inverse)
    )
    slowness, turn = np.linalg.eigh((back @ (inertia / scale) @ back).mean(axis=0))
    shifted = 1.0 / np.maximum(slowness, 1.0 / squared(_FASTEST))
    pulls = root @ turn
    pulling = np.abs(pulls).max(axis=(0, 1)) > _NEGLIGIBLE
    rows = sizes[:, None] * pulls * np.sqrt(shifted)
    return (shifted - squared(SLOW))[pulling], rows[..., pulling]


def squared(frequency: float) -> float:
    """Return ω² in rad²/s² of a frequency in Hz."""
    return float((2.0 * np.pi * frequency) ** 2)
