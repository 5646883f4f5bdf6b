# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact and friction forces of one implicit step, accurate to round-off.

Rows are contacts and frictions. Their displacements are z = z₀ − C p, with the displacements z₀
without forces, the forces p and the compliance C of a step. A contact row follows its law p = F(z),
F as in (4) of Rusiński and Wyciślok (1997). A friction row sticks at z_s while |p| ≤ μN, and slips
with p = μN sign(z − z_s). Both laws are monotone, so that the forces minimise a convex function.
Gauss-Seidel sweeps over the rows reduce it; Newton's method then finds the minimum.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numba import njit

from protractile.dynamics.contact import ContactLaw, DryFriction, Terms, contact_terms
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.kernels.compiled import LOOP
from protractile.dynamics.kernels.row_forces import contact_energy
from protractile.geometry.arrays import Array

_ROUNDS = 1000
_MOST_NEWTON = 100
# C in m/N (num_rows, num_rows), contact rows first; displacements without forces in m (num_rows,);
# terms of the contacts' laws, one on each side of a row at most; of friction rows (num_frictions,)
# μN in N and the displacements in m at which they stick.
Problem = tuple[Array, Array, Terms, Array, Array]
# Round-off of a displacement, as a fraction of the terms that add up to it.
_ROUND_OFF = 32.0 * float(np.finfo(np.float64).eps)


class ResistingRows:
    """Contact and friction rows during a time integration from rest.

    Args:
        laws: laws of the contact rows, without damping.
        frictions: frictions of the following rows, with prescribed normal forces.
        compliance: (num_rows, num_rows) C in m/N, for displacements at the time of the forces.
        onward: ratio of the displacement at the end of the step to that at the time of the forces.

    Attributes:
        displacements: displacements (num_rows,) of the rows in m at the end of the step.
        friction_loss: dissipated energy so far, in J.
    """

    def __init__(
        self,
        laws: Sequence[ContactLaw],
        frictions: Sequence[DryFriction],
        compliance: Array,
        onward: float,
    ) -> None:
        self._terms, self._contacts = contact_terms(laws), len(laws)
        self._bound = np.array([one.coefficient * one.normal_force for one in frictions])
        self._compliance, self._onward = compliance, onward
        self._place, self._forces = np.zeros(len(frictions)), np.zeros(len(compliance))
        self.displacements = np.zeros(len(compliance))
        self.friction_loss = 0.0

    def forces(self, free: Array) -> Array:
        """Return the forces (num_rows,) of the next step in N, opposed to positive displacements.

        Args:
            free: displacements (num_rows,) of the rows in m without these forces.

        Raises:
            NumericsError: the iteration does not converge.
        """
        forces, friction = self._forces, slice(self._contacts, None)
        problem = self._compliance, free, self._terms, self._bound, self._place
        if not (np.isfinite(free).all() and resist(problem, forces)):
            raise NumericsError("the forces of contact and friction are not found; halve the step")
        way = self._onward * (free - self._compliance @ forces - self.displacements)
        self.displacements += way
        self.friction_loss += float(forces[friction] @ way[friction])
        slides = np.abs(forces[friction]) >= self._bound
        self._place[slides] = self.displacements[friction][slides]
        return forces

    @property
    def contact_energy(self) -> float:
        """Energy of the contacts in J."""
        return float(contact_energy(self.displacements[: self._contacts], self._terms))


@njit(**LOOP)
def resist(problem: Problem, force: Array) -> bool:
    """Iterate ``force`` (num_rows,) in N to the solution; return True if it converges.

    A force is positive if it opposes a positive displacement. The initial values are a guess.
    """
    compliance, free, _, _, _ = problem
    n = free.size
    left, slope = np.zeros(n), np.zeros(n)
    for _ in range(_ROUNDS):
        converged = True
        for j in range(n):
            answer, slope[j] = _answer(problem, force, j)
            left[j] = answer - force[j]
            converged = converged and _excess(compliance, free, force, left[j], j) <= 1.0
            # The next sweep starts from this result.
            force[j] = answer
        if converged:
            return True
        before = _defect(problem, force, left, slope)
        matrix = np.eye(n)
        for j in range(n):
            for k in range(n):
                if k != j:
                    matrix[j, k] = slope[j] * compliance[j, k]
        trial = force + np.linalg.lstsq(matrix, left)[0]
        if _defect(problem, trial, left, slope) < before:
            force[:] = trial
    return False


@njit(**LOOP)
def _defect(problem: Problem, force: Array, left: Array, slope: Array) -> float:
    """Store residuals in N and slopes in N/m of all rows; return the largest residual in m."""
    compliance, free, _, _, _ = problem
    worst = 0.0
    for j in range(free.size):
        answer, slope[j] = _answer(problem, force, j)
        left[j] = answer - force[j]
        worst = max(worst, abs(left[j]) * compliance[j, j])
    return worst


@njit(**LOOP)
def _excess(compliance: Array, free: Array, force: Array, change: float, j: int) -> float:
    """Return the ratio of the displacement of row j by a change of its force to round-off."""
    reach = abs(free[j])
    for k in range(free.size):
        reach += abs(compliance[j, k] * force[k])
    return abs(change) * compliance[j, j] / (_ROUND_OFF * reach) if reach > 0.0 else 0.0


@njit(**LOOP)
def _answer(problem: Problem, force: Array, j: int) -> tuple[float, float]:
    """Return the force of row j in N for given other forces, and its derivative in N/m."""
    compliance, free, terms, bound, place = problem
    alone = free[j]
    for i in range(free.size):
        if i != j:
            alone -= compliance[j, i] * force[i]
    own = compliance[j, j]
    contacts = free.size - bound.size
    if j >= contacts:
        held = (alone - place[j - contacts]) / own
        most = bound[j - contacts]
        if abs(held) < most:
            return held, 1.0 / own
        return np.sign(held) * most, 0.0
    touching = False
    for t in range(terms.size):
        if terms[t]["row"] == j and terms[t]["side"] * alone > terms[t]["onset"]:
            k, n = terms[t]["stiffness"], terms[t]["exponent"]
            depth = abs(alone) - terms[t]["onset"]
            touching = True
    if not touching:
        return 0.0, 0.0
    # e + own k eⁿ = depth: convex, so that Newton's method comes down to the root from above.
    e = depth if n > 1.0 else depth / (1.0 + own * k)
    for _ in range(_MOST_NEWTON if n > 1.0 else 0):
        before = e
        e -= (e + own * k * e**n - depth) / (1.0 + own * k * n * e ** (n - 1.0))
        if not e < before:
            break
    stiffness = k * n * e ** (n - 1.0)
    return np.sign(alone) * k * e**n, stiffness / (1.0 + own * stiffness)
