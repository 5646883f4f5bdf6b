# SPDX-License-Identifier: LGPL-3.0-or-later
"""Steps of the splitting of a boom that is drawn out or in, with all that touches, rubs and drags.

As :mod:`dynamics.kernels.lossy_steps`, but for rows that move: a kick takes the rows of its time,
friction and dashpots in the middle those between, all rates have their convective part, and what
the drive does is entered for each row.
"""

from __future__ import annotations

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.contact_term import Limits, Terms
from dynamics.gap_system import GapSystem
from dynamics.kernels import friction_step as coulomb
from dynamics.kernels.bounded_impulses import problem_for
from dynamics.kernels.compiled import LOOP, borrowed
from dynamics.kernels.contact_kicks import contact_energy, contact_forces, damped_kick
from dynamics.kernels.decay import fade, kept_after
from dynamics.kernels.drawn_strides import Strides, glide
from dynamics.kernels.integrator_state import (
    CONTACT,
    DAMPING,
    FRICTION,
    MIDDLE,
    REST,
    WORK,
    Excitations,
    State,
    enter,
    excite,
    read,
)
from dynamics.kernels.modal_flow import drive, modal_energy, move, tabulate, travel
from dynamics.kernels.moving_rows import Tables, arrive, average, carry, moving_drag, place_rows
from dynamics.kernels.moving_thrusts import Pushed, Thrusts, drag_along, kick, press_along

# After so many steps apart it is worth the while to look how many more can be made at once.
_APART = 8

# ω² and load (num_modes,), terms and limits of the laws, rates c of damping (num_modes,) or none
# (0,), μ and prescribed N (2, num_frictions), 1 where a contact row presses (num_frictions,
# num_rows).
Still = tuple[Array, Array, Terms, Limits, Array, Array, Array]

# All rows where a part of a step begins, where it ends, and in the mean (num_all, num_modes);
# convective rates, what the drive has done at each row, and behind these at each thrust, in this
# part and in all (3, num_all + num_thrusts).
Rows = tuple[Array, Array, Array, Array]

# Of a length of step (1,): the flow over its half (11, num_modes), what modes keep over a quarter,
# and likewise the flow over all of it; filtered friction rows and their matrix, D Dᵀ; for modes
# (num_modes,) and contact rows (3, num_rows); the problem of bounded impulses.
Space = tuple[Array, Array, Array, Array, Array, Array, Array, Array, Array]

# All that steps of a boom that is drawn out read and change; (num_parts + 1, num_travels) is how
# far each travel is in m where parts of steps begin.
Drawn = tuple[State, Still, Rows, Tables, Thrusts, Pushed, Array, Excitations, Space]


def space_for(system: GapSystem) -> Space:
    """What the steps of a system need beside its state."""
    n, m, f = system.num_modes, len(system.laws), len(system.frictions)
    r = n if system.damping.any() else 0
    shapes = ((1,), (11, n), (r,), (f, n), (f, f), (f, f), (n,), (3, m))
    length, half, faded, filtered, matrix, masses, ahead, middle = map(np.zeros, shapes)
    return length, half, faded, filtered, matrix, masses, ahead, middle, problem_for(f)


@njit(**LOOP)
def _damp(
    v: Array, faded: Array, rows: Array, carried: Array, time: float, backward: bool, driven: Array,
) -> float:  # fmt: skip
    """All damping over a time, dashpots in their order or ``backward``; gives the loss in J."""
    loss: float = fade(v, faded)
    loss += moving_drag(v, rows, carried, time, backward, driven)
    loss += fade(v, faded)
    return loss


