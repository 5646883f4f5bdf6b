# SPDX-License-Identifier: LGPL-3.0-or-later
"""Symbols of supports and loads in pictures.

A symbol is a matplotlib path in units of its size, relative to its position.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from math import cos, radians, sin
from typing import Any, Literal

import numpy as np
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from protractile.geometry.boom import Boom, Segment
from protractile.geometry.load import PartialLoad
from protractile.geometry.place import at
from protractile.geometry.section import Direction
from protractile.geometry.typography import number
from protractile.runs.case import actions
from protractile.runs.case.load_tables import LoadTable
from protractile.runs.case.schema import Case
from protractile.runs.case.segments import pinned_masses
from protractile.runs.report import theme

# Displayed height of a segment without plates, over the length of the boom.
DEFAULT_HEIGHT = 0.015
# Distance of the arrows of a distributed load, over the length of the boom.
ARROW_DISTANCE = 0.07
# Number of strokes of a zigzag, and their amplitude.
TURNS, SWING = 6, 0.18

# Position of a symbol: an edge of the segment, or z in m.
Edge = Literal["top", "bottom"] | float

# Larger units of large numbers, and the numbers above which they are used.
_LARGER = {
    "N": (("kN", 1e3),),
    "N m": (("kN m", 1e3),),
    "N/m": (("GN/m", 1e9), ("MN/m", 1e6), ("kN/m", 1e3)),
}


def _strokes(*lines: Sequence[tuple[float, float]]) -> Path:
    """Return a path of separate lines."""
    return Path.make_compound_path(*map(Path, lines))


def _ground(z: float) -> list[Sequence[tuple[float, float]]]:
    """Return the lines of a hatched ground."""
    hatches = [((x, z), (x - 0.15, z - 0.15)) for x in np.linspace(-0.3, 0.45, 6).tolist()]
    return [((-0.45, z), (0.45, z)), *hatches]


def _rotated(path: Path, degrees: float) -> Path:
    """Return a symbol rotated counter-clockwise by an angle in degrees."""
    return path.transformed(Affine2D().rotate_deg(degrees))


_ZIGZAG = [0.0, *(SWING * (-1) ** i for i in range(TURNS - 1)), 0.0]
PINNED = _strokes([(0.0, 0.0), (-0.35, -0.7), (0.35, -0.7), (0.0, 0.0)], *_ground(-0.7))
CLAMPED = _strokes(
    [(0.0, -0.8), (0.0, 0.8)],
    *([(0.0, z), (-0.25, z - 0.2)] for z in np.linspace(-0.6, 0.8, 8).tolist()),
)
ELASTIC = _strokes(
    [*zip(_ZIGZAG, np.linspace(0.0, -0.7, TURNS + 1).tolist(), strict=True)], *_ground(-0.7)
)
REST_ABOVE = Path([[-0.4, 0.25], [0.4, 0.25], [0.4, 0.6], [-0.4, 0.6], [-0.4, 0.25]])
REST_BELOW = _rotated(REST_ABOVE, 180.0)
PAYLOAD = Path.make_compound_path(
    _strokes([(0.0, 0.0), (0.0, -0.45)]), Path.circle((0.0, -0.72), 0.27)
)
PIN = Path.circle((0.0, 0.0), 0.12)
HUNG = _strokes(
    [(0.0, 0.0), (0.0, -1.3)],
    [(-0.3, -1.3), (0.3, -1.3), (0.3, -1.9), (-0.3, -1.9), (-0.3, -1.3)],
)
FORCE_DOWN = _strokes([(0.0, 1.0), (0.0, 0.0)], [(-0.2, 0.35), (0.0, 0.0), (0.2, 0.35)])
FORCE_UP = _rotated(FORCE_DOWN, 180.0)
FORCE_BACK = _rotated(FORCE_DOWN, -90.0)
FORCE_ON = _rotated(FORCE_DOWN, 90.0)
AWAY = Path.make_compound_path(
    Path.circle((0.0, 0.0), 0.4),
    _strokes([(-0.28, -0.28), (0.28, 0.28)], [(-0.28, 0.28), (0.28, -0.28)]),
)
TOWARDS = Path.make_compound_path(*(Path.circle((0.0, 0.0), radius) for radius in (0.4, 0.1)))
_ARC = [
    (0.5 * float(np.cos(t)), 0.5 * float(np.sin(t))) for t in np.linspace(-0.3, 1.3, 17) * np.pi
]
CLOCKWISE = _strokes(_ARC, [(0.02, -0.24), _ARC[0], (0.42, -0.7)])
MOMENT = CLOCKWISE.transformed(Affine2D().scale(-1.0, 1.0))


@dataclass(frozen=True, slots=True)
class Symbol:
    """Symbol of a support or a load."""

    kind: Literal["supports", "springs", "stops", "masses", "loads"]  #: name of the kind
    segment: int  #: number of the segment
    places: tuple[float, ...]  #: positions x in m
    edge: Edge  #: edge of the segment at which it is drawn, or z in m
    path: Path  #: path of the symbol
    meaning: str  #: text of the legend
    color: str = theme.FORCE  #: colour of the symbol
    turns: bool = True  #: True if the symbol rotates with the boom
    clearance: float = 0.0  #: distance between edge and symbol in m
    grounded: bool = False  #: True if the symbol does not move with the boom
    #: x, y and z in m of the symbol from its place, at the end of a line
    arm: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def on_boom(self, angle: float) -> Path:
        """Return the path of the symbol in the axes of a boom at an angle in degrees."""
        return self.path if self.turns else _rotated(self.path, -angle)

    def z(self, boom: Boom, x: float) -> float:
        """Return z of the edge at x, in m."""
        if not isinstance(self.edge, str):
            return self.edge
        return edges(boom, boom.segments[self.segment], x)[self.edge == "top"]


def marker_style(path: Path, color: str, size: float) -> dict[str, Any]:
    """Return matplotlib's marker style of a symbol with a size in pt."""
    return {
        "marker": path,
        "markersize": 2.0 * size * float(np.abs(path.vertices).max()),
        "linestyle": "",
        "markeredgecolor": color,
        "markerfacecolor": "none",
        "markeredgewidth": max(1.1, size / 14.0),
    }


