# SPDX-License-Identifier: LGPL-3.0-or-later
"""What acts on the boom of a case, over time and before it starts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from dynamics.equilibrium import equilibrium
from dynamics.excitation import Ramp, Sine, Step, Table
from dynamics.gap_system import GapSystem
from geometry.boom import BoomError, Load, Segment, Stop
from runs.bad_input import choices
from runs.schema import Case, HistoryTable

Array = npt.NDArray[np.float64]


def loads(case: Case, segments: Sequence[Segment]) -> tuple[Load, ...]:
    """Loads from t = 0 on, then those released at t = 0, then those whose impulse throws a segment.

    :func:`start` takes the latter two out of the gap system again.

    Raises:
        BoomError: a name that is no segment, a history that cannot be.
    """
    given = [
        Load(
            segment=_segment(f"load[{number}].segment", table.segment, segments),
            direction=table.direction,
            magnitude=table.magnitude,
            x=table.x,
            history=_history(f"load[{number}]", table),
        )
        for number, table in enumerate(case.loads, start=1)
    ]
    for number, table in enumerate(case.loads, start=1):
        if table.released and not isinstance(given[number - 1].history, Step):
            raise BoomError(
                f"load[{number}].released",
                "a load that is let go has acted for ever, without ramp, frequency or table; leave "
                "one of them out",
            )
    both = list(zip(given, case.loads, strict=True))
    during = [load for load, table in both if not table.released]
    released = [load for load, table in both if table.released]
    last = len(segments) - 1
    if case.payload is not None and case.payload.gravity > 0.0:
        weight = -case.payload.mass * case.payload.gravity
        during.append(Load(last, "z", weight, segments[last].end, Step()))
    for number, base in enumerate(case.base, start=1):
        history = _history(f"base[{number}]", base)
        for index, segment in enumerate(segments):
            felt = -base.acceleration
            inertia = felt * segment.mass_per_length
            during.append(Load(index, base.direction, inertia, None, history, inertial=True))
            during += [
                Load(index, base.direction, felt * point.mass, point.x, history)
                for point in segment.masses
            ]
    return (*during, *released, *_throws(case, segments))


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
        )
        for number, table in enumerate(case.stops, start=1)
    )


def start(
    system: GapSystem, case: Case, segments: Sequence[Segment]
) -> tuple[GapSystem, Array, Array]:
    """The system under the loads from t = 0 on, and its initial a and ȧ, (num_modes,) each.

    Args:
        system: of a boom with the loads of :func:`loads`.
        case: of this boom.
        segments: of this boom.

    Raises:
        NumericsError: there is no static equilibrium to start from.
    """
    num_released = sum(load.released for load in case.loads)
    num_thrown = len(_throws(case, segments))
    before = len(system.excitations) - num_released - num_thrown
    during = system.excitations[:before]
    released = system.excitations[before : before + num_released]
    thrown = system.excitations[before + num_released :]
    held = np.zeros(system.num_modes)
    if case.start.state == "equilibrium":
        held += system.load
        for excitation in during:
            held += excitation.load * excitation.history(np.zeros(1))[0]
    for excitation in released:
        held += excitation.load
    velocity = np.zeros(system.num_modes)
    for excitation in thrown:
        velocity += excitation.load
    return replace(system, excitations=during), equilibrium(system, held), velocity


def _throws(case: Case, segments: Sequence[Segment]) -> list[Load]:
    """The momentum of each thrown segment as a load: its impulse in one second gives the speed."""
    throws = []
    for name, speed in case.start.velocity.items():
        index = _segment("start.velocity", name, segments)
        segment = segments[index]
        momentum = speed * segment.mass_per_length
        throws.append(Load(index, "z", momentum, None, Step(), inertial=True))
        throws += [
            Load(index, "z", speed * point.mass, point.x, Step()) for point in segment.masses
        ]
    return throws


def _segment(where: str, name: str, segments: Sequence[Segment]) -> int:
    names = [segment.name for segment in segments]
    if name not in names:
        raise BoomError(where, f"{name!r} is no segment; give {choices(names)}")
    return names.index(name)


def _history(where: str, table: HistoryTable) -> Step | Ramp | Sine | Table:
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
