# SPDX-License-Identifier: LGPL-3.0-or-later
"""Values of all quantities of :data:`.analysis.quantities.MEASURED` over states.

The states may be static or those of a motion, of a beam or of a shell, with play or without.
Section forces act on the part nearer the base. A positive normal force is tension. A positive
moment causes tension at the top, a positive lateral moment tension at larger y.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from protractile.analysis.model import AnalysisModel
from protractile.analysis.pads import largest_force, loaded_pads, pad_forces, side_force
from protractile.analysis.states import States
from protractile.analysis.stresses import Fibres
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import LineQuantity
from protractile.geometry.arrays import Array, Indices
from protractile.geometry.axial import foot_thrust
from protractile.geometry.boom import Boom, Segment
from protractile.geometry.contact_places import ContactPair, contact_centres, pads
from protractile.geometry.ground import difference_name, force_name
from protractile.geometry.joint import PADS_OF_SIDE, Joint, Pad
from protractile.geometry.section import EACH_SIDE, Direction
from protractile.geometry.station import Station
from protractile.geometry.telescoping import station_positions, travel

if TYPE_CHECKING:
    import xarray as xr


class Measured(NamedTuple):
    """Values of a quantity at places of a part, over states."""

    quantity: str  #: name of the quantity
    part: str  #: part of the boom
    place: str  #: place within the part
    values: Array  #: values (num_states, num_places) in SI units
    time: Array | None  #: times (num_states,) in s; None if the time is unknown
    #: x, y and z (num_places,) in m; None where a value has no such position
    places: tuple[Array | None, Array | None, Array | None] = (None, None, None)
    limit: float | None = None  #: permitted value in SI units


def _single(
    quantity: str,
    part: str,
    values: Array,
    time: Array | None,
    x: float | None = None,
    place: str = "",
    limit: float | None = None,
) -> Measured:
    """Return a quantity with one place from its values (num_states,)."""
    at = None if x is None else np.array([x])
    return Measured(quantity, part, place, values[:, None], time, (at, None, None), limit)


class _Plane(NamedTuple):
    """Names of section forces and of their quantities in a plane of bending."""

    direction: Direction
    lateral: str
    shear: LineQuantity
    moment: LineQuantity


_PLANES = (
    _Plane("z", "", "shear", "moment"),
    _Plane("y", "lateral_", "lateral_shear", "lateral_moment"),
)


def measure(states: States) -> Iterator[Measured]:
    """Yield every quantity that the model has, at each of its places."""
    yield from measure_boom(states)
    for number in range(len(states.boom.segments)):
        yield from measure_segment(states, number, states.section_forces(number))


def measure_boom(states: States) -> Iterator[Measured]:
    """Yield deflections of the tip, forces of cylinders and ropes, contacts, pads, rotations."""
    boom, time = states.boom, states.time
    for name in ("tip", "tip_lateral"):
        if name in states.model.system.observers:
            yield _single(name, "tip", states.observed(name), time, boom.tip)
    for number, cylinder in enumerate(boom.cylinders, start=1):
        part = "cylinder" if len(boom.cylinders) == 1 else f"cylinder {number}"
        force, at = states.observed(force_name(number)), (time, cylinder.x)
        # A cylinder that pulls has another resistance than one that pushes.
        limits = cylinder.resistance(), cylinder.resistance(pulls=True)
        if cylinder.spread == 0.0:
            forces = np.maximum(force, 0.0), np.minimum(force, 0.0)
            for values, limit in zip(forces, limits, strict=True):
                yield _single("cylinder_force", part, values, *at, limit=limit)
            continue
        apart = states.observed(difference_name(number))
        yield _single("cylinder_force", part, force, *at)
        yield _single("cylinder_force_difference", part, apart, *at)
        for sign, limit in zip((1.0, -1.0), limits, strict=True):
            larger = np.maximum(0.5 * (sign * force + np.abs(apart)), 0.0)
            yield _single("larger_cylinder_force", part, larger, *at, limit=limit and 0.5 * limit)
    if (data := states.recorded) is not None:
        if "rope_force_peak" in data:
            yield _single("rope_force", "rope", data["rope_force_peak"].values, time)
        yield from _recorded_contacts(states, data)
    else:
        yield from _static_contacts(states)
        yield from _rotations(states)


def station_label(boom: Boom, station: Station) -> tuple[str, str]:
    """Return the part of a station, and its place, which does not depend on the extension.

    A segment in several others counts the stations of all its joints.
    """
    name = boom.segments[station.segment].name
    if station.joint is None:
        return name, f"stop {station.number + 1}"
    before = (joint for joint in boom.joints[: station.number] if joint.inner == station.segment)
    number = 1 + station.place + sum(len(joint.stations) for joint in before)
    return name, f"station {number}{', lateral' if station.direction == 'y' else ''}"


def _recorded_contacts(states: States, data: xr.Dataset) -> Iterator[Measured]:
    """Yield forces of contacts and pads in motion: means and maxima over output intervals."""
    boom, system, contacts = states.boom, states.model.system, pads(states.boom)
    time, peaks = data["time"].values, data["contact_force_peak"].values
    for station in boom.stations:
        part, place = station_label(boom, station)
        force = data["contact_force"].values[:, station.index]
        yield _single("contact_force", part, force, time, station.x, place)
        here = np.flatnonzero(system.station_of_row == station.index)
        loaded: Iterable[tuple[Pad, str, Array]] = ()
        if (pairs := _own_rows(contacts, station, here)) and states.row_peaks.size:
            of_rows = np.abs(states.row_peaks[here])
            loaded = pad_forces(station, pairs, of_rows[:, None])
        elif station.joint is not None and station.joint.pad is not None:
            # A law that acts on both sides gives the net force.
            net = any(len({term.side for term in system.laws[row].terms}) > 1 for row in here)
            ends = np.array([peaks[:, station.index].min(), peaks[:, station.index].max()])
            name, both = largest_force(station, ends, net)
            loaded = [(station.joint.pad, name, np.array([both / PADS_OF_SIDE]))]
        for pad, name, force in loaded:
            yield from _pad(part, f"{place}, {name}", station.x, force, pad, None)


def _own_rows(
    contacts: Sequence[ContactPair], station: Station, rows: Indices
) -> list[ContactPair]:
    """Return the contact pairs of a station with pads; none if they have no rows of their own."""
    pairs = [
        pair
        for pair in contacts
        if pair.station.index == station.index
        and pair.joint.padded
        and pair.side
        and station.law.one_sided(pair.side) is not None
    ]
    return pairs if len(pairs) == rows.size else []


def _pad(
    part: str, place: str, x: float, force: Array, pad: Pad, time: Array | None
) -> Iterator[Measured]:
    """Yield force and pressure of a pad from its force (num_states,) in N."""
    yield _single("pad_force", part, force, time, x, place)
    yield _single("pad_pressure", part, force / pad.area, time, x, place, pad.allowable_pressure)


def _static_contacts(states: States) -> Iterator[Measured]:
    """Yield forces, penetrations and pads of stations with play, and of stops."""
    boom, system, time = states.boom, states.model.system, states.time
    systems, gaps = [system] * time.size, states.positions @ system.rows.T
    if system.travels:
        systems = [system.at_time(at) for at in time.tolist()]
        at_times = zip(systems, states.positions, strict=True)
        gaps = np.array([there.rows @ position for there, position in at_times])
    contacts = pads(boom)
    for station in boom.stations:
        # The stations of a model without play have no contacts.
        here = np.flatnonzero(system.station_of_row == station.index)
        sides = [_on_side(systems, side, gaps, here) for side in EACH_SIDE]
        part, place = station_label(boom, station)
        yield _single("contact_force", part, sides[0] - sides[1], time, station.x, place)
        penetrations = [
            [there.laws[row].penetration(gap[row]) for row in here]
            for there, gap in zip(systems, gaps, strict=True)
        ]
        deepest = np.array(penetrations).reshape(time.size, -1).max(axis=1, initial=0.0)
        yield _single("penetration", part, deepest, time, station.x, place)
        if station.direction == "y" and station.joint is not None:
            closed, play = _closed_play(system, gaps, here)
            limit = play if play > 0.0 else None
            yield _single("closed_play", part, closed, time, station.x, place, limit=limit)
        loaded = loaded_pads(station, sides)
        if pairs := _own_rows(contacts, station, here):
            forces_of_pairs = [
                _on_side(systems, pair.side, gaps, here[k : k + 1]) for k, pair in enumerate(pairs)
            ]
            loaded = pad_forces(station, pairs, forces_of_pairs)
        for pad, name, force in loaded:
            yield from _pad(part, f"{place}, {name}", station.x, force, pad, time)


def _on_side(systems: list[GapSystem], side: int, gaps: Array, rows: Indices) -> Array:
    """Return the contact force (num_states,) in N of rows on one side, in compression."""
    if all(system is systems[0] for system in systems):
        parts = (side_force(systems[0].laws[row], side, gaps[:, row]) for row in rows)
        return sum(parts, np.zeros(len(gaps)))
    return np.array(
        [
            sum(float(side_force(system.laws[row], side, gap[row])) for row in rows)
            for system, gap in zip(systems, gaps, strict=True)
        ]
    )


def _closed_play(system: GapSystem, gaps: Array, rows: Indices) -> tuple[Array, float]:
    """Return the play (num_states,) in m that bulging walls close, and the play between pads.

    It is the approach on the right less that on the left, at the corner or point where most is
    closed: a wall that bulges beside loaded pads bends inwards at its other edge.
    """
    laws = system.laws
    right, left = (
        [row for row in rows if np.isfinite(laws[row].onset(side))] for side in EACH_SIDE
    )
    if not (right and left):
        return np.zeros(len(gaps)), 0.0
    onsets = np.array([[min(law.onset(side) for side in EACH_SIDE) for law in laws]])
    # A corner may have other pads on the right than on the left.
    corners = np.gcd(len(right), len(left))

    def at_corners(values: Array, side: list[int]) -> Array:
        parts = values[:, side].reshape(len(values), corners, -1)
        return np.asarray(parts.mean(axis=2))

    closed = at_corners(gaps, right) - at_corners(gaps, left)
    play = at_corners(onsets, right) + at_corners(onsets, left)
    return closed.max(axis=1), float(play.min())


def _rotations(states: States) -> Iterator[Measured]:
    """Yield the rotation of each joint with play and several stations in its outer segment.

    Play, the compression of contacts and walls that bend cause it. It is positive for a larger
    slope. The deflection of the tip by it follows.
    """
    boom = states.boom
    for joint in (joint for joint in boom.joints if not joint.bonded and len(joint.stations) > 1):
        inner, outer = (boom.segments[number].name for number in (joint.inner, joint.outer))
        both = np.array(
            [
                _rotation(states.model, joint, time, position)
                for time, position in zip(states.time.tolist(), states.positions, strict=True)
            ]
        )
        for name, values in zip(("rotation", "rotation_tip"), both.T, strict=True):
            yield _single(name, inner, values, states.time, place=f"in {outer}")


def _rotation(
    model: AnalysisModel, joint: Joint, time: float, position: Array
) -> tuple[float, float]:
    """Return the rotation of a joint in rad, and the deflection of the tip by it in m."""
    boom = model.boom
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
        inner = model.deflection(joint.inner, x_inner + offset, position)
        displacements.append(inner - model.deflection(joint.outer, on_outer[-1], position))
    tip = boom.tip + travel(boom, len(boom.segments) - 1, time) - before
    angle = (displacements[-1] - displacements[0]) / (on_outer[-1] - on_outer[0])
    return angle, displacements[0] + angle * (tip - on_outer[0])


def measure_segment(
    states: States, number: int, curves: Mapping[LineQuantity, Array]
) -> Iterator[Measured]:
    """Yield moments, reactions and stresses of a segment.

    ``curves`` are its section forces (num_states, num_places). Stresses come as one quantity for
    each outer fibre.
    """
    model, time = states.model, states.time
    segment, line = states.boom.segments[number], model.lines[number]
    for plane in _PLANES:
        if plane.moment in curves:
            at = line.x, None, None
            name = f"{plane.lateral}bending_moment"
            yield Measured(name, segment.name, "", curves[plane.moment], time, at)
    if "moment" in curves and not model.smooth:
        yield from _reactions(states, number)
    if (fibres := Fibres.of(segment, line)) is not None:
        for fibre in range(len(fibres.z)):
            at = fibres.x, fibres.y[fibre], fibres.z[fibre]
            stress = fibres.stress(fibre, curves)
            strength = float(fibres.strengths[fibre])
            limit = segment.yield_strength if np.isnan(strength) else strength
            yield Measured("stress", segment.name, "", stress, time, at, limit)


def _reactions(states: States, number: int) -> Iterator[Measured]:
    """Yield the support reactions of a segment, from jumps of its section forces."""
    boom, line, time = states.boom, states.model.lines[number], states.time

    def jump(name: LineQuantity, x: float) -> Array:
        if name not in line.rows:
            return np.zeros(time.size)
        row = line.one_sided_row(name, x, -1) - line.one_sided_row(name, x, 1)
        return np.asarray(states.positions[:, : row.size] @ row)

    segment: Segment = boom.segments[number]
    for support in segment.supports:
        at = time, support.x, f"at {support.x:g} m"
        across = []
        for plane in _PLANES:
            if plane.shear not in line.rows:
                continue
            across.append(jump(plane.shear, support.x))
            yield _single(f"{plane.lateral}reaction", segment.name, across[-1], *at)
            if support.holds_slope(plane.direction) or support.rotation_stiffness:
                # Positive towards a larger slope.
                held = -jump(plane.moment, support.x)
                yield _single(f"{plane.lateral}support_moment", segment.name, held, *at)
        if "torque" in line.rows:
            yield _single("support_torque", segment.name, jump("torque", support.x), *at)
        if support is not segment.foot:
            continue
        thrust = foot_thrust(boom.segments, boom.joints, number, time, boom.axial_changes)
        along = jump("normal", support.x) + thrust
        if segment.compression or "normal" in line.rows:
            yield _single("axial_reaction", segment.name, along, *at)
        whole = np.linalg.norm([*across, along], axis=0)
        yield _single("foot_reaction", segment.name, whole, *at)


def measure_walls(boom: Boom, stresses: xr.Dataset) -> Iterator[Measured]:
    """Yield the von Mises stresses of a shell near stations and supports, by segment.

    ``wall_stress`` is the mean over a patch, which converges with the mesh; ``triangle_stress`` is
    that of a triangle, which may grow with it. ``stresses`` are those of
    :func:`.shell_model.stress.history.stress_near_places`.
    """
    time, at = stresses["time"].values, (stresses["place"].values, None, None)
    for segment in boom.segments:
        of_segment = stresses.sel(segment=segment.name)
        patches, triangles = (
            np.nan_to_num(of_segment[name].values) for name in ("von_mises_patch", "von_mises")
        )
        if patches.any():
            name, strength = segment.name, segment.yield_strength
            yield Measured("wall_stress", name, "", patches, time, at, strength)
            yield Measured("triangle_stress", name, "", triangles, time, at)
