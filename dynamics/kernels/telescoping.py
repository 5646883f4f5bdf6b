# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows and axial forces that change with travels, in the time loop.

A row is B₀ at the start and B₁ at the end of a step, with the mean B̄. Its displacement changes by
B₁ a₁ − B₀ a₀ = B̄ (a₁ − a₀) + (B₁ − B₀)(a₀ + a₁)/2. Forces act on the modes by B̄. The second term
times the force is the work of the drive, so that the energy balance is exact.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from protractile.dynamics.arrays import Array, Indices
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.kernels.compiled import SUMS
from protractile.dynamics.travel import ROW_KINDS, ChangingAxialForce, MovingAxialForce

# Fraction of the largest slope of a mode at a force below which the slope of a mode is round-off.
_NOTHING = 1.0e-13


class MovingRows(NamedTuple):
    """Rows that change with travels, as cubics between knots."""

    number: Indices  #: (num_moving,) index of each moving row among all rows
    #: (num_moving, 4) indices of the row's travel, first and last knot, and first piece
    spans: Indices
    shifts: Array  #: (num_moving,) increase of the row's displacement per m of extension
    knots: Array  #: knots of all travels in m
    #: (num_pieces, 4, num_modes) coefficients of powers of the relative position in a piece, for
    #: all rows
    cubics: Array


class AxialForces(NamedTuple):
    """Axial forces that move with travels, one for each plane of bending, or change in magnitude.

    Args:
        force: (num_forces,) P_t in N.
        spans: (num_forces, 4) as in :class:`MovingRows`.
        num_modes: (num_forces,) number of modes with a slope at the force.
        modes: (num_forces, most_modes) indices of these modes.
        knots: knots of all forces in m.
        slopes: (num_pieces, 3, most_modes) coefficients of w′, as in
            :class:`.dynamics.travel.MovingAxialForce`.
        products: (num_pieces, most_modes, most_modes) ∫ w′ᵀ w′ ds̃ from 0 to each piece.
        changed_by: (num_vectors,) index of the travel of each vector.
        factors, vectors: as in :class:`.dynamics.travel.ChangingAxialForce`.
    """

    force: Array
    spans: Indices
    num_modes: Indices
    modes: Indices
    knots: Array
    slopes: Array
    products: Array
    changed_by: Indices
    factors: Array
    vectors: Array


def moving_rows(system: GapSystem) -> MovingRows:
    """Return the rows of a system that change with travels."""
    firsts = np.cumsum([0, *(len(getattr(system, kind)) for kind in ROW_KINDS)])
    first_of = dict(zip(ROW_KINDS, firsts[:-1].tolist(), strict=True))
    numbers, spans, shifts, pieces = [], [], list[float](), 0
    cubics = [np.zeros((0, 4, system.num_modes))]
    first_knots = np.cumsum([0, *(len(travel.table.knots) for travel in system.travels)]).tolist()
    for number, travel in enumerate(system.travels):
        shifts += travel.shifts or [0.0] * len(travel.moved_rows)
        for row, (kind, position) in enumerate(travel.moved_rows):
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
    """Return the axial forces of a system that move or change with travels."""
    forces = [
        (k, axial) for k, travel in enumerate(system.travels) for axial in travel.axial_forces
    ]
    every = [
        (k, axial, plane)
        for k, axial in forces
        if isinstance(axial, MovingAxialForce)
        for plane in range(axial.table.coefficients.shape[2])
    ]
    changing = [(k, axial) for k, axial in forces if isinstance(axial, ChangingAxialForce)]
    reach = [np.abs(axial.slopes[:, :, plane]).max(axis=(0, 1)) for _, axial, plane in every]
    moved = [np.flatnonzero(part > _NOTHING * part.max(initial=0.0)) for part in reach]
    most = max((modes.size for modes in moved), default=0)
    pieces = sum(len(axial.table.coefficients) for _, axial, _ in every)
    slopes, products = np.zeros((pieces, 3, most)), np.zeros((pieces, most, most))
    columns, spans, first = np.zeros((len(every), most), dtype=np.int64), [], 0
    for t, ((number, axial, plane), modes) in enumerate(zip(every, moved, strict=True)):
        last = first + len(axial.table.coefficients)
        slopes[first:last, :, : modes.size] = axial.slopes[:, :, plane, modes]
        products[first:last, : modes.size, : modes.size] = axial.slope_products(plane)[
            :, modes[:, None], modes
        ]
        columns[t, : modes.size] = modes
        spans.append((number, first + t, last + t, first))
        first = last
    return AxialForces(
        np.array([axial.force for _, axial, _ in every], dtype=np.float64),
        np.array(spans, dtype=np.int64).reshape(-1, 4),
        np.array([modes.size for modes in moved], dtype=np.int64),
        columns,
        np.concatenate([np.zeros(0), *(axial.table.knots for _, axial, _ in every)]),
        slopes,
        products,
        np.array([k for k, axial in changing for _ in axial.factors], dtype=np.int64),
        np.concatenate([np.zeros(0), *(axial.factors for _, axial in changing)]),
        np.concatenate(
            [np.zeros((0, system.num_modes)), *(axial.vectors for _, axial in changing)]
        ),
    )


