# SPDX-License-Identifier: LGPL-3.0-or-later
"""Springs that move with pads: the compliance of walls beyond the modes of segments.

At the extension s, pads with the rows B(s) have the compliance B (K + σ M)⁻¹ Bᵀ at the shift σ.
Modes of the circular frequencies ω_i and the rows b_i(s) contribute Σ_i b_i b_iᵀ / (ω_i² + σ). The
difference Γ(s, σ) is a compliance of walls, with small inertia up to about 1000 Hz. Springs with
the diagonal matrix Ω_p of circular frequencies and the rows L(s) = Γ^½ X (Ω_p² + σ)^½ represent it:
L (Ω_p² + σ)⁻¹ Lᵀ = Γ for all s at one σ (residual flexibility; MacNeal 1971). Ω_p and the
orthogonal matrix X represent the inertia Γ′ = −dΓ/dσ by the mean of Γ^−½ Γ′ Γ^−½ = X (Ω_p² + σ)⁻¹
Xᵀ over all extensions (Rubin 1975). The symmetric root Γ^½ is smooth in s.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from shell_model.reduction.symmetry import Job, SymmetryReduction
from shell_model.segment.solver import ShiftedSolver, times

# Frequencies in Hz: of the shift σ, between rigid and residual modes, and maximum of springs.
SLOW, _FASTEST = 50.0, 10000.0

# Fraction of the largest compliance below which the compliance of a force pattern is neglected.
_NEGLIGIBLE = 1.0e-4


class PadResponses(NamedTuple):
    """Responses (num_columns, num_columns) of a full segment to pad forces."""

    compliance: Array  #: B (K + σ M)⁻¹ Bᵀ in m/N at the shift of springs
    inertia: Array  #: B (K + σ M)⁻¹ M (K + σ M)⁻¹ Bᵀ in m s²/N, the negative derivative by σ
    tested: Array  #: compliance in m/N at the shift for the test of springs


def pad_responses(symmetry: SymmetryReduction, columns: Array, test: float) -> PadResponses:
    """Return the responses to columns (num_owned, num_columns) of pads. Collective.

    ``test`` is the frequency in Hz of the shift for ``tested``.
    """

    def of_class(_: int, job: Job) -> Array:
        shell = job.shell(symmetry.cell)
        solve = ShiftedSolver(shell, SLOW)
        # Pads press on few nodes, so that columns are sparse.
        loaded_rows = np.flatnonzero((job.forces != 0.0).any(axis=1))
        forces = job.forces[loaded_rows]
        response = solve(job.forces)
        slow = forces.T @ response[loaded_rows], response.T @ times(shell.mass, response)
        solve.move(test)
        tested = forces.T @ solve(job.forces)[loaded_rows]
        solve.destroy()
        return np.array([*slow, tested])

    start = np.zeros((3, columns.shape[1], columns.shape[1]))
    return PadResponses(*symmetry.sum_classes(columns, start, of_class))


def springs(residual: Array, inertia: Array) -> tuple[Array, Array]:
    """Return springs that replace a residual compliance: ω² and rows.

    ω² (num_springs,) is in rad²/s², rows (num_extensions, num_rows, num_springs) are in 1/√kg.
    ``residual`` Γ (num_extensions, num_rows, num_rows) is in m/N, ``inertia`` Γ′ in m s²/N.
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
    kept = np.abs(pulls).max(axis=(0, 1)) > _NEGLIGIBLE
    rows = sizes[:, None] * pulls * np.sqrt(shifted)
    return (shifted - squared(SLOW))[kept], rows[..., kept]


def squared(frequency: float) -> float:
    """Return ω² in rad²/s² of a frequency in Hz."""
    return float((2.0 * np.pi * frequency) ** 2)
