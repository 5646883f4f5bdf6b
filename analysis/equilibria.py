# SPDX-License-Identifier: LGPL-3.0-or-later
"""Equilibria of a model at the instants of extreme loads and extensions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress

import numpy as np

from protractile.dynamics.equilibrium import Equilibria
from protractile.dynamics.excitation import Excitation, resolving_times
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.travel import Travel
from protractile.geometry.arrays import Array

# Extensions that differ by less than this fraction count as equal.
_SAME_EXTENSION = 1.0e-12
# Fraction of a contact row below which its part of the boom is round-off.
_ROUND_OFF = 1.0e-9


def instants(system: GapSystem, duration: float) -> list[float]:
    """Return 0 and the times in s at which a load, hoist or axial force has its extreme values.

    At t = 0 a released load still acts; another time is then without it. The ``load`` of the system
    includes all constant loads. ``duration`` is that of the motion in s.
    """
    # Hoisting changes no static state of a load that hangs, without contact with the ground.
    of_boom = system.rows - system.rows @ system.hung.T @ system.hung
    moved_by_boom = np.linalg.norm(of_boom, axis=1) > _ROUND_OFF * np.linalg.norm(
        system.rows, axis=1
    )
    grounded = bool(system.hung.size) and not moved_by_boom.all()
    changes = [
        travel
        for travel in system.travels
        if not travel.telescopes and (grounded or not any(travel.shifts))
    ]
    times, values = _sample_histories([*system.excitations, *changes], system, duration)
    if system.released_load.any():
        values = np.vstack([values, times <= 0.0])
    return _distinct_times(times, values, [0, *values.argmax(axis=1), *values.argmin(axis=1)])


def extended_instants(system: GapSystem, duration: float) -> list[float]:
    """Return times in s of extreme extensions, and of extreme loads while these extensions last.

    The ``load`` of the system includes all constant loads. ``duration`` is that of the motion in s.
    """
    drives = [travel for travel in system.travels if travel.telescopes]
    times, ways = _sample_histories(drives, system, duration)
    _, loads = _sample_histories(system.excitations, system, duration)
    steps_at_ends: list[int] = []
    for way in ways:
        for end in (way.max(), way.min()):
            there = np.flatnonzero(np.abs(way - end) <= _SAME_EXTENSION * abs(end))
            of_loads = loads[:, there]
            steps = [0, *of_loads.argmax(axis=1), *of_loads.argmin(axis=1)]
            steps_at_ends += there[steps].tolist() if end else []
    return _distinct_times(times, np.vstack([loads, ways]), steps_at_ends)


def _sample_histories(
    changes: Sequence[Excitation | Travel], system: GapSystem, duration: float
) -> tuple[Array, Array]:
    """Return times in s that resolve all histories, and the values (num_changes, num_times)."""
    histories = [x.history for x in system.excitations] + [x.history for x in system.travels]
    times = resolving_times(histories, duration)
    values = np.array([change.history(times) for change in changes])
    return times, values.reshape(-1, times.size)


def _distinct_times(times: Array, values: Array, steps: Sequence[int]) -> list[float]:
    """Return the first time in s of each distinct value at the given steps."""
    first_times: dict[tuple[float, ...], float] = {}
    for step in steps:
        first_times.setdefault(tuple(values[:, step]), float(times[step]))
    return list(first_times.values())


def equilibria(system: GapSystem, times: Sequence[float] = (0.0,)) -> dict[float, Array]:
    """Return the equilibria (num_modes,) under the loads at given times, by time in s.

    Times without an equilibrium are left out. The result is empty if the first has none. The
    ``load`` of the system includes all constant loads.
    """
    first, later = _equilibria(system, times[:1]), times[1:]
    return first | _equilibria(system, later) if first and later else first


def vibrating_state(system: GapSystem, rests: Mapping[float, Array]) -> tuple[GapSystem, Array]:
    """Return the system at rest and the equilibrium (num_modes,) about which the boom vibrates.

    A load that is released at t = 0 no longer acts. ``rests`` are those of :func:`equilibria`.
    """
    released = system.released_load.any()
    after = min((time for time in rests if time > 0.0 or not released), default=0.0)
    return system.at_time(after), rests[after]


def vibrating_system(system: GapSystem, duration: float) -> tuple[GapSystem, Array] | None:
    """Return the state of :func:`vibrating_state`; None without an equilibrium at t = 0.

    The ``load`` of the system includes all constant loads. ``duration`` is that of the motion in s.
    """
    released = system.released_load.any()
    rests = equilibria(system, instants(system, duration) if released else [0.0])
    return vibrating_state(system, rests) if rests else None


def extended_equilibria(system: GapSystem, duration: float) -> dict[float, Array]:
    """Return the equilibria (num_modes,) at the largest and smallest extension, by time in s.

    The ``load`` of the system includes all constant loads. ``duration`` is that of the motion in s.
    """
    earlier = instants(system, duration)
    times = [time for time in extended_instants(system, duration) if time not in earlier]
    return _equilibria(system, times)


def _equilibria(system: GapSystem, times: Sequence[float]) -> dict[float, Array]:
    equilibria: dict[float, Array] = {}
    fixed = None if system.travels else Equilibria(system)
    for time, load in zip(times, system.load_at(np.array(times)), strict=True):
        with suppress(*NUMERICAL_ERRORS), np.errstate(all="ignore"):
            near = next(reversed(equilibria.values()), None)
            there = fixed or Equilibria(system.at_time(time))
            equilibria[time] = there.under(load, near)
    return equilibria
