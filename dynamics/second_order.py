# SPDX-License-Identifier: LGPL-3.0-or-later
"""Second-order theory: modes under constant axial forces, and buckling loads.

In the modes of the unloaded boom the stiffness is diag(ω²) − G, with G = Φᵀ K_G Φ of the geometric
stiffness (Timoshenko and Gere 1961). Without contact, a segment whose supports are contacts may be
unstable: its rotation has a negative ω².
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from dynamics.arrays import Array

# Fraction of the largest change of rigid motions' stiffness below which a change is round-off.
_ROUND_OFF = 1.0e-9


def soften_modes(omega2: Array, geometric: Array) -> tuple[Array, Array]:
    """Return ω² (num_modes,), ascending, and modes (num_modes, num_modes) under axial forces.

    ``omega2`` is ω² without axial forces, exactly 0 for rigid motions; ``geometric`` is G. Columns
    of the modes are coefficients of the modes without axial forces.
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
    """Return the lowest buckling factor λ > 0 of the axial forces, det(K − λ K_G) = 0.

    It is infinite if the boom does not buckle. The boom must be supported; coordinates are
    arbitrary.
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
