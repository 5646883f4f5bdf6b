# SPDX-License-Identifier: LGPL-3.0-or-later
"""Second-order theory: modes softened by constant axial forces, and buckling loads.

In the modes of the unloaded boom the stiffness is diag(ω²) − G, with G = Φᵀ K_G Φ of the geometric
stiffness (second-order theory, Timoshenko and Gere 1961). A segment that contacts alone
hold tips over: its rotation has a negative ω².
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import eigh

from dynamics.arrays import Array

# Part of what rigid motions lose most below which one loses nothing.
_ROUND_OFF = 1.0e-9


def soften_modes(omega2: Array, geometric: Array) -> tuple[Array, Array]:
    """Return ω² (num_modes,), rising, and the new modes (num_modes, num_modes) in the old ones.

    ``omega2`` is without axial forces, rigid motions exactly 0; ``geometric`` is G.
    """
    # The upper triangle leaves the low modes their digits, see ``natural_modes`` of the beams.
    found, combination = eigh(np.diag(omega2) - geometric, lower=False)
    # Translations keep ω of exactly 0.
    rigid = omega2 == 0.0
    lost = np.abs(np.linalg.eigvalsh(geometric[np.ix_(rigid, rigid)]))
    kept = np.count_nonzero(lost <= _ROUND_OFF * lost.max(initial=0.0))
    found[np.argsort(np.abs(found))[:kept]] = 0.0
    return found, combination


def buckling_factor(stiffness: Array, geometric: Array) -> float:
    """Return the factor λ of the axial forces at which a boom first buckles, det(K − λ K_G) = 0.

    It is infinite where the boom does not buckle. The boom is supported; coordinates (num_dofs,)
    are any.
    """
    last = len(stiffness) - 1
    if last < 0:
        return float("inf")
    # Coordinates may be of different sizes: deflections and rotations.
    scale = 1.0 / np.sqrt(np.diag(stiffness))
    scales = np.outer(scale, scale)
    (largest,) = eigh(
        geometric * scales, stiffness * scales, eigvals_only=True, subset_by_index=[last, last]
    )
    return float(1.0 / largest) if largest > 0.0 else float("inf")
