# SPDX-License-Identifier: LGPL-3.0-or-later
"""Actions on the boom of a case: loads, weights, axial forces and ground accelerations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from functools import partial
from math import cos, radians, sin
from typing import Any, NamedTuple

import numpy as np
from pydantic import ValidationError

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import History, InitialImpulse, ReleasedLoad, Step
from protractile.geometry.arrays import Array
from protractile.geometry.axial import Lead, Thrust, with_compression
from protractile.geometry.boom import Boom, BoomError, Direction, Joint, Segment, Stop
from protractile.geometry.fields import check_kind, check_numbers, describe, error_in_python
from protractile.geometry.head import Head, Sheave
from protractile.geometry.joint import BareStop
from protractile.geometry.load import AngularAcceleration, Load, Moment, PartialLoad
from protractile.geometry.place import Distance, at, resolve_level, resolve_segments
from protractile.geometry.section import COMPONENT
from protractile.geometry.segment import SAME_PLACE
from protractile.geometry.typography import choices
from protractile.geometry.wind import wind_direction, wind_loads
from protractile.runs.case.load_tables import (
    Group,
    LoadTable,
    RopeTable,
    WindPressureTable,
    build_history,
)
from protractile.runs.case.schema import Case, GravityTable, VelocityTable
from protractile.runs.case.sections import SegmentTable

STANDARD_GRAVITY = 9.80665


def loads(case: Case, segments: Sequence[Segment], joints: Sequence[Joint]) -> Iterator[Load]:
    """Yield all loads across the boom: weights, applied and released loads, and impulses.

    Released loads and impulses determine the state at t = 0.

    Raises:
        BoomError: a segment or section is unknown, or a history, the head or the wind is invalid.
    """
    gravity = case.gravity
    for number, table in case.loads_of_segments:
        yield _load(f"load[{number}]", table)
    for force in oblique_forces(case, segments):
        yield from force.loads()
    last, end, extra = len(segments) - 1, segments[-1].end, _extra_weight(case)
    if extra:
        up = -1.0 if gravity is None else -gravity.cosine
        yield Load(last, "z", extra * up, end, Step())
    yield from head_moments(case, segments)
    if case.wind is not None:
        yield from wind(case, case.wind, segments, joints)
    if gravity is not None:
        yield from _inertia_loads(-gravity.across, "z", Step(), segments)
        if case.hoist is not None and case.hoist.dropped:
            weight = -case.hoist.mass * gravity.across
            yield Load(last, "z", weight, end, ReleasedLoad())
    for number, base in enumerate(case.base, start=1):
        history = build_history(f"base[{number}]", base)
        yield from _inertia_loads(-base.acceleration, base.direction, history, segments)
    for name, velocity in case.start.velocity.items():
        index = segment_index("start.velocity", name, segments)
        yield from _initial_momentum(index, velocity, segments[index])


def _initial_momentum(index: int, velocity: VelocityTable, segment: Segment) -> Iterator[Load]:
    """Yield the impulses that give a segment its rigid-body velocity at t = 0."""
    x0 = segment.start if velocity.x is None else at(velocity.x, segment.start, segment.end)
    planes: tuple[tuple[Direction, float, float], ...] = (
        ("z", velocity.z, velocity.turn),
        ("y", velocity.y, velocity.lateral_turn),
    )
    impulse = InitialImpulse()
    for direction, speed, turn in planes:
        if speed or turn:
            momentum = (speed - turn * x0) * segment.mass_per_length
            yield Load(index, direction, momentum, None, impulse, inertial=True)
            for point in segment.masses:
                momentum = (speed + turn * (point.x - x0)) * point.mass
                yield Load(index, direction, momentum, point.x, impulse)
        if turn:
            yield AngularAcceleration(index, direction, turn, None, impulse)


def _inertia_loads(
    acceleration: float, direction: Direction, history: History, segments: Sequence[Segment]
) -> Iterator[Load]:
    """Yield loads on all masses, each the mass times an acceleration in m/s²."""
    for index, segment in enumerate(segments):
        force = acceleration * segment.mass_per_length
        yield Load(index, direction, force, None, history, inertial=True)
        for point in segment.masses:
            yield Load(index, direction, acceleration * point.mass, point.x, history)


def with_weight(
    boom: Boom,
    angle: float = 0.0,
    acceleration: float = STANDARD_GRAVITY,
    thrusts: Sequence[Thrust] = (),
) -> Boom:
    """Return the boom with the weight of all masses, across and along the boom, from t = 0 on.

    >>> upright = pt.with_weight(boom, angle=90.0, acceleration=10.0)
    >>> foot = upright.segments[0].compression.ends[0][0]
    >>> round(foot / sum(segment.mass for segment in boom.segments), 6)
    10.0

    Args:
        boom: the boom without weight.
        angle: luffing angle in degrees, positive where the tip is up.
        acceleration: acceleration of gravity in m/s².
        thrusts: other axial forces, such as the force of a hoist rope.

    Raises:
        BoomError: the boom has axial forces or its weight already, or a segment is unknown.
    """
    check_kind("with_weight.boom", boom, Boom)
    if any(segment.compression for segment in boom.segments):
        raise BoomError("boom", "has axial forces already; give all of them as thrusts at once")
    if any(load.inertial and load.history == Step() for load in boom.loads):
        raise BoomError("boom", "has its weight already; give it once")
    check_numbers("with_weight", angle=angle, acceleration=acceleration)
    try:
        gravity = GravityTable(acceleration=float(acceleration), angle=float(angle))
    except ValidationError as error:
        raise error_in_python(GravityTable, error) from None
    segments = with_compression(boom.segments, boom.joints, thrusts, gravity.along)
    weights = _inertia_loads(-gravity.across, "z", Step(), segments)
    return replace(boom, segments=segments, loads=(*boom.loads, *weights))


def thrusts(case: Case, segments: Sequence[Segment]) -> Iterator[Thrust]:
    """Yield the axial forces of the tables ``axial``.

    Raises:
        BoomError: a segment is unknown, or a point is outside its segment.
    """
    for number, table in enumerate(case.axial, start=1):
        name = segments[-1].name if table.segment is None else table.segment
        thrust = _place_on(f"axial[{number}]", name, table.x, segments)
        yield replace(thrust, force=table.force)


def _place_on(where: str, name: str, x: Any, segments: Sequence[Segment]) -> Thrust:
    """Return a force of 0 N on a segment with a name, at its end without x."""
    place: Any = Distance(head=0.0) if x is None else x
    thrust = resolve_segments(Thrust(name, place, 0.0), where, segments)
    segments[thrust.segment].check_place(f"{where}.x", thrust.x)
    return thrust


def tip_thrusts(case: Case, segments: Sequence[Segment]) -> Iterator[Thrust]:
    """Yield the axial forces of weights at the tip, of wind, of oblique loads and of the rope."""
    last, end, gravity, hoist = len(segments) - 1, segments[-1].end, case.gravity, case.hoist
    if gravity is not None:
        hanging = gravity.acceleration * hoist.mass if hoist and hoist.hanging else 0.0
        yield Thrust(last, end, (_extra_weight(case) + hanging) * gravity.sine)
    blows = [] if case.wind is None else [wind_on_load(case, case.wind, segments)]
    for force in (*blows, *oblique_forces(case, segments)):
        if force.vector[0]:
            yield Thrust(force.segment, force.x, -float(force.vector[0]) * force.history.peak)


class ObliqueForce(NamedTuple):
    """A force at a place of the axis, or where the payload hangs."""

    segment: int  #: index of the segment
    x: float  #: x in m of the place, or of the end of the boom
    vector: Array  #: force (3,) in N along x, y and z
    history: History  #: its factor over time
    head: Head | None = None  #: its place ahead of, below and beside the axis; None on the axis

    def loads(self) -> Iterator[Load]:
        """Yield the loads across the boom, and the moments and the torque about its end."""
        axes: tuple[Direction, ...] = ("y", "z")
        for axis, part in zip(axes, self.vector[1:].tolist(), strict=True):
            if abs(part) > SAME_PLACE * np.linalg.norm(self.vector):
                yield Load(self.segment, axis, part, self.x, self.history)
        if self.head is not None:
            yield from self.head.moments(self.segment, self.x, self.vector, self.history)


def oblique_forces(case: Case, segments: Sequence[Segment]) -> Iterator[ObliqueForce]:
    """Yield the forces of oblique loads, and of the lead of the rope at t = 0.

    Raises:
        BoomError: a segment is unknown, a place is outside its segment, or a history is invalid.
    """
    for number, table in case.oblique_loads:
        where = f"load[{number}]"
        if isinstance(table.direction, str):
            unit = np.eye(3)[COMPONENT[table.direction]]
        else:
            unit = wind_direction(radians(table.direction), _luffing(case))
        force = table.magnitude * unit, build_history(where, table)
        if table.segment is None:
            yield _where_payload_hangs(case, segments, *force)
        else:
            at = _place_on(where, table.segment, table.x, segments)
            yield ObliqueForce(at.segment, at.x, *force)
    for lead in leads(case, segments):
        along, up = lead.components
        sheave = Head(lead.ahead, lead.below)
        yield ObliqueForce(lead.segment, lead.x, np.array([along, 0.0, up]), Step(), sheave)


def wind_on_load(case: Case, table: WindPressureTable, segments: Sequence[Segment]) -> ObliqueForce:
    """Return the force of the wind on the load at the tip, 0 without a load."""
    force = table.dynamic_pressure * table.load_area * table.load_shape_factor
    masses = [] if case.payload is None else [(case.payload.group, case.payload.mass)]
    if case.hoist is None and not in_wind(case, masses):
        force = 0.0
    unit = wind_direction(radians(table.direction), _luffing(case))
    return _where_payload_hangs(case, segments, force * unit, build_history("wind", table))


def in_wind(case: Case, masses: Sequence[tuple[Group, float]]) -> bool:
    """Return whether masses at the tip, each with its group, include a load for the wind.

    Dead masses on a rope are hook and rope. Without a rope they are a cage.
    """
    return any(mass for group, mass in masses if case.rope is None or group != "dead")


def _where_payload_hangs(
    case: Case, segments: Sequence[Segment], force: Array, history: History
) -> ObliqueForce:
    head = head_of(case)
    head = None if head is None else head.in_boom_axes(segments[-1], _luffing(case))
    return ObliqueForce(len(segments) - 1, segments[-1].end, force, history, head)


def head_of(case: Case) -> Head | None:
    """Return the head with the place of the load, that of the sheave unless the head gives one."""
    head, sheave = case.head or Head(), None if case.rope is None else case.rope.sheave
    if sheave is None or head.placed:
        return case.head
    return replace(head, ahead=sheave.ahead, below=sheave.below)


def leads(case: Case, segments: Sequence[Segment]) -> Iterator[Lead]:
    """Yield the lead of the hoist rope under the weights that hang on it at t = 0.

    Raises:
        BoomError: the number of falls is missing or given twice, nothing hangs on the rope, or the
            first segment has no foot.
    """
    weight, hoist = payload_weight(case), case.hoist
    if hoist is not None and case.gravity is not None and hoist.hanging:
        weight += case.gravity.acceleration * hoist.mass
    if weight:
        yield from lead_of(case, segments, weight)


def lead_of(case: Case, segments: Sequence[Segment], weight: float) -> Iterator[Lead]:
    """Yield the lead of the hoist rope, if there is one, under a weight in N on the hook.

    Raises:
        BoomError: as in :func:`leads`.
    """
    rope, hoist, foot = case.rope, case.hoist, segments[0].foot
    last, end = len(segments) - 1, segments[-1].end
    if rope is None:
        return
    if foot is None:
        raise BoomError("rope.winch", f"{segments[0].name!r} has no support to measure it from")
    if rope.falls is None and hoist is None:
        raise BoomError("rope.falls", f"missing; it is {describe(RopeTable, 'falls')}")
    if rope.falls is not None and hoist is not None and hoist.falls != 1:
        raise BoomError("rope.falls", "hoist.falls is given; leave one of them out")
    falls = rope.falls or (1 if hoist is None else hoist.falls)
    at_end = partial(segments[-1].surfaces, end)
    where = "rope.sheave" if rope.sheave or not case.head else "head"
    sheave = resolve_level(rope.sheave or case.head or Sheave(), where, at_end)
    lead = Lead(last, end, weight / falls, foot.x - rope.winch, 0.0, sheave.ahead, sheave.below)
    if rope.ground is None:
        yield lead
        return
    if case.luff is not None or (hoist is not None and (hoist.dropped or not hoist.hanging)):
        what = "the rope's lead across the boom is that at t = 0; leave luff or hoist out"
        raise BoomError("rope.ground", what)
    along, up = rope.ground.turned(_luffing(case))
    yield replace(lead, winch=foot.x + along, depth=foot.depth - up)


def payload_weight(case: Case) -> float:
    """Return the weight in N of the payload of a case."""
    payload = case.payload
    if payload is None:
        return 0.0
    if payload.gravity is not None:
        return payload.mass * payload.gravity
    return payload.mass * (STANDARD_GRAVITY if case.gravity is None else case.gravity.acceleration)


def _extra_weight(case: Case) -> float:
    """Return the weight in N of the payload beyond that by the table ``gravity``."""
    weighs = 0.0 if case.gravity is None else case.gravity.acceleration
    weight = payload_weight(case)
    extra = weight - (weighs * case.payload.mass if case.payload else 0.0)
    return extra if abs(extra) > SAME_PLACE * weight else 0.0


def _luffing(case: Case) -> float:
    """Return the luffing angle in rad."""
    return 0.0 if case.gravity is None else radians(case.gravity.angle)


def head_moments(case: Case, segments: Sequence[Segment]) -> Iterator[Load]:
    """Yield the moments of the weights of payload and head about the end of the last segment.

    Raises:
        BoomError: the head weighs nothing, or a hoisted load hangs beside the end.
    """
    if (head := head_of(case)) is None:
        return
    if case.hoist is not None and head.placed:
        what = "the load of hoist hangs at the end of the boom; leave ahead, below and beside out"
        raise BoomError("head" if case.head and case.head.placed else "rope.sheave", what)
    if case.gravity is None and head.mass:
        raise BoomError("head.mass", "nothing weighs without the table gravity; give it")
    own = 0.0 if case.gravity is None else case.gravity.acceleration * head.mass
    down = -np.array([sin(_luffing(case)), 0.0, cos(_luffing(case))])
    hung = _where_payload_hangs(case, segments, down, Step())
    assert hung.head is not None
    for weight, part in ((payload_weight(case), 1.0), (own, 0.5)):
        yield from hung.head.moments(hung.segment, hung.x, weight * down, Step(), part)


def wind(
    case: Case, table: WindPressureTable, segments: Sequence[Segment], joints: Sequence[Joint]
) -> Iterator[Load]:
    """Yield the wind loads across the boom.

    Raises:
        BoomError: there is not one shape factor, or one for each segment; the boom moves; a segment
            has no section; or the history is invalid.
    """
    if not table.dynamic_pressure:
        return
    table.demand("shape_factor")
    for key, moves in {"drive": case.driven_segments, "slew": case.slew, "luff": case.luff}.items():
        if moves:
            what = f"the wind acts on the boom as it stands at t = 0; leave wind or {key} out"
            raise BoomError("wind", what)
    factors = table.shape_factor * (len(segments) if len(table.shape_factor) == 1 else 1)
    if len(factors) != len(segments):
        what = f"must be one number, or one for each of {len(segments)} segments"
        raise BoomError("wind.shape_factor", f"{what}, got {len(factors)}")
    history = build_history("wind", table)
    direction = wind_direction(radians(table.direction), _luffing(case))
    pressure = table.dynamic_pressure
    yield from wind_loads(segments, joints, pressure, direction, factors, history)
    yield from wind_on_load(case, table, segments).loads()


def _load(where: str, table: LoadTable) -> Load:
    """Return the load of a table that is across its segment."""
    history: History | ReleasedLoad = build_history(where, table)
    if table.released and not isinstance(history, Step):
        raise BoomError(
            f"{where}.released",
            "a load that is let go has acted for ever, without a history; leave one of them out",
        )
    history = ReleasedLoad() if table.released else history
    direction: Any = table.direction
    arguments = table.segment, direction, table.magnitude, table.x, history
    if table.moment and table.x is None:
        raise BoomError(f"{where}.x", "missing; it is the x in m at which the moment acts")
    for key, bound in (("from", table.start), ("to", table.end)):
        if bound is not None and table.x is not None:
            raise BoomError(f"{where}.{key}", "x is given; leave one of them out")
    if table.moment:
        return Moment(*arguments)
    if table.start is None and table.end is None:
        return Load(*arguments)
    start: Any = Distance(tail=0.0) if table.start is None else table.start
    end: Any = Distance(head=0.0) if table.end is None else table.end
    return PartialLoad(*arguments, span=(start, end))


def stops(case: Case) -> Iterator[Stop]:
    """Yield the stops on the ground.

    Raises:
        BoomError: no segment can touch a stop.
    """
    for number, table in enumerate(case.stops, start=1):
        if table.stiffness == 0.0 and not table.stiffness_below:
            raise BoomError(
                f"stop[{number}].stiffness", "must be positive on one side at least, got 0 on both"
            )
        contact = PowerContact(
            table.stiffness, table.exponent, stiffness_below=table.stiffness_below
        )
        yield Stop(contact=contact, **field_values(table, BareStop))


def field_values(table: Any, part: type) -> dict[str, Any]:
    """Return the values that a table has for the fields of a dataclass, by name."""
    return {field.name: getattr(table, field.name) for field in fields(part)}


def segment_index(where: str, name: str, segments: Sequence[Segment | SegmentTable]) -> int:
    """Return the index of the segment with a name.

    Raises:
        BoomError: no segment has the name.
    """
    names = [segment.name for segment in segments]
    if name not in names:
        raise BoomError(where, f"{name!r} is no segment; give {choices(names)}")
    return names.index(name)
