# SPDX-License-Identifier: LGPL-3.0-or-later
"""Small systems, chaotic ones among them, and their motions by another code."""

from dataclasses import replace

import numpy as np
from scipy.integrate import solve_ivp

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.trajectory import Trajectory
from protractile.dynamics.travel import ROW_KINDS, RowTable
from tests.modal import modal_system

# Half the distance in s over which the speed of a drive is measured.
_APART = 1.0e-6


def two_modes(exponent: float = 2.0) -> GapSystem:
    """Return two modes under load that hit a one-sided stop once within 0.6 s."""
    law = PowerContact(5.0e3 * 20.0 ** (exponent - 2.0), exponent).upper().with_clearance(0.05)
    first = {"first": Observer(np.array([1.0, 0.0]))}
    return modal_system([9.0, 60.0], [2.0, 5.0], [1.0, 0.6], [law], observers=first)


def table_slope(table: RowTable, s: float) -> Array:
    """Return the slopes (num_rows, num_modes) of the rows of a table along s, per m."""
    piece, part, length = table.locate(s)
    powers = np.array([0.0, 1.0, 2.0 * part, 3.0 * part**2]) / length
    return np.tensordot(powers, table.coefficients[piece], 1)


def runge_kutta(motion: Motion, max_step: float = 1.0e-3) -> Array:
    """Return the states (num_times, num_modes) by scipy's DOP853 (other code).

    Friction rows must slide all the time, so that their law is smooth.
    """
    system, n = motion.system, motion.system.num_modes
    times = motion.output_step * np.arange(motion.outputs + 1)
    parts = np.cumsum([len(system.rows), len(system.friction_rows)])

    def rate(time: float, state: Array) -> Array:
        a, v = state[:n], state[n:]
        rows = {kind: getattr(system, kind).copy() for kind in ROW_KINDS}
        drift = {kind: np.zeros(len(rows[kind])) for kind in ROW_KINDS}
        pull = np.zeros(n)
        for travel in system.travels:
            ahead, behind = travel.history(np.array([time + _APART, abs(time - _APART)]))
            way, speed = float(travel.history(np.array(time))), (ahead - behind) / (2.0 * _APART)
            now, slopes = travel.table(way), table_slope(travel.table, way)
            for (kind, j), row, slope in zip(travel.moved_rows, now, slopes, strict=True):
                rows[kind][j], drift[kind][j] = row, speed * (slope @ a)
            for force in travel.axial_forces:
                pull += force.geometric_stiffness(way) @ a
        stacked = np.concatenate([rows[kind] for kind in ROW_KINDS])
        speeds = stacked @ v + np.concatenate([drift[kind] for kind in ROW_KINDS])
        closing, sliding, dragged = np.split(speeds, parts)
        pressed = np.array([
            law.force(y) * max(0.0, 1.0 + law.damping * np.sign(y) * u)
            for law, y, u in zip(system.laws, rows["rows"] @ a, closing, strict=True)
        ])  # fmt: skip
        normal = [f.normal_force + np.abs(pressed[list(f.normal_rows)]).sum()
                  for f in system.frictions]  # fmt: skip
        limits = np.array([f.coefficient for f in system.frictions]) * normal
        forces = np.concatenate([pressed, limits * np.sign(sliding), dragged])
        pull = pull + system.load - system.omega2 * a - system.damping * v - stacked.T @ forces
        for x in system.excitations:
            pull = pull + x.load * x.history(np.array(time))
        return np.concatenate([v, pull])

    start = np.concatenate([motion.position, motion.velocity])
    run = solve_ivp(
        rate, (0.0, times[-1]), start, "DOP853", times, rtol=1e-11, atol=1e-14, max_step=max_step
    )
    return np.asarray(run.y[:n].T)


def errors_in_the_step(motion: Motion, expected: Array, steps: Array) -> Array:
    """Return the largest error of the states for each step, as a fraction of the largest state."""
    size = np.abs(expected).max()
    return np.array([np.abs(FixedStep(h)(motion).states - expected).max() / size for h in steps])


def slopes(errors: Array) -> Array:
    """Return the orders of convergence from errors of steps, each half the previous one."""
    return np.log2(errors[:-1] / errors[1:])


def with_rates(system: GapSystem) -> GapSystem:
    """Return the system with the velocities of all modes as observers."""
    rates = {f"v{i}": Observer(row, "m/s", 1) for i, row in enumerate(np.eye(system.num_modes))}
    return replace(system, observers={**system.observers, **rates})


def end_of(run: Trajectory) -> tuple[Array, Array]:
    """Return coordinates and velocities (num_modes,) at the end of a run :func:`with_rates`."""
    a = run.states[-1]
    return a, np.array([float(run.data[f"v{i}"][-1]) for i in range(a.size)])


NUMBERS = {"omega2": [4.0, 31.0], "load": [2.0, 3.0], "tip": [1.0, 0.4]}
LINEAR = modal_system(**NUMBERS)
# Both modes in turn press one row against its two stops, about twice a second.
LAW = PowerContact(stiffness=1.0e6, exponent=2.0).with_clearance(0.02)
CHAOTIC = modal_system(**NUMBERS, rows=[0.8, -0.6], laws=[LAW])

# Eight modes rattle between the stops of two rows, about 500 times a second.
_MODES = np.arange(1, 9)
RATTLING = modal_system(
    omega2=16.0 * _MODES**4,
    load=[30.0, *np.zeros(7)],
    tip=np.cos(_MODES),
    rows=[np.sin(1.1 * _MODES), np.cos(0.7 * _MODES)],
    laws=2 * [PowerContact(stiffness=1.0e6, exponent=1.0).with_clearance(0.001)],
)
