# SPDX-License-Identifier: LGPL-3.0-or-later
"""Axial forces whose places move along a segment, in the time loop."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import SUMS
from dynamics.kernels.moving_rows import knot_before

# A mode that moves the place by a smaller part of the largest does not but for round-off.
_NOTHING = 1.0e-13


class Thrusts(NamedTuple):
    """Axial forces that go along with travels, one for each plane in which they act.

    Args:
        force: (num_thrusts,) N in N.
        place: (num_thrusts, 5) the travel, the first and the last knot, the first piece, and the
            number of modes of each.
        modes: (num_thrusts, most_modes) the modes that move its place.
        knots: of all, in m.
        slopes: (num_pieces, 3, most_modes) of w′ over the powers of the part passed, and
        passed: (num_pieces, most_modes, most_modes) ∫ w′ᵀ w′ ds before each piece; see
            :class:`dynamics.drive.row_table.MovingThrust`.
    """

    force: Array
    place: Indices
    modes: Indices
    knots: Array
    slopes: Array
    passed: Array


def thrust_arrays(system: GapSystem) -> Thrusts:
    """Return the thrusts of a system."""
    every = [
        (number, thrust, plane)
        for number, travel in enumerate(system.travels)
        for thrust in travel.thrusts
        for plane in range(thrust.planes)
    ]
    moved = [_moved(thrust.slopes[:, :, plane]) for _, thrust, plane in every]
    most = max((len(modes) for modes in moved), default=0)
    pieces = sum(len(thrust.table.coefficients) for _, thrust, _ in every)
    slopes, passed = np.zeros((pieces, 3, most)), np.zeros((pieces, most, most))
    columns, where, knots, first = np.zeros((len(every), most), dtype=np.int64), [], [], 0
    for t, ((number, thrust, plane), modes) in enumerate(zip(every, moved, strict=True)):
        own, count, low = thrust.slopes[:, :, plane], len(modes), first + t
        last = first + len(own)
        slopes[first:last, :, :count] = own[:, :, modes]
        passed[first:last, :count, :count] = thrust.passed(plane)[:, modes[:, None], modes]
        columns[t, :count] = modes
        where.append((number, low, low + len(own), first, count))
        knots.append(thrust.table.knots)
        first = last
    return Thrusts(
        np.array([thrust.force for _, thrust, _ in every], dtype=np.float64),
        np.array(where, dtype=np.int64).reshape(-1, 5),
        columns,
        np.concatenate([np.zeros(0), *knots]),
        slopes,
        passed,
    )


def _moved(slopes: Array) -> Indices:
    """Return the modes that slopes (num_pieces, 3, num_modes) read."""
    reach = np.abs(slopes).max(axis=(0, 1))
    return np.flatnonzero(reach > _NOTHING * reach.max(initial=0.0))


@njit(**SUMS)
def add_thrust_forces(ways: Array, thrusts: Thrusts, a: Array, share: float, total: Array) -> None:
    """Add a share of K_G a to ``total`` (num_modes,), at ways (num_travels,) in m."""
    most = thrusts.modes.shape[1]
    own, force = np.zeros(most), np.zeros(most)
    for t in range(thrusts.force.size):
        soften(ways, thrusts, t, a, own, force)
        for i in range(thrusts.place[t, 4]):
            total[thrusts.modes[t, i]] += share * force[i]


@njit(**SUMS)
def thrust_energies(ways: Array, thrusts: Thrusts, a: Array, energies: Array) -> None:
    """Set ``energies`` (num_thrusts,) to ½ aᵀ K_G a in J, which the strain energy loses."""
    most = thrusts.modes.shape[1]
    own, force = np.zeros(most), np.zeros(most)
    for t in range(thrusts.force.size):
        soften(ways, thrusts, t, a, own, force)
        energies[t] = 0.0
        for i in range(thrusts.place[t, 4]):
            energies[t] += 0.5 * own[i] * force[i]


@njit(**SUMS)
def soften(ways: Array, thrusts: Thrusts, t: int, a: Array, own: Array, force: Array) -> None:
    """Set ``own`` (most_modes,) to the coordinates that thrust t moves, ``force`` to its K_G a."""
    travel, start, end, first, count = thrusts.place[t]
    knots, slopes, passed = thrusts.knots, thrusts.slopes, thrusts.passed
    low = knot_before(knots, start, end, ways[travel])
    length = knots[low + 1] - knots[low]
    u = (ways[travel] - knots[low]) / length
    p = first + low - start
    for i in range(count):
        own[i] = a[thrusts.modes[t, i]]
    level, turned, bent = 0.0, 0.0, 0.0
    for i in range(count):
        level += slopes[p, 0, i] * own[i]
        turned += slopes[p, 1, i] * own[i]
        bent += slopes[p, 2, i] * own[i]
    scale = length * u * thrusts.force[t]
    of_level = scale * (level + u * (turned / 2.0 + u * bent / 3.0))
    of_turned = scale * u * (level / 2.0 + u * (turned / 3.0 + u * bent / 4.0))
    of_bent = scale * u * u * (level / 3.0 + u * (turned / 4.0 + u * bent / 5.0))
    for i in range(count):
        force[i] = of_level * slopes[p, 0, i] + of_turned * slopes[p, 1, i]
        force[i] += of_bent * slopes[p, 2, i]
    for j in range(count):
        pressed = thrusts.force[t] * own[j]
        for i in range(count):
            force[i] += passed[p, j, i] * pressed
