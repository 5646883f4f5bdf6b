# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact forces of all rows, and the impulses that they give within half a step."""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.contact_term import Limits, Terms
from dynamics.kernels.compiled import LOOP, SUMS
from dynamics.kernels.terms import term_energy, term_force


@njit(**SUMS)
def contact_forces(a: Array, rows: Array, terms: Terms, y: Array, force: Array) -> bool:
    """Relative displacements and elastic forces of every row; whether any row touches."""
    for j in range(rows.shape[0]):
        total = 0.0
        for i in range(a.size):
            total += rows[j, i] * a[i]
        y[j] = total
        force[j] = 0.0
    touching = False
    for t in range(terms.size):
        j = terms[t]["row"]
        force[j] += term_force(terms[t], y[j])
        touching = touching or force[j] != 0.0
    return touching


@njit(**LOOP)
def law_forces(y: Array, terms: Terms, force: Array) -> None:
    """Fill in the elastic forces of every row at the gaps y (num_rows,) in m."""
    force[:] = 0.0
    for t in range(terms.size):
        force[terms[t]["row"]] += term_force(terms[t], y[terms[t]["row"]])


@njit(**LOOP)
def contact_energy(y: Array, terms: Terms) -> float:
    """Potential of the elastic forces in J."""
    energy = 0.0
    for t in range(terms.size):
        energy += term_energy(terms[t], y[terms[t]["row"]])
    return energy


@njit(**SUMS)
def elastic_kick(v: Array, rows: Array, force: Array, duration: float) -> None:
    """Change the speeds ``v`` (num_modes,) by elastic forces that act for ``duration``."""
    for j in range(rows.shape[0]):
        if force[j] != 0.0:
            impulse = duration * force[j]
            for i in range(v.size):
                v[i] -= rows[j, i] * impulse


@njit(**SUMS)
def add_closed_forces(
    a: Array, rows: Array, stiffness: Array, preload: Array, share: float, force: Array
) -> None:
    """Add to ``force`` (num_rows,) in N the part ``share`` of what closed contacts press with."""
    for j in range(rows.shape[0]):
        if stiffness[j] != 0.0:
            y = 0.0
            for i in range(a.size):
                y += rows[j, i] * a[i]
            force[j] += share * (stiffness[j] * y - preload[j])


@njit(**SUMS)
def damped_kick(
    v: Array, rows: Array, carried: Array, force: Array, limits: Limits, duration: float,
    backward: bool, push: Array, driven: Array,
) -> float:  # fmt: skip
    """Change the speeds by forces with contact damping; gives its loss in J.

    The speed in a force is the mean of those before and after, row by row, from the last row on
    if ``backward``: so a kick forward and one backward make a symmetric step.

    Args:
        v: (num_modes,) is changed.
        carried: (num_rows,) speeds in m/s that gaps have since rows move.
        force: (num_rows,) elastic forces in N.
        push: (num_rows,) is set to the forces with damping in N.
        driven: (num_rows,) is given what moves the rows does in J.
    """
    loss = 0.0
    for position in range(force.size):
        j = force.size - 1 - position if backward else position
        push[j] = 0.0
        if force[j] == 0.0:
            continue
        side = np.sign(force[j])
        rate = side * carried[j]
        square = 0.0
        for i in range(v.size):
            rate += side * rows[j, i] * v[i]
            square += rows[j, i] * rows[j, i]
        elastic = duration * abs(force[j])
        # I = τ f (1 + d ṗ) with ṗ = rate − I square/2 in the middle of the kick; never adhesive.
        strength = elastic * limits[j]["damping"]
        impulse = max(0.0, (elastic + strength * rate) / (1.0 + 0.5 * strength * square))
        loss += (impulse - elastic) * (rate - 0.5 * impulse * square)
        driven[j] += side * impulse * carried[j]
        push[j] = side * impulse / duration
        for i in range(v.size):
            v[i] -= side * rows[j, i] * impulse
    return loss


@njit(**LOOP, inline="always")
def _side(y: float, limit: np.void) -> float:
    """1 where a row presses above, -1 below, 0 where it is open."""
    if y > limit["high"]:
        return 1.0
    if y < limit["low"]:
        return -1.0
    return 0.0


@njit(**LOOP, inline="always")
def first_closing(
    y: Array, before: Array, limits: Limits, now: float, time: float
) -> tuple[int, float]:
    """How many rows opened or closed within ``time`` up to ``now``, and when the first closed."""
    changes = 0
    closing = np.inf
    for j in range(y.size):
        side = _side(y[j], limits[j])
        if side != _side(before[j], limits[j]):
            changes += 1
            if side != 0.0:
                deep = y[j] - limits[j]["high"] if side > 0.0 else limits[j]["low"] - y[j]
                since = time * deep / (side * (y[j] - before[j]))
                closing = min(closing, now - since)
    return changes, closing
