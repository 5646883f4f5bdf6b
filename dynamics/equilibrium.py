# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static equilibrium of a gap system under a constant load.

Strain and contact energies are convex, so that the equilibrium is the minimum of the potential
energy. If axial forces make a segment unstable within its play, the equilibrium is a local minimum.
Friction, which would allow a range of equilibria, is ignored.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, cho_solve, cholesky, solve_triangular

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import OfTerm, Term, Terms, contact_terms, force_of, slope_of
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem

# Permitted unbalanced force, as a fraction of the load or the force of shims; the search aims at a
# hundredth of it.
BALANCE = 1.0e-6

# Unbalanced force at which the search ends, and its maximum number of steps.
_AIM, _MOST_STEPS = 0.01 * BALANCE, 200

# Minimum curvature of a step, as a fraction of the curvature of the boom with closed contacts.
_FLAT = 1.0e-6

# Slope of the energy at the end of a line search as a fraction of the slope at its beginning, and
# multiple of a step beyond which the search finds no equilibrium.
_EXACT, _FARTHEST = 0.05, 1.0e9

# Maximum number of slopes of a line search.
_MOST_TRIALS = 100


def equilibrium(system: GapSystem, load: Array, near: Array | None = None) -> Array:
    """Return the modal coordinates a (num_modes,) in √kg·m at equilibrium.

    >>> depth = equilibrium(ball, ball.load)[0]
    >>> print(f"{1e6 * depth:.2f} µm")
    -9.81 µm

    Args:
        system: gap system; contacts may support it.
        load: constant modal load (num_modes,) in N/√kg.
        near: equilibrium (num_modes,) under a similar load, from which the search starts if it is
            nearer than the undeformed boom.

    Raises:
        NumericsError: neither supports nor contacts resist the load.
    """
    return Equilibria(system).under(load, near)


class _Scaling(NamedTuple):
    """Scaled unknowns, in which the stiffness with closed contacts is the unit matrix.

    They are Lᵀ a with the Cholesky factor L of this stiffness. A force that presses no contact
    displaces the boom as if the contacts were closed. So the search has the unknowns that the rows
    span, which are far fewer than those of a shell.
    """

    spring: Array  #: stiffness (num_rows,) in N/m of the closed contacts
    factor: Array  #: L (num_modes, num_modes), the lower factor
    span: Array  #: orthonormal basis (num_modes, num_unknowns) of the rows in scaled unknowns
    rows: Array  #: the rows (num_rows, num_unknowns) in this basis
    stiffness: Array  #: the stiffness without contacts (num_unknowns, num_unknowns) in this basis


class Equilibria:
    """Equilibria of a gap system without travels, under several loads.

    Loads share one factorisation of the stiffness if the contact laws are linear.
    """

    def __init__(self, system: GapSystem) -> None:
        self._system = system
        self._laws = contact_terms(system.laws)
        shim_forces = [float(law.force(np.zeros(()))) for law in system.laws]
        # Scale of the force of shims at zero displacement.
        self._shims: Array = np.array(shim_forces) @ system.rows
        self._last: _Scaling | None = None

    def under(self, load: Array, near: Array | None = None) -> Array:
        """Return the equilibrium (num_modes,) under a load, as :func:`equilibrium`."""
        system, laws = self._system, self._laws
        unbalanced_load = load - self._shims
        if not unbalanced_load.any():
            return np.zeros(system.num_modes)
        whole = max(float(np.linalg.norm(load)), float(np.linalg.norm(unbalanced_load)))
        scaling = self._scaling(whole)
        factor, span = scaling.factor, scaling.span
        if not system.laws:
            return np.asarray(cho_solve((factor, True), load))
        scaled_load, scaled_push = solve_triangular(
            factor, np.column_stack([load, unbalanced_load]), lower=True
        ).T
        unit = max(float(np.linalg.norm(scaled_load)), float(np.linalg.norm(scaled_push)))
        pressing = span.T @ scaled_load / unit
        start = np.zeros(pressing.size) if near is None else span.T @ (factor.T @ near) / unit
        minimum = _minimum(scaling.stiffness, pressing, scaling.rows, laws, unit, start)
        if minimum is None:
            raise NumericsError(
                "no static equilibrium is found: look for a segment that nothing holds"
            )
        displaced = scaled_load + unit * span @ (minimum - pressing)
        return np.asarray(solve_triangular(factor, displaced, lower=True, trans=1))

    def _scaling(self, whole: float) -> _Scaling:
        """Return the scaling of unknowns by which all directions have a similar stiffness.

        A contact has its tangent at the force of the whole load.
        """
        system, laws = self._system, self._laws
        row, k, n = laws["row"], np.abs(laws["stiffness"]), laws["exponent"]
        force, spring = whole * np.sqrt(system.row_masses), np.zeros(len(system.laws))
        np.maximum.at(spring, row, n * k ** (1.0 / n) * force[row] ** (1.0 - 1.0 / n))
        if self._last is None or not np.array_equal(spring, self._last.spring):
            closed = system.stiffness + (system.rows.T * spring) @ system.rows
            try:
                factor = cholesky(closed, lower=True)
            except LinAlgError:
                raise NumericsError(
                    "nothing holds the boom, or axial forces buckle it: it has no static "
                    "equilibrium"
                ) from None
            span, _ = np.linalg.qr(solve_triangular(factor, system.rows.T, lower=True))
            unscaled = solve_triangular(factor, span, lower=True, trans=1)
            stiffness = (unscaled.T * system.omega2) @ unscaled
            if system.geometric_stiffness.size:
                stiffness -= unscaled.T @ system.geometric_stiffness @ unscaled
            rows = system.rows @ unscaled
            self._last = _Scaling(spring, factor, span, rows, stiffness)
        return self._last


