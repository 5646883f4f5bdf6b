# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modal coordinates of a boom of shells, with the constraints of bonded joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag, eigh, null_space

from protractile.dynamics.second_order import buckling_factor, soften_modes
from protractile.geometry.arrays import Array
from protractile.geometry.ground import GroundLine
from protractile.shell_model.boom_shell import BoomShell
from protractile.shell_model.reduction.segment import ReducedSegment
from protractile.shell_model.segment.cross_section import Operator
from protractile.shell_model.segment.solver import exact_product

# Fraction of the largest singular value below which a singular value is round-off.
ROUND_OFF = 1.0e-9


class BoomCoordinates:
    """Mass-normalised coordinates of a boom with bonded joints and cylinders. Collective.

    Args:
        full: shells of the boom.
        reduced: reduced coordinates of each segment.
        ties: displacement operators that bonded joints constrain to zero.
        lines: springs to the ground, which the shells do not include.

    Attributes:
        omega2: ω² (num_modes,) in rad²/s², exactly 0 for rigid motions, negative if an axial force
            makes a segment unstable.
        coarser: orthonormal coefficients (num_modes, num_coarser) of a coarser basis, see
            :class:`.krylov.Coordinates`.
        geometric: K_G (num_modes, num_modes) in 1/s² of axial forces, which ``omega2`` includes.
        critical_factor: buckling factor of the axial forces, see
            :func:`.second_order.buckling_factor`; infinite without axial forces, None for a
            mechanism.
    """

    def __init__(
        self,
        full: BoomShell,
        reduced: Sequence[ReducedSegment],
        ties: Sequence[Operator],
        lines: Sequence[GroundLine] = (),
    ) -> None:
        self._full, self._reduced, comm = full, reduced, full.comm
        self._combination: Array | None = None
        self.omega2 = np.concatenate([segment.omega2 for segment in reduced])
        springs = [line for line in lines if line.stiffness > 0.0]
        if ties or springs:
            tied_rows = np.array([self.row(tie) for tie in ties]).reshape(-1, self.omega2.size)
            spring_rows = [np.sqrt(s.stiffness) * self.push(s.segment, s.push) for s in springs]
            pulls = np.array(spring_rows).reshape(-1, self.omega2.size)
            self.omega2, self._combination = comm.bcast(
                _constrained_modes(self.omega2, tied_rows, pulls)
            )
        self.critical_factor: float | None = np.inf
        self.geometric = np.zeros((self.omega2.size, self.omega2.size))
        geometric = block_diag(*(segment.geometric for segment in reduced))
        if geometric.any():
            # Transform to the modes under the axial forces of the segments.
            tied = np.eye(self.omega2.size) if self._combination is None else self._combination
            softening = tied.T @ geometric @ tied
            is_supported = not (self.omega2 == 0.0).any()
            self.critical_factor = (
                buckling_factor(np.diag(self.omega2), softening) if is_supported else None
            )
            self.omega2, turn = comm.bcast(soften_modes(self.omega2, softening))
            self._combination = tied @ turn
            self.geometric = turn.T @ softening @ turn
        self.coarser = block_diag(*(segment.coarser for segment in reduced))
        if ties:
            self.coarser = self.coarser @ null_space(tied_rows @ self.coarser)
        self.coarser = self.of_rows(self.coarser.T).T

    def row(self, operator: Operator) -> Array:
        """Return the row (num_modes,) of a displacement operator, the same on every rank."""
        shells = self._full.shells
        rows = [self.push(number, shells[number].row(row)) for number, row in operator.items()]
        return np.asarray(np.sum(rows, axis=0))

    def push(self, number: int, force: Array) -> Array:
        """Return the modal load (num_modes,) of a segment's load vector, from this rank's part."""
        parts = [np.zeros(segment.omega2.size) for segment in self._reduced]
        parts[number] = exact_product(self._full.comm, force, self._reduced[number].shapes)
        return self.of_rows(np.concatenate(parts))

    def of_rows(self, apart: Array) -> Array:
        """Return rows (…, num_modes) in modes of the boom from rows in modes of the segments."""
        if self._combination is None:
            return apart
        return np.asarray(apart @ self._combination.astype(apart.dtype, copy=False))


def _constrained_modes(omega2: Array, tied: Array, pulls: Array) -> tuple[Array, Array]:
    """Return ω² and modes (num_modes, num_held_modes) under constraints and springs.

    Args:
        omega2: ω² (num_modes,) without constraints and springs.
        tied: rows (num_ties, num_modes) of displacements that are zero.
        pulls: rows (num_springs, num_modes) of springs times the root of their stiffness, in 1/s.
    """
    free = null_space(tied) if tied.size else np.eye(omega2.size)
    free_pulls = pulls @ free
    held_omega2, combination = eigh(free.T @ (omega2[:, None] * free) + free_pulls.T @ free_pulls)
    # Rigid motions that satisfy all constraints are rigid modes.
    rigid = [rows[:, omega2 == 0.0] for rows in (tied, pulls) if rows.size]
    scaled = np.concatenate(
        [rows / np.abs(rows).max(initial=np.finfo(float).tiny) for rows in rigid]
    )
    values = np.linalg.svd(scaled, compute_uv=False) if scaled.size else np.zeros(0)
    num_rigid = scaled.shape[1] - int((values > ROUND_OFF * values.max(initial=0.0)).sum())
    held_omega2[:num_rigid] = 0.0
    return held_omega2, free @ combination
