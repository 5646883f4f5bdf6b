# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the compiled loops of the splitting read and change, as arrays."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numba import njit

from dynamics.arrays import Array, Indices
from dynamics.contact import contact_limits, contact_terms
from dynamics.contact_term import Limits, Terms
from dynamics.gap_system import GapSystem
from dynamics.kernels.compiled import LOOP, SUMS
from dynamics.kernels.contact_kicks import contact_forces, first_closing

# omega2, load (num_modes,), contact rows (num_rows, num_modes), terms and limits of their laws.
System = tuple[Array, Array, Array, Terms, Limits]

# Friction rows (num_frictions, num_modes), their μ and prescribed N (2, num_frictions), 1 where a
# contact row presses (num_frictions, num_rows) or nothing (num_frictions, 0) where none does, D Dᵀ.
Dry = tuple[Array, Array, Array, Array]

# Loads of the excitations (num_excitations, num_modes). Kinks cut steps into parts, over each of
# which all histories are straight: their factors where parts begin and end (num_parts + 1,
# num_excitations), the length of each part in s, the first part of each step (num_steps + 1,), and
# through how many steps from each one on the lines go on (num_steps,). Scratch (3, num_modes).
Excitations = tuple[Array, Array, Array, Indices, Indices, Array]

# Positions in the tally; from the work on as in ``ENERGIES``.
TIME, FIRST_CONTACT, CHANGES, STEPS, WORK, DAMPING, FRICTION, CONTACT = range(8)
_TALLY = 8

# What is known of each friction row, the rows of ``grip`` (7, num_frictions): where it is, or was
# when it came to rest, in m; its speed in m/s; 1 or -1 while it slides, 0 at rest; the impulse in
# the middle of the last step in N·s, its bound, and the impulse at its end; 1 if it was held.
PLACE, SPEED, SLIDING, MIDDLE, BOUND, REST, HELD = range(7)
_GRIP = 7

# All that a step changes, in one array; its parts a, v (num_modes,), y and elastic contact forces
# (num_rows,), grip, tally, mean and peak contact forces (num_rows,) and mean friction forces
# (num_frictions,) of the output interval; another such array for what was before the step, and
# its y.
State = tuple[Array, Array, Array, Array, Array, Array, Array, Array, Array, Array, Array, Array]


def system_arrays(system: GapSystem) -> System:
    """A system without damping, friction and excitations in the layout of the compiled loops."""
    omega2, load, rows = (
        np.ascontiguousarray(array) for array in (system.omega2, system.load, system.rows)
    )
    return omega2, load, rows, contact_terms(system.laws), contact_limits(system.laws)


def friction_arrays(system: GapSystem) -> Dry:
    """Its frictions."""
    frictions = system.frictions
    pressing = np.zeros((len(frictions), len(system.laws)))
    for j, friction in enumerate(frictions):
        pressing[j, list(friction.pressed_by)] = 1.0
    pressing = pressing if pressing.any() else pressing[:, :0].copy()
    given = np.array([[f.coefficient, f.normal_force] for f in frictions]).reshape(-1, 2)
    rows = np.ascontiguousarray(system.friction_rows)
    return rows, given.T.copy(), pressing, rows @ rows.T


def excitation_arrays(system: GapSystem, times: Array, step: float) -> Excitations:
    """Its excitations at the times of all steps and of the end, (num_steps + 1,) in s."""
    histories = [x.history for x in system.excitations]
    loads = np.array([x.load for x in system.excitations]).reshape(-1, system.num_modes)
    kinks = np.concatenate([np.zeros(0), *(history.kinks for history in histories)])
    kinks = np.unique(kinks[(kinks > times[0]) & (kinks < times[-1])])
    after = np.searchsorted(times, kinks)
    within = times[after] != kinks
    new = after[within]
    knots = np.insert(times, new, kinks[within])
    samples = np.array([history(knots) for history in histories], dtype=np.float64)
    parts = np.arange(times.size) + np.bincount(new, minlength=times.size).cumsum()
    spans = np.full(knots.size - 1, step)
    cut = new + np.arange(new.size)
    spans[cut] = knots[cut + 1] - knots[cut]
    spans[cut - 1] = knots[cut] - knots[cut - 1]
    if any(history.fastest for history in histories):
        ends = np.arange(1, times.size)
    else:
        ends = np.unique(np.concatenate([after, after - within, [times.size - 1]]))
    straight = np.repeat(ends, np.diff(ends, prepend=0)) - np.arange(times.size - 1)
    samples = np.ascontiguousarray(samples.reshape(len(histories), knots.size).T)
    return loads, samples, spans, parts, straight, np.zeros((3, system.num_modes))


