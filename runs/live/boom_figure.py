# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plotly figure of a boom to scale, with its deflection, supports and loads."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from matplotlib.path import Path

from geometry.arrays import Array
from geometry.boom import Boom
from runs.case.schema import Case
from runs.pipeline.static_results import Diagram, StaticResult
from runs.report import symbols, theme
from runs.report.formatting import number

# Smallest deflection of the tip in the figure, as a fraction of the length of the boom.
_SHOWN = 0.03

# Plotly marker of each symbol, and clockwise rotation of the marker in degrees.
_MARKERS: Mapping[Path, tuple[str, float]] = {
    symbols.FORCE_DOWN: ("arrow", 180.0),
    symbols.FORCE_UP: ("arrow", 0.0),
    symbols.FORCE_BACK: ("arrow", 270.0),
    symbols.FORCE_ON: ("arrow", 90.0),
    symbols.AWAY: ("circle-x-open", 0.0),
    symbols.TOWARDS: ("circle-open-dot", 0.0),
    symbols.MOMENT: ("star-triangle-up-open", 0.0),
    symbols.CLOCKWISE: ("star-triangle-down-open", 0.0),
    symbols.PAYLOAD: ("circle", 0.0),
    symbols.PINNED: ("triangle-up", 0.0),
    symbols.CLAMPED: ("line-ns-open", 0.0),
    symbols.ELASTIC: ("diamond-tall-open", 0.0),
    symbols.REST_ABOVE: ("square-open", 0.0),
    symbols.REST_BELOW: ("square-open", 0.0),
}


def boom_figure(case: Case, boom: Boom, rest: StaticResult) -> dict[str, Any]:
    """Return the figure of the deflected boom at its luffing angle.

    Args:
        case: case with supports and loads.
        boom: boom of the case.
        rest: static results of a beam.
    """
    visible = _SHOWN * boom.length / max(abs(rest.tip), 1e-12)
    factor = max(1.0, float(f"{min(visible, 1e6):.1g}"))
    angle = 0.0 if case.gravity is None else case.gravity.angle
    traces = [
        *_segments(boom, rest, factor),
        *_cylinders(boom),
        *_symbols(case, boom, rest, factor),
    ]
    turn = np.radians(angle)
    matrix = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    for trace in traces:
        trace["x"], trace["y"] = matrix @ np.array([trace.pop("along"), trace.pop("across")])
        if "marker" in trace:
            trace["marker"]["angle"] -= angle * trace.pop("turns")
    title = "to scale" if factor == 1.0 else f"to scale, deflection × {factor:g}"
    axis = {"showgrid": False, "zeroline": False, "ticksuffix": " m"}
    layout = {
        "title": {"text": f"At rest under the maximum load, {title}", "font": {"size": 14}},
        "template": "none",
        "font": {"family": "system-ui, sans-serif", "size": 13, "color": theme.INK},
        "showlegend": False,
        "margin": {"l": 50, "r": 12, "t": 36, "b": 30},
        "xaxis": axis,
        "yaxis": axis | {"scaleanchor": "x"},
        "height": 380,
    }
    return {"data": traces, "layout": layout}


def _segments(boom: Boom, rest: StaticResult, factor: float) -> Iterator[dict[str, Any]]:
    """Yield the traces of the undeformed axis, then of each segment from tip to base."""
    yield {
        "along": [boom.segments[0].start, boom.tip],
        "across": [0.0, 0.0],
        "mode": "lines",
        "line": {"color": theme.FAINT, "dash": "dash", "width": 1},
        "hoverinfo": "skip",
    }
    for index in reversed(range(len(boom.segments))):
        segment, diagram = boom.segments[index], rest.diagrams[index]
        x = np.array(diagram.x)
        ends = np.array([symbols.edges(boom, segment, end) for end in segment.ends])
        low, high = (_deflection(diagram, factor) + np.interp(x, segment.ends, z) for z in ends.T)
        color = theme.segment_color(index)
        yield {
            "along": [*x, *x[::-1], x[0]],
            "across": [*low, *high[::-1], low[0]],
            "mode": "lines",
            "fill": "toself",
            "fillcolor": f"{color}40",
            "line": {"color": color, "width": 1.2},
            "name": segment.name,
            "text": segment.name,
            "hoverinfo": "text",
            "hoveron": "fills",
        }


def _deflection(diagram: Diagram, factor: float) -> Array:
    zero = [0.0] * len(diagram.x)
    return factor * np.array(diagram.curves.get("deflection", zero))


def _cylinders(boom: Boom) -> Iterator[dict[str, Any]]:
    for cylinder in boom.cylinders:
        yield {
            "along": [cylinder.x, cylinder.ground[0]],
            "across": [-cylinder.depth, cylinder.ground[1]],
            "mode": "lines",
            "line": {"color": theme.INK, "width": 4},
            "text": f"cylinder, {number(cylinder.length, 4)} m",
            "hoverinfo": "text",
        }


def _symbols(case: Case, boom: Boom, rest: StaticResult, factor: float) -> Iterator[dict[str, Any]]:
    for symbol in symbols.boom_symbols(case, boom):
        diagram, x = rest.diagrams[symbol.segment], np.array(symbol.places)
        shift = np.interp(x, diagram.x, _deflection(diagram, 0.0 if symbol.grounded else factor))
        shape, rotation = _MARKERS[symbol.path]
        yield {
            "along": x,
            "across": shift + np.array([symbol.z(boom, place) for place in symbol.places]),
            "mode": "markers",
            "marker": {
                "symbol": shape,
                "angle": rotation,
                "size": 18 if len(x) == 1 else 10,
                "color": symbol.color,
            },
            "turns": symbol.turns,
            "text": symbol.meaning,
            "hoverinfo": "text",
        }
