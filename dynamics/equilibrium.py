# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static equilibrium of a gap system under a constant load.

Strain and contact energies are convex, so that the equilibrium is the minimum of the potential
energy. If axial forces make a segment unstable within its play, it is a local minimum. Friction,
which would allow a range of equilibria, is ignored.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import LinAlgError, cholesky, solve_triangular

from dynamics.arrays import Array
from dynamics.contact import contact_terms
from dynamics.contact_term import OfTerm, energy_of, force_of, slope_of
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem

# Permitted unbalanced force, as a fraction of the load or the force of shims; the minimiser aims at
# a hundredth of it.
BALANCE = 1.0e-6


def equilibrium(system: GapSystem, load: Array) -> Array:
    """Return the equilibrium a (num_modes,) in √kg·m.

    >>> depth = equilibrium(ball, ball.load)[0]
    >>> print(f"{1e6 * depth:.2f} µm")
    -9.81 µm

    Args:
        system: gap system; contacts may support it.
        load: constant modal load (num_modes,) in N/√kg.

    Raises:
        NumericsError: neither supports nor contacts resist the load.
    """
    pressed = [float(law.force(np.zeros(()))) for law in system.laws]
    # Scale of the force of shims at zero displacement.
    pushed = load - np.array(pressed) @ system.rows
    if not pushed.any():
        return np.zeros(system.num_modes)
    terms = contact_terms(system.laws)
    # L Lᵀ, the stiffness with each contact's tangent at the force of the whole load, scales the
    # unknowns, so that all directions have a similar stiffness.
    whole = max(float(np.linalg.norm(load)), float(np.linalg.norm(pushed)))
    force = whole * np.sqrt(system.row_masses)
    spring = np.array([law.slope_at(f) for law, f in zip(system.laws, force.tolist(), strict=True)])
    try:
        factor = cholesky(system.stiffness + (system.rows.T * spring) @ system.rows, lower=True)
    except LinAlgError:
        raise NumericsError(
            "nothing holds the boom, or axial forces buckle it: it has no static equilibrium"
        ) from None
    if not (system.laws or system.geometric_stiffness.size):
        return np.asarray(load / system.omega2)
    scaled_load = solve_triangular(factor, load, lower=True)
    scaled_push = solve_triangular(factor, pushed, lower=True)
    unit = max(float(np.linalg.norm(scaled_load)), float(np.linalg.norm(scaled_push)))
    scaled_load /= unit
    # In scaled unknowns, the stiffness with springs is the unit matrix. So all iterates are in the
    # span of load and rows, which has far fewer unknowns than a shell.
    pushes = np.column_stack([scaled_load, solve_triangular(factor, system.rows.T, lower=True)])
    span, _ = np.linalg.qr(pushes)
    scaled_load = span.T @ scaled_load
    unscaled = solve_triangular(factor, span, lower=True, trans=1)
    rows = system.rows @ unscaled
    stiffness = (unscaled.T * system.omega2) @ unscaled
    if system.geometric_stiffness.size:
        stiffness -= unscaled.T @ system.geometric_stiffness @ unscaled

    def sum_terms(of_term: OfTerm, x: Array) -> Array:
        """Return the sums (num_rows,) of terms; a compiled loop would take longer to load."""
        total, y = np.zeros(len(rows)), unit * rows @ x
        for term in terms:
            total[term["row"]] += of_term(term, y[term["row"]])
        return total

    def energy(x: Array) -> float:
        contact = sum_terms(energy_of, x).sum() / unit**2
        return float(0.5 * x @ stiffness @ x - scaled_load @ x + contact)

    def unbalanced(x: Array) -> Array:
        forces = sum_terms(force_of, x)
        return np.asarray(stiffness @ x - scaled_load + rows.T @ forces / unit)

    def tangent(x: Array) -> Array:
        slopes = sum_terms(slope_of, x)
        return np.asarray(stiffness + (rows.T * slopes) @ rows)

    from scipy.optimize import minimize

    found = minimize(
        energy,
        np.zeros(scaled_load.size),
        method="trust-exact",
        jac=unbalanced,
        hess=tangent,
        options={"gtol": 0.01 * BALANCE, "maxiter": 1000, "max_trust_radius": 1.0e9},
    )
    if not np.linalg.norm(found.jac) < BALANCE:
        raise NumericsError("no static equilibrium is found: look for a segment that nothing holds")
    return np.asarray(unit * unscaled @ found.x)


def equilibrium_at(system: GapSystem, time: float = 0.0) -> Array:
    """Return the equilibrium (num_modes,) in √kg·m under the extension and loads at a time in s.

    Raises:
        NumericsError: neither supports nor contacts resist the loads.
    """
    return equilibrium(system.at_time(time), system.load_at(time))
