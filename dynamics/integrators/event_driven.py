# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a gap system from contact to contact, for few modes.

While no row touches, every gap is a sum of cosines and parabolas: the motion jumps, each time as
far as the gaps cannot shut even if all modes pulled together, so that no contact is missed however
short (:mod:`dynamics.kernels.flight`). While rows press, it goes on by its Taylor series
(:mod:`dynamics.kernels.contact_series`), a few of which make a contact. Outputs are read on the
way.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numba import njit

from dynamics.arrays import Array
from dynamics.contact import contact_limits, contact_terms
from dynamics.contact_term import Terms
from dynamics.energy import ENERGIES, ENERGY_BOUND, energy_residual
from dynamics.failure import NumericsError, StepTooLong
from dynamics.gap_system import GapSystem
from dynamics.integrators.step import closing_speeds
from dynamics.kernels.compiled import SUMS
from dynamics.kernels.contact_series import (
    Series,
    evaluate,
    exit_time,
    expand,
    farthest,
    impulse,
    reach,
)
from dynamics.kernels.flight import jump, pulls, safe_time, tabulate
from dynamics.kernels.terms import term_force
from dynamics.motion import Motion
from dynamics.trajectory import Trajectory

# Truncation of a series, as a part of the motion: an energy residual of about 1e-9 on the paper's
# five-term case.
TOLERANCE = 1.0e-10

# A gap is shut within this part of its clearance; without one, of its way in an output step.
_SHUT = 1.0e-13

# The shortest jump, as a part of the output step: far below any contact, above round-off.
_SHORTEST = 1.0e-12

# Jumps and series between two outputs beyond which something rattles without end.
_ENDLESS = 1_000_000


@njit(nogil=True, inline="always")
def _fly(
    a: Array,
    v: Array,
    system: tuple[Array, ...],
    flows: tuple[Array, Array],
    time: float,
    output_step: float,
    out: tuple[Array, ...],
    place: Array,
) -> None:
    """Move over ``time`` while nothing touches, recording the outputs that are passed.

    Where ``time`` would end before the next output, the last one passed is far enough: from there
    the next jump is longer. ``flows`` are that over an output step, and room for another.
    """
    omega, load, _ = system
    whole, part = flows
    states, velocities, _, _ = out
    while place[0] < states.shape[0]:
        step = min(time, place[1])
        if step == output_step:
            jump(a, v, whole)
        else:
            tabulate(omega, load, step, part)
            jump(a, v, part)
        if time < place[1]:
            place[1] -= time
            return
        time -= step
        states[int(place[0])] = a
        velocities[int(place[0])] = v
        place[0] += 1.0
        place[1] = output_step
        if time < output_step:
            return


@njit(nogil=True, inline="always")
def _press(
    series: Series,
    terms: Terms,
    pressed: Array,
    time: float,
    output_step: float,
    out: tuple[Array, ...],
    place: Array,
    a: Array,
    v: Array,
) -> None:
    """Move over ``time`` by the series, recording the outputs that are passed."""
    states, velocities, impulses, peaks = out
    begin = 0.0
    while place[0] < states.shape[0]:
        interval = int(place[0])
        end = min(begin + place[1], time)
        for t in range(terms.size):
            j, side = terms[t]["row"], terms[t]["side"]
            if pressed[j] == side:
                impulses[interval, j] += impulse(series.force[j], begin, end)
                force = term_force(terms[t], side * farthest(series.gap[j], side, begin, end))
                if abs(force) > abs(peaks[interval, j]):
                    peaks[interval, j] = force
        evaluate(series, end, a, v)
        if time < begin + place[1]:
            place[1] -= time - begin
            return
        states[interval] = a
        velocities[interval] = v
        begin = end
        place[0] += 1.0
        place[1] = output_step


