# SPDX-License-Identifier: LGPL-3.0-or-later
"""A small system that swings against one stop, and how another code moves it."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from dynamics.arrays import Array
from dynamics.contact import PowerContact
from dynamics.gap_system import GapSystem, Observer


def two_modes(exponent: float = 2.0) -> GapSystem:
    """Two modes under load that swing against a one-sided stop, once within 0.6 s."""
    return GapSystem(
        omega2=np.array([9.0, 60.0]),
        load=np.array([2.0, 5.0]),
        rows=np.array([[1.0, 0.6]]),
        laws=[PowerContact(5.0e3 * 20.0 ** (exponent - 2.0), exponent, clearance=0.05).upper()],
        station_of_row=np.array([0]),
        stations=[0.0],
        observers={"first": Observer(np.array([1.0, 0.0]))},
    )


def reference_states(system: GapSystem, times: Array) -> Array:
    """(num_times, num_modes) from an adaptive Runge-Kutta method of order 8 (other code, scipy)."""
    (law,) = system.laws
    (row,) = system.rows
    n = system.num_modes

    def rate(_: float, state: Array) -> Array:
        a, v = state[:n], state[n:]
        return np.concatenate([v, system.load - system.omega2 * a - row * law.force(row @ a)])

    run = solve_ivp(
        rate, (0.0, times[-1]), np.zeros(2 * n), "DOP853", times,
        rtol=1e-13, atol=1e-15, max_step=1e-3,
    )  # fmt: skip
    return np.asarray(run.y[:n].T)
