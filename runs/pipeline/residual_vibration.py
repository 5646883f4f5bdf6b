# SPDX-License-Identifier: LGPL-3.0-or-later
"""Residual vibration of the tip by drives or a winch, compared with vibration without them.

The amplitude is the largest distance of the tip from its static position, at the current extension
and under the current loads.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated

import numpy as np

from protractile.analysis.quantities import Quantity, Record
from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.excitation import resolving_times
from protractile.dynamics.failure import NUMERICAL_ERRORS, NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.trajectory import Trajectory
from protractile.dynamics.travel import Travel
from protractile.geometry.arrays import Array, Indices
from protractile.runs.case.schema import Case, Model
from protractile.runs.pipeline.models import MotionPlan

# Number of equilibria in a motion and between two reversals; maximum number of reversals.
_RESTS, _BETWEEN_TURNS, _MOST_TURNS = 60, 4, 100

_TIP = ("tip", "tip_lateral")

# Quantity of a vibration at constant extension.
_level = partial(Quantity, unit="m", shown="mm", charted=False)


@dataclass(frozen=True, slots=True)
class ResidualVibration(Record):
    """Residual vibration of the tip during and after telescoping or hoisting."""

    title = "Residual vibration of the tip"
    notes = (
        "Largest distance of the tip from its static position at the current extension and under "
        "the current loads. Last columns: the same distance with drives and winch at rest, in "
        "their initial and final positions.",
    )

    #: largest distance of the tip from its static position in m
    tip: Annotated[
        float,
        Quantity(
            "residual_vibration", "m", "residual vibration",
            shown="mm", heading="residual\nvibration",
        ),
    ]  # fmt: skip
    #: time of this distance in s
    time: Annotated[
        float, Quantity("", "s", "time of the residual vibration", heading="at", form=".3f")
    ]
    #: mean speed in m/s of the fastest drive while it moves
    speed: Annotated[
        float, Quantity("drive_speed", "m/s", "mean speed of the drive", charted=False)
    ]
    #: largest distance in m at constant initial extension, under the same loads; None if it cannot
    #: be computed
    initial: Annotated[
        float | None,
        _level(
            "residual_vibration_initial",
            title="vibration at the initial position of drives",
            heading="at initial\nposition",
        ),
    ]
    #: largest distance in m at constant final extension; None if it cannot be computed
    final: Annotated[
        float | None,
        _level(
            "residual_vibration_final",
            title="vibration at the final position of drives",
            heading="at final\nposition",
        ),
    ]


def residual_vibration(
    system: GapSystem, trajectory: Trajectory, case: Case, model: Model
) -> ResidualVibration | None:
    """Return the residual vibration; None without drives and winch, or without equilibria.

    The ``load`` of the system includes all constant loads.
    """
    travels = [travel for travel in system.travels if travel.telescopes or any(travel.shifts)]
    ends = [time for travel in travels for time in travel.history.kinks]
    if not ends or max(ends) > trajectory.time[-1]:
        # The largest vibration may come after the end of the run.
        return None
    try:
        tip, time = farthest_from_rest(system, trajectory)
    except NUMERICAL_ERRORS:
        return None
    at_constant_extension = [
        _vibration_at_constant_extension(system.at_time(when).in_own_modes(), case, model)
        for when in (0.0, max(ends))
    ]
    speed = max(_speed(travel) for travel in travels)
    return ResidualVibration(tip, time, speed, *at_constant_extension)


def farthest_from_rest(system: GapSystem, trajectory: Trajectory) -> tuple[float, float]:
    """Return the largest distance of the tip from its static position in m, and its time in s.

    The ``load`` of the system includes all constant loads.

    Raises:
        NumericsError: there is no equilibrium, or loads reverse too often.
    """
    time = trajectory.time
    system = replace(system, released_load=np.zeros(system.num_modes))
    changes = [x.history for x in system.excitations] + [x.history for x in system.travels]
    times = resolving_times(changes, float(time[-1]))
    values = np.array([change(times) for change in changes]).reshape(len(changes), times.size)
    # The sum of the relative changes of all values since t = 0.
    sizes = np.abs(values).max(axis=1, keepdims=True)
    increments = np.abs(np.diff(values, axis=1)) / np.where(sizes > 0.0, sizes, 1.0)
    total = np.concatenate([[0.0], np.cumsum(increments.sum(axis=0))])
    steps = _equilibrium_steps(values, total)
    rests = [equilibrium_at(system, t) for t in times[steps].tolist()]
    off = np.zeros(time.size)
    for name in _TIP:
        if name in system.observers:
            deflections_at_rest = np.array(rests) @ system.observers[name].row
            there = np.interp(np.interp(time, times, total), total[steps], deflections_at_rest)
            off = np.hypot(off, trajectory.data[name].values - there)
    step = int(off.argmax())
    return float(off[step]), float(time[step])


def _equilibrium_steps(values: Array, total: Array) -> Indices:
    """Return the ascending output steps (num_rests,) at which equilibria are computed.

    They divide the accumulated change (num_times,) into equal parts, and likewise each interval
    between two reversals of the values (num_changes, num_times).
    """
    turns = sorted({step for change in values for step in _reversals(change).tolist()})
    if len(turns) > _MOST_TURNS:
        raise NumericsError(f"loads and drives reverse {len(turns)} times, more than {_MOST_TURNS}")
    ends = total[[0, *turns, -1]]
    parts = np.arange(_BETWEEN_TURNS) / _BETWEEN_TURNS
    between = ends[:-1, None] + np.diff(ends)[:, None] * parts
    even = np.linspace(0.0, total[-1], _RESTS)
    steps = np.searchsorted(total, np.union1d(even, between))
    return np.unique(np.array([*turns, *steps], dtype=np.int64))


def _reversals(values: Array) -> Indices:
    """Return the steps (num_turns,) at which values (num_times,) reverse or become constant."""
    increments = np.diff(values)
    moves = np.flatnonzero(increments)
    back = increments[moves[:-1]] * increments[moves[1:]] < 0.0
    return np.union1d(moves[:-1][back] + 1, moves[1:][back])


def _speed(travel: Travel) -> float:
    """Return the mean speed in m/s of a drive while it moves; 0 for a sum of several drives."""
    if travel.suffix is None:
        return 0.0
    times = resolving_times([travel.history], max(travel.history.kinks))
    increments = np.abs(np.diff(travel.history(times)))
    return float(increments.sum() / np.diff(times)[increments > 0.0].sum())


def _vibration_at_constant_extension(system: GapSystem, case: Case, model: Model) -> float | None:
    """Return the largest distance of the tip from its static position in m, without telescoping."""
    with suppress(*NUMERICAL_ERRORS):
        plan = MotionPlan.of(system, case, model)
        changes = system.excitations or system.released_load.any() or plan.motion.velocity.any()
        if case.start.state == "equilibrium" and not changes:
            return 0.0
        return farthest_from_rest(system, plan.trajectory())[0]
    return None