@njit(**SUMS)
def _march(
    a: Array,
    v: Array,
    system: tuple[Array, ...],
    terms: Terms,
    touch: tuple[Array, ...],
    pressed: Array,
    output_step: float,
    tolerance: float,
    series: Series,
    out: tuple[Array, ...],
    tally: Array,
) -> bool:
    """Advance through all output intervals; False if contacts follow without end.

    ``system`` = (ω, load, rows); ``terms`` of the rows' laws; ``touch`` = (low,
    high, shut): the gaps at which each row touches, and what counts as there; ``pressed``
    (num_rows,) 1 above, −1 below, 0 open. ``out`` = (states, velocities, impulses, peaks), one row
    an interval. ``tally`` = first contact, steps, contact changes.
    """
    omega, load, rows = system
    shut = touch[2]
    # The gaps between which each row stays as it is.
    low = np.where(pressed > 0.0, touch[1], np.where(pressed < 0.0, -np.inf, touch[0]))
    high = np.where(pressed < 0.0, touch[0], np.where(pressed > 0.0, np.inf, touch[1]))
    squares = omega * omega
    intervals = out[0].shape[0]
    highest = series.powers.shape[1]
    pull = np.zeros(shut.size)
    touching = np.count_nonzero(pressed)
    # Output interval, and the time that is left in it.
    place = np.array([0.0, output_step])
    interval, moves = 0.0, 0
    pulls(a, v, omega, load, rows, pull)
    whole, part = np.empty((2, 5, a.size))
    tabulate(omega, load, output_step, whole)
    while place[0] < intervals:
        leaving = 0
        if touching > 0:
            expand(series, a, v, (squares, load, rows), terms, pressed)
            time = min(reach(series.state, squares, highest, tolerance), intervals * output_step)
            for j in range(shut.size):
                free, side = exit_time(series.gap[j], low[j], high[j], shut[j], time)
                if side != 0 or free < time:
                    time, leaving = free, side * (j + 1)
            time = max(time, _SHORTEST * output_step)
            _press(series, terms, pressed, time, output_step, out, place, a, v)
            tally[1] += 1.0
        else:
            time, leaving = safe_time(a, v, rows, pull, low, high, shut)
            if leaving == 0:
                time = max(time, _SHORTEST * output_step)
                _fly(a, v, system, (whole, part), time, output_step, out, place)
                tally[1] += 1.0
        if leaving != 0 and place[0] < intervals:
            j = abs(leaving) - 1
            if pressed[j] != 0.0:
                pressed[j], low[j], high[j] = 0.0, touch[0][j], touch[1][j]
                touching -= 1
            elif leaving > 0:
                pressed[j], low[j], high[j] = 1.0, touch[1][j], np.inf
                touching += 1
            else:
                pressed[j], low[j], high[j] = -1.0, -np.inf, touch[0][j]
                touching += 1
            if touching == 0:
                pulls(a, v, omega, load, rows, pull)
            tally[2] += 1.0
            if np.isnan(tally[0]):
                tally[0] = (place[0] + 1.0) * output_step - place[1]
        moves = moves + 1 if place[0] == interval else 0
        interval = place[0]
        if moves > _ENDLESS:
            return False
    return True


def what_hinders(system: GapSystem) -> str | None:
    """What of a system cannot be moved from contact to contact; None if all can."""
    if any(travel.moves for travel in system.travels):
        return "rows that move as a boom is drawn out leave no closed form from contact to contact"
    if (system.omega2 < 0.0).any():
        return "a segment that tips over under an axial force has no closed form here"
    if system.damped:
        return "a damped system has no closed form from contact to contact"
    if not all(excitation.constant for excitation in system.excitations):
        return "loads that change with time leave no closed form from contact to contact"
    if system.frictions:
        return "dry friction leaves no closed form from contact to contact"
    if any(law.damping > 0.0 for law in system.laws):
        return "contact damping is not analytic where a press ends"
    broken = [t.exponent for law in system.laws for t in law.terms if t.exponent % 1.0 != 0.0]
    if broken:
        return f"a force of the exponent {broken[0]:g} is not analytic where a press begins"
    if any(len({t.side for t in law.terms}) < len(law.terms) for law in system.laws):
        return "a force of several terms is not analytic where one begins"
    if any(law.clearance < 0.0 and len(law.terms) > 1 for law in system.laws):
        return "a contact that is pressed from both sides has no free flight"
    return None