@njit(**LOOP)
def drawn_steps(
    drawn: Drawn, step: float, first: int, last: int, substeps: int, gliding: bool
) -> int:
    """Make the steps from ``first`` up to ``last``, of which ``substeps`` make an output interval.

    Gives the number of the next step, the first at which nothing touches where it is ``gliding``.
    """
    state, still, rows, tables, thrusts, pushed, ways, excitations, space = drawn
    whole, a, v, y, force, grip, tally, mean, peak, friction, kept, before = borrowed(state)
    omega2, load, terms, limits, rates, given, pressing = borrowed(still)
    now, then, middles, told = borrowed(rows)
    tabled, driving = borrowed(tables), borrowed(excitations)
    moving = tabled[3]
    loads, _, spans, parts, _, pushes = driving
    start, centre, end = pushes
    length, half, faded, filtered, matrix, masses, ahead, middle, problem = borrowed(space)
    push, y_ahead, force_ahead = middle
    along, slope, along_then, slope_then = borrowed(pushed)
    pressing_along = borrowed(thrusts)
    softened = pressing_along[0].size > 0
    carried, driven, done = told
    fading, excited = rates.size > 0, loads.shape[0] > 0
    rubbing = pressing.size > 0 or (given[0] * given[1]).any()
    m, o = y.size, y.size + friction.size
    f = friction.size if rubbing else 0
    d = now.shape[0] - o
    damped = fading or d > 0
    halved = damped or f > 0
    touching_rows, rubbing_rows = then[:m], then[m : m + f]
    between, dragging = middles[m : m + f], middles[o:]
    carried_on, driven_on = carried[o:], driven[o:]
    none, no_rates, no_work = np.zeros(a.size), np.zeros(d), np.zeros(d)
    place = np.zeros(ways.shape[1])
    # Whether rows moved in the part before, or may have.
    fresh = True
    k, apart, touching, pressed_then = first, 0, force.any(), False
    for p in range(parts[first], parts[last]):
        span = spans[p]
        left = span
        cuts = 0
        moves = False
        for t in range(place.size):
            moves = moves or ways[p, t] != ways[p + 1, t]
        while left > 0.0:
            before[:] = y
            if f > 0:
                for i in range(whole.size):
                    kept[i] = whole[i]
            time = left
            cut = False
            while True:
                reached = 1.0 - (left - time) / span
                fresh = fresh or moves or time != length[0]
                if time != length[0]:
                    length[0] = time
                    tabulate(half, omega2, load, none, 0.5 * time if halved else time)
                    kept_after(rates, 0.25 * time, faded)
                if fresh:
                    for t in range(place.size):
                        place[t] = ways[p, t] + reached * (ways[p + 1, t] - ways[p, t])
                    place_rows(place, tabled, then)
                    carried[:] = 0.0
                if fresh and halved:
                    average(now, then, moving, m, middles)
                if fresh and f > 0:
                    coulomb.filter_rows(between, half, time, filtered)
                    for j in range(f):
                        ahead[:] = filtered[j]
                        if damped:
                            _damp(ahead, faded, dragging, no_rates, 0.5 * time, False, no_work)
                        read(filtered, ahead, matrix[j])
                        matrix[j] *= 0.5 * time
                        read(rubbing_rows, then[m + j], masses[j])
                    for j in range(f):
                        for i in range(j):
                            matrix[j, i] = matrix[i, j] = 0.5 * (matrix[j, i] + matrix[i, j])
                fresh = moves
                if excited:
                    excite(driving, p, p + 1, 1.0 - left / span, reached)
                share = 0.5 * time / (substeps * step)
                driven[:] = 0.0

                loss = 0.0
                if softened:
                    kick(v, along, 0.5 * time)
                if touching:
                    if moves:
                        carry(now, then, moving, 0, m, a, time, carried)
                    loss += damped_kick(
                        v, now, carried, force, limits, 0.5 * time, False, push, driven
                    )
                    for j in range(m):
                        mean[j] += share * push[j]
                else:
                    push[:] = 0.0
                if halved:
                    if excited:
                        travel(a, v, half, 0.5 * time, False, start, centre, tally)
                    else:
                        move(a, v, half)
                    if moves:
                        carry(now, then, moving, m, carried.size, a, time, carried)
                    if damped:
                        tally[DAMPING] += _damp(
                            v, faded, dragging, carried_on, 0.5 * time, False, driven_on
                        )
                    if f > 0:
                        ahead[:] = v
                        if damped:
                            _damp(ahead, faded, dragging, carried_on, 0.5 * time, True, no_work)
                        coulomb.look_ahead(a, ahead, half, ahead)
                        if excited:
                            drive(ahead, half, centre, end)
                        coulomb.bound_impulses(
                            ahead, v, touching_rows, terms, limits, push, pressing, given, time,
                            y_ahead, force_ahead, grip,
                        )  # fmt: skip
                        tally[FRICTION] += coulomb.rub(
                            v, ahead, rubbing_rows, masses, filtered, matrix, grip, problem, time
                        )
                        for j in range(f):
                            driven[m + j] -= grip[MIDDLE, j] * carried[m + j]
                    if damped:
                        tally[DAMPING] += _damp(
                            v, faded, dragging, carried_on, 0.5 * time, True, driven_on
                        )
                    if excited:
                        travel(a, v, half, 0.5 * time, False, centre, end, tally)
                    else:
                        move(a, v, half)
                elif excited:
                    travel(a, v, half, time, False, start, end, tally)
                else:
                    move(a, v, half)
                pressed_then = contact_forces(a, touching_rows, terms, y, force)
                if moves and f > 0:
                    carry(now, then, moving, m, o, a, time, carried)
                if moves and pressed_then:
                    carry(now, then, moving, 0, m, a, time, carried)
                if pressed_then:
                    loss += damped_kick(
                        v, then, carried, force, limits, 0.5 * time, True, push, driven
                    )
                    for j in range(m):
                        mean[j] += share * push[j]
                        if abs(push[j]) > abs(peak[j]):
                            peak[j] = push[j]
                if softened:
                    press_along(place, pressing_along, a, along_then, slope_then)
                    kick(v, along_then, 0.5 * time)
                    drag_along(
                        pressing_along, slope, slope_then, ways[p], ways[p + 1], time, span,
                        driven[now.shape[0] :],
                    )  # fmt: skip
                tally[CONTACT] += loss
                changed = False
                if f > 0:
                    tally[FRICTION] += coulomb.settle(
                        v, rubbing_rows, carried[m:o], masses, grip, problem
                    )
                    for j in range(f):
                        driven[m + j] -= grip[REST, j] * carried[m + j]
                        friction[j] += (grip[MIDDLE, j] + grip[REST, j]) / (substeps * step)
                    changed = coulomb.note_directions(masses, grip, problem)
                enter(y, before, limits, time, tally)
                if cut or not changed or cuts > 2 * f:
                    break
                first_turn = coulomb.find_turns(masses, grip, problem, time)
                if not 0.0 < first_turn < left:
                    break
                for i in range(whole.size):
                    whole[i] = kept[i]
                time, cut = first_turn, True
            if cut:
                coulomb.stop(problem, time, grip)
            for j in range(done.size):
                done[j] += driven[j]
            if softened:
                along[:] = along_then
                slope[:] = slope_then
            if moves:
                arrive(now, then, moving)
            touching = pressed_then
            left -= time
            cuts += 1
        if p + 1 == parts[k + 1]:
            k += 1
            apart = 0 if touching else apart + 1
            if gliding and apart >= _APART:
                break
    return k


