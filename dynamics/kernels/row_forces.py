# SPDX-License-Identifier: LGPL-3.0-or-later
"""The forces of all rows in one time step, constant within it.

With the displacements y₁ = y_free − C f of the rows at the end of the step,

- a contact presses with the discrete gradient of its energy, f = (V(y₁) − V(y₀))/(y₁ − y₀), times
  1 + d ṗ of Hunt and Crossley (1975) at the mean rate of the penetration, never adhesive;
- friction obeys |f| ≤ μN and f = μN sign(y₁ − y₀) where it slides (Moreau 1988), N being the
  prescribed force and the |f| of the contacts that press;
- a dashpot resists the mean rate, f = (y₁ − y₀)/h.

The system is solved by a semismooth Newton method on the rows that act (Alart and Curnier 1991).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.contact import contact_limits, contact_terms
from dynamics.contact_term import Limits, Terms
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import LOOP
from dynamics.kernels.terms import discrete_gradient

# Iterations after which a step is halved. Two are usual.
_MOST_ITERATIONS = 25

# Residual, as a part of the largest force, that is converged, and the round-off of displacements.
_CONVERGED, _ROUND_OFF = 1.0e-13, 4.0e-16

# A pivot below this part of its diagonal: the row depends on those before it and keeps its force.
_DEPENDENT = 1.0e-11


class Laws(NamedTuple):
    """The laws of all rows: first the contacts, then friction, then dashpots.

    Args:
        terms, limits: of the contacts.
        first_term: (num_contacts + 1,) where the terms of each contact begin.
        friction: (2, num_frictions) μ and the prescribed normal force in N.
        pressing: (num_frictions, num_contacts) 1 where a contact presses, else 0.
    """

    terms: Terms
    limits: Limits
    first_term: Indices
    friction: Array
    pressing: Array


class Problem(NamedTuple):
    """The unknowns of a step, and scratch for its solution.

    Args:
        free: (num_rows,) y_free in m.
        force: (num_rows,) f in N; the first guess, then the solution.
        bound: (num_frictions,) μN in N.
        active: (num_rows,) positions of the rows that act.
        jacobian: (num_rows, num_rows), and
        residual: (num_rows,) of these.
    """

    free: Array
    force: Array
    bound: Array
    active: Indices
    jacobian: Array
    residual: Array


def row_laws(system: GapSystem) -> Laws:
    """Return the laws of a system's rows."""
    terms, frictions = contact_terms(system.laws), system.frictions
    first = np.searchsorted(terms["row"], np.arange(len(system.laws) + 1))
    friction = np.array([[f.coefficient, f.normal_force] for f in frictions]).reshape(-1, 2)
    pressing = np.zeros((len(frictions), len(system.laws)))
    for number, one in enumerate(frictions):
        pressing[number, list(one.normal_rows)] = 1.0
    return Laws(terms, contact_limits(system.laws), first, friction.T.copy(), pressing)


def row_problem(num_rows: int, num_frictions: int) -> Problem:
    """Return an empty problem."""
    square = np.zeros((num_rows, num_rows))
    active = np.zeros(num_rows, dtype=np.int64)
    free, force, residual = np.zeros((3, num_rows))
    return Problem(free, force, np.zeros(num_frictions), active, square, residual)


@njit(**LOOP)
def contact_response(
    laws: Laws, j: int, before: float, after: float, time: float
) -> tuple[float, float, float]:
    """Return force in N, its derivative by y₁ in N/m, and elastic force in N of contact j."""
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
def solve_rows(laws: Laws, problem: Problem, compliance: Array, start: Array, time: float) -> bool:
    """Find the forces of a step; return whether the iteration has converged.

    Args:
        laws: of the rows.
        problem: with y_free and a guess of the forces, which becomes the solution.
        compliance: (num_rows, num_rows) C in m/N.
        start: (num_rows,) y₀ in m.
        time: h in s.
    """
    force = problem.force
    contacts, frictions = laws.limits.size, laws.friction.shape[1]
    for _ in range(_MOST_ITERATIONS):
        for k in range(frictions):
            normal = laws.friction[1, k]
            for i in range(contacts):
                normal += laws.pressing[k, i] * abs(force[i])
            problem.bound[k] = laws.friction[0, k] * normal
        count = 0
        worst, scale = 0.0, 0.0
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
    """Turn the residuals of the active rows into changes of their forces.

    Gaussian elimination with row exchanges on the first ``count`` rows of the Jacobian, whose
    columns are those of the active rows.
    """
    matrix, right, active = problem.jacobian, problem.residual, problem.active
    for p in range(count):
        for q in range(count):
            matrix[p, q] = matrix[p, active[q]]
    for p in range(count):
        pivot = p
        for q in range(p + 1, count):
            if abs(matrix[q, p]) > abs(matrix[pivot, p]):
                pivot = q
        if pivot != p:
            for k in range(p, count):
                matrix[p, k], matrix[pivot, k] = matrix[pivot, k], matrix[p, k]
            right[p], right[pivot] = right[pivot], right[p]
        if abs(matrix[p, p]) <= _DEPENDENT:
            continue
        for q in range(p + 1, count):
            factor = matrix[q, p] / matrix[p, p]
            if factor != 0.0:
                for k in range(p + 1, count):
                    matrix[q, k] -= factor * matrix[p, k]
                right[q] -= factor * right[p]
    for p in range(count - 1, -1, -1):
        if abs(matrix[p, p]) <= _DEPENDENT:
            right[p] = 0.0
            continue
        for k in range(p + 1, count):
            right[p] -= matrix[p, k] * right[k]
        right[p] /= matrix[p, p]