def _way(motion: Motion) -> Array:
    """(num_rows,) about how far each gap may move within an output step, in m."""
    system, time = motion.system, motion.output_step
    fall = 0.5 * time**2 * np.abs(system.rows) @ np.abs(system.load)
    return np.asarray(time * closing_speeds(system, motion.initial_speeds) + fall)


def integrate_events(motion: Motion, tolerance: float = TOLERANCE) -> Trajectory:
    """Move an undamped gap system from contact to contact.

    Args:
        motion: the cost of a jump grows with its modes, and jumps shorten with its highest
            frequencies.
        tolerance: of a series while rows press, as a part of the motion.

    Raises:
        ValueError: :func:`what_hinders` names something.
        NumericsError: the energy residual passes its bound, or contacts follow without end.

    The trajectory's ``step`` is the mean of its jumps and series.
    """
    hindrance = what_hinders(motion.system)
    if hindrance is not None:
        raise ValueError(f"{hindrance}; integrate by splitting")
    motion = replace(motion, system=motion.system.gathered())
    system, outputs, output_step = motion.system, motion.outputs, motion.output_step
    n, m = system.num_modes, len(system.laws)
    a, v = motion.position.copy(), motion.velocity.copy()
    terms, limits = contact_terms(system.laws), contact_limits(system.laws)
    clearance = np.array([law.clearance for law in system.laws])
    states, velocities = np.zeros((outputs + 1, n)), np.zeros((outputs + 1, n))
    impulses, peaks = np.zeros((outputs + 1, m)), np.zeros((outputs + 1, m))
    states[0], velocities[0] = a, v
    out = (states[1:], velocities[1:], impulses[1:], peaks[1:])
    arrays = tuple(
        np.ascontiguousarray(array) for array in (np.sqrt(system.omega2), system.load, system.rows)
    )
    touch = (
        limits["low"].copy(),
        limits["high"].copy(),
        _SHUT * np.where(clearance > 0.0, clearance, _way(motion)),
    )
    gaps = system.rows @ a
    peaks[0] = [w.force(gap) for w, gap in zip(system.laws, gaps, strict=True)]
    impulses[0] = output_step * peaks[0]
    pressed = 1.0 * (gaps > touch[1]) - (gaps < touch[0])
    tally = np.array([0.0 if pressed.any() else np.nan, 0.0, 0.0])
    series = Series.room(n, m, terms)
    if not _march(a, v, arrays, terms, touch, pressed, output_step, tolerance, series, out, tally):
        raise NumericsError(
            f"more than {_ENDLESS} contacts follow within {output_step:g} s; make the contact "
            "softer"
        )
    row_gaps = states @ system.rows.T
    energies = np.zeros((outputs + 1, len(ENERGIES)))
    energies[:, 0] = 0.5 * np.einsum("ti,ti->t", velocities, velocities)
    energies[:, 1] = 0.5 * states**2 @ system.omega2
    energies[:, 2] = sum(w.energy(y) for w, y in zip(system.laws, row_gaps.T, strict=True))
    energies[:, 3] = (states - states[0]) @ system.load
    residual = float(np.abs(energy_residual(energies)).max())
    if not residual <= ENERGY_BOUND:
        raise StepTooLong(
            f"the energy residual is {residual:.3g} of the work done, above the bound of "
            f"{ENERGY_BOUND:.3g}, at a tolerance of {tolerance:.3g}; make it smaller"
        )
    steps = max(1, int(tally[1]))
    return Trajectory.record(
        system,
        time=output_step * np.arange(outputs + 1),
        states=states,
        velocities=velocities,
        energies=energies,
        row_gaps=row_gaps,
        row_forces=impulses / output_step,
        row_peaks=peaks,
        row_frictions=np.zeros((outputs + 1, 0)),
        step=outputs * output_step / steps,
        steps=steps,
        first_contact=float(tally[0]),
        contact_changes=int(tally[2]),
    )