@njit(**LOOP)
def march_drawn(
    drawn: Drawn, strides: Strides, step: float, substeps: int, out: tuple[Array, ...]
) -> None:
    """Advance by ``len(out[0])`` output intervals and record each.

    ``out`` = (states, velocities, energies, gaps, mean forces, peak forces, friction forces, work
    of the drive at each row and thrust), one row an interval; velocities may have no columns.
    """
    state, still, rows, tables, thrusts, pushed, ways, excitations, _ = drawn
    _, a, v, y, _, _, tally, mean, peak, friction, _, _ = state
    omega2, load, terms, limits, rates, given, pressing = still
    modal = omega2, load, rates
    # What rubs, drags or softens does so in every step.
    dragged = len(rows[0]) > y.size + friction.size or thrusts[0].size > 0
    gliding = not (dragged or pressing.size > 0 or (given[0] * given[1]).any())
    states, velocities, energies, gaps, means, peaks, frictions, drives = out
    done = rows[3][2]
    for interval in range(states.shape[0]):
        start = a.copy()
        mean[:] = 0.0
        peak[:] = 0.0
        friction[:] = 0.0
        k, end = interval * substeps, (interval + 1) * substeps
        while k < end:
            made = 0
            if gliding:
                made = glide(
                    state, rows[0], modal, limits, tables, ways, excitations, strides, step, k, end
                )
            if made > 0:
                k += made
            else:
                k = drawn_steps(drawn, step, k, end, substeps, gliding)
        tally[WORK] += np.dot(load, a - start)
        states[interval] = a
        velocities[interval] = v[: velocities.shape[1]]
        gaps[interval] = y
        means[interval] = mean
        peaks[interval] = peak
        frictions[interval] = friction
        drives[interval] = done
        energies[interval, 0], energies[interval, 1] = modal_energy(a, v, omega2)
        energies[interval, 1] -= 0.5 * np.dot(a, pushed[0])
        energies[interval, 2] = contact_energy(y, terms)
        energies[interval, 3:7] = tally[WORK : WORK + 4]
        energies[interval, 7] = done.sum()
