# SPDX-License-Identifier: LGPL-3.0-or-later
"""A model of the boom at rest, under the loads of the instants at which these are largest."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from itertools import count

import numpy as np

from dynamics.contact import ContactLaw
from dynamics.drive.travel import Travel
from dynamics.equilibrium import rest_at
from dynamics.excitation import Excitation, followed
from dynamics.failure import NUMERICS
from dynamics.gap_system import GapSystem
from dynamics.line import Line
from geometry.arrays import Array
from geometry.boom import Boom, Direction, Joint
from geometry.cylinder import forces
from geometry.drawing import drawn, places
from geometry.section import Side
from runs.case.contact import PADS_OF_SIDE
from runs.pipeline.answers import AtRest, Diagram, Pressed, Tilt, rounded
from runs.pipeline.place_names import place_names
from runs.pipeline.section_forces import section_forces

# Of sides.
_SIGNS: tuple[Side, Side] = (1, -1)

# A part of the farthest way that is none.
_SAME_WAY = 1.0e-12


def instants(system: GapSystem, duration: float) -> list[float]:
    """0, and the times in s at which a load that changes is largest one way or the other.

    Args:
        system: all that stays constant is in its ``load``.
        duration: of the motion in s.
    """
    times, values = _over_time(system.excitations, system, duration)
    return _distinct(times, values, [0, *values.argmax(axis=1), *values.argmin(axis=1)])


def drawn_instants(system: GapSystem, duration: float) -> list[float]:
    """The times in s at which it first is drawn out, or in, farthest, and those at which a load is
    largest one way or the other while it is.

    Args:
        system: all that stays constant is in its ``load``.
        duration: of the motion in s.
    """
    times, ways = _over_time(system.travels, system, duration)
    _, loads = _over_time(system.excitations, system, duration)
    found: list[int] = []
    for way in ways:
        for end in (way.max(), way.min()):
            there = np.flatnonzero(np.abs(way - end) <= _SAME_WAY * abs(end))
            of_loads = loads[:, there]
            steps = [0, *of_loads.argmax(axis=1), *of_loads.argmin(axis=1)]
            found += there[steps].tolist() if end else []
    return _distinct(times, np.vstack([loads, ways]), found)


def _over_time(
    changes: Sequence[Excitation | Travel], system: GapSystem, duration: float
) -> tuple[Array, Array]:
    """Times in s that follow all that changes, and (num_changes, num_times) of some of it."""
    loads, ways = ([change.history for change in of] for of in (system.excitations, system.travels))
    times = followed([*loads, *ways], duration)
    values = np.array([change.history(times) for change in changes])
    return times, values.reshape(-1, times.size)


def _distinct(times: Array, values: Array, steps: Sequence[int]) -> list[float]:
    """The first time in s of each of the different values among some steps."""
    found: dict[tuple[float, ...], float] = {}
    for step in steps:
        found.setdefault(tuple(values[:, step]), float(times[step]))
    return list(found.values())


def positions(system: GapSystem, times: Sequence[float] = (0.0,)) -> dict[float, Array]:
    """Where it rests, (num_modes,), by the instants in s whose loads act.

    Instants under whose loads it has no rest are left out; there is none without the first one.

    Args:
        system: of a model, all that stays constant in its ``load``.
        times: of :func:`instants`.
    """
    found: dict[float, Array] = {}
    for time in times:
        try:
            with np.errstate(all="ignore"):
                found[time] = rest_at(system, time)
        except NUMERICS:
            if not found:
                return {}
    return found


def drawn_positions(system: GapSystem, duration: float) -> dict[float, Array]:
    """Where it rests when it is drawn out, or in, farthest, beside :func:`positions`.

    Args:
        system: of a model, all that stays constant in its ``load``.
        duration: of the motion in s.
    """
    known = instants(system, duration)
    found: dict[float, Array] = {}
    for time in drawn_instants(system, duration):
        with suppress(*NUMERICS), np.errstate(all="ignore"):
            if time not in known:
                found[time] = rest_at(system, time)
    return found


def at_rest(
    boom: Boom, system: GapSystem, lines: Sequence[Line], time: float, position: Array
) -> AtRest:
    """What is told of a rest.

    Args:
        boom: with the play that the system has.
        system: of the model.
        lines: along its segments.
        time: whose loads act, and as far drawn out as it is then, in s.
        position: (num_modes,) of the rest.
    """
    system = system.standing(time)
    seen = {name: float(one.row @ position) for name, one in system.observers.items()}
    stations = list(pressed(boom, system, position))
    return AtRest(
        time=time,
        tip=seen["tip"],
        tip_lateral=seen.get("tip_lateral"),
        diagrams=[
            _diagram(boom, number, line, position, time) for number, line in enumerate(lines)
        ],
        tilts=list(tilts(boom, system, position, time)),
        stations=stations,
        cylinders={name: seen[name] for name in forces(boom)},
    )


def _diagram(boom: Boom, number: int, line: Line, position: Array, time: float) -> Diagram:
    carried = section_forces(boom, number, line, position, np.array(time))
    curves: dict[str, list[float]] = {name: rounded(values) for name, values in carried.items()}
    return Diagram(boom.segments[number].name, rounded(line.x), curves.pop("normal"), curves)


def pressed(boom: Boom, system: GapSystem, position: Array) -> Iterator[Pressed]:
    """Of the stations of joints with play, in z and in y, and of stops, at (num_modes,)."""
    gaps = system.rows @ position
    joints = [
        joint
        for _ in boom.directions
        for joint in boom.joints
        if not joint.tied
        for _ in joint.stations
    ] + [None for _ in boom.stops]
    names = place_names(boom.stations)
    for k, ((x, direction), name, joint) in enumerate(
        zip(boom.stations, names, joints, strict=True)
    ):
        here = np.flatnonzero(system.station_of_row == k)
        sides = [
            sum(_one_sided(system.laws[row], side, gaps[row]) for row in here) for side in _SIGNS
        ]
        yield Pressed(
            place=name,
            x=x,
            direction=direction,
            force=sides[0] - sides[1],
            pad=None if joint is None else _of_a_pad(joint, direction, sides),
            # A tied model has stations, and no rows there.
            depth=max((system.laws[row].depth(float(gaps[row])) for row in here), default=0.0),
        )


def _of_a_pad(joint: Joint, direction: Direction, sides: Sequence[float]) -> float | None:
    """The most in N that one pad bears where they bear so much on both sides; None without pads."""
    if not joint.padded:
        return None
    pairs = (_hardest(joint, direction, *of) for of in zip(_SIGNS, sides, strict=True))
    return max(pairs) / PADS_OF_SIDE


def _hardest(joint: Joint, direction: Direction, side: Side, force: float) -> float:
    """What bears most in N of the pairs of a side, of which those with more shim press first."""
    pairs = sorted(joint.pads_of(direction, side), key=lambda pair: -pair[2])
    shares, shims = (np.array([pair[k] for pair in pairs]) for k in (1, 2))
    own = [pad.stiffness for pad in joint.pads if pad.touches(direction, side)]
    stiffness = PADS_OF_SIDE * sum(own) or 1.0
    # Each further pair that presses leaves less way to those before it.
    ways = (force / stiffness - np.cumsum(shares * shims)) / np.cumsum(shares)
    return float(stiffness * (shares * (ways.min() + shims)).max())


def _one_sided(law: ContactLaw, side: int, gap: float) -> float:
    """What a contact bears on a side in N, not negative."""
    there = law.one_sided(side)
    return 0.0 if there is None else float(abs(there.force(np.array(gap))))


def tilts(boom: Boom, system: GapSystem, position: Array, time: float = 0.0) -> Iterator[Tilt]:
    """Of the joints with play and two stations at least, at a rest (num_modes,) at a time in s."""
    gaps, numbers = system.rows @ position, count()
    for joint in (joint for joint in boom.joints if not joint.tied):
        of_station = [
            float(gaps[system.station_of_row == next(numbers)].mean()) for _ in joint.stations
        ]
        if len(joint.stations) > 1:
            yield _tilt(boom, joint, of_station, time)


def _tilt(boom: Boom, joint: Joint, gaps: Sequence[float], time: float) -> Tilt:
    way = drawn(boom, joint.inner, time) - drawn(boom, joint.outer, time)
    on_outer = [x for x, _ in places(joint, way)] if joint.drive else joint.stations
    first, last = on_outer[0], on_outer[-1]
    tip = boom.tip + drawn(boom, len(boom.segments) - 1, time) - drawn(boom, joint.outer, time)
    rotation = (gaps[-1] - gaps[0]) / (last - first)
    inner, outer = (boom.segments[number].name for number in (joint.inner, joint.outer))
    return Tilt(inner, outer, rotation, gaps[0] + rotation * (tip - first))
