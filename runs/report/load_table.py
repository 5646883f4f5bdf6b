# SPDX-License-Identifier: LGPL-3.0-or-later
"""Table of the loads of a case, with their histories and largest values."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from protractile.dynamics.excitation import resolving_times
from protractile.geometry.boom import Boom
from protractile.geometry.load import Load, Moment, PartialLoad, Torque
from protractile.geometry.typography import SHOWN, in_shown_unit
from protractile.geometry.units import System
from protractile.runs.case.actions import (
    head_moments,
    oblique_forces,
    payload_weight,
    thrusts,
    wind,
)
from protractile.runs.case.load_tables import HistoryTable, LoadTable, build_history
from protractile.runs.case.schema import Case
from protractile.runs.report.tables import Amount, Cell, Table

# Forces and moments are in kN and kN m in other systems than SI, in SI from this number on.
_ENGINEERS, _MANY = {"N", "N m"}, 1.0e5
_CONSTANT, _ALL = "constant", "all masses"
# Direction of axial forces, which are positive in compression.
_AXIAL = "to the base"


class _LoadRow(NamedTuple):
    """Row of a load, with its largest value in an SI unit and the time of this value in s."""

    key: str
    place: str
    direction: str
    history: str
    largest: float
    unit: str
    time: float | None = None


def load_table(case: Case, boom: Boom) -> Table:
    """Return the table of all loads of a case, in the units of the case."""
    system, rows = case.system, list[Sequence[Cell]]()
    for *names, largest, unit, time in _rows(case, boom):
        shown, label = system.of(largest, unit), system.label(unit)
        if unit in _ENGINEERS and (system.name != "SI" or abs(shown) >= _MANY):
            label, shown = SHOWN[unit], in_shown_unit(largest, unit)
        rows.append((*names, Amount(shown, label, 4), "" if time is None else time))
    headings = "load", "on", "direction", "history", "maximum", ("maximum\nat", ".4g", "s")
    return Table.of_rows("", "Loads", headings, rows)


def release_note(case: Case) -> str:
    """Return a sentence on static results at t = 0; empty if no load is released."""
    dropped = case.hoist is not None and case.hoist.dropped
    released = dropped or any(load.released for load in case.loads)
    return "Static results at t = 0 are those before the release." if released else ""


def _rows(case: Case, boom: Boom) -> Iterator[_LoadRow]:
    gravity, tip = case.gravity, _place(boom, len(boom.segments) - 1, boom.tip, case.system)
    if gravity is not None:
        weighing = [("gravity", _ALL, _CONSTANT, boom.mass)]
        if case.hoist is not None:
            history = _CONSTANT if case.hoist.hanging else "from lift-off"
            history = "until t = 0" if case.hoist.dropped else history
            weighing.append(("hoist", tip, history, case.hoist.mass))
        for key, place, history, mass in weighing:
            for direction, part in (("z", -gravity.across), (_AXIAL, gravity.along)):
                if part:
                    yield _LoadRow(key, place, direction, history, part * mass, "N")
    for i, segment in enumerate(case.segments, start=1):
        for key, direction in (("load", "z"), ("lateral_load", "y")):
            if load := getattr(segment, key):
                key = f"segment[{i}].{key}"
                yield _LoadRow(key, segment.name, direction, _CONSTANT, load, "N/m")
    for (i, table), of in zip(case.loads_of_segments, boom.loads, strict=False):
        place = _place_of(boom, of, case.system)
        yield _history_row(f"load[{i}]", place, _direction(of), table, case.time.duration)
    for (i, table), force in zip(
        case.oblique_loads, oblique_forces(case, boom.segments), strict=False
    ):
        place = _place(boom, force.segment, force.x, case.system)
        yield _history_row(f"load[{i}]", place, table.heading, table, case.time.duration)
    if case.payload is not None and gravity is None and case.payload.gravity != 0.0:
        yield _LoadRow("payload", tip, "z", _CONSTANT, -payload_weight(case), "N")
    for i, base in enumerate(case.base, start=1):
        yield _history_row(f"base[{i}]", _ALL, base.direction, base, case.time.duration)
    for of in head_moments(case, boom.segments):
        yield _LoadRow("head", tip, _direction(of), _CONSTANT, of.magnitude, "N m")
    if case.wind is not None:
        for of in wind(case, case.wind, boom.segments, boom.joints):
            unit = {PartialLoad: "N/m", Load: "N"}.get(type(of), "N m")
            largest = of.magnitude * getattr(of.history, "peak", 1.0)
            place, history = _place_of(boom, of, case.system), case.wind.description or _CONSTANT
            yield _LoadRow("wind", place, _direction(of), history, largest, unit)
    for lead in boom.leads:
        yield _LoadRow("rope", tip, "to the winch", _CONSTANT, lead.force, "N")
    for i, thrust in enumerate(thrusts(case, boom.segments), start=1):
        place = _place(boom, thrust.segment, thrust.x, case.system)
        yield _LoadRow(f"axial[{i}]", place, _AXIAL, _CONSTANT, thrust.force, "N")


def _direction(load: Load) -> str:
    if isinstance(load, Torque):
        return "torque"
    return f"{load.direction}, moment" if isinstance(load, Moment) else load.direction


def _place(boom: Boom, segment: int, x: float, system: System) -> str:
    return f"{boom.segments[segment].name} at {system.text(x, 'm', 5)}"


def _place_of(boom: Boom, load: Load, system: System) -> str:
    name = boom.segments[load.segment].name
    if isinstance(load, PartialLoad):
        start, end = (system.of(x, "m") for x in load.span)
        return f"{name}, {start:.5g}–{end:.5g} {system.label('m')}"
    return name if load.x is None else _place(boom, load.segment, load.x, system)


def _history_row(
    key: str, place: str, direction: str, table: HistoryTable, duration: float
) -> _LoadRow:
    """Return the row of a load with a time history, in a run of the given duration in s."""
    unit, amplitude = table.declared_units(table.amount)[0], getattr(table, table.amount)
    history = build_history(key, table)
    times = resolving_times([history], duration)
    values = history(times)
    step = int(np.abs(values).argmax())
    time = float(times[step]) if np.ptp(values) else None
    description = table.description or _CONSTANT
    if isinstance(table, LoadTable) and table.released:
        description = "until t = 0"
    return _LoadRow(key, place, direction, description, amplitude * float(values[step]), unit, time)
