# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact, friction and dashpot forces f of one time step, constant within it.

A step of length h leads from the displacements y₀ of all rows to y₁ = y_free − H f, with y_free
without these forces and the compliance H. In the step,

- a contact force is the discrete gradient of the contact energy U, f = (U(y₁) − U(y₀))/(y₁ − y₀),
  times 1 + χ δ̇ at the mean rate δ̇ of the penetration (Hunt and Crossley 1975), never attractive;
- friction obeys |f| ≤ μ N_l, and f = μ N_l sign(y₁ − y₀) in sliding (Moreau 1988). The normal force
  N_l is the prescribed one plus the |f| of contacts;
- a dashpot resists the mean rate, f = (y₁ − y₀)/h.

A semismooth Newton method on the active rows solves the system (Alart and Curnier 1991).

The formulas of force, energy and slope are in :mod:`.dynamics.contact`. It does not import
numba, since this takes longer than the check of a case.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from protractile.dynamics.arrays import Array, Indices
from protractile.dynamics.contact import (
    Limits,
    Terms,
    contact_limits,
    contact_terms,
    energy_of,
    force_of,
    slope_of,
)
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.kernels.compiled import LOOP

# Number of iterations after which a step is halved. Most steps need two.
_MOST_ITERATIONS = 25

# Residual of a converged solution, as a fraction of the largest force, and relative round-off of
# displacements.
_CONVERGED, _ROUND_OFF = 1.0e-13, 4.0e-16

# Pivot below which a column depends linearly on earlier columns; the force of this row does not
# change.
_DEPENDENT = 1.0e-11

term_force, term_energy, term_slope = (
    njit(**LOOP, inline="always")(of_term) for of_term in (force_of, energy_of, slope_of)
)

# Relative change of a penetration below which the difference quotient is round-off.
_CLOSE = 1.0e-3


@njit(**LOOP)
def contact_energy(y: Array, terms: Terms) -> float:
    """Return the elastic energy in J of all contacts at displacements y (num_rows,) in m."""
    energy = 0.0
    for t in range(terms.size):
        energy += term_energy(terms[t], y[terms[t]["row"]])
    return energy


@njit(**LOOP)
def discrete_gradient(term: np.void, before: float, after: float) -> tuple[float, float]:
    """Return (U(y₁) − U(y₀))/(y₁ − y₀) of a term's energy U in N, and its derivative by y₁ in N/m.

    Both are free of cancellation for y₁ near y₀ (Gonzalez 1996). The derivative, which only
    Newton's method uses, is a midpoint value for y₁ near y₀ unless the exponent is 1 or 2.

    Args:
        before, after: relative displacements y₀ and y₁ in m.
    """
    side, k, n = term["side"], term["stiffness"], term["exponent"]
    p, q = side * before - term["onset"], side * after - term["onset"]
    if p <= 0.0 and q <= 0.0:
        return 0.0, 0.0
    if p <= 0.0:
        force = k * q**n
        mean = force * q / ((n + 1.0) * (q - p))
        return side * mean, (force - mean) / (q - p)
    if q <= 0.0:
        mean = k * p ** (n + 1.0) / ((n + 1.0) * (p - q))
        return side * mean, mean / (p - q)
    if n == 1.0:
        return side * 0.5 * k * (p + q), 0.5 * k
    if n == 2.0:
        return side * k * (p * p + p * q + q * q) / 3.0, k * (p + 2.0 * q) / 3.0
    change = (q - p) / p
    mean = k * p**n
    if change != 0.0:
        mean *= np.expm1((n + 1.0) * np.log1p(change)) / ((n + 1.0) * change)
    if abs(change) < _CLOSE:
        return side * mean, 0.5 * n * k * ((p + 2.0 * q) / 3.0) ** (n - 1.0)
    return side * mean, (k * q**n - mean) / (q - p)


class Laws(NamedTuple):
    """Contact and friction laws of all rows in the order contacts, frictions, dashpots.

    Args:
        terms, limits: terms of the contact laws, and ranges of y in which contacts are open.
        first_term: (num_contacts + 1,) index of the first term of each contact.
        friction: (2, num_frictions) μ and prescribed normal force in N.
        pressing: (num_frictions, num_contacts) 1 if the contact adds to the normal force, else 0.
    """

    terms: Terms
    limits: Limits
    first_term: Indices
    friction: Array
    pressing: Array


class Problem(NamedTuple):
    """Unknowns of a step, and work arrays for their solution."""

    free: Array  #: (num_rows,) y_free in m
    force: Array  #: (num_rows,) f in N; the initial guess, then the solution
    bound: Array  #: (num_frictions,) μ N_l in N
    active: Indices  #: (num_rows,) indices of the active rows
    jacobian: Array  #: (num_rows, num_rows) Jacobian of the active rows
    residual: Array  #: (num_rows,) residuals of the active rows


def row_laws(system: GapSystem) -> Laws:
    """Return the laws of all rows of a system."""
    terms, frictions = contact_terms(system.laws), system.frictions
    first = np.searchsorted(terms["row"], np.arange(len(system.laws) + 1))
    friction = np.array([[f.coefficient, f.normal_force] for f in frictions]).reshape(-1, 2)
    pressing = np.zeros((len(frictions), len(system.laws)))
    for number, law in enumerate(frictions):
        pressing[number, list(law.normal_rows)] = 1.0
    return Laws(terms, contact_limits(system.laws), first, friction.T.copy(), pressing)


def row_problem(num_rows: int, num_frictions: int) -> Problem:
    """Return the problem of a step with zero forces."""
    square = np.zeros((num_rows, num_rows))
    active = np.zeros(num_rows, dtype=np.int64)
    free, force, residual = np.zeros((3, num_rows))
    return Problem(free, force, np.zeros(num_frictions), active, square, residual)


