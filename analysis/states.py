# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states of a model at the instants of extreme loads.

Section forces act on the part nearer the base. A positive normal force is tension. A positive
moment causes tension at the top, a positive lateral moment tension at larger y.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import Any

import numpy as np

from protractile.analysis.model import AnalysisModel, round_values
from protractile.analysis.pads import loaded_pads, side_force
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line, Quantity
from protractile.geometry.arrays import Array, Indices
from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import contact_centres
from protractile.geometry.cylinder import forces
from protractile.geometry.section import EACH_SIDE
from protractile.geometry.telescoping import station_positions, travel


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


def static_results(model: AnalysisModel, times: Array, states: Array) -> list[StaticResult]:
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


def tilts(model: AnalysisModel, states: Array, time: float = 0.0) -> list[list[Tilt]]:
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
