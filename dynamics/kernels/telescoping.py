# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows and axial forces of a gap system that travels move, in the time loop.

Between the ends of a step a row changes its displacement by B₁ a₁ − B₀ a₀ = B̄ (a₁ − a₀) +
(B₁ − B₀)(a₀ + a₁)/2. Forces push with the mean row B̄ on the modes; the second part times the force
is the work of the drive, so that the energy balances exactly.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.drive.travel import KINDS
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import SUMS

# A mode that moves the place of a force by a smaller part of the largest does so by round-off.
_NOTHING = 1.0e-13


class MovingRows(NamedTuple):
    """The rows that travels move, as cubics between knots.

    Args:
        number: (num_moving,) the position of each among all rows.
        spans: (num_moving, 4) its travel, its first and last knot, and its first piece.
        shifts: (num_moving,) growth of its displacement per m of extension.
        knots: of all travels in m.
        cubics: (num_pieces of all rows, 4, num_modes) coefficients of the part of a piece passed.
    """

    number: Indices
    spans: Indices
    shifts: Array
    knots: Array
    cubics: Array


class AxialForces(NamedTuple):
    """Axial forces that move with travels, one for each plane in which they act.

    Args:
        force: (num_forces,) N in N.
        spans: (num_forces, 4) as of :class:`MovingRows`.
        moved: (num_forces,) number of modes that move the place of each, and
        modes: (num_forces, most_modes) these modes.
        knots: of all, in m.
        slopes: (num_pieces, 3, most_modes) of w′ over the powers of the part passed, and
        passed: (num_pieces, most_modes, most_modes) ∫ w′ᵀ w′ ds before each piece; see
            :class:`dynamics.drive.row_table.MovingAxialForce`.
    """

    force: Array
    spans: Indices
    moved: Indices
    modes: Indices
    knots: Array
    slopes: Array
    passed: Array


def moving_rows(system: GapSystem) -> MovingRows:
    """Return the rows of a system that travels move."""
    firsts = np.cumsum([0, *(len(getattr(system, kind)) for kind in KINDS)])
    first_of = dict(zip(KINDS, firsts[:-1].tolist(), strict=True))
    numbers, spans, shifts, pieces = [], [], list[float](), 0
    cubics = [np.zeros((0, 4, system.num_modes))]
    first_knots = np.cumsum([0, *(len(travel.table.knots) for travel in system.travels)]).tolist()
    for number, travel in enumerate(system.travels):
        shifts += travel.shifts or [0.0] * len(travel.moving)
        for row, (kind, position) in enumerate(travel.moving):
            numbers.append(first_of[kind] + position)
            spans.append((number, first_knots[number], first_knots[number + 1] - 1, pieces))
            cubics.append(travel.table.coefficients[:, :, row])
            pieces += len(travel.table.coefficients)
    return MovingRows(
        np.array(numbers, dtype=np.int64),
        np.array(spans, dtype=np.int64).reshape(-1, 4),
        np.array(shifts),
        np.concatenate([np.zeros(0), *(travel.table.knots for travel in system.travels)]),
        np.ascontiguousarray(np.concatenate(cubics)),
    )


def moving_axial_forces(system: GapSystem) -> AxialForces:
    """Return the axial forces of a system that travels move."""
    every = [
        (number, one, plane)
        for number, travel in enumerate(system.travels)
        for one in travel.axial_forces
        for plane in range(one.planes)
    ]
    reach = [np.abs(one.slopes[:, :, plane]).max(axis=(0, 1)) for _, one, plane in every]
    moved = [np.flatnonzero(part > _NOTHING * part.max(initial=0.0)) for part in reach]
    most = max((modes.size for modes in moved), default=0)
    pieces = sum(len(one.table.coefficients) for _, one, _ in every)
    slopes, passed = np.zeros((pieces, 3, most)), np.zeros((pieces, most, most))
    columns, spans, first = np.zeros((len(every), most), dtype=np.int64), [], 0
    for t, ((number, one, plane), modes) in enumerate(zip(every, moved, strict=True)):
        last = first + len(one.table.coefficients)
        slopes[first:last, :, : modes.size] = one.slopes[:, :, plane, modes]
        passed[first:last, : modes.size, : modes.size] = one.passed(plane)[:, modes[:, None], modes]
        columns[t, : modes.size] = modes
        spans.append((number, first + t, last + t, first))
        first = last
    return AxialForces(
        np.array([one.force for _, one, _ in every], dtype=np.float64),
        np.array(spans, dtype=np.int64).reshape(-1, 4),
        np.array([modes.size for modes in moved], dtype=np.int64),
        columns,
        np.concatenate([np.zeros(0), *(one.table.knots for _, one, _ in every)]),
        slopes,
        passed,
    )