def edges(
    boom: Boom, segment: Segment, x: float, direction: Direction = "z"
) -> tuple[float, float]:
    """Return the lowest and highest z in m of a segment at x; an estimate without a section."""
    half = 0.5 * DEFAULT_HEIGHT * boom.length
    return (-half, half) if segment.section is None else segment.section_at(x).reach(direction)


def abbreviate(value: float, unit: str) -> str:
    """Return a number with its unit as text, with prefix k or M for large numbers."""
    units = (*_LARGER.get(unit, ()), (unit, 1.0))
    name, factor = next((prefix for prefix in units if abs(value) >= prefix[1]), units[-1])
    return f"{number(value / factor, 4)} {name}"


def boom_symbols(case: Case, boom: Boom) -> Iterator[Symbol]:
    """Yield the symbols of supports, stops, masses, loads and axial forces, in this order."""
    yield from _support_symbols(boom)
    for index, segment in enumerate(boom.segments):
        segment_table = case.segments[index]
        for load, direction in ((segment_table.load, "z"), (segment_table.lateral_load, "y")):
            if load:
                yield _spread(boom, index, segment.ends, load, direction, "")
        for mass in segment_table.masses:
            yield _mass(index, at(mass.x, *segment.ends), f"mass, {number(mass.mass, 4)} kg")
    for index, mass in pinned_masses(case, boom.segments):
        yield _mass(index, mass.x, f"mass between two pins, {number(mass.mass, 4)} kg")
    hung: Callable[..., Symbol] = replace
    if (head := actions.head_of(case)) is not None:
        angle = 0.0 if case.gravity is None else radians(case.gravity.angle)
        head = head.in_boom_axes(boom.segments[-1], angle)
        hung = partial(replace, edge=0.0, arm=(head.ahead, head.beside, -head.below))
        what = f"head, {number(head.mass, 4)} kg" if case.head else "sheave"
        pin = _mass(len(boom.segments) - 1, boom.tip, what)
        yield hung(pin, path=PIN)
    if case.payload is not None:
        payload = f"mass at the tip, {number(case.payload.mass, 4)} kg"
        yield hung(_mass(len(boom.segments) - 1, boom.tip, payload))
    if case.hoist is not None:
        on_rope = f"load on the rope, {number(case.hoist.mass, 4)} kg"
        yield replace(_mass(len(boom.segments) - 1, boom.tip, on_rope), path=HUNG)
    names = [segment.name for segment in boom.segments]
    for _, table in case.loads_of_segments:
        yield _load(table, boom, names.index(table.segment or ""))
    forces = actions.oblique_forces(case, boom.segments)
    for (_, table), acting in zip(case.oblique_loads, forces, strict=False):
        size, place = table.magnitude * acting.history.peak, hung if acting.head else replace
        if isinstance(table.direction, str):
            yield place(_force(acting.segment, (acting.x,), size, table.direction, "N", ""))
            continue
        forwards = size * cos(radians(table.direction))
        sign = FORCE_ON if forwards > 0.0 else FORCE_BACK
        if abs(forwards) < 0.5 * abs(size):
            sign = AWAY if size * sin(radians(table.direction)) > 0.0 else TOWARDS
        meaning = f"{abbreviate(abs(size), 'N')} horizontal, {table.heading}"
        flat = Symbol("loads", acting.segment, (acting.x,), 0.0, sign, meaning, turns=False)
        yield place(flat)
    if case.wind is not None:
        for blow in actions.wind(case, case.wind, boom.segments, boom.joints):
            if isinstance(blow, PartialLoad):
                force = blow.magnitude * getattr(blow.history, "peak", 1.0)
                yield _spread(boom, blow.segment, blow.span, force, blow.direction, ", wind")
    for lead in boom.leads:
        along = f"{abbreviate(lead.force, 'N')} of the rope's lead"
        arm = lead.ahead, 0.0, -lead.below
        yield Symbol("loads", lead.segment, (lead.x,), 0.0, FORCE_BACK, along, arm=arm)
    for thrust in actions.thrusts(case, boom.segments):
        sign = FORCE_BACK if thrust.force > 0.0 else FORCE_ON
        along = f"{abbreviate(abs(thrust.force), 'N')} along the boom"
        yield Symbol("loads", thrust.segment, (thrust.x,), 0.0, sign, along)


