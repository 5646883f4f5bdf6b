# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact forces of all rows, and the impulses that they give within half a step.

A law is a column of ``law`` (5, num_rows): k above, k below, Δ, n, d.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
from numba import njit

from dynamics.contact import PowerContact

Array = npt.NDArray[np.float64]


def law_columns(laws: Sequence[PowerContact]) -> Array:
    """(5, num_rows), the layout of the compiled loop."""
    return np.array(
        [
            [law.stiffness, law.below, law.clearance, law.exponent, law.damping]
            for law in laws
        ]
    ).reshape(len(laws), 5).T.copy()  # fmt: skip


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"})
def contact_forces(a: Array, rows: Array, law: Array, y: Array, force: Array) -> bool:
    """Relative displacements and elastic forces of every row; whether any row touches."""
    touching = False
    for j in range(rows.shape[0]):
        total = 0.0
        for i in range(a.size):
            total += rows[j, i] * a[i]
        y[j] = total
        depth = abs(total) - law[2, j]
        if depth > 0.0:
            n = law[3, j]
            power = depth if n == 1.0 else depth * depth if n == 2.0 else depth**n
            force[j] = law[0, j] * power if total > 0.0 else -law[1, j] * power
            touching = touching or force[j] != 0.0
        else:
            force[j] = 0.0
    return touching


@njit(cache=True, nogil=True, error_model="numpy")
def _side(y: float, clearance: float, above: float, below: float) -> float:
    """1 where a row presses above, -1 below, 0 where it is open."""
    if y > clearance and above > 0.0:
        return 1.0
    if y < -clearance and below > 0.0:
        return -1.0
    return 0.0


@njit(cache=True, nogil=True, error_model="numpy")
def contact_energy(y: Array, law: Array) -> float:
    """Potential of the elastic forces in J."""
    energy = 0.0
    for j in range(y.size):
        depth = abs(y[j]) - law[2, j]
        if depth > 0.0:
            side = law[0, j] if y[j] > 0.0 else law[1, j]
            energy += side * depth ** (law[3, j] + 1.0) / (law[3, j] + 1.0)
    return energy


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"})
def elastic_kick(v: Array, rows: Array, force: Array, duration: float) -> None:
    """Change the speeds ``v`` (num_modes,) by elastic forces that act for ``duration``."""
    for j in range(rows.shape[0]):
        if force[j] != 0.0:
            impulse = duration * force[j]
            for i in range(v.size):
                v[i] -= rows[j, i] * impulse


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"reassoc", "contract", "arcp", "nsz"})
def damped_kick(
    v: Array, rows: Array, force: Array, law: Array, duration: float, backward: bool, push: Array
) -> float:
    """Change the speeds by forces with contact damping; gives its loss in J.

    The speed in a force is the mean of those before and after, row by row, from the last row on
    if ``backward``: so a kick forward and one backward make a symmetric step.

    Args:
        v: (num_modes,) is changed.
        force: (num_rows,) elastic forces in N.
        push: (num_rows,) is set to the forces with damping in N.
    """
    loss = 0.0
    for position in range(rows.shape[0]):
        j = rows.shape[0] - 1 - position if backward else position
        push[j] = 0.0
        if force[j] == 0.0:
            continue
        side = np.sign(force[j])
        rate = 0.0
        square = 0.0
        for i in range(v.size):
            rate += side * rows[j, i] * v[i]
            square += rows[j, i] * rows[j, i]
        elastic = duration * abs(force[j])
        # I = τ f (1 + d ṗ) with ṗ = rate − I square/2 in the middle of the kick; never adhesive.
        strength = elastic * law[4, j]
        impulse = max(0.0, (elastic + strength * rate) / (1.0 + 0.5 * strength * square))
        loss += (impulse - elastic) * (rate - 0.5 * impulse * square)
        push[j] = side * impulse / duration
        for i in range(v.size):
            v[i] -= side * rows[j, i] * impulse
    return loss


@njit(cache=True, nogil=True, error_model="numpy", inline="always")
def first_closing(
    y: Array, before: Array, law: Array, now: float, time: float
) -> tuple[int, float]:
    """How many rows opened or closed within ``time`` up to ``now``, and when the first closed."""
    changes = 0
    closing = np.inf
    for j in range(y.size):
        above, below, clearance = law[0, j], law[1, j], law[2, j]
        side = _side(y[j], clearance, above, below)
        if side != _side(before[j], clearance, above, below):
            changes += 1
            if side != 0.0:
                deep = side * y[j] - clearance
                since = time * deep / (side * (y[j] - before[j]))
                closing = min(closing, now - since)
    return changes, closing
