# SPDX-License-Identifier: LGPL-3.0-or-later
"""Second-order theory: modes under constant axial forces, and buckling loads.

In the modes Φ of the unloaded boom with the circular frequencies ω, the stiffness is
diag(ω²) − Φᵀ K_G Φ with the geometric stiffness K_G (Timoshenko and Gere 1961). A segment that only
contacts support may be unstable while they are open: its rotation has a negative ω².
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from protractile.dynamics.arrays import Array

# Fraction of the largest change of rigid motions' stiffness below which a change is round-off.
_ROUND_OFF = 1.0e-9


def soften_modes(omega2: Array, geometric: Array) -> tuple[Array, Array]:
    """Return ω² (num_modes,), ascending, and modes (num_modes, num_modes) under axial forces.

    Each column of the modes has the coefficients of the modes without axial forces.

    Args:
        omega2: ω² (num_modes,) in rad²/s² without axial forces, exactly 0 for rigid motions.
        geometric: Φᵀ K_G Φ (num_modes, num_modes) in 1/s².
    """
    # The upper triangle preserves the digits of low modes, see ``natural_modes`` of beams.
    softened, combination = eigh(np.diag(omega2) - geometric, lower=False)
    # Translations keep ω = 0 exactly.
    rigid = omega2 == 0.0
    changes = np.abs(np.linalg.eigvalsh(geometric[np.ix_(rigid, rigid)]))
    unchanged = np.count_nonzero(changes <= _ROUND_OFF * changes.max(initial=0.0))
    softened[np.argsort(np.abs(softened))[:unchanged]] = 0.0
    return softened, combination


def buckling_factor(stiffness: Array, geometric: Array) -> float:
    """Return the lowest factor λ > 0 of the axial forces at which det(K − λ K_G) = 0.

    It is infinite if the boom does not buckle. ``stiffness`` K must be positive definite;
    ``geometric`` is K_G in the same coordinates.
    """
    last = len(stiffness) - 1
    if last < 0:
        return float("inf")
    # Coordinates are scaled, since deflections and rotations may differ in size.
    scale = 1.0 / np.sqrt(np.diag(stiffness))
    scales = np.outer(scale, scale)
    (largest,) = eigh(
        geometric * scales, stiffness * scales, eigvals_only=True, subset_by_index=[last, last]
    )
    return float(1.0 / largest) if largest > 0.0 else float("inf")
