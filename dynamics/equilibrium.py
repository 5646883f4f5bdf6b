# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where a gap system comes to rest under a constant load.

Strain and contact energies are convex, so that the rest position is the minimum of the potential
energy. Dry friction would leave a whole range of rest positions; this is the one without it.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.linalg import LinAlgError, cholesky, solve_triangular
from scipy.optimize import minimize

from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem

Array = npt.NDArray[np.float64]

# Unbalanced force, as a part of the load, at which a system counts as at rest; the minimiser aims
# at a hundredth of it.
BALANCE = 1.0e-6


def equilibrium(system: GapSystem, load: Array) -> Array:
    """(num_modes,) rest position a in √kg·m.

    Args:
        system: its contacts hold what its supports leave free.
        load: (num_modes,) constant modal load in N/√kg.

    Raises:
        NumericsError: nothing holds the system against the load.
    """
    if not load.any():
        return np.zeros(system.num_modes)
    above = np.array([law.stiffness for law in system.laws])
    below = np.array([law.below for law in system.laws])
    clearance = np.array([law.clearance for law in system.laws])
    n = np.array([law.exponent for law in system.laws])
    # With each contact's spring at the force of the whole load in place, no direction is softer
    # or stiffer than another: L Lᵀ scales the unknowns.
    force = np.linalg.norm(load) * np.sqrt(system.row_masses)
    spring = n * np.maximum(above, below) ** (1.0 / n) * force ** (1.0 - 1.0 / n)
    try:
        factor = cholesky(
            np.diag(system.omega2) + (system.rows.T * spring) @ system.rows, lower=True
        )
    except LinAlgError:
        raise NumericsError("nothing holds the boom: it has no static equilibrium") from None
    scaled_load = solve_triangular(factor, load, lower=True)
    unit = float(np.linalg.norm(scaled_load))
    scaled_load /= unit
    rows = solve_triangular(factor, system.rows.T, lower=True).T
    half = solve_triangular(factor, np.diag(np.sqrt(system.omega2)), lower=True)
    stiffness = half @ half.T

    def pressed(x: Array) -> tuple[Array, Array]:
        """Signed penetrations, and the stiffness of the side that they are on."""
        y = unit * rows @ x
        return np.sign(y) * np.maximum(np.abs(y) - clearance, 0.0), np.where(y > 0.0, above, below)

    def energy(x: Array) -> float:
        p, k = pressed(x)
        contact = (k * np.abs(p) ** (n + 1.0) / (n + 1.0)).sum() / unit**2
        return float(0.5 * x @ stiffness @ x - scaled_load @ x + contact)

    def unbalanced(x: Array) -> Array:
        p, k = pressed(x)
        forces = np.sign(p) * k * np.abs(p) ** n / unit
        return np.asarray(stiffness @ x - scaled_load + rows.T @ forces)

    def tangent(x: Array) -> Array:
        p, k = pressed(x)
        slopes = np.where(p != 0.0, n * k * np.abs(p) ** (n - 1.0), 0.0)
        return np.asarray(stiffness + (rows.T * slopes) @ rows)

    found = minimize(
        energy,
        np.zeros(system.num_modes),
        method="trust-exact",
        jac=unbalanced,
        hess=tangent,
        options={"gtol": 0.01 * BALANCE, "maxiter": 1000, "max_trust_radius": 1.0e9},
    )
    if not np.linalg.norm(found.jac) < BALANCE:
        raise NumericsError("no static equilibrium is found: look for a segment that nothing holds")
    return np.asarray(unit * solve_triangular(factor, found.x, lower=True, trans=1))
