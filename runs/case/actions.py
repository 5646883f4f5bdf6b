# SPDX-License-Identifier: LGPL-3.0-or-later
"""Actions on the boom of a case: loads, weights, axial forces and ground accelerations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from math import cos, radians, sin
from typing import Any

import numpy as np
from pydantic import ValidationError

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import History, InitialImpulse, ReleasedLoad, Step
from protractile.geometry.axial import Lead, Thrust, with_compression
from protractile.geometry.boom import Boom, BoomError, Direction, Joint, Segment, Stop
from protractile.geometry.fields import check_kind, check_numbers, describe, error_in_python
from protractile.geometry.head import Head
from protractile.geometry.joint import BareStop
from protractile.geometry.load import AngularAcceleration, Load, Moment, PartialLoad
from protractile.geometry.place import Distance, at, resolve_segments
from protractile.geometry.segment import SAME_PLACE
from protractile.geometry.typography import choices
from protractile.geometry.wind import wind_direction, wind_loads
from protractile.runs.case.load_tables import (
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
    for number, table in enumerate(case.loads, start=1):
        yield _load(f"load[{number}]", table)
    last, end, extra = len(segments) - 1, segments[-1].end, _extra_weight(case)
    if extra:
        up = -1.0 if gravity is None else -gravity.cosine
        yield Load(last, "z", extra * up, end, Step())
    if case.head is not None:
        yield from head_moments(case, case.head, last, end)
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
        where = f"axial[{number}]"
        name: Any = segments[-1].name if table.segment is None else table.segment
        place: Any = Distance(head=0.0) if table.x is None else table.x
        thrust = resolve_segments(Thrust(name, place, table.force), where, segments)
        segments[thrust.segment].check_place(f"{where}.x", thrust.x)
        yield thrust


def tip_thrusts(case: Case, segments: Sequence[Segment]) -> Iterator[Thrust]:
    """Yield the axial forces at the tip in addition to the weights of masses of the segments."""
    last, end, gravity, hoist = len(segments) - 1, segments[-1].end, case.gravity, case.hoist
    if gravity is not None:
        hanging = gravity.acceleration * hoist.mass if hoist and hoist.hanging else 0.0
        yield Thrust(last, end, (_extra_weight(case) + hanging) * gravity.sine)
    if case.wind is not None:
        along = wind_direction(radians(case.wind.direction), _luffing(case))[0]
        peak = build_history("wind", case.wind).peak
        force = peak * case.wind.load_area * case.wind.dynamic_pressure
        yield Thrust(last, end, -float(along) * force)
    for lead in leads(case, segments):
        yield Thrust(last, end, lead.force)


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
    if rope is None:
        return
    if foot is None:
        raise BoomError("rope.winch", f"{segments[0].name!r} has no support to measure it from")
    if rope.falls is None and hoist is None:
        raise BoomError("rope.falls", f"missing; it is {describe(RopeTable, 'falls')}")
    if rope.falls is not None and hoist is not None and hoist.falls != 1:
        raise BoomError("rope.falls", "hoist.falls is given; leave one of them out")
    falls = rope.falls or (1 if hoist is None else hoist.falls)
    yield Lead(len(segments) - 1, segments[-1].end, weight / falls, foot.x - rope.winch)


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


def head_moments(case: Case, head: Head, last: int, end: float) -> Iterator[Load]:
    """Yield the moments of the weights of payload and head about the end of the last segment.

    Raises:
        BoomError: the head weighs nothing, or a hoisted load hangs beside the end.
    """
    if case.hoist is not None and (head.ahead or head.below or head.beside):
        what = "the load of hoist hangs at the end of the boom; leave ahead, below and beside out"
        raise BoomError("head", what)
    if case.gravity is None and head.mass:
        raise BoomError("head.mass", "nothing weighs without the table gravity; give it")
    own = 0.0 if case.gravity is None else case.gravity.acceleration * head.mass
    down = -np.array([sin(_luffing(case)), 0.0, cos(_luffing(case))])
    for weight, part in ((payload_weight(case), 1.0), (own, 0.5)):
        yield from head.moments(last, end, weight * down, Step(), part)


def wind(
    case: Case, table: WindPressureTable, segments: Sequence[Segment], joints: Sequence[Joint]
) -> Iterator[Load]:
    """Yield the wind loads across the boom.

    Raises:
        BoomError: there is not one shape factor, or one for each segment; the boom moves; a segment
            has no section; or the history is invalid.
    """
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
    pressure, last = table.dynamic_pressure, len(segments) - 1
    yield from wind_loads(segments, joints, pressure, direction, factors, history)
    force = pressure * table.load_area * direction
    axes: tuple[Direction, ...] = ("y", "z")
    for axis, component in zip(axes, force[1:].tolist(), strict=True):
        if abs(component) > SAME_PLACE * pressure * table.load_area:
            yield Load(last, axis, component, segments[last].end, history)
    if case.head is not None:
        yield from case.head.moments(last, segments[last].end, force, history)


def _load(where: str, table: LoadTable) -> Load:
    history: History | ReleasedLoad = build_history(where, table)
    if table.released and not isinstance(history, Step):
        raise BoomError(
            f"{where}.released",
            "a load that is let go has acted for ever, without a history; leave one of them out",
        )
    history = ReleasedLoad() if table.released else history
    arguments = table.segment, table.direction, table.magnitude, table.x, history
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
