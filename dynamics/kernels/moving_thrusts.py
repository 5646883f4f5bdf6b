# SPDX-License-Identifier: LGPL-3.0-or-later
"""What axial forces do whose places move along, in steps of a boom that is drawn out."""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import SUMS

# Of each thrust in a plane: its force in N (num_thrusts,); its travel, its first and its last knot,
# the first of its pieces, and between which modes it acts (num_thrusts, 6); knots of all in m;
# slopes of all pieces (num_pieces, 3, num_modes) and what was passed before each
# (num_pieces, most_modes, most_modes), see ``MovingThrust``.
Thrusts = tuple[Array, Indices, Array, Array, Array]

# Forces on the modes (num_modes,) and slopes where thrusts act (num_thrusts,), where a part of a
# step begins, and where it ends.
Pushed = tuple[Array, Array, Array, Array]


def thrust_arrays(system: GapSystem) -> Thrusts:
    """The thrusts of a system in the layout of the compiled loop."""
    forces, where, knots, slopes, passed = [], [], [np.zeros(0)], [], []
    pieces = first = 0
    for number, travel in enumerate(system.travels):
        for thrust in travel.thrusts:
            own = thrust.slopes
            for plane in range(own.shape[2]):
                (modes,) = np.nonzero(own[:, :, plane].any(axis=(0, 1)))
                begin, end = (int(modes[0]), int(modes[-1]) + 1) if modes.size else (0, 0)
                last = first + len(own)
                forces.append(thrust.force)
                where.append((number, first, last, pieces, begin, end))
                knots.append(thrust.table.knots)
                slopes.append(own[:, :, plane])
                passed.append(thrust.passed(plane)[:, begin:end, begin:end])
                first, pieces = last + 1, pieces + len(own)
    most = max((block.shape[1] for block in passed), default=0)
    blocks = [
        np.pad(block, ((0, 0), *2 * [(0, most - block.shape[1])])) for block in passed
    ]  # fmt: skip
    return (
        np.array(forces),
        np.array(where, dtype=np.int64).reshape(-1, 6),
        np.concatenate(knots),
        np.concatenate([np.zeros((0, 3, system.num_modes)), *slopes]),
        np.concatenate([np.zeros((0, most, most)), *blocks]),
    )


def pushed_by(thrusts: Thrusts, a: Array) -> Pushed:
    """What they do to modes (num_modes,) at t = 0, where a step begins and where it ends."""
    force, slopes = np.zeros(a.size), np.zeros(thrusts[0].size)
    press_along(np.zeros(int(thrusts[1][:, 0].max(initial=-1)) + 1), thrusts, a, force, slopes)
    return force, slopes, force.copy(), slopes.copy()


@njit(**SUMS)
def press_along(ways: Array, thrusts: Thrusts, a: Array, force: Array, slopes: Array) -> None:
    """Fill in K_G a of all thrusts and the slopes where they act, ``ways`` (num_travels,) in m."""
    forces, where, knots, powers, passed = thrusts
    force[:] = 0.0
    for t in range(forces.size):
        travel, low, high, first, begin, end = where[t]
        start = low
        while high - low > 1:
            middle = (low + high) // 2
            if knots[middle] <= ways[travel]:
                low = middle
            else:
                high = middle
        length = knots[low + 1] - knots[low]
        u = (ways[travel] - knots[low]) / length
        p = first + low - start
        bent, turned, level = 0.0, 0.0, 0.0
        for i in range(begin, end):
            level += powers[p, 0, i] * a[i]
            turned += powers[p, 1, i] * a[i]
            bent += powers[p, 2, i] * a[i]
        slopes[t] = level + u * (turned + u * bent)
        scale = forces[t] * length * u
        of_level = scale * (level + u * (turned / 2.0 + u * bent / 3.0))
        of_turned = scale * u * (level / 2.0 + u * (turned / 3.0 + u * bent / 4.0))
        of_bent = scale * u * u * (level / 3.0 + u * (turned / 4.0 + u * bent / 5.0))
        for i in range(begin, end):
            total = 0.0
            for j in range(begin, end):
                total += passed[p, i - begin, j - begin] * a[j]
            force[i] += forces[t] * total + of_level * powers[p, 0, i]
            force[i] += of_turned * powers[p, 1, i] + of_bent * powers[p, 2, i]


@njit(**SUMS)
def kick(v: Array, force: Array, time: float) -> None:
    for i in range(v.size):
        v[i] += time * force[i]
