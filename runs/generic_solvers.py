# SPDX-License-Identifier: LGPL-3.0-or-later
"""A gap system by solvers that know nothing of it, to measure ours against."""

from __future__ import annotations

from collections.abc import Callable
from time import perf_counter

import numpy as np
import numpy.typing as npt
from numba import njit
from scipy.integrate import odeint, solve_ivp

from dynamics.energy import energy_residual
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem

Array = npt.NDArray[np.float64]
Rates = Callable[[float, Array], Array]

OUTPUT_STEP = 1.0e-3

# Of scipy; odeint keeps the loop in Fortran, the others in Python.
SOLVERS = ("LSODA", "DOP853", "Radau", "odeint")

# Tried from the loosest on, for an energy residual that is no larger than ours.
TOLERANCES = 10.0 ** np.arange(-3.0, -12.5, -0.5)
# Absolute tolerance over the relative one; the modal coordinates are of order one.
ABSOLUTE = (1.0, 0.01)


def compiled_rates(system: GapSystem) -> Rates:
    """t, (a, ȧ) → (ȧ, ä) of an undamped system, compiled with its data as constants."""
    omega2, load, rows = system.omega2.copy(), system.load.copy(), system.rows.copy()
    stiffness = np.array([[law.below, law.stiffness] for law in system.laws])
    clearance = np.array([law.clearance for law in system.laws])
    exponent = np.array([law.exponent for law in system.laws])
    n = system.num_modes

    @njit
    def rates(t: float, state: Array) -> Array:
        out = np.empty(2 * n)
        for i in range(n):
            out[i] = state[n + i]
            out[n + i] = load[i] - omega2[i] * state[i]
        for j in range(clearance.size):
            y = 0.0
            for i in range(n):
                y += rows[j, i] * state[i]
            depth = abs(y) - clearance[j]
            if depth > 0.0:
                side = 1 if y > 0.0 else 0
                power = depth * depth if exponent[j] == 2.0 else depth ** exponent[j]
                force = (2 * side - 1) * stiffness[j, side] * power
                for i in range(n):
                    out[n + i] -= rows[j, i] * force
        return out

    compiled: Rates = rates
    compiled(0.0, np.zeros(2 * n))
    return compiled


def array_rates(system: GapSystem) -> Rates:
    """The same as :func:`compiled_rates` in NumPy, as one writes it for a generic solver."""
    n = system.num_modes
    above = np.array([law.stiffness for law in system.laws])
    below = np.array([law.below for law in system.laws])
    clearance = np.array([law.clearance for law in system.laws])
    exponent = np.array([law.exponent for law in system.laws])

    def rates(t: float, state: Array) -> Array:
        y = system.rows @ state[:n]
        side = np.where(y > 0.0, above, -below)
        force = side * np.maximum(np.abs(y) - clearance, 0.0) ** exponent
        acceleration = system.load - system.omega2 * state[:n] - force @ system.rows
        return np.concatenate([state[n:], acceleration])

    return rates


def residual_of(system: GapSystem, states: Array) -> float:
    """Largest energy residual of a motion from rest, states (num_times, 2 num_modes)."""
    a, v = np.split(states, 2, axis=1)
    energies = np.zeros((len(states), 5))
    energies[:, 0] = 0.5 * (v**2).sum(axis=1)
    energies[:, 1] = 0.5 * a**2 @ system.omega2
    gaps = a @ system.rows.T
    energies[:, 2] = sum(w.energy(y) for w, y in zip(system.laws, gaps.T, strict=True))
    energies[:, 3] = a @ system.load
    return float(np.abs(energy_residual(energies)).max())


def generic(
    name: str,
    rates: Rates,
    num_states: int,
    duration: float,
    relative: float,
    absolute: float,
) -> Array:
    """(num_times, num_states) from rest by one of scipy's solvers, at the output steps of ours."""
    times = OUTPUT_STEP * np.arange(round(duration / OUTPUT_STEP) + 1)
    start = np.zeros(num_states)
    tolerances = {"rtol": relative, "atol": absolute}
    if name == "odeint":
        return np.asarray(odeint(rates, start, times, tfirst=True, mxstep=10**7, **tolerances))
    span = (0.0, float(times[-1]))
    return np.asarray(solve_ivp(rates, span, start, name, times, **tolerances).y.T)


def matched(
    name: str, system: GapSystem, rates: Rates, duration: float, target: float
) -> tuple[float, float, float]:
    """Relative and absolute tolerance, and energy residual, of a generic solver.

    For each of ``ABSOLUTE`` the loosest of ``TOLERANCES`` whose energy residual is at most
    ``target``, and of these the faster.

    Raises:
        NumericsError: none is.
    """
    found = []
    for share in ABSOLUTE:
        for relative in TOLERANCES.tolist():
            start = perf_counter()
            states = generic(
                name, rates, 2 * system.num_modes, duration, relative, share * relative
            )
            seconds = perf_counter() - start
            residual = residual_of(system, states)
            if residual <= target:
                found.append((seconds, relative, share * relative, residual))
            # Tighter ones only take longer.
            if residual <= target or (found and seconds > found[0][0]):
                break
    if not found:
        raise NumericsError(f"{name} leaves more than {target:.3g} at every tolerance")
    return min(found)[1:]
