# SPDX-License-Identifier: LGPL-3.0-or-later
"""Closed-form motion of undamped modes, and how far it may jump without missing a contact."""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array


@njit(nogil=True, inline="always")
def tabulate(omega: Array, load: Array, time: float, flow: Array) -> None:
    """The exact flow of undamped modes over ``time`` under a constant load, (5, num_modes).

    a' = f0 a + f1 v + f2, v' = f3 a + f0 v + f4.
    """
    for i in range(omega.size):
        w = omega[i]
        if w > 0.0:
            c, s = np.cos(w * time), np.sin(w * time)
            flow[0, i] = c
            flow[1, i] = s / w
            flow[2, i] = (1.0 - c) * load[i] / (w * w)
            flow[3, i] = -w * s
            flow[4, i] = s / w * load[i]
        else:
            flow[0, i] = 1.0
            flow[1, i] = time
            flow[2, i] = 0.5 * time * time * load[i]
            flow[3, i] = 0.0
            flow[4, i] = time * load[i]


@njit(nogil=True, inline="always")
def jump(a: Array, v: Array, flow: Array) -> None:
    """Move the state (a, v), each (num_modes,), by a flow."""
    for i in range(a.size):
        ai, vi = a[i], v[i]
        a[i] = flow[0, i] * ai + flow[1, i] * vi + flow[2, i]
        v[i] = flow[3, i] * ai + flow[0, i] * vi + flow[4, i]


@njit(cache=True, nogil=True)
def pulls(a: Array, v: Array, omega: Array, load: Array, rows: Array, out: Array) -> None:
    """(num_rows,) what no gap's acceleration can exceed while nothing touches, in m/s².

    Σ |B_i| ω_i √(v_i² + ω_i² s_i²), with the swing s_i about the rest position, which all modes
    together reach at most, plus |Σ B_i Q_i| over the rigid modes.
    """
    for j in range(rows.shape[0]):
        swinging = 0.0
        falling = 0.0
        for i in range(a.size):
            b = rows[j, i]
            w = omega[i]
            if w > 0.0:
                swing = w * a[i] - load[i] / w
                swinging += abs(b) * w * np.sqrt(v[i] * v[i] + swing * swing)
            else:
                falling += b * load[i]
        out[j] = swinging + abs(falling)


@njit(cache=True, nogil=True)
def stay(
    y: float, speed: float, pull: float, low: float, high: float, shut: float
) -> tuple[float, int]:
    """Time in which a gap y cannot leave [low, high], and on which side it is leaving.

    A gap that accelerates by no more than ``pull`` does not come from the distance d to a bound,
    at the speed u towards it, before 2 d / (u + √(u² + 2 pull d)). Within ``shut`` of the bound
    and moving on it is leaving: 1 above, −1 below, 0 if it is not.
    """
    time = np.inf
    for side in (-1, 1):
        distance = high - y if side > 0 else y - low
        if distance == np.inf:
            continue
        towards = side * speed
        if distance <= shut and towards > 0.0:
            return 0.0, side
        distance = max(distance, 0.0)
        root = np.sqrt(towards * towards + 2.0 * pull * distance)
        if towards > 0.0:
            time = min(time, 2.0 * distance / (towards + root))
        elif pull > 0.0:
            time = min(time, (root - towards) / pull)
    return time, 0


@njit(nogil=True, inline="always")
def safe_time(
    a: Array, v: Array, rows: Array, pull: Array, low: Array, high: Array, shut: Array
) -> tuple[float, int]:
    """Time in which no gap can leave its [low, high], and which one is leaving, as :func:`stay`.

    Gaps are counted from 1, negative where they leave below; 0 if none is leaving.
    """
    time = np.inf
    for j in range(rows.shape[0]):
        y = 0.0
        speed = 0.0
        for i in range(a.size):
            y += rows[j, i] * a[i]
            speed += rows[j, i] * v[i]
        free, side = stay(y, speed, pull[j], low[j], high[j], shut[j])
        if side != 0:
            return 0.0, side * (j + 1)
        time = min(time, free)
    return time, 0
