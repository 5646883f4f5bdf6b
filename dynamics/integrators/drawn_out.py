# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a boom that is drawn out or in while it vibrates.

The splitting with the row of the time of the impulse. A gap's rate is ẏ = B ȧ + ṡ B′ a; friction
and contact damping act on all of it. Contact forces do −F B ȧ on the modes and store F ẏ, and the
rest, ∫ ṡ Σ F B′ a dt, is the work of the drive, negative where a boom slides out downhill. Pads rub
along the boom as well: the drive's force against them is μ Σ|N| sign(ṡ), which no mode feels, and
what a drive of a given stiffness draws against it may stick and slip
(:mod:`dynamics.drive.stick_slip`). What an axial force softens as its place moves along is a smooth
force K_G(s) a beside the contacts', at both ends of a step, and −½ ṡ N (w′ a)² the power of the
drive at it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from dynamics.arrays import Array, Indices
from dynamics.contact import contact_limits, contact_terms
from dynamics.drive.stick_slip import FOLLOWED, follow
from dynamics.drive.travel import Travel
from dynamics.energy import DRAWN_ENERGIES
from dynamics.excitation import Excitation
from dynamics.gap_system import GapSystem
from dynamics.integrators.record import Record
from dynamics.kernels.drawn_steps import Rows, Still, march_drawn, space_for
from dynamics.kernels.drawn_strides import strides_for, strides_over
from dynamics.kernels.integrator_state import (
    Excitations,
    excitation_arrays,
    friction_arrays,
)
from dynamics.kernels.moving_rows import row_tables, stacked_rows
from dynamics.kernels.moving_thrusts import pushed_by, thrust_arrays
from dynamics.motion import Motion
from dynamics.trajectory import OF_DRIVES, Trajectory


def integrate_drawn(
    motion: Motion, step: float, energy_bound: float, progress: Callable[[float], None] | None
) -> Trajectory:
    """Move a system whose rows move, as :func:`dynamics.integrators.splitting.integrate` does.

    Args:
        motion: its loads are gathered.
        step: in s, made smaller to fit the output step.
        energy_bound, progress: of the splitting.

    Returns:
        With what it is drawn out and what the drive does beside what every trajectory has:
        ``drawn_out`` in m, ``drive_friction`` in N and ``drive_power`` in W of each travel that
        has a suffix, ``drive_work`` in J, all of a stiff drive. Of one of a given stiffness what
        ``FOLLOWED`` lists, and its ``StickSlip`` by name in the attribute ``stick_slip``.

    Raises:
        NumericsError: the state is not finite, or the energy residual passes its bound.
    """
    system, still, thrusts = motion.system, _still(motion.system), thrust_arrays(motion.system)
    rows = _rows(system, len(thrusts[0]))
    record = Record.begin(motion, step, len(DRAWN_ENERGIES), rows[3].shape[1])
    state, h, substeps = record.state, record.step, record.substeps
    tables, strides = row_tables(system), strides_for(system, h)
    pushed, space = pushed_by(thrusts, state[1]), space_for(system)
    done = 0
    while done < motion.outputs:
        first, done = done, motion.until(done, substeps)
        times = h * np.arange(first * substeps, done * substeps + 1)
        excitations, ways = _followed(system, times, h)
        straight = excitation_arrays(replace(system, travels=()), times, h)[4]
        strides = strides_over(strides, tables[3], straight, ways, h)
        drawn = state, still, rows, tables, thrusts, pushed, ways, excitations, space
        march_drawn(drawn, strides, h, substeps, record.rows(first, done))
        record.check(first, done, energy_bound, progress)
    return _with_drives(record, tables[3], thrusts[1][:, 0])


def _still(system: GapSystem) -> Still:
    """What of a system does not move."""
    _, given, pressing, _ = friction_arrays(system)
    rates = system.damping if system.damping.any() else np.zeros(0)
    omega2, load, rates = map(np.ascontiguousarray, (system.omega2, system.load, rates))
    terms, limits = contact_terms(system.laws), contact_limits(system.laws)
    return omega2, load, terms, limits, rates, given, pressing


def _rows(system: GapSystem, thrusts: int) -> Rows:
    now = stacked_rows(system)
    return now, now.copy(), now.copy(), np.zeros((3, len(now) + thrusts))


def _followed(system: GapSystem, times: Array, step: float) -> tuple[Excitations, Array]:
    """Excitations, and how far each travel is where parts of steps begin, cut at kinks of both."""
    none = np.zeros(system.num_modes)
    travels = [Excitation(none, travel.history) for travel in system.travels]
    both = replace(system, excitations=[*system.excitations, *travels])
    loads, samples, spans, parts, straight, pushes = excitation_arrays(both, times, step)
    count = len(system.excitations)
    own, ways = (samples[:, columns].copy() for columns in (slice(count), slice(count, None)))
    return (loads[:count].copy(), own, spans, parts, straight, pushes), ways


def _with_drives(record: Record, moving: Indices, of_thrust: Indices) -> Trajectory:
    """The trajectory, with what drives do at rows that move and at thrusts, whose travels these
    are."""
    system, found, (*_, drives) = record.motion.system, record.trajectory(), record.arrays
    forces = record.arrays[4]
    at_rows, at_thrusts = np.split(drives, [drives.shape[1] - len(of_thrust)], axis=1)
    works = [
        at_rows[:, np.unique(moving[moving[:, 1] == number, 0])].sum(axis=1)
        + at_thrusts[:, of_thrust == number].sum(axis=1)
        for number in range(len(system.travels))
    ]
    added, told = {}, {}
    for travel, work in zip(system.travels, works, strict=True):
        if travel.suffix is None:
            continue
        way, friction = travel.history(found.time), rubbing(system, travel, forces)
        rubbed = np.sign(np.diff(way, prepend=way[0])) * friction
        against = (rubbed + travel.borne) * np.diff(way, prepend=way[0])
        power = np.diff(work + np.cumsum(against), prepend=0.0)
        power[1:] /= np.diff(found.time)
        for (name, of), values in zip(OF_DRIVES.items(), (way, rubbed, power), strict=True):
            added[f"{name}{travel.suffix}"] = ("time", values, of)
        if travel.pulled is not None:
            followed = follow(travel.pulled, travel.history, found.time, friction)
            told[f"drive_force{travel.suffix}"] = followed.told
            for name, of in FOLLOWED.items():
                added[f"{name}{travel.suffix}"] = ("time", getattr(followed, name), of)
    data = found.data.assign(added).assign_attrs({"stick_slip": told} if told else {})
    return Trajectory(data, found.states)


def rubbing(system: GapSystem, travel: Travel, forces: Array) -> Array:
    """(num_times,) μ Σ|N| in N of the pads that one of a system's travels moves.

    ``forces`` (num_times, num_rows) are those of contacts in N, of a motion means of outputs.
    """
    coefficients = {friction.station: friction.coefficient for friction in system.frictions}
    total = np.zeros(len(forces))
    for kind, row in travel.moving:
        if kind == "rows":
            coefficient = coefficients.get(int(system.station_of_row[row]), 0.0)
            total += coefficient * np.abs(forces[:, row])
        elif kind == "friction_rows":
            friction = system.frictions[row]
            total += friction.coefficient * friction.normal_force
    return total
