# SPDX-License-Identifier: LGPL-3.0-or-later
"""What damping takes from the speeds of a gap system within a time, and from its energy.

With C = diag(c) + Gᵀ G, v' = −C v over a time t is made in two parts, each of which has a closed
form and can only take: the rates c of single modes, and the dashpots along the right singular
vectors V of G, v − Vᵀ (1 − exp(−σ² t)) V v. What they take of ½ v·v is their loss, exactly.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from scipy.linalg import svd

from dynamics.arrays import Array
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import LOOP, SUMS

# Rates c (num_modes,), or none (0,) where no mode has any, so that its loops cost nothing;
# directions V (num_dashpots, num_modes) and their rates σ² (num_dashpots,).
Damping = tuple[Array, Array, Array]


def damping_arrays(system: GapSystem) -> Damping:
    """The damping of a system in the layout of the compiled loops."""
    _, sigma, directions = svd(system.dashpots, full_matrices=False)
    rates = system.damping if system.damping.any() else np.zeros(0)
    return np.ascontiguousarray(rates), np.ascontiguousarray(directions), sigma**2


@njit(**LOOP)
def kept_after(rates: Array, time: float, kept: Array) -> None:
    """Fill in what is left of a speed after ``time``, for each rate."""
    for i in range(rates.size):
        kept[i] = np.exp(-rates[i] * time)


@njit(**SUMS)
def fade(v: Array, kept: Array) -> float:
    """Leave a part of the speed of every mode that has one; gives the loss in J."""
    loss = 0.0
    for i in range(kept.size):
        loss += v[i] * v[i] * (1.0 - kept[i] * kept[i])
        v[i] *= kept[i]
    return 0.5 * loss


@njit(**SUMS)
def drag(v: Array, directions: Array, kept: Array) -> float:
    """Leave a part of the speed along every dashpot; gives the loss in J."""
    loss = 0.0
    for d in range(kept.size):
        speed = 0.0
        for i in range(v.size):
            speed += directions[d, i] * v[i]
        loss += speed * speed * (1.0 - kept[d] * kept[d])
        taken = speed * (1.0 - kept[d])
        for i in range(v.size):
            v[i] -= directions[d, i] * taken
    return 0.5 * loss


@njit(**LOOP)
def damp(v: Array, faded: Array, directions: Array, dragged: Array) -> float:
    """All damping over a time, as a symmetric matrix; gives the loss in J.

    A mode keeps ``faded`` (num_modes,), or none (0,), over half that time; ``dragged``
    (num_dashpots,) is kept along each dashpot over all of it.
    """
    loss: float = fade(v, faded)
    loss += drag(v, directions, dragged)
    loss += fade(v, faded)
    return loss
