# SPDX-License-Identifier: LGPL-3.0-or-later
"""Steps that are made at once while nothing touches of a boom that is drawn out."""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.contact_term import Limits
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import LOOP
from dynamics.kernels.integrator_state import Excitations, State, enter, excite, read
from dynamics.kernels.modal_flow import move, stacked_flows, travel
from dynamics.kernels.moving_rows import Tables, place_rows, row_tables
from dynamics.kernels.strides import STRIDES, closing_bounds, safe_stride

# Numbers of steps, the flow over each (num_strides, 11, num_modes), through how many steps from
# each one on the loads go straight (num_steps,), the fastest of each row's travel in m/s and the
# steepest slope of each of its entries in 1/m (num_rows,), (num_rows, num_modes); scratch
# (3, num_modes), (num_rows,).
Strides = tuple[Indices, Array, Indices, Array, Array, Array, Array]


def strides_for(system: GapSystem, step: float) -> Strides:
    """What strides of a system by steps in s need, but for loads and travels of some time."""
    flows = stacked_flows(system, STRIDES * step)
    rates, slopes = np.zeros(len(system.laws)), np.zeros(system.rows.shape)
    _, _, coefficients, moving = row_tables(system)
    for row, number, first, *_ in moving:
        if row < len(rates):
            knots = system.travels[number].table.knots
            cubic = coefficients[first : first + len(knots) - 1]
            steepest = np.abs(cubic[:, 1]) + 2.0 * np.abs(cubic[:, 2]) + 3.0 * np.abs(cubic[:, 3])
            slopes[row] = (steepest / np.diff(knots)[:, None]).max(axis=0)
    scratch, bounds = np.zeros((3, system.num_modes)), np.zeros(len(system.laws))
    return STRIDES, flows, np.zeros(0, dtype=np.int64), rates, slopes, scratch, bounds


def strides_over(
    strides: Strides, moving: Indices, straight: Indices, ways: Array, step: float
) -> Strides:
    """Strides over some time, by ``straight`` and ``ways`` of its steps.

    ``ways`` (num_parts + 1, num_travels) are in m, in parts no longer than a step.
    """
    counts, flows, _, rates, *scratch = strides
    fastest = np.abs(np.diff(ways, axis=0)).max(axis=0, initial=0.0) / step
    touching = moving[moving[:, 0] < rates.size]
    rates[touching[:, 0]] = fastest[touching[:, 1]]
    slopes, reach, bounds = scratch
    return counts, flows, straight, rates, slopes, reach, bounds


@njit(**LOOP)
def glide(
    state: State, now: Array, modal: tuple[Array, Array, Array], limits: Limits, tables: Tables,
    ways: Array, excitations: Excitations, strides: Strides, step: float, first: int, last: int,
) -> int:  # fmt: skip
    """Make as many steps from ``first`` on, up to ``last``, as no gap can shut within.

    A row that moves adds to the rate of its gap what the modes make of its change, and to its own
    entries what they may grow by.

    Args:
        now: (num_all, num_modes) all rows, which are set to where they come.
        modal: ω², load (num_modes,) and the rates of damping, or none (0,).

    Gives how many: 0 where something touches, or is too near.
    """
    _, a, v, y, force, _, tally, _, _, _, _, before = state
    omega2, load, rates = modal
    loads, _, _, parts, _, pushes = excitations
    counts, flows, straight, speeds, slopes, scratch, bounds = strides
    reach, start, end = scratch[0], pushes[0], pushes[2]
    for j in range(force.size):
        if force[j] != 0.0:
            return 0
    left = min(straight[first], last - first)
    excite(excitations, parts[first], parts[first + left], 0.0, 1.0)
    time = left * step
    closing_bounds(a, v, omega2, load, start, end, now[: y.size], time, reach, bounds)
    for j in range(y.size):
        if speeds[j] > 0.0:
            for i in range(a.size):
                pull = abs(load[i] + start[i]) + abs(end[i] - start[i])
                speed = reach[i] if omega2[i] > 0.0 else abs(v[i]) + pull * time
                bounds[j] += speeds[j] * slopes[j, i] * (abs(a[i]) + 2.0 * time * speed)
    stride = safe_stride(y, limits, bounds, step, left, counts)
    if stride == 0:
        return 0
    count = counts[stride]
    if loads.shape[0] > 0:
        excite(excitations, parts[first], parts[first + count], 0.0, 1.0)
    if loads.shape[0] > 0 or rates.size > 0:
        damped, flow = rates.size > 0, flows[stride]
        travel(a, v, flow, count * step, damped, start, end, tally)
    else:
        move(a, v, flows[stride])
    place_rows(ways[parts[first + count]], tables, now)
    before[:] = y
    read(now[: y.size], a, y)
    enter(y, before, limits, count * step, tally)
    return int(count)
