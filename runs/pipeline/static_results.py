# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states of a model at the instants of extreme loads.

Section forces act on the part nearer the base. A positive normal force is tension. A positive
moment causes tension at the top, a positive lateral moment tension at larger y.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import repeat
from typing import Any

import numpy as np

from protractile.dynamics.equilibrium import Equilibria
from protractile.dynamics.excitation import Excitation
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line, Quantity
from protractile.dynamics.travel import Travel
from protractile.geometry.arrays import Array, Indices
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import contact_centres
from protractile.geometry.cylinder import forces
from protractile.geometry.section import EACH_SIDE
from protractile.geometry.telescoping import station_positions, travel
from protractile.runs.case.motion_tables import resolving_times
from protractile.runs.pipeline.pads import loaded_pads, side_force
from protractile.runs.pipeline.section_forces import LoadedModel, round_values

# Extensions that differ by less than this fraction count as equal.
_SAME_EXTENSION = 1.0e-12
# Fraction of a contact row below which its part of the boom is round-off.
_ROUND_OFF = 1.0e-9


@dataclass(frozen=True, slots=True)
class Diagram:
    """Static section forces and deflections of a segment, from its start to its end."""

    segment: str  #: name of the segment
    x: list[float]  #: positions (num_places) in m; a position with a jump occurs twice
    normal: list[float]  #: normal force in N
    #: other available quantities of :data:`.dynamics.line.Quantity`: ``deflection`` in m, ``shear``
    #: in N, ``moment`` in N·m; in space ``lateral`` in m, ``twist`` in rad, ``lateral_shear``,
    #: ``lateral_moment``, ``torque``
    curves: dict[str, list[float]]


@dataclass(frozen=True, slots=True)
class Tilt:
    """Rotation of a joint by its play, the compression of its contacts, and walls that bend."""

    inner: str  #: name of the inner segment
    outer: str  #: name of the outer segment
    #: rotation in rad of the inner segment in the outer one, positive for a larger slope
    rotation: float
    tip: float  #: tip displacement in m by this rotation


@dataclass(frozen=True, slots=True)
class StationLoad:
    """Static contact force and compression of a station."""

    place: str  #: name of the station in trajectories
    x: float  #: position in m
    direction: str  #: z or y
    #: force in N, positive if the inner segment presses up (along y, towards larger y)
    force: float
    #: largest force on a pad of the station in N, not negative; stiffness and shims determine the
    #: distribution over the pads of a side. None without pads.
    pad: float | None
    depth: float  #: largest compression of a contact of the station in m
    #: largest pressure on a pad of the station in Pa; None without pads
    pressure: float | None = None
    #: largest utilisation of the allowable pressure; None without such a pressure
    utilisation: float | None = None
    #: part of the lateral play in m that bulging walls close, negative if they open it; 0 along z,
    #: and for beams
    closed: float = 0.0


@dataclass(frozen=True, slots=True)
class StaticResult:
    """Static state of a model."""

    time: float  #: time in s of the loads and of the extension
    tip: float  #: tip deflection in m
    tip_lateral: float | None  #: tip deflection along y in m, in space
    diagrams: list[Diagram]  #: diagram of each segment
    tilts: list[Tilt]  #: rotations of the joints with play and at least two stations
    stations: list[StationLoad]  #: loads of stations with play, and of stops
    cylinders: dict[str, float]  #: axial forces of cylinders in N, by their names in the results


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


def positions(system: GapSystem, times: Sequence[float] = (0.0,)) -> dict[float, Array]:
    """Return the equilibria (num_modes,) under the loads at given times, by time in s.

    Times without an equilibrium are left out. The result is empty if the first has none. The
    ``load`` of the system includes all constant loads.
    """
    first = _equilibria(system, times[:1])
    return first | _equilibria(system, times[1:]) if first else {}


def vibrating_state(
    system: GapSystem, equilibria: Mapping[float, Array]
) -> tuple[GapSystem, Array]:
    """Return the system at rest and the equilibrium (num_modes,) about which the boom vibrates.

    A load that is released at t = 0 no longer acts. ``equilibria`` are those of :func:`positions`.
    """
    released = system.released_load.any()
    after = min((time for time in equilibria if time > 0.0 or not released), default=0.0)
    return system.at_time(after), equilibria[after]


def vibrating_system(system: GapSystem, duration: float) -> tuple[GapSystem, Array] | None:
    """Return the state of :func:`vibrating_state`; None without an equilibrium at t = 0.

    The ``load`` of the system includes all constant loads. ``duration`` is that of the motion in s.
    """
    released = system.released_load.any()
    equilibria = positions(system, instants(system, duration) if released else [0.0])
    return vibrating_state(system, equilibria) if equilibria else None


def extended_positions(system: GapSystem, duration: float) -> dict[float, Array]:
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


