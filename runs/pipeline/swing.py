# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far the tip swings while a boom is drawn out, beside the same boom that stands.

The swing is the largest distance of the tip from where it would rest, drawn out as far as it is and
under the loads of that moment.
"""

from __future__ import annotations

import numpy as np

from dynamics.equilibrium import equilibrium
from dynamics.gap_system import GapSystem
from dynamics.trajectory import Trajectory
from dynamics.travel import Travel
from geometry.arrays import Array
from runs.case.schema import Case, Model
from runs.pipeline.answers import Swing
from runs.pipeline.at_rest import NUMERICS, load_at
from runs.pipeline.motion import asked

# At so many places along all that changes rests are found, linear between them.
_RESTS = 60
# Among so many times beside its kinks what changes is followed.
_TIMES = 2001

_TIP = ("tip", "tip_lateral")


def swing(system: GapSystem, trajectory: Trajectory, case: Case, model: Model) -> Swing | None:
    """Of a model that is drawn out; None where it is not, or has no rest.

    Args:
        system: of the model, all that stays constant in its load.
        trajectory: its motion.
        case: the model's.
        model: one of the case's.
    """
    ends = [time for travel in system.travels for time in travel.history.kinks]
    if not ends or max(ends) > trajectory.time[-1]:
        # What has not ended has not swung as far as it will.
        return None
    try:
        tip, time = farthest_from_rest(system, trajectory)
    except NUMERICS:
        return None
    stands = [_standing(system.standing(when), case, model) for when in (0.0, max(ends))]
    speed = max(_speed(travel) for travel in system.travels)
    return Swing(tip, time, speed, *stands)


def farthest_from_rest(system: GapSystem, trajectory: Trajectory) -> tuple[float, float]:
    """The swing in m, and when it is, in s.

    Args:
        system: all that stays constant is in its ``load``.
        trajectory: its motion.

    Raises:
        NumericsError: it has no rest.
    """
    time = trajectory.time
    changes = [x.history for x in system.excitations] + [x.history for x in system.travels]
    kinks = [kink for change in changes for kink in change.kinks if 0.0 < kink < time[-1]]
    times = np.unique([*np.linspace(0.0, time[-1], _TIMES), *kinks])
    values = np.array([change(times) for change in changes])
    passed = _passed(values.reshape(len(changes), times.size))
    steps = np.searchsorted(passed, np.linspace(0.0, passed[-1], _RESTS))
    steps = np.unique(np.minimum(steps, times.size - 1))
    rests = [equilibrium(system.standing(t), load_at(system, t)) for t in times[steps].tolist()]
    off = np.zeros(time.size)
    for name in _TIP:
        if name in system.observers:
            still = np.array(rests) @ system.observers[name].row
            there = np.interp(np.interp(time, times, passed), passed[steps], still)
            off = np.hypot(off, trajectory.data[name].values - there)
    step = int(off.argmax())
    return float(off[step]), float(time[step])


def _speed(travel: Travel) -> float:
    """The mean in m/s while it moves; 0 of several together, whose own travels are beside it."""
    if travel.suffix is None:
        return 0.0
    kinks = travel.history.kinks
    times = np.linspace(max(0.0, min(kinks)), max(kinks), _TIMES)
    ways = np.abs(np.diff(travel.history(times)))
    return float(ways.sum() / np.diff(times)[ways > 0.0].sum())


def _passed(values: Array) -> Array:
    """(num_times,) how much of all that changes has passed, of values (num_changes, num_times)."""
    sizes = np.abs(values).max(axis=1, keepdims=True)
    ways = np.abs(np.diff(values, axis=1)) / np.where(sizes > 0.0, sizes, 1.0)
    return np.concatenate([[0.0], np.cumsum(ways.sum(axis=0))])


def _standing(system: GapSystem, case: Case, model: Model) -> float | None:
    """The swing of the same boom that stands, in m."""
    from dynamics.integrators import by_splitting

    try:
        motion, _ = asked(system, case, model)
        changes = system.excitations or system.released.any() or motion.velocity.any()
        if case.start.state == "equilibrium" and not changes:
            return 0.0
        return farthest_from_rest(system, by_splitting(motion)(motion))[0]
    except NUMERICS:
        return None