def _minimum(
    stiffness: Array, load: Array, rows: Array, laws: Terms, unit: float, start: Array
) -> Array | None:
    """Return the scaled unknowns (num_unknowns,) at the minimum of the energy; None if not found.

    The method is Newton's with a line search.

    Args:
        stiffness, load, rows: stiffness, load and contact rows in scaled unknowns.
        laws: terms of the contact laws.
        unit: factor from scaled unknowns to displacements in m.
        start: scaled unknowns of another equilibrium.
    """
    # Terms with a common exponent, as arrays.
    terms = [
        {name: laws[name][laws["exponent"] == n] for name in ("row", *Term._fields)}
        | {"exponent": n}
        for n in np.unique(laws["exponent"])
    ]
    row_of_value = np.concatenate([term["row"] for term in terms])

    def of_terms(of_term: OfTerm, gaps: Array) -> Array:
        """Return ``of_term`` of each term (num_terms,) at displacements (num_rows,) in m."""
        return np.concatenate([of_term(term, gaps[term["row"]]) for term in terms])

    def sum_terms(of_term: OfTerm, x: Array) -> Array:
        """Return the sum of ``of_term`` over the terms of each row (num_rows,)."""
        values = of_terms(of_term, unit * rows @ x)
        return np.asarray(np.bincount(row_of_value, values, len(rows)), dtype=float)

    def unbalanced(x: Array) -> Array:
        return np.asarray(stiffness @ x - load + rows.T @ sum_terms(force_of, x) / unit)

    def slopes_along(x: Array, step: Array) -> Callable[[float], float]:
        """Return the derivative of the energy at ``x`` + ``length`` · ``step`` along the step."""
        first, rise = float((stiffness @ x - load) @ step), float(step @ stiffness @ step)
        gaps, moves = unit * rows @ x, unit * rows @ step
        along = moves[row_of_value]

        def slope(length: float) -> float:
            forces = of_terms(force_of, gaps + length * moves)
            return first + length * rise + float(forces @ along) / unit**2

        return slope

    x = min(np.zeros(load.size), start, key=lambda one: float(np.linalg.norm(unbalanced(one))))
    for _ in range(_MOST_STEPS):
        force = unbalanced(x)
        if np.linalg.norm(force) < _AIM:
            break
        # With the magnitudes of the curvatures the energy falls along the step, even where axial
        # forces make a segment unstable within its play.
        curvatures, axes = np.linalg.eigh(stiffness + (rows.T * sum_terms(slope_of, x)) @ rows)
        step = -axes @ (axes.T @ force / np.maximum(np.abs(curvatures), _FLAT))
        small, low, high = _EXACT * abs(float(force @ step)), 0.0, 1.0
        slope = slopes_along(x, step)
        while (end := slope(high)) < -small and high < _FARTHEST:
            low, high = high, 4.0 * high
        if end < -small:
            return None
        if end > small:
            start_slope = slope(low) if low else float(force @ step)
            high = _flat_place(slope, (low, start_slope), (high, end), small)
        x = x + high * step
    return x if np.linalg.norm(force) < BALANCE else None


def _flat_place(
    slope: Callable[[float], float],
    low: tuple[float, float],
    high: tuple[float, float],
    small: float,
) -> float:
    """Return a length at which a slope that rises through 0 is at most ``small``.

    The method is the false position with halved ends (Dowell and Jarratt 1971).

    Args:
        slope: function of the length.
        low, high: (length, slope) before and behind the root.
        small: permitted magnitude of the slope.
    """
    (low_length, low_slope), (length, high_slope) = low, high
    side, high_length = 0, length
    for _ in range(_MOST_TRIALS):
        length = low_length - low_slope * (high_length - low_length) / (high_slope - low_slope)
        here = slope(length)
        if abs(here) <= small:
            break
        if here < 0.0:
            low_length, low_slope = length, here
            high_slope *= 0.5 if side < 0 else 1.0
            side = -1
        else:
            high_length, high_slope = length, here
            low_slope *= 0.5 if side > 0 else 1.0
            side = 1
    return length


def equilibrium_at(system: GapSystem, time: float = 0.0, near: Array | None = None) -> Array:
    """Return the equilibrium (num_modes,) in √kg·m under the extension and loads at a time in s.

    ``near`` is an equilibrium at another time, near which the search starts.

    Raises:
        NumericsError: neither supports nor contacts resist the loads.
    """
    return equilibrium(system.at_time(time), system.load_at(time), near)
