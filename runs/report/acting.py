# SPDX-License-Identifier: LGPL-3.0-or-later
"""What acts on a case's boom, as signs at places."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from matplotlib.path import Path as Shape

from geometry.boom import Boom
from runs.case import actions
from runs.case.places import at
from runs.case.schema import Case, HistoryTable, LoadTable
from runs.report import symbols, theme
from runs.report.numerals import number

FORCE = "#b03000"
# Arrows of a load along a segment, m apart as a part of the boom's length.
APART = 0.07

_KILO = {"N": "kN", "N/m": "kN/m", "N m": "kN m"}
_MORE = {"N/m": (("GN/m", 1e9), ("MN/m", 1e6), ("kN/m", 1e3))}


@dataclass(frozen=True, slots=True)
class Acting:
    """One thing that acts.

    Args:
        segment: its number.
        places: x in m of its signs.
        edge: of the segment, where they are.
        shape: of the sign.
        meaning: in words.
        leans: whether the sign turns with the boom.
        color: of the sign.
    """

    segment: int
    places: tuple[float, ...]
    edge: Literal["top", "bottom", "axis"]
    shape: Shape
    meaning: str
    leans: bool = True
    color: str = FORCE

    def turned(self, angle: float) -> Shape:
        """The sign on a boom at an angle in degrees."""
        return symbols.turned(self.shape, angle) if self.leans else self.shape


def amount(value: float, unit: str) -> str:
    """A number with its unit, in thousands, millions where it is large."""
    for larger, factor in _MORE.get(unit, ()):
        if abs(value) >= factor:
            return f"{number(value / factor, 4)} {larger}"
    if abs(value) >= 1e3 and unit in _KILO:
        return f"{number(value / 1e3, 4)} {_KILO[unit]}"
    return f"{number(value, 4)} {unit}"


def acting(case: Case, boom: Boom) -> Iterator[Acting]:
    """Masses, loads, axial forces, those of segments first."""
    for index, segment in enumerate(boom.segments):
        given = case.segments[index]
        if given.load:
            yield _spread(boom, index, (segment.start, segment.end), given.load, "z", "")
        if given.lateral_load:
            yield _spread(boom, index, (segment.start, segment.end), given.lateral_load, "y", "")
        for one in given.masses:
            yield _mass(index, at(one.x, segment.start, segment.end), one.mass, "mass")
    last = len(boom.segments) - 1
    if case.payload is not None:
        yield _mass(last, boom.tip, case.payload.mass, "payload")
    names = [segment.name for segment in boom.segments]
    for table in case.loads:
        yield _load(table, boom, names.index(table.segment))
    for thrust in actions.thrusts(case, boom.segments):
        shape = symbols.FORCE_BACK if thrust.force > 0.0 else symbols.FORCE_ON
        along = f"{amount(abs(thrust.force), 'N')} along the boom"
        yield Acting(thrust.segment, (thrust.x,), "axis", shape, along)


def _mass(index: int, x: float, mass: float, what: str) -> Acting:
    meaning = f"{what}, {number(mass, 4)} kg"
    return Acting(index, (x,), "bottom", symbols.PAYLOAD, meaning, leans=False, color=theme.INK)


def _load(table: LoadTable, boom: Boom, index: int) -> Acting:
    segment = boom.segments[index]
    how = _history(table) + (", let go" if table.released else "")
    largest = table.magnitude * max((abs(f) for _, f in table.table or ()), default=1.0)
    if table.x is None:
        ends = segment.start, segment.end
        start = ends[0] if table.start is None else at(table.start, *ends)
        end = ends[1] if table.end is None else at(table.end, *ends)
        return _spread(boom, index, (start, end), largest, table.direction, how)
    x = at(table.x, segment.start, segment.end)
    if table.moment:
        shape = symbols.MOMENT if largest > 0.0 else symbols.CLOCKWISE
        return Acting(index, (x,), "axis", shape, f"moment {amount(abs(largest), 'N m')}{how}")
    return _force(index, (x,), largest, table.direction, "N", how)


def _spread(
    boom: Boom, index: int, span: tuple[float, float], load: float, direction: str, how: str
) -> Acting:
    """Arrows along a part of a segment."""
    start, end = span
    arrows = max(2, round((end - start) / (APART * boom.length)))
    places = start + (np.arange(arrows) + 0.5) / arrows * (end - start)
    on = f"{how}, {boom.segments[index].name}"
    return _force(index, tuple(places.tolist()), load, direction, "N/m", on)


def _force(
    index: int, places: tuple[float, ...], value: float, direction: str, unit: str, how: str
) -> Acting:
    size = amount(abs(value), unit)
    if direction == "y":
        shape = symbols.AWAY if value > 0.0 else symbols.TOWARDS
        return Acting(index, places, "axis", shape, f"{size} sideways{how}")
    if value > 0.0:
        return Acting(index, places, "bottom", symbols.FORCE_UP, f"{size} up across the boom{how}")
    return Acting(index, places, "top", symbols.FORCE_DOWN, f"{size} down across the boom{how}")


def _history(table: HistoryTable) -> str:
    if table.ramp is not None:
        return f" within {table.ramp:g} s"
    if table.frequency is not None:
        return f", {table.frequency:g} Hz"
    return " at most" if table.table is not None else ""