def static_results(model: LoadedModel, times: Array, states: Array) -> list[StaticResult]:
    """Return each state of a model, at an equilibrium or at an instant of its motion.

    Args:
        times: times (num_states,) in s of the loads and of the extensions.
        states: modal coordinates (num_states, num_modes).
    """
    boom, system = model.boom, model.system
    if system.travels:
        if times.size > 1:
            steps = (slice(step, step + 1) for step in range(times.size))
            return [
                one for step in steps for one in static_results(model, times[step], states[step])
            ]
        system = system.at_time(float(times[0]))
    diagrams = [
        _diagrams(boom.segments[number].name, line, model.section_forces(number, states, times))
        for number, line in enumerate(model.lines)
    ]
    seen = {name: (states @ one.row).tolist() for name, one in system.observers.items()}
    rotations = tilts(model, states, float(times[0]))
    stations = station_loads(boom, system, states)
    return [
        StaticResult(
            time=time,
            tip=seen["tip"][step],
            tip_lateral=seen["tip_lateral"][step] if "tip_lateral" in seen else None,
            diagrams=[of_states[step] for of_states in diagrams],
            tilts=[of_states[step] for of_states in rotations],
            stations=stations[step],
            cylinders={name: seen[name][step] for name in forces(boom)},
        )
        for step, time in enumerate(times.tolist())
    ]


def _diagrams(segment: str, line: Line, carried: Mapping[Quantity, Array]) -> list[Diagram]:
    """Return the diagram of a segment in each state from curves (num_states, num_places)."""
    x, diagrams = round_values(line.x), []
    for of_state in zip(*carried.values(), strict=True):
        curves: dict[str, list[float]] = {
            name: round_values(values) for name, values in zip(carried, of_state, strict=True)
        }
        diagrams.append(Diagram(segment, x, curves.pop("normal"), curves))
    return diagrams


def station_loads(boom: Boom, system: GapSystem, states: Array) -> list[list[StationLoad]]:
    """Return the loads of stations with play and of stops, in each state.

    ``states`` are equilibria (num_states, num_modes).
    """
    gaps, loads = states @ system.rows.T, list[list[StationLoad]]()
    for station in boom.stations:
        # The stations of a model without play have no contacts.
        here = np.flatnonzero(system.station_of_row == station.index)
        none = np.zeros(len(gaps))
        sides = [
            sum((side_force(system.laws[row], side, gaps[:, row]) for row in here), none)
            for side in EACH_SIDE
        ]
        pads = loaded_pads(station, sides)
        used = [
            force / pad.area / pad.allowable_pressure
            for pad, force in pads
            if pad.allowable_pressure is not None
        ]
        columns = (
            (sides[0] - sides[1]).tolist(),
            _largest([force for _, force in pads]),
            _largest([none, *(system.laws[row].depth(gaps[:, row]) for row in here)]),
            _largest([force / pad.area for pad, force in pads]),
            _largest(used),
            (_closed_play(system, gaps, here) if station.direction == "y" else none).tolist(),
        )
        place = station.name, station.x, station.direction
        loads.append([StationLoad(*place, *values) for values in zip(*columns, strict=False)])
    return [list(of_state) for of_state in zip(*loads, strict=True)] or [[] for _ in states]


def _largest(values: Sequence[Array]) -> Iterable[Any]:
    """Return the largest of the values (num_states,) in each state; None without values."""
    return np.max(values, axis=0).tolist() if values else repeat(None)


def _closed_play(system: GapSystem, gaps: Array, rows: Indices) -> Array:
    """Return the play (num_states,) in m that bulging walls close.

    It is the mean approach on the right less that on the left.
    """
    right, left = (
        [row for row in rows if np.isfinite(system.laws[row].onset(side))] for side in EACH_SIDE
    )
    if not (right and left):
        return np.zeros(len(gaps))
    return np.asarray(gaps[:, right].mean(axis=1) - gaps[:, left].mean(axis=1))


def tilts(model: LoadedModel, states: Array, time: float = 0.0) -> list[list[Tilt]]:
    """Return the rotation of each joint with play and several stations, in each state.

    The equilibria are (num_states, num_modes), and the extension the one at a time in s.
    """
    boom, axes, rotations = model.boom, model.axes, []
    for joint in (joint for joint in boom.joints if not joint.bonded and len(joint.stations) > 1):
        before = travel(boom, joint.outer, time)
        extension = travel(boom, joint.inner, time) - before
        places = [(x, x) for x in joint.stations]
        if joint.drive:
            places = station_positions(joint, extension)
        # The resultant force of a pad acts at its centre.
        centres = contact_centres(boom, joint)
        offsets = [sum(at) / len(at) - x for at, x in zip(centres, joint.stations, strict=True)]
        on_outer, displacements = [], []
        for (x_outer, x_inner), offset in zip(places, offsets, strict=True):
            on_outer.append(x_outer + offset)
            relative = axes[joint.inner](x_inner + offset) - axes[joint.outer](x_outer + offset)
            displacements.append(states[:, : relative.size] @ relative)
        tip = boom.tip + travel(boom, len(boom.segments) - 1, time) - before
        angles = (displacements[-1] - displacements[0]) / (on_outer[-1] - on_outer[0])
        tips = displacements[0] + angles * (tip - on_outer[0])
        inner, outer = (boom.segments[number].name for number in (joint.inner, joint.outer))
        both = zip(angles.tolist(), tips.tolist(), strict=True)
        rotations.append([Tilt(inner, outer, *values) for values in both])
    return rotations
