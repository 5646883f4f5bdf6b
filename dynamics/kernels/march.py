# SPDX-License-Identifier: LGPL-3.0-or-later
"""The time loop: exact modal solutions under contact and friction forces, constant in each step.

The work of a constant force is force times displacement. So the energy of modes and contacts
changes by exactly the work of loads and drives less the losses of damping, friction and dashpots,
for any step. Rows may change with travels, see :mod:`.dynamics.kernels.telescoping`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from protractile.dynamics.arrays import Array
from protractile.dynamics.kernels.compiled import LOOP, SUMS, borrow
from protractile.dynamics.kernels.modal_flow import (
    Flow,
    compliance,
    finish_flow,
    free_flow,
    modal_energy,
)
from protractile.dynamics.kernels.row_forces import (
    Laws,
    Problem,
    contact_energy,
    contact_response,
    solve_contact_forces,
    term_energy,
    term_force,
    term_slope,
)
from protractile.dynamics.kernels.telescoping import (
    AxialForces,
    MovingRows,
    add_axial_forces,
    move_rows,
)
from protractile.dynamics.trajectory import Output

# Indices in ``State.tally``. From the index of the work on, they have the order of
# ``protractile.dynamics.energy.ENERGIES``.
TIME, FIRST_CONTACT, CHANGES, STEPS, WORK, DAMPING, FRICTION, CONTACT, TALLY = range(9)

# Largest h ω of a closed contact at which steps of length h resolve its force: the largest sample
# of a half-sine is too small by 1 − cos(hω/2), at most 3 %.
RESOLVED = 0.5

# Maximum penetration in m in the search for a given energy.
_MAX_DEPTH = 1.0

# Maximum number and relative tolerance of the iterations for moving axial forces.
_MAX_ITERATIONS, _TOLERANCE = 40, 1.0e-10


class LoopSystem(NamedTuple):
    """Constant data of a gap system.

    Args:
        load: (num_modes,) constant modal load in N/√kg.
        excitations: (num_excitations, num_modes) modal loads that histories multiply.
        laws: contact and friction laws.
        moving, axial: rows and axial forces that change with travels.
    """

    load: Array
    excitations: Array
    laws: Laws
    moving: MovingRows
    axial: AxialForces


class State(NamedTuple):
    """State of a motion, which steps change.

    Args:
        a, v: (num_modes,) modal coordinates and velocities.
        rows: (num_rows, num_modes) current rows: contacts, friction rows, dashpots.
        y: (num_rows,) displacements of the rows in m.
        force: (num_rows,) forces of the last step in N.
        axial_push: (num_modes,) K_G a of the moving axial forces in the last step.
        tally: sums over all steps, with the indices ``TIME`` to ``CONTACT``.
        driven: (num_travels,) cumulative work of each drive in J.
        crest: (num_contacts,) largest force of all steps in N.
        resolving: (num_contacts,) largest step in s that resolves the contact at its largest force;
            infinite if the actual step does.
    """

    a: Array
    v: Array
    rows: Array
    y: Array
    force: Array
    axial_push: Array
    tally: Array
    driven: Array
    crest: Array
    resolving: Array


class Schedule(NamedTuple):
    """Loads and extensions within the steps of a call.

    Args:
        mean, change: (num_steps, num_excitations) mean and change within each step of the straight
            line that replaces a history, see :func:`.dynamics.time_step.line_within`.
        extensions: (num_steps + 1, num_travels) extensions in m at the ends of the steps.
    """

    mean: Array
    change: Array
    extensions: Array


@njit(**SUMS)
def assign(target: Array, source: Array) -> None:
    """Copy the first numbers of ``source`` to ``target``.

    Slice assignments compile an error message, which takes a quarter of the compile time.
    """
    for i in range(target.size):
        target[i] = source[i]


@njit(**SUMS)
def read_rows(rows: Array, a: Array, values: Array) -> None:
    """Set ``values`` (num_rows,) in m to the displacements of the rows."""
    for j in range(rows.shape[0]):
        total = 0.0
        for i in range(a.size):
            total += rows[j, i] * a[i]
        values[j] = total


@njit(**SUMS)
def _subtract_forces(rows: Array, force: Array, total: Array) -> None:
    """Subtract the modal forces Sᵀ f of rows S with forces f from ``total`` (num_modes,)."""
    for j in range(rows.shape[0]):
        if force[j] != 0.0:
            for i in range(total.size):
                total[i] -= rows[j, i] * force[j]


@njit(**LOOP)
def _update_contacts(state: State, laws: Laws, end: Array, free: Array, time: float) -> None:
    """Count contacts that open or close within a step, and store the time of the first contact."""
    closing = np.inf
    for j in range(laws.limits.size):
        low, high = laws.limits[j]["low"], laws.limits[j]["high"]
        # One bit per side, since shims may close both sides.
        before = int(state.y[j] > high) + 2 * int(state.y[j] < low)
        after = int(end[j] > high) + 2 * int(end[j] < low)
        if before == after:
            continue
        state.tally[CHANGES] += 1.0
        closed = after & ~before
        if closed != 0:
            bound = high if closed == 1 else low
            # Until contact, the displacement equals the displacement without contact forces.
            passed = (bound - state.y[j]) / (free[j] - state.y[j])
            closing = min(closing, time * min(max(passed, 0.0), 1.0))
    if np.isnan(state.tally[FIRST_CONTACT]) and closing < np.inf:
        state.tally[FIRST_CONTACT] = state.tally[TIME] + closing


@njit(**LOOP)
def _energy_and_stiffness(laws: Laws, j: int, y: float) -> tuple[float, float]:
    """Return energy in J and tangent stiffness in N/m of contact j at the displacement y in m."""
    energy, slope = 0.0, 0.0
    for t in range(laws.first_term[j], laws.first_term[j + 1]):
        energy += term_energy(laws.terms[t], y)
        slope += term_slope(laws.terms[t], y)
    return energy, slope


@njit(**LOOP)
def _stiffness_at_energy(laws: Laws, j: int, side: float, energy: float) -> float:
    """Return the tangent stiffness in N/m of contact j on one side at a stored energy in J."""
    onset = laws.limits[j]["high"] if side > 0.0 else laws.limits[j]["low"]
    low, high = 0.0, 1.0e-12
    # The limit ends the search on a side without contact, which round-off of a force may give.
    while high < _MAX_DEPTH and _energy_and_stiffness(laws, j, onset + side * high)[0] < energy:
        low, high = high, 2.0 * high
    for _ in range(10):
        middle = 0.5 * (low + high)
        if _energy_and_stiffness(laws, j, onset + side * middle)[0] < energy:
            low = middle
        else:
            high = middle
    slope: float = _energy_and_stiffness(laws, j, onset + side * high)[1]
    return slope


@njit(**LOOP)
def _update_peaks(
    state: State, laws: Laws, compliance: Array, time: float, end: Array, force: Array,
    free: Array, peaks: Array,
) -> None:  # fmt: skip
    """Update the peaks of contact forces, and the largest steps in s that resolve the contacts.

    A peak is the force at the end of a step that resolves the contact. In a longer step the force
    oscillates, and the peak is the mean force. The largest step follows from the stiffness at the
    maximum penetration, where the contact also stores the kinetic energy (y_free − y₀)²/(4 H_jj).
    """
    for j in range(laws.limits.size):
        largest = 0.0
        for t in range(laws.first_term[j], laws.first_term[j + 1]):
            largest += term_force(laws.terms[t], end[j])
        before = state.y[j]
        slope = max(
            _energy_and_stiffness(laws, j, before)[1], _energy_and_stiffness(laws, j, end[j])[1]
        )
        phase = np.sqrt(2.0 * max(slope, 0.0) * compliance[j, j])
        if phase > RESOLVED or abs(force[j]) > abs(largest):
            largest = force[j]
        if abs(largest) > abs(peaks[j]):
            peaks[j] = largest
        if abs(largest) > state.crest[j]:
            state.crest[j] = abs(largest)
            state.resolving[j] = np.inf
            if phase > RESOLVED:
                energy = _energy_and_stiffness(laws, j, before)[0]
                energy += (free[j] - before) ** 2 / (4.0 * compliance[j, j])
                most = _stiffness_at_energy(laws, j, np.sign(largest), energy)
                phase = np.sqrt(2.0 * max(most, slope) * compliance[j, j])
                state.resolving[j] = time * RESOLVED / phase


@njit(**SUMS)
def _set_loads(
    system: LoopSystem, mean: Array, change: Array, middle: float, part: float,
    load: Array, tilt: Array,
) -> None:  # fmt: skip
    """Set the mean load (num_modes,) and its change ``tilt`` within a part of a step.

    ``mean`` and ``change`` (num_excitations,) apply to the whole step. ``part`` is the length of
    the part and ``middle`` its offset from the middle of the step, as fractions of the step.
    """
    assign(load, system.load)
    tilt[:] = 0.0
    for e in range(system.excitations.shape[0]):
        now, then = mean[e] + middle * change[e], part * change[e]
        for i in range(load.size):
            load[i] += now * system.excitations[e, i]
            tilt[i] += then * system.excitations[e, i]


@njit(**SUMS)
def free_time(system: LoopSystem, flow: Flow, state: State, longest: float) -> float:
    """Return a time in s up to ``longest`` within which no contact closes; 0 if any is closed.

    Without contact, the speed of a mode is at most √(ȧ² + (ω² a − Q)²/ω²), or |ȧ| + |Q| t for
    ω = 0. The speed of a row is at most the sum over all modes.
    """
    limits, speed = system.laws.limits, np.empty(state.a.size)
    for i in range(speed.size):
        pull = system.load[i] - flow.omega2[i] * state.a[i]
        if flow.omega2[i] > 0.0:
            speed[i] = np.sqrt(state.v[i] * state.v[i] + pull * pull / flow.omega2[i])
        else:
            speed[i] = abs(state.v[i]) + abs(pull) * longest
    for j in range(limits.size):
        room = min(limits[j]["high"] - state.y[j], state.y[j] - limits[j]["low"])
        if room <= 0.0:
            return 0.0
        fastest = 0.0
        for i in range(speed.size):
            fastest += abs(state.rows[j, i]) * speed[i]
        longest = min(longest, room / fastest) if fastest > 0.0 else longest
    return longest


@njit(**LOOP)
def march(
    system: LoopSystem, flow: Flow, compliances: Array, state: State, schedule: Schedule,
    stretches: int, joined: int, problem: Problem, output: Output,
) -> bool:  # fmt: skip
    """Advance to the last time of ``output``, and return whether all steps converged.

    An output interval is divided into stretches of 2ʲ steps, with j = ``joined``. Steps in which no
    contact can close are joined, at most to a whole stretch, since the modal solution is exact.

    Args:
        system: constant data of the system.
        flow: coefficients for a stretch, half of it, a quarter and so on. They continue below the
            step, since a step is halved if its forces do not converge.
        compliances: (num_lengths, num_rows, num_rows) H in m/N for each length of ``flow``, if rows
            are constant.
        state: state at the start; the function changes it to the state at the end.
        schedule: loads and extensions of all stretches.
        stretches: number of stretches of an output interval.
        joined: j; 0 if other forces act than constant loads and contact forces.
        problem: work arrays of contact and friction forces.
        output: output to fill in.
    """
    laws, axial, moving = borrow(system.laws), borrow(system.axial), borrow(system.moving)
    state, flow, problem = borrow(state), borrow(flow), borrow(problem)
    a, v, rows, y, force, axial_push = (
        state.a, state.v, state.rows, state.y, state.force, state.axial_push,
    )  # fmt: skip
    tally, driven, free, now = state.tally, state.driven, problem.free, problem.force
    n, m, contacts, frictions = a.size, y.size, laws.limits.size, laws.friction.shape[1]
    moves, excited = moving.number.size > 0, system.excitations.shape[0] > 0
    softens, travels = axial.force.size + axial.factors.size > 0, driven.size
    end, load, total, pull = system.load.copy(), system.load.copy(), np.zeros(n), np.zeros(n)
    tilt, y_end, a_mean = np.zeros(n if excited else 0), np.zeros(m), np.zeros(n)
    rows_end, rows_mean = (rows.copy(), rows.copy()) if moves else (rows, rows)
    travel_of = np.zeros(m, dtype=np.int64)
    for j in range(moving.number.size):
        travel_of[moving.number[j]] = moving.spans[j, 0]
    extensions, stored = np.zeros((2, travels)), np.zeros(travels)
    mean, peak, friction = np.zeros(contacts), np.zeros(contacts), np.zeros(frictions)
    matrix = compliances[0]
    for step in range(output.states.shape[0] * stretches):
        done, level, joins = 0.0, joined, True
        while done < 1.0:
            if joins and 0 < joined == level and done * 2.0 ** (joined - 1) % 1.0 == 0.0:
                free_for = free_time(system, flow, state, flow.time[0])
                while (
                    level > 0
                    and flow.time[level - 1] <= free_for
                    and done * 2.0 ** (level - 1) % 1.0 == 0.0
                ):
                    level -= 1
            part, time = 0.5**level, flow.time[level]
            if excited:
                off = done + 0.5 * part - 0.5
                _set_loads(
                    system, schedule.mean[step], schedule.change[step], off, part, load, tilt
                )
            for t in range(travels):
                before, after = schedule.extensions[step : step + 2, t]
                extensions[0, t] = before + done * (after - before)
                extensions[1, t] = extensions[0, t] + part * (after - before)
            if moves:
                move_rows(extensions[1], moving, rows, rows_end, rows_mean)
                matrix = compliance(rows_end, rows_mean, flow.gain[level])
            elif m > 0:
                matrix = compliances[level]
            assign(now, force)
            converged = False
            for _ in range(_MAX_ITERATIONS):
                for i in range(n):
                    total[i] = load[i] + axial_push[i]
                if m > 0:
                    free_flow(a, v, flow, level, total, tilt, end)
                    read_rows(rows_end, end, free)
                    for j in range(moving.number.size):
                        free[moving.number[j]] += (
                            moving.shifts[j] * extensions[1, moving.spans[j, 0]]
                        )
                    if not solve_contact_forces(laws, problem, matrix, y, time):
                        break
                    _subtract_forces(rows_mean, now, total)
                free_flow(a, v, flow, level, total, tilt, end)
                converged = not softens
                if softens:
                    pull[:] = 0.0
                    for i in range(n):
                        a_mean[i] = 0.5 * (a[i] + end[i])
                    for side in range(2):
                        add_axial_forces(extensions[side], axial, a_mean, 0.5, pull, stored)
                    change, largest = 0.0, 0.0
                    for i in range(n):
                        change = max(change, abs(pull[i] - axial_push[i]))
                        largest = max(largest, abs(pull[i]))
                    converged = change <= _TOLERANCE * largest
                    assign(axial_push, pull)
                if converged:
                    break
            joins = converged
            if not converged:
                level = max(level, joined) + (level >= joined)
                if level == flow.time.size:
                    return False
                continue
            share = part / stretches
            for j in range(m):
                y_end[j] = free[j]
                for i in range(m):
                    y_end[j] -= matrix[j, i] * now[i]
                row_work = now[j] * (y_end[j] - y[j])
                if j < contacts:
                    mean[j] += share * now[j]
                    # This includes the stored energy of a contact that opens at zero force.
                    if laws.limits[j]["damping"] > 0.0:
                        _, _, elastic = contact_response(laws, j, y[j], y_end[j], time)
                        tally[CONTACT] += row_work - elastic * (y_end[j] - y[j])
                elif j < contacts + frictions:
                    friction[j - contacts] -= share * now[j]
                    tally[FRICTION] += row_work
                else:
                    tally[DAMPING] += row_work
                if moves and now[j] != 0.0:
                    for i in range(n):
                        row_work -= now[j] * rows_mean[j, i] * (end[i] - a[i])
                    driven[travel_of[j]] += row_work
            if softens:
                # ½ aᵀ ΔK_G a, the mean of both ends of the step.
                for corner in range(4):
                    at, share = (a, end)[corner // 2], 0.5 - corner % 2
                    add_axial_forces(extensions[corner % 2], axial, at, share, pull, driven)
            _update_contacts(state, laws, y_end, free, time)
            _update_peaks(state, laws, matrix, time, y_end, now, free, peak)
            work, lost = finish_flow(a, v, flow, level, total, tilt, end, load)
            tally[WORK] += work
            tally[DAMPING] += lost
            tally[TIME] += time
            tally[STEPS] += 1.0
            assign(y, y_end)
            assign(force, now)
            if moves:
                assign(rows.ravel(), rows_end.ravel())
            done += part
            level = max(level, joined)
            while level > joined and done * 2.0 ** (level - 1) % 1.0 == 0.0:
                level -= 1
        if (step + 1) % stretches == 0:
            interval = step // stretches
            assign(output.states[interval], a)
            assign(output.velocities[interval], v)
            assign(output.gaps[interval], y)
            assign(output.means[interval], mean)
            assign(output.peaks[interval], peak)
            assign(output.frictions[interval], friction)
            assign(output.drives[interval], driven)
            energies = output.energies[interval]
            energies[0], energies[1] = modal_energy(a, v, flow.omega2)
            if softens:
                stored[:] = 0.0
                add_axial_forces(extensions[1], axial, a, 1.0, pull, stored)
                energies[1] -= stored.sum()
            energies[2] = contact_energy(y, laws.terms)
            assign(energies[3:7], tally[WORK:])
            if energies.size > 7:
                energies[7] = driven.sum()
            mean[:] = 0.0
            peak[:] = 0.0
            friction[:] = 0.0
    return True