@lru_cache(maxsize=4)
def no_excitations(num_modes: int, steps: int, step: float) -> Excitations:
    """What :func:`excitation_arrays` gives where there are none, for up to so many steps.

    It would take as long as the steps themselves while nothing touches. Nobody writes there but
    zeros.
    """
    parts = np.arange(steps + 1)
    none, scratch = np.zeros((0, num_modes)), np.zeros((3, num_modes))
    return none, np.zeros((steps + 1, 0)), np.full(steps, step), parts, steps - parts[:-1], scratch


def initial_state(system: GapSystem, position: Array, velocity: Array) -> State:
    """A state, with the forces that act in it."""
    n, m, f = system.num_modes, len(system.laws), len(system.frictions)
    sizes = np.cumsum([0, n, n, m, m, _GRIP * f, _TALLY, m, m, f])
    whole, kept = np.zeros((2, sizes[-1]))
    a, v, y, force, grip, tally, mean, peak, friction = np.split(whole, sizes[1:-1])
    before = np.split(kept, sizes[1:-1])[2]
    a[:], v[:] = position, velocity
    touching = contact_forces(
        a, np.ascontiguousarray(system.rows), contact_terms(system.laws), y, force
    )
    tally[FIRST_CONTACT] = 0.0 if touching else np.nan
    grip = grip.reshape(_GRIP, f)
    look(a, v, np.ascontiguousarray(system.friction_rows), grip)
    return whole, a, v, y, force, grip, tally, mean, peak, friction, kept, before


@njit(**SUMS)
def read(rows: Array, a: Array, values: Array) -> None:
    """values = rows a."""
    for j in range(rows.shape[0]):
        total = 0.0
        for i in range(a.size):
            total += rows[j, i] * a[i]
        values[j] = total


@njit(**LOOP)
def look(a: Array, v: Array, rows: Array, grip: Array) -> None:
    """Take place and speed of every friction row from a state that friction has not made."""
    read(rows, a, grip[PLACE])
    read(rows, v, grip[SPEED])
    grip[SLIDING] = np.sign(grip[SPEED])


@njit(**LOOP)
def enter(y: Array, before: Array, limits: Limits, time: float, tally: Array) -> None:
    """Enter a step of ``time`` that has been made: contact changes, the first contact."""
    tally[TIME] += time
    tally[STEPS] += 1.0
    changes, closing = first_closing(y, before, limits, tally[TIME], time)
    tally[CHANGES] += changes
    if np.isnan(tally[FIRST_CONTACT]) and closing < np.inf:
        tally[FIRST_CONTACT] = closing


@njit(**SUMS)
def excite(excitations: Excitations, first: int, last: int, begin: float, end: float) -> None:
    """Set the modal loads at the start, the middle and the end of a piece of a straight line.

    Args:
        excitations: of whose scratch they are the rows.
        first, last: where in the samples the line begins and ends.
        begin, end: of the piece, as parts of the line.
    """
    loads, samples, _, _, _, pushes = excitations
    middle = 0.5 * (begin + end)
    pushes[:] = 0.0
    for e in range(loads.shape[0]):
        now, more = samples[first, e], samples[last, e] - samples[first, e]
        for i in range(loads.shape[1]):
            pushes[0, i] += (now + begin * more) * loads[e, i]
            pushes[1, i] += (now + middle * more) * loads[e, i]
            pushes[2, i] += (now + end * more) * loads[e, i]
