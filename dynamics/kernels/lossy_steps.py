# SPDX-License-Identifier: LGPL-3.0-or-later
"""Steps of the splitting with friction and contact damping."""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.gap_system import GapSystem
from dynamics.kernels import friction_step as coulomb
from dynamics.kernels.bounded_impulses import problem_for
from dynamics.kernels.compiled import LOOP, borrowed
from dynamics.kernels.contact_kicks import contact_forces, damped_kick
from dynamics.kernels.decay import Damping, damp, kept_after
from dynamics.kernels.integrator_state import (
    CONTACT,
    DAMPING,
    FRICTION,
    MIDDLE,
    REST,
    Dry,
    Excitations,
    State,
    System,
    enter,
    excite,
    read,
)
from dynamics.kernels.modal_flow import drive, move, tabulate, travel

# A length of step in s (1,), and of this the flow over its half (11, num_modes), what modes keep
# over a quarter (num_rates,) and dashpots over a half (num_dashpots,), the filtered friction rows
# and their matrix; scratch for modes (num_modes,) and contact rows (5, num_rows); the problem of
# bounded impulses.
Space = tuple[Array, Array, Array, Array, Array, Array, Array, Array, Array]

# All that steps read and change.
Lossy = tuple[State, System, Damping, Dry, Excitations, Space]


def space_for(system: GapSystem, damping: Damping) -> Space:
    """What the steps of a system need beside its state."""
    n, m, f = system.num_modes, len(system.laws), len(system.frictions)
    rates, _, dashpot_rates = damping
    r, d = rates.size, dashpot_rates.size
    shapes = ((1,), (11, n), (r,), (d,), (f, n), (f, f), (n,), (5, m))
    length, half, faded, dragged, filtered, matrix, ahead, middle = map(np.zeros, shapes)
    return length, half, faded, dragged, filtered, matrix, ahead, middle, problem_for(f)


@njit(**LOOP)
def lossy_steps(
    lossy: Lossy, step: float, first: int, last: int, substeps: int, always: bool
) -> int:
    """Make the steps from ``first`` up to ``last``, of which ``substeps`` make an output interval.

    A step is made in parts where histories have kinks. One in which a sliding row turns is made in
    parts, too, the first of which ends where the first row turns; so the direction of friction
    changes when it should and not at the next step.

    Gives the number of the next step: ``last``, or an earlier one when nothing touches any more
    unless ``always``.
    """
    state, system, damping, dry, excitations, space = lossy
    # All in one loop: every array that is handed on in a tuple costs as much as a small sum.
    whole, a, v, y, force, grip, tally, mean, peak, friction, kept, before = borrowed(state)
    omega2, load, rows, terms, limits = borrowed(system)
    rates, directions, dashpot_rates = borrowed(damping)
    friction_rows, given, pressing, masses = borrowed(dry)
    loads, _, spans, parts, _, pushes = borrowed(excitations)
    start, centre, end = pushes
    length, half, faded, dragged, filtered, matrix, ahead, middle, problem = borrowed(space)
    push, y_ahead, force_ahead, resting, driven = middle
    damped = rates.size > 0 or dashpot_rates.size > 0
    excited = loads.shape[0] > 0
    none, still = np.zeros(a.size), np.zeros(friction.size)
    k = first
    for p in range(parts[first], parts[last]):
        span = spans[p]
        left = span
        cuts = 0
        while left > 0.0:
            for i in range(whole.size):
                kept[i] = whole[i]
            time = left
            cut = False
            while True:
                if time != length[0]:
                    length[0] = time
                    tabulate(half, omega2, load, none, 0.5 * time)
                    kept_after(rates, 0.25 * time, faded)
                    kept_after(dashpot_rates, 0.5 * time, dragged)
                    coulomb.filter_rows(friction_rows, half, time, filtered)
                    for j in range(friction.size):
                        ahead[:] = filtered[j]
                        damp(ahead, faded, directions, dragged)
                        read(filtered, ahead, matrix[j])
                        matrix[j] *= 0.5 * time
                if excited:
                    excite(excitations, p, p + 1, 1.0 - left / span, 1.0 - (left - time) / span)
                share = 0.5 * time / (substeps * step)

                loss = damped_kick(v, rows, resting, force, limits, 0.5 * time, False, push, driven)
                for j in range(y.size):
                    mean[j] += share * push[j]
                if excited:
                    travel(a, v, half, 0.5 * time, False, start, centre, tally)
                else:
                    move(a, v, half)

                if damped:
                    tally[DAMPING] += damp(v, faded, directions, dragged)
                ahead[:] = v
                if damped:
                    damp(ahead, faded, directions, dragged)
                coulomb.look_ahead(a, ahead, half, ahead)
                if excited:
                    drive(ahead, half, centre, end)
                coulomb.bound_impulses(
                    ahead, v, rows, terms, limits, push, pressing, given, time, y_ahead,
                    force_ahead, grip,
                )  # fmt: skip
                tally[FRICTION] += coulomb.rub(
                    v, ahead, friction_rows, masses, filtered, matrix, grip, problem, time
                )
                if damped:
                    tally[DAMPING] += damp(v, faded, directions, dragged)

                if excited:
                    travel(a, v, half, 0.5 * time, False, centre, end, tally)
                else:
                    move(a, v, half)
                contact_forces(a, rows, terms, y, force)
                loss += damped_kick(v, rows, resting, force, limits, 0.5 * time, True, push, driven)
                tally[CONTACT] += loss
                for j in range(y.size):
                    mean[j] += share * push[j]
                    if abs(push[j]) > abs(peak[j]):
                        peak[j] = push[j]

                tally[FRICTION] += coulomb.settle(v, friction_rows, still, masses, grip, problem)
                for j in range(friction.size):
                    friction[j] += (grip[MIDDLE, j] + grip[REST, j]) / (substeps * step)
                changed = coulomb.note_directions(masses, grip, problem)
                enter(y, before, limits, time, tally)

                if cut or not changed or cuts > 2 * friction.size:
                    break
                first_turn = coulomb.find_turns(masses, grip, problem, time)
                if not 0.0 < first_turn < left:
                    break
                for i in range(whole.size):
                    whole[i] = kept[i]
                time, cut = first_turn, True
            if cut:
                coulomb.stop(problem, time, grip)
            left -= time
            cuts += 1
        if p + 1 == parts[k + 1]:
            k += 1
            if not (always or force.any()):
                break
    return k
