# SPDX-License-Identifier: LGPL-3.0-or-later
"""How many steps may be made at once while nothing touches, since no gap can shut within them."""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.contact_term import Limits
from dynamics.kernels.compiled import LOOP, SUMS

# Numbers of steps that are made at once.
STRIDES = np.array([1, 8, 64, 512])


@njit(**SUMS)
def _reach(
    a: Array, v: Array, omega2: Array, load: Array, now: Array, then: Array, reach: Array
) -> None:
    """Speeds that swinging modes do not exceed while nothing touches.

    A mode's amplitude √(v² + ω² s²) about its rest position under a constant load does not grow
    unless dashpots hand it the speed of others (:func:`dragged_speeds`); under a load that goes
    straight from ``load`` + ``now`` to ``load`` + ``then`` it grows by no more than the change
    over ω.
    """
    for i in range(a.size):
        if omega2[i] > 0.0:
            off = a[i] - (load[i] + now[i]) / omega2[i]
            growth = abs(then[i] - now[i]) / np.sqrt(omega2[i])
            reach[i] = np.sqrt(v[i] * v[i] + omega2[i] * off * off) + growth


@njit(**SUMS)
def dragged_speeds(v: Array, directions: Array, kept: Array, speeds: Array) -> None:
    """Fill in what no mode's |v| exceeds as dashpots leave ``kept`` of it or more along each."""
    for i in range(v.size):
        speeds[i] = abs(v[i])
    for d in range(kept.size):
        along = 0.0
        for i in range(v.size):
            along += directions[d, i] * v[i]
        taken = abs(along) * (1.0 - kept[d])
        for i in range(v.size):
            speeds[i] += abs(directions[d, i]) * taken


@njit(**SUMS)
def closing_bounds(
    a: Array, v: Array, omega2: Array, load: Array, now: Array, then: Array, rows: Array,
    duration: float, reach: Array, bounds: Array,
) -> None:  # fmt: skip
    """What no row's |ẏ| can exceed within ``duration`` while nothing touches.

    Rigid modes fall; those that tip over do so by cosh κt, κ² = −ω².
    """
    _reach(a, v, omega2, load, now, then, reach)
    for j in range(rows.shape[0]):
        swing = 0.0
        speed = 0.0
        fall = 0.0
        for i in range(a.size):
            if omega2[i] > 0.0:
                swing += abs(rows[j, i]) * reach[i]
            else:
                tips = np.cosh(np.sqrt(-omega2[i]) * duration)
                pull = abs(load[i] + now[i] - omega2[i] * a[i]) + abs(then[i] - now[i])
                speed += tips * abs(rows[j, i] * v[i])
                fall += tips * abs(rows[j, i]) * pull
        bounds[j] = swing + speed + fall * duration


@njit(**LOOP)
def safe_stride(
    y: Array, limits: Limits, bounds: Array, step: float, left: int, strides: Indices
) -> int:
    """Position in ``strides`` of the most steps, up to ``left``, that no gap can shut within."""
    free = float(left)
    for j in range(y.size):
        reach = bounds[j] * step
        if reach > 0.0:
            free = min(free, (limits[j]["high"] - y[j]) / reach)
            free = min(free, (y[j] - limits[j]["low"]) / reach)
    stride = 0
    while stride + 1 < strides.size and strides[stride + 1] <= free:
        stride += 1
    return stride