def _support_symbols(boom: Boom) -> Iterator[Symbol]:
    """Yield the symbols of supports other than cylinders."""
    upright: dict[str, Any] = {"color": theme.INK, "turns": False, "grounded": True}
    for index, segment in enumerate(boom.segments):
        for support in segment.supports:
            place = (support.x,)
            edge: Edge = -support.depth if support.depth else "bottom"
            if support.kind == "clamped":
                yield Symbol("supports", index, place, 0.0, CLAMPED, "clamped", **upright)
            elif support.stiffness is None:
                yield Symbol("supports", index, place, edge, PINNED, "support", **upright)
            else:
                meaning = f"elastic support, {abbreviate(support.stiffness, 'N/m')}"
                yield Symbol("springs", index, place, edge, ELASTIC, meaning, **upright)
    for stop in boom.stops:
        grey = {**upright, "color": theme.PLAY_FREE, "clearance": 0.5 * stop.play}
        meaning = f"rest, {1e3 * stop.play:g} mm of play"
        if -1 in stop.sides:
            yield Symbol("stops", stop.segment, (stop.x,), "bottom", REST_BELOW, meaning, **grey)
        if 1 in stop.sides:
            yield Symbol("stops", stop.segment, (stop.x,), "top", REST_ABOVE, meaning, **grey)


def _mass(index: int, x: float, meaning: str) -> Symbol:
    return Symbol("masses", index, (x,), "bottom", PAYLOAD, meaning, theme.INK, turns=False)


def _load(table: LoadTable, boom: Boom, index: int) -> Symbol:
    ends = boom.segments[index].ends
    how = f", {table.description}" if table.description else ""
    if table.table is not None:
        how = " at most"
    how += ", let go" if table.released else ""
    largest = table.magnitude * max((abs(f) for _, f in table.table or ()), default=1.0)
    if table.x is None:
        start = ends[0] if table.start is None else at(table.start, *ends)
        end = ends[1] if table.end is None else at(table.end, *ends)
        return _spread(boom, index, (start, end), largest, table.heading, how)
    place = (at(table.x, *ends),)
    if table.moment:
        sign = MOMENT if largest > 0.0 else CLOCKWISE
        return Symbol(
            "loads", index, place, 0.0, sign, f"moment {abbreviate(abs(largest), 'N m')}{how}"
        )
    return _force(index, place, largest, table.heading, "N", how)


def _spread(
    boom: Boom, index: int, span: tuple[float, float], load: float, direction: str, how: str
) -> Symbol:
    """Return the symbol of a distributed load along a part of a segment."""
    start, end = span
    arrows = max(2, round((end - start) / (ARROW_DISTANCE * boom.length)))
    places = start + (np.arange(arrows) + 0.5) / arrows * (end - start)
    on = f"{how}, {boom.segments[index].name}"
    return _force(index, tuple(places.tolist()), load, direction, "N/m", on)


def _force(
    index: int, places: tuple[float, ...], value: float, direction: str, unit: str, how: str
) -> Symbol:
    size = abbreviate(abs(value), unit)
    if direction == "y":
        sign = AWAY if value > 0.0 else TOWARDS
        return Symbol("loads", index, places, 0.0, sign, f"{size} lateral{how}")
    edge: Edge = "bottom" if value > 0.0 else "top"
    sign, side = (FORCE_UP, "upper") if value > 0.0 else (FORCE_DOWN, "lower")
    meaning = f"{size} perpendicular to the boom, towards its {side} side{how}"
    return Symbol("loads", index, places, edge, sign, meaning)