@njit(**LOOP)
def contact_response(
    laws: Laws, j: int, before: float, after: float, time: float
) -> tuple[float, float, float]:
    """Return the force in N of contact j, its derivative by y₁ in N/m, and its elastic part in N.

    ``before`` and ``after`` are y₀ and y₁ in m, ``time`` is h in s.
    """
    force, slope, elastic = 0.0, 0.0, 0.0
    damping = laws.limits[j]["damping"]
    for t in range(laws.first_term[j], laws.first_term[j + 1]):
        mean, rise = discrete_gradient(laws.terms[t], before, after)
        elastic += mean
        if damping == 0.0:
            force += mean
            slope += rise
        elif mean != 0.0:
            rate = laws.terms[t]["side"] * damping / time
            factor = 1.0 + rate * (after - before)
            if factor > 0.0:
                force += factor * mean
                slope += factor * rise + rate * mean
    return force, slope, elastic


@njit(**LOOP)
def solve_contact_forces(
    laws: Laws, problem: Problem, compliance: Array, start: Array, time: float
) -> bool:
    """Compute the contact, friction and dashpot forces of a step.

    Args:
        laws: contact and friction laws.
        problem: problem with y_free and an initial guess of the forces, which the solution
            replaces.
        compliance: H (num_rows, num_rows) in m/N.
        start: y₀ (num_rows,) in m.
        time: h in s.

    Returns:
        Whether the iteration has converged.
    """
    force = problem.force
    contacts, frictions = laws.limits.size, laws.friction.shape[1]
    for _ in range(_MOST_ITERATIONS):
        for k in range(frictions):
            normal = laws.friction[1, k]
            for i in range(contacts):
                normal += laws.pressing[k, i] * abs(force[i])
            problem.bound[k] = laws.friction[0, k] * normal
        count, worst, scale = 0, 0.0, 0.0
        for j in range(force.size):
            scale = max(scale, abs(force[j]))
        for j in range(force.size):
            c = compliance[j, j]
            if c <= 0.0:
                force[j] = 0.0
                continue
            y = problem.free[j]
            for i in range(force.size):
                y -= compliance[j, i] * force[i]
            blur = _ROUND_OFF * (abs(y) + abs(start[j]) + abs(problem.free[j]))
            row = problem.jacobian[count]
            if contacts <= j < contacts + frictions:
                bound = problem.bound[j - contacts]
                if bound == 0.0 and force[j] == 0.0:
                    continue
                slip = (y - start[j]) / c
                if abs(force[j] + slip) <= bound:
                    for i in range(force.size):
                        row[i] = compliance[j, i] / c
                    residual, noise = slip, blur / c
                else:
                    side = 1.0 if force[j] + slip > 0.0 else -1.0
                    for i in range(force.size):
                        row[i] = 0.0
                    for i in range(contacts):
                        if laws.pressing[j - contacts, i] != 0.0:
                            row[i] = -side * laws.friction[0, j - contacts] * np.sign(force[i])
                    row[j] = 1.0
                    residual, noise = side * bound - force[j], 0.0
            else:
                wanted, slope = (y - start[j]) / time, 1.0 / time
                if j < contacts:
                    wanted, slope, _ = contact_response(laws, j, start[j], y, time)
                    if wanted == 0.0 and force[j] == 0.0:
                        continue
                weight = 1.0 / (1.0 + slope * c)
                for i in range(force.size):
                    row[i] = weight * slope * compliance[j, i]
                row[j] += weight
                residual = weight * (wanted - force[j])
                noise = weight * slope * blur
            worst = max(worst, abs(residual) - noise)
            problem.residual[count] = residual
            problem.active[count] = j
            count += 1
        if worst <= _CONVERGED * scale:
            return True
        _eliminate(problem, count)
        for p in range(count):
            change = problem.residual[p]
            if not np.isfinite(change):
                return False
            force[problem.active[p]] += change
    return False


@njit(**LOOP)
def _eliminate(problem: Problem, count: int) -> None:
    """Replace the residuals of the ``count`` active rows by the changes of their forces.

    This is Gaussian elimination with partial pivoting, in place in the Jacobian. Columns without
    pivot, and their indices in ``active``, are moved to the end.
    """
    matrix, right, active = problem.jacobian, problem.residual, problem.active
    for p in range(count):
        for q in range(count):
            matrix[p, q] = matrix[p, active[q]]
    rank, p = count, 0
    while p < rank:
        pivot = p
        for q in range(p + 1, count):
            if abs(matrix[q, p]) > abs(matrix[pivot, p]):
                pivot = q
        if abs(matrix[pivot, p]) <= _DEPENDENT:
            # The other columns are still solved from all remaining rows.
            rank -= 1
            active[p], active[rank] = active[rank], active[p]
            for q in range(count):
                matrix[q, p], matrix[q, rank] = matrix[q, rank], matrix[q, p]
            continue
        if pivot != p:
            for k in range(p, rank):
                matrix[p, k], matrix[pivot, k] = matrix[pivot, k], matrix[p, k]
            right[p], right[pivot] = right[pivot], right[p]
        for q in range(p + 1, count):
            factor = matrix[q, p] / matrix[p, p]
            if factor != 0.0:
                for k in range(p + 1, rank):
                    matrix[q, k] -= factor * matrix[p, k]
                right[q] -= factor * right[p]
        p += 1
    right[rank:count] = 0.0
    for p in range(rank - 1, -1, -1):
        for k in range(p + 1, rank):
            right[p] -= matrix[p, k] * right[k]
        right[p] /= matrix[p, p]
