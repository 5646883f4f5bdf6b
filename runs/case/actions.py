# SPDX-License-Identifier: LGPL-3.0-or-later
"""Actions on the boom of a case: loads, weights, axial forces and ground accelerations."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import fields, replace
from typing import Any

from pydantic import ValidationError

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.excitation import History, InitialImpulse, ReleasedLoad, Step
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, BoomError, Direction, Segment, Stop
from protractile.geometry.fields import check_kind, check_numbers, error_in_python
from protractile.geometry.joint import BareStop
from protractile.geometry.load import AngularAcceleration, Load, Moment, PartialLoad
from protractile.geometry.place import Distance, at, resolve_segments
from protractile.geometry.typography import choices
from protractile.runs.case.load_tables import AxialTable, LoadTable, PayloadTable, build_history
from protractile.runs.case.schema import Case, GravityTable, VelocityTable
from protractile.runs.case.sections import SegmentTable

STANDARD_GRAVITY = 9.80665


def loads(case: Case, segments: Sequence[Segment]) -> Iterator[Load]:
    """Yield all loads across the boom: weights, applied and released loads, and impulses.

    Released loads and impulses determine the state at t = 0.

    Raises:
        BoomError: a segment is unknown, a history is invalid, or both the payload and the table
            ``gravity`` give an acceleration of gravity.
    """
    payload, gravity = case.payload, case.gravity
    if gravity is not None and payload is not None and payload.gravity is not None:
        raise BoomError(
            "payload.gravity",
            "the table gravity is given, by which the payload weighs too; leave one of them out",
        )
    for number, table in enumerate(case.loads, start=1):
        yield _load(f"load[{number}]", table)
    if payload is not None and gravity is None:
        weight = -payload.mass * payload_gravity(payload)
        if weight < 0.0:
            yield Load(len(segments) - 1, "z", weight, segments[-1].end, Step())
    if gravity is not None:
        yield from _inertia_loads(-gravity.across, "z", Step(), segments)
        if case.hoist is not None and case.hoist.dropped:
            weight = -case.hoist.mass * gravity.across
            yield Load(len(segments) - 1, "z", weight, segments[-1].end, ReleasedLoad())
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
    """Yield the axial forces on the boom except weights.

    Raises:
        BoomError: a segment is unknown, a point is outside its segment, a rope has no payload, or a
            force is given twice or not at all.
    """
    for number, table in enumerate(case.axial, start=1):
        where = f"axial[{number}]"
        name: Any = segments[-1].name if table.segment is None else table.segment
        place: Any = Distance(head=0.0) if table.x is None else table.x
        thrust = Thrust(name, place, axial_force(where, table, case))
        thrust = resolve_segments(thrust, where, segments)
        segments[thrust.segment].check_place(f"{where}.x", thrust.x)
        yield thrust


def axial_force(where: str, table: AxialTable, case: Case, carried: float | None = None) -> float:
    """Return the compressive force in N of a table ``axial`` of a case, at the key ``where``.

    Args:
        where: key of the table.
        table: table of the force.
        case: case with the payload and the hoist.
        carried: mass in kg on a hoist rope, in place of the mass of payload and hoist.

    Raises:
        BoomError: a rope has no payload, or a force is given twice or not at all.
    """
    if table.force is not None:
        for key in ("falls", "mass"):
            if getattr(table, key) is not None:
                raise BoomError(f"{where}.{key}", "force is given; leave one of them out")
        return table.force
    if table.falls is None:
        raise BoomError(
            f"{where}.force",
            "missing; it is the force in N towards the base, or give the falls of a hoist rope",
        )
    mass = carried if table.mass is None else table.mass
    if mass is None:
        if case.payload is None and case.hoist is None:
            raise BoomError(
                f"{where}.mass",
                "missing, and there is no payload; it is the mass in kg that the rope carries",
            )
        mass = sum(
            mass_table.mass for mass_table in (case.payload, case.hoist) if mass_table is not None
        )
    gravity = payload_gravity(case.payload) if case.gravity is None else case.gravity.acceleration
    return mass * gravity / table.falls


def payload_gravity(payload: PayloadTable | None) -> float:
    """Return the acceleration of gravity in m/s² that acts on the payload alone."""
    if payload is None or payload.gravity is None:
        return STANDARD_GRAVITY
    return payload.gravity


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
