# SPDX-License-Identifier: LGPL-3.0-or-later
"""What axial forces do whose places move along, in steps of a boom that is drawn out."""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import PART, SUMS
from dynamics.kernels.moving_rows import knot_before

# Of each thrust in a plane: its force in N (num_thrusts,); its travel, its first and its last knot,
# the first of its pieces, and how many modes it moves (num_thrusts, 5); which these are
# (num_thrusts, most_modes); knots of all in m; in these modes slopes of all pieces
# (num_pieces, 3, most_modes) and what was passed before each (num_pieces, most_modes, most_modes),
# see ``MovingThrust``; scratch (2, most_modes).
Thrusts = tuple[Array, Indices, Indices, Array, Array, Array, Array]

# A mode that moves the place by a smaller part of the largest does not but for round-off.
_NOTHING = 1.0e-13

# Forces on the modes (num_modes,) and slopes where thrusts act (num_thrusts,), where a part of a
# step begins, and where it ends.
Pushed = tuple[Array, Array, Array, Array]


def thrust_arrays(system: GapSystem) -> Thrusts:
    """The thrusts of a system in the layout of the compiled loop."""
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
    return (
        np.array([thrust.force for _, thrust, _ in every], dtype=np.float64),
        np.array(where, dtype=np.int64).reshape(-1, 5),
        columns,
        np.concatenate([np.zeros(0), *knots]),
        slopes,
        passed,
        np.zeros((2, most)),
    )


def _moved(slopes: Array) -> Indices:
    """Modes that slopes (num_pieces, 3, num_modes) read."""
    reach = np.abs(slopes).max(axis=(0, 1))
    return np.flatnonzero(reach > _NOTHING * reach.max(initial=0.0))


def pushed_by(thrusts: Thrusts, a: Array) -> Pushed:
    """What they do to modes (num_modes,) at t = 0, where a step begins and where it ends."""
    force, slopes = np.zeros(a.size), np.zeros(thrusts[0].size)
    press_along(np.zeros(int(thrusts[1][:, 0].max(initial=-1)) + 1), thrusts, a, force, slopes)
    return force, slopes, force.copy(), slopes.copy()


@njit(**SUMS)
def press_along(ways: Array, thrusts: Thrusts, a: Array, force: Array, slopes: Array) -> None:
    """Fill in K_G a of all thrusts and the slopes where they act, ``ways`` (num_travels,) in m."""
    forces, where, columns, knots, powers, passed, scratch = thrusts
    own, total = scratch
    force[:] = 0.0
    for t in range(forces.size):
        travel, start, end, first, count = where[t]
        low = knot_before(knots, start, end, ways[travel])
        length = knots[low + 1] - knots[low]
        u = (ways[travel] - knots[low]) / length
        p = first + low - start
        for i in range(count):
            own[i] = a[columns[t, i]]
        level, turned, bent = 0.0, 0.0, 0.0
        for i in range(count):
            level += powers[p, 0, i] * own[i]
            turned += powers[p, 1, i] * own[i]
            bent += powers[p, 2, i] * own[i]
        slopes[t] = level + u * (turned + u * bent)
        scale = length * u
        of_level = scale * (level + u * (turned / 2.0 + u * bent / 3.0))
        of_turned = scale * u * (level / 2.0 + u * (turned / 3.0 + u * bent / 4.0))
        of_bent = scale * u * u * (level / 3.0 + u * (turned / 4.0 + u * bent / 5.0))
        for i in range(count):
            total[i] = of_level * powers[p, 0, i] + of_turned * powers[p, 1, i]
            total[i] += of_bent * powers[p, 2, i]
        for j in range(count):
            for i in range(count):
                total[i] += passed[p, j, i] * own[j]
        for i in range(count):
            force[columns[t, i]] += forces[t] * total[i]


@njit(**SUMS)
def kick(v: Array, force: Array, time: float) -> None:
    """Let a force (num_modes,) act on the speeds over a time in s."""
    for i in range(v.size):
        v[i] += time * force[i]


@njit(**PART)
def drag_along(
    thrusts: Thrusts, before: Array, after: Array, start: Array, end: Array, time: float,
    span: float, driven: Array,
) -> None:  # fmt: skip
    """Add −½ N (w′ a)² Δs to ``driven`` (num_thrusts,) in J, what the drive does at each thrust.

    Args:
        before, after: (num_thrusts,) slopes where ``time`` in s begins and ends.
        start, end: (num_travels,) in m where the ``span`` in s does, of which that is a part.
    """
    forces, where = thrusts[0], thrusts[1]
    for t in range(forces.size):
        n = where[t, 0]
        way = (end[n] - start[n]) * time / span
        both = before[t] ** 2 + after[t] ** 2
        driven[t] -= 0.25 * forces[t] * both * way
