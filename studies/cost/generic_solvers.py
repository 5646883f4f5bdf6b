# SPDX-License-Identifier: LGPL-3.0-or-later
"""Generic solvers of a gap system, for comparison with the time step."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable

import numpy as np
from numba import njit
from scipy.integrate import odeint, solve_ivp

from protractile.dynamics.contact import contact_terms
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.kernels.row_forces import term_force
from protractile.geometry.arrays import Array
from studies.motions import OUTPUT_STEP

Rates = Callable[[float, Array], Array]

# Methods of solve_ivp, whose loop is in Python, and a solver whose loop is in Fortran.
METHODS = ("LSODA", "DOP853", "Radau")
SOLVERS = (*METHODS, "odeint")

# Relative tolerances; the comparison uses the loosest one with at most the error of the time step.
TOLERANCES = 10.0 ** np.arange(-3.0, -13.5, -0.5)
# Ratio of absolute to relative tolerance. Of 1, 0.01, 1e-3, 1e-4 and 1e-5, LSODA is fastest with
# this one at equal energy residual.
ABSOLUTE = 1.0e-3


def compiled_rates(system: GapSystem) -> Rates:
    """Return the compiled function t, (a, ȧ) → (ȧ, ä) of an undamped system."""
    omega2, load, rows = system.omega2.copy(), system.load.copy(), system.rows.copy()
    terms = contact_terms(system.laws)
    n = system.num_modes

    @njit
    def rates(t: float, state: Array) -> Array:
        out = np.empty(2 * n)
        for i in range(n):
            out[i] = state[n + i]
            out[n + i] = load[i] - omega2[i] * state[i]
        for t in range(terms.size):
            j = terms[t]["row"]
            y = 0.0
            for i in range(n):
                y += rows[j, i] * state[i]
            force = term_force(terms[t], y)
            if force != 0.0:
                for i in range(n):
                    out[n + i] -= rows[j, i] * force
        return out

    compiled: Rates = rates
    compiled(0.0, np.zeros(2 * n))
    return compiled


def array_rates(system: GapSystem) -> Rates:
    """Return the function t, (a, ȧ) → (ȧ, ä) in NumPy; friction has the sign of the speed."""
    n = system.num_modes
    terms = contact_terms(system.laws)
    side, stiffness, onset, exponent = (
        terms[name] for name in ("side", "stiffness", "onset", "exponent")
    )
    pressed = side[:, None] * system.rows[terms["row"]]

    def rates(t: float, state: Array) -> Array:
        force = stiffness * np.maximum(pressed @ state[:n] - onset, 0.0) ** exponent
        acceleration = system.load - system.omega2 * state[:n] - force @ pressed
        return np.concatenate([state[n:], acceleration])

    if not system.frictions:
        return rates
    slides = system.friction_rows
    drag = np.array([f.coefficient * f.normal_force for f in system.frictions])

    def rates_with_friction(t: float, state: Array) -> Array:
        out = rates(t, state)
        out[n:] -= (drag * np.sign(slides @ state[n:])) @ slides
        return out

    return rates_with_friction


def generic(name: str, rates: Rates, num_states: int, duration: float, tolerance: float) -> Array:
    """Return the states (num_times, num_states) of a motion from rest, by a solver of scipy."""
    times = OUTPUT_STEP * np.arange(round(duration / OUTPUT_STEP) + 1)
    start = np.zeros(num_states)
    tolerances = {"rtol": tolerance, "atol": ABSOLUTE * tolerance}
    if name == "odeint":
        return np.asarray(odeint(rates, start, times, tfirst=True, mxstep=10**7, **tolerances))
    span = (0.0, float(times[-1]))
    return np.asarray(solve_ivp(rates, span, start, name, times, **tolerances).y.T)


def match_tolerance(error: Callable[[float], float], target: float) -> tuple[float | None, float]:
    """Return the largest of ``TOLERANCES`` with an error of at most ``target``, and the error.

    The bisection assumes that the error decreases with the tolerance. If no tolerance suffices, the
    result is None and the smallest error.
    """
    found: dict[int, float] = {}

    def suffices(i: int) -> bool:
        found[i] = error(float(TOLERANCES[i]))
        return found[i] <= target

    i = bisect_left(range(TOLERANCES.size), True, key=suffices)
    if i == TOLERANCES.size:
        return None, min(found.values())
    return float(TOLERANCES[i]), found[i]
