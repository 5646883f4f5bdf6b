# SPDX-License-Identifier: LGPL-3.0-or-later
"""What acts on the boom of a case, over time and before it starts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dynamics.equilibrium import equilibrium
from dynamics.excitation import History, Ramp, Released, Sine, Step, Table, Thrown
from dynamics.gap_system import GapSystem
from geometry.arrays import Array
from geometry.boom import BoomError, Segment, Stop
from geometry.load import Load, Moment, PartialLoad
from runs.case.messages import choices
from runs.case.schema import Case, HistoryTable, LoadTable


def loads(case: Case, segments: Sequence[Segment]) -> tuple[Load, ...]:
    """Loads from t = 0 on, those released at t = 0, and those whose impulse throws a segment.

    :func:`start` makes of the latter two what they leave at t = 0.

    Raises:
        BoomError: a name that is no segment, a history that cannot be.
    """
    given = [
        _load(f"load[{number}]", table, segments)
        for number, table in enumerate(case.loads, start=1)
    ]
    last = len(segments) - 1
    if case.payload is not None and case.payload.gravity > 0.0:
        weight = -case.payload.mass * case.payload.gravity
        given.append(Load(last, "z", weight, segments[last].end, Step()))
    for number, base in enumerate(case.base, start=1):
        history = _history(f"base[{number}]", base)
        for index, segment in enumerate(segments):
            felt = -base.acceleration
            inertia = felt * segment.mass_per_length
            given.append(Load(index, base.direction, inertia, None, history, inertial=True))
            given += [
                Load(index, base.direction, felt * point.mass, point.x, history)
                for point in segment.masses
            ]
    for name, speed in case.start.velocity.items():
        index = _segment("start.velocity", name, segments)
        momentum = speed * segments[index].mass_per_length
        given.append(Load(index, "z", momentum, None, Thrown(), inertial=True))
        given += [
            Load(index, "z", speed * point.mass, point.x, Thrown())
            for point in segments[index].masses
        ]
    return tuple(given)


def _load(where: str, table: LoadTable, segments: Sequence[Segment]) -> Load:
    index = _segment(f"{where}.segment", table.segment, segments)
    acts = index, table.direction, table.magnitude, table.x, _load_history(where, table)
    if table.moment and table.x is None:
        raise BoomError(f"{where}.x", "missing; it is the x in m at which the moment acts")
    for key, given in (("from", table.start), ("to", table.end)):
        if given is not None and table.x is not None:
            raise BoomError(f"{where}.{key}", "x is given; leave one of them out")
    if table.moment:
        return Moment(*acts)
    if table.start is None and table.end is None:
        return Load(*acts)
    start = segments[index].start if table.start is None else table.start
    end = segments[index].end if table.end is None else table.end
    if not start < end:
        raise BoomError(f"{where}.to", f"must be beyond from, {start:g} m, got {end:g} m")
    return PartialLoad(*acts, span=(start, end))


def stops(case: Case, segments: Sequence[Segment]) -> tuple[Stop, ...]:
    """The rests on the ground.

    Raises:
        BoomError: a name that is no segment, a rest that nothing can press.
    """
    for number, table in enumerate(case.stops, start=1):
        if table.stiffness == 0.0 and not table.stiffness_below:
            raise BoomError(
                f"stop[{number}].stiffness", "must be positive on one side at least, got 0 on both"
            )
    return tuple(
        Stop(
            segment=_segment(f"stop[{number}].segment", table.segment, segments),
            x=table.x,
            clearance=0.5 * table.play,
            stiffness=table.stiffness,
            stiffness_below=(
                table.stiffness if table.stiffness_below is None else table.stiffness_below
            ),
            exponent=table.exponent,
            contact_length=table.contact_length,
        )
        for number, table in enumerate(case.stops, start=1)
    )


def start(system: GapSystem, case: Case) -> tuple[GapSystem, Array, Array]:
    """The system under the loads from t = 0 on, and its initial a and ȧ, (num_modes,) each.

    Args:
        system: of a boom with the loads of :func:`loads`.
        case: of this boom.

    Raises:
        NumericsError: there is no static equilibrium to start from.
    """
    system = system.gathered()
    held = system.released.copy()
    if case.start.state == "equilibrium":
        held += system.load
        for excitation in system.excitations:
            held += excitation.load * excitation.history(np.zeros(1))[0]
    return system, equilibrium(system, held), system.thrown


def _segment(where: str, name: str, segments: Sequence[Segment]) -> int:
    names = [segment.name for segment in segments]
    if name not in names:
        raise BoomError(where, f"{name!r} is no segment; give {choices(names)}")
    return names.index(name)


def _load_history(where: str, table: LoadTable) -> History | Released:
    history = _history(where, table)
    if table.released and not isinstance(history, Step):
        raise BoomError(
            f"{where}.released",
            "a load that is let go has acted for ever, without ramp, frequency or table; leave "
            "one of them out",
        )
    return Released() if table.released else history


def _history(where: str, table: HistoryTable) -> History:
    given = [key for key in ("ramp", "frequency", "table") if getattr(table, key) is not None]
    if len(given) > 1:
        raise BoomError(f"{where}.{given[1]}", f"{given[0]} is given; leave one of them out")
    if table.ramp is not None:
        return Ramp(table.ramp)
    if table.frequency is not None:
        return Sine(table.frequency)
    if table.table is not None:
        times, factors = zip(*table.table, strict=True)
        try:
            return Table(times, factors)
        except ValueError as error:
            raise BoomError(f"{where}.table", str(error)) from None
    return Step()
