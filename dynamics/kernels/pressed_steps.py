# SPDX-License-Identifier: LGPL-3.0-or-later
"""Steps of the splitting while something presses, nothing is lost and no load changes."""

from __future__ import annotations

from numba import njit

from dynamics.arrays import Array
from dynamics.contact_term import Limits
from dynamics.kernels.compiled import LOOP, borrowed
from dynamics.kernels.contact_kicks import contact_forces, elastic_kick
from dynamics.kernels.integrator_state import State, System, enter
from dynamics.kernels.modal_flow import move


@njit(**LOOP)
def pressed_steps(
    state: State,
    system: System,
    touch: Limits,
    flow: Array,
    step: float,
    left: int,
    substeps: int,
) -> int:
    """Make up to ``left`` steps, of which ``substeps`` make an output interval; how many.

    It ends where nothing touches any more. ``flow`` (11, num_modes) is that over a step.
    """
    _, a, v, y, force, _, tally, mean, peak, _, _, before = borrowed(state)
    _, _, rows, terms, _ = borrowed(system)
    done = 0
    touching = True
    while touching and done < left:
        before[:] = y
        elastic_kick(v, rows, force, 0.5 * step)
        for j in range(y.size):
            mean[j] += 0.5 * force[j] / substeps
        move(a, v, flow)
        touching = contact_forces(a, rows, terms, y, force)
        done += 1
        enter(y, before, touch, step, tally)
        if touching:
            elastic_kick(v, rows, force, 0.5 * step)
            for j in range(y.size):
                mean[j] += 0.5 * force[j] / substeps
                if abs(force[j]) > abs(peak[j]):
                    peak[j] = force[j]
    return done
