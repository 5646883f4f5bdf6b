# SPDX-License-Identifier: LGPL-3.0-or-later
"""Closed-form motion of undamped modes, and how far it may jump without missing a contact."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from numba import njit

Array = npt.NDArray[np.float64]


@njit(cache=True, nogil=True)
def flow(z: Array, v: Array, omega: Array, load: Array, time: float) -> None:
    """Move (z, v), each (num_modes,), exactly over ``time`` under a constant load."""
    for i in range(z.size):
        w = omega[i]
        if w > 0.0:
            rest = load[i] / (w * w)
            swing = z[i] - rest
            c, s = np.cos(w * time), np.sin(w * time)
            z[i] = rest + swing * c + v[i] / w * s
            v[i] = v[i] * c - w * swing * s
        else:
            z[i] += time * (v[i] + 0.5 * time * load[i])
            v[i] += time * load[i]


@njit(cache=True, nogil=True)
def safe_time(
    z: Array,
    v: Array,
    omega: Array,
    load: Array,
    rows: Array,
    low: Array,
    high: Array,
    shut: Array,
    longest: float,
) -> tuple[float, int]:
    """Longest time in which no gap can leave its interval [low, high], and who is leaving it.

    All modes together cannot accelerate a gap by more than A = Σ |B_i| ω_i √(v_i² + ω_i² s_i²),
    with the swing s_i about the rest position, plus |Σ B_i q_i| over the rigid modes. From the
    distance d to the bound and the speed u towards it, the gap stays inside for
    2 d / (u + √(u² + 2 A d)). A row within ``shut`` of its bound and moving on is leaving; its
    number is given, counted from 1, negative where it leaves below; 0 if no row does.
    """
    time = longest
    for j in range(rows.shape[0]):
        y = 0.0
        speed = 0.0
        fall = 0.0
        pull = 0.0
        for i in range(z.size):
            b = rows[j, i]
            w = omega[i]
            y += b * z[i]
            speed += b * v[i]
            if w > 0.0:
                swing = w * z[i] - load[i] / w
                pull += abs(b) * w * np.sqrt(v[i] * v[i] + swing * swing)
            else:
                fall += b * load[i]
        pull += abs(fall)
        for side in (1, -1):
            distance = high[j] - y if side > 0 else y - low[j]
            towards = side * speed
            if distance == np.inf:
                continue
            if distance <= shut[j] and towards > 0.0:
                return 0.0, side * (j + 1)
            d = max(distance, 0.0)
            root = np.sqrt(towards * towards + 2.0 * pull * d)
            if towards > 0.0:
                time = min(time, 2.0 * d / (towards + root))
            elif pull > 0.0:
                time = min(time, (root - towards) / pull)
    return time, 0