@njit(**SUMS)
def find_piece(extensions: Array, span: Indices, knots: Array) -> tuple[int, float, float]:
    """Return the piece of a span at its travel's extension, the part passed, the length in m."""
    travel, low, high, first = span
    start, extension = low, extensions[travel]
    while high - low > 1:
        middle = (low + high) // 2
        if knots[middle] <= extension:
            low = middle
        else:
            high = middle
    length = knots[low + 1] - knots[low]
    return first + low - start, (extension - knots[low]) / length, length


@njit(**SUMS)
def move_rows(
    extensions: Array, moving: MovingRows, before: Array, after: Array, mean: Array
) -> None:
    """Set the rows (num_rows, num_modes) that move.

    Args:
        extensions: (num_travels,) in m at the end of a step.
        moving: the rows that move.
        before: at the start of the step.
        after: B₁, is set.
        mean: B̄, is set.
    """
    for m in range(moving.number.size):
        row = moving.number[m]
        piece, u, _ = find_piece(extensions, moving.spans[m], moving.knots)
        cubic = moving.cubics[piece]
        for i in range(after.shape[1]):
            bent = cubic[2, i] + u * cubic[3, i]
            after[row, i] = cubic[0, i] + u * (cubic[1, i] + u * bent)
            mean[row, i] = 0.5 * (before[row, i] + after[row, i])


@njit(**SUMS)
def add_axial_forces(
    extensions: Array, axial: AxialForces, a: Array, share: float, total: Array, energies: Array
) -> None:
    """Add a share of K_G a to ``total``, and of ½ aᵀ K_G a in J to the energy of each travel.

    Args:
        extensions: (num_travels,) in m.
        axial: the axial forces that move.
        a: (num_modes,) modal coordinates.
        share: factor of the force and of the energy.
        total: (num_modes,) force on the modes; is changed.
        energies: (num_travels,) energy that the strain energy loses; is changed.
    """
    own, force = np.zeros((2, axial.modes.shape[1]))
    slopes, passed = axial.slopes, axial.passed
    for t in range(axial.force.size):
        p, u, length = find_piece(extensions, axial.spans[t], axial.knots)
        count = axial.moved[t]
        for i in range(count):
            own[i] = a[axial.modes[t, i]]
        level, turned, bent = 0.0, 0.0, 0.0
        for i in range(count):
            level += slopes[p, 0, i] * own[i]
            turned += slopes[p, 1, i] * own[i]
            bent += slopes[p, 2, i] * own[i]
        scale = length * u * axial.force[t]
        of_level = scale * (level + u * (turned / 2.0 + u * bent / 3.0))
        of_turned = scale * u * (level / 2.0 + u * (turned / 3.0 + u * bent / 4.0))
        of_bent = scale * u * u * (level / 3.0 + u * (turned / 4.0 + u * bent / 5.0))
        for i in range(count):
            force[i] = of_level * slopes[p, 0, i] + of_turned * slopes[p, 1, i]
            force[i] += of_bent * slopes[p, 2, i]
        for j in range(count):
            pressed = axial.force[t] * own[j]
            for i in range(count):
                force[i] += passed[p, j, i] * pressed
        for i in range(count):
            total[axial.modes[t, i]] += share * force[i]
            energies[axial.spans[t, 0]] += 0.5 * share * own[i] * force[i]