@njit(**SUMS)
def find_piece(extensions: Array, span: Indices, knots: Array) -> tuple[int, float, float]:
    """Return the index of the piece at a travel's extension, the position in it, and its length.

    The position is a fraction of the length, the length is in m.
    """
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
    """Compute the rows (num_rows, num_modes) that change with travels.

    Args:
        extensions: (num_travels,) extensions in m at the end of a step.
        moving: cubics of the rows that change.
        before: B₀ at the start of the step.
        after: B₁ at the end of the step; the function sets it.
        mean: B̄; the function sets it.
    """
    for m in range(moving.number.size):
        row = moving.number[m]
        piece, u, _ = find_piece(extensions, moving.spans[m], moving.knots)
        cubic = moving.cubics[piece]
        for i in range(after.shape[1]):
            upper_terms = cubic[2, i] + u * cubic[3, i]
            after[row, i] = cubic[0, i] + u * (cubic[1, i] + u * upper_terms)
            mean[row, i] = 0.5 * (before[row, i] + after[row, i])


@njit(**SUMS)
def add_axial_forces(
    extensions: Array, axial: AxialForces, a: Array, share: float, total: Array, energies: Array
) -> None:
    """Add ``share`` K_G a to ``total``, and ``share`` ½ aᵀ K_G a in J to the energy of each travel.

    Args:
        extensions: (num_travels,) extensions in m.
        axial: moving axial forces.
        a: (num_modes,) modal coordinates.
        share: factor of force and energy.
        total: (num_modes,) modal force in N/√kg.
        energies: (num_travels,) reduction of the strain energy in J.
    """
    coordinates, force = np.zeros((2, axial.modes.shape[1]))
    slopes, products = axial.slopes, axial.products
    for t in range(axial.force.size):
        p, u, length = find_piece(extensions, axial.spans[t], axial.knots)
        count = axial.num_modes[t]
        for i in range(count):
            coordinates[i] = a[axial.modes[t, i]]
        constant, linear, quadratic = 0.0, 0.0, 0.0
        for i in range(count):
            constant += slopes[p, 0, i] * coordinates[i]
            linear += slopes[p, 1, i] * coordinates[i]
            quadratic += slopes[p, 2, i] * coordinates[i]
        scale = length * u * axial.force[t]
        of_constant = scale * (constant + u * (linear / 2.0 + u * quadratic / 3.0))
        of_linear = scale * u * (constant / 2.0 + u * (linear / 3.0 + u * quadratic / 4.0))
        of_quadratic = scale * u * u * (constant / 3.0 + u * (linear / 4.0 + u * quadratic / 5.0))
        for i in range(count):
            force[i] = of_constant * slopes[p, 0, i] + of_linear * slopes[p, 1, i]
            force[i] += of_quadratic * slopes[p, 2, i]
        for j in range(count):
            scaled_force = axial.force[t] * coordinates[j]
            for i in range(count):
                force[i] += products[p, j, i] * scaled_force
        for i in range(count):
            total[axial.modes[t, i]] += share * force[i]
            energies[axial.spans[t, 0]] += 0.5 * share * coordinates[i] * force[i]
    for r in range(axial.factors.size):
        vector, product = axial.vectors[r], 0.0
        for i in range(a.size):
            product += vector[i] * a[i]
        scaled_force = share * extensions[axial.changed_by[r]] * axial.factors[r] * product
        for i in range(a.size):
            total[i] += scaled_force * vector[i]
        energies[axial.changed_by[r]] += 0.5 * scaled_force * product
