# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures along the boom: static deflections and section forces, envelopes, modes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from geometry.typography import TO_MILLI, with_minus_signs
from runs.pipeline.design_results import ModelDesignResults
from runs.pipeline.motion_results import Envelope
from runs.pipeline.static_results import StaticResult
from runs.report import formatting, theme
from runs.report.charts import Chart, Curve
from runs.report.figure_context import (
    Figure,
    FigureContext,
    extension_note,
    initial_position_note,
    new_sheet,
)

# Heading of each quantity's panel, and conversion factor to its unit.
_PANELS: Mapping[str, tuple[str, float]] = {
    "deflection": ("deflection (mm)", TO_MILLI),
    "lateral": ("lateral deflection (mm)", TO_MILLI),
    "normal": ("normal force N (kN)", 1e-3),
    "shear": ("shear force V (kN)", 1e-3),
    "moment": ("bending moment M (kN m)", 1e-3),
    "lateral_moment": ("lateral bending moment M (kN m)", 1e-3),
    "torque": ("torque T (kN m)", 1e-3),
}
# Quantities of an envelope.
_FORCES = ("normal", "shear", "moment", "lateral_moment", "torque")
# Quantity that is drawn for each kind of mode.
_DISPLACED = {"bending in z": "deflection", "bending in y": "lateral", "twist": "twist"}
# Number of modes in the figure.
MODES = 4


class Line(NamedTuple):
    """Curve of one segment in a panel."""

    name: str
    x: Array
    values: Array
    color: str
    dashes: str


def at_rest(run: FigureContext) -> list[Figure]:
    """Draw static deflection and section forces, with and without play."""
    designs = dict(_main_designs(run))
    farthest = {name: design.farthest_static for name, design in designs.items()}
    rests = {name: rest for name, rest in farthest.items() if rest is not None}
    if not rests:
        return []
    lines = {name: rest_lines(rest, name, run.strokes[name].color) for name, rest in rests.items()}
    # The boom without play has no static state at the end of telescoping.
    bonded = [
        rest
        for name in rests
        if name in run.with_play
        for rest in designs[name].static_bonded
        if rest.time == rests[name].time
    ]
    if bonded and not rests.keys() & set(run.bonded):
        lines["without play"] = rest_lines(bonded[0], "without play", theme.PLAY_FREE)
    caption = (
        "Static state with the largest tip deflection: deflection and section forces. Positive: "
        "normal force in tension, shear force that acts upwards on the part nearer the base, "
        "moment with tension at the top. In an overlap each segment has its own curve."
        + initial_position_note(run.case)
        + extension_note(run.case, rests.values())
    )
    name, far = max(rests.items(), key=lambda item: abs(item[1].tip))
    tips = [f"{TO_MILLI * far.tip:.1f} mm"]
    tips += [f"lateral {TO_MILLI * far.tip_lateral:.1f} mm"] if far.tip_lateral else []
    tip = with_minus_signs(", ".join(tips))
    title = f"Static state under the loads at {far.time:g} s: tip at {tip} in {name}"
    return _draw_panels(run, lines, "at-rest", title, caption)


def envelopes(run: FigureContext) -> list[Figure]:
    """Draw the envelopes of the section forces in motion."""
    envelopes_of_models = {
        name: design.motion.envelopes
        for name, design in _main_designs(run)
        if design.motion is not None
    }
    lines = {
        name: {
            what: [
                line
                for envelope in several
                for line in _envelope_lines(envelope, what, name, run.strokes[name].color)
            ]
            for what in _FORCES
        }
        for name, several in envelopes_of_models.items()
    }
    caption = (
        "Minimum and maximum of the section forces over the run, along each segment; signs as in "
        "the figure of the static state." + initial_position_note(run.case)
    )
    return _draw_panels(run, lines, "envelopes", "Section forces in motion", caption)


def mode_shapes(run: FigureContext) -> list[Figure]:
    """Draw the first modes of the first main model that has modes."""
    modes_of_models = [(name, design.modes) for name, design in _main_designs(run) if design.modes]
    if not modes_of_models:
        return []
    name, modes = modes_of_models[0]
    modes = modes[:MODES]
    sheet, panels = new_sheet(len(modes), 0.9 + 1.15 * len(modes))
    for axes, mode in zip(panels, modes, strict=True):
        for number, shape in enumerate(mode.shapes):
            if (values := shape.curves.get(_DISPLACED[mode.motion])) is not None:
                axes.plot(shape.x, values, color=theme.segment_color(number), linewidth=1.8)
        axes.set_title(f"{formatting.number(mode.frequency, 4)} Hz, {mode.motion}")
        axes.set_yticks([0.0])
    panels[-1].set_xlabel("x along the boom (m)")
    caption = (
        f"First modes of {name!r} in the static state at t = 0, with the contacts that are closed "
        "there. Each segment has its colour; the amplitude is arbitrary."
    )
    return [
        run.finish(sheet, None, "modes", "Mode shapes with closed contacts", caption, part="rest")
    ]


def _main_designs(run: FigureContext) -> Iterator[tuple[str, ModelDesignResults]]:
    for name in run.models:
        if name in run.main_models and name in run.design:
            yield name, run.design[name]


def rest_lines(rest: StaticResult, name: str, color: str) -> dict[str, list[Line]]:
    """Return the lines of each quantity of a static state, with ``name`` in the legend."""
    lines: dict[str, list[Line]] = {what: [] for what in _PANELS}
    dashes = "--" if color == theme.PLAY_FREE else "-"
    for diagram in rest.diagrams:
        curves = {"normal": diagram.normal, **diagram.curves}
        for what in lines.keys() & curves.keys():
            values = np.array(curves[what])
            lines[what].append(Line(name, np.array(diagram.x), values, color, dashes))
    return lines


def _envelope_lines(envelope: Envelope, what: str, name: str, color: str) -> Iterator[Line]:
    dashes = "--" if color == theme.PLAY_FREE else "-"
    for side in (envelope.low, envelope.high):
        if what in side:
            yield Line(name, np.array(envelope.x), np.array(side[what]), color, dashes)


def _draw_panels(
    run: FigureContext,
    lines: Mapping[str, Mapping[str, Sequence[Line]]],
    stem: str,
    title: str,
    caption: str,
) -> list[Figure]:
    """Draw a panel for each quantity that is not zero; nothing if all are zero."""
    if not (quantities := _nonzero_quantities(lines)):
        return []
    sheet, panels = new_sheet(len(quantities), 1.2 + 1.4 * len(quantities))
    for axes, what in zip(panels, quantities, strict=True):
        heading, factor = _PANELS[what]
        for name, each in lines.items():
            for line in each.get(what, ()):
                axes.plot(
                    line.x,
                    factor * line.values,
                    color=line.color,
                    linestyle=line.dashes,
                    label=name,
                )
        axes.set_title(heading)
    panels[-1].set_xlabel("x along the boom (m)")
    chart = chart_along(lines)
    return [run.finish(sheet, panels[0], stem, title, caption, part="rest", chart=chart)]


def chart_along(lines: Mapping[str, Mapping[str, Sequence[Line]]]) -> Chart:
    """Return the chart of the non-zero quantities along the boom.

    Args:
        lines: lines of each quantity by the names of their sources, see :func:`rest_lines`.
    """
    quantities = _nonzero_quantities(lines)
    ends = [
        edge(line.x)
        for edge in (np.min, np.max)
        for each in lines.values()
        for line in each.get(quantities[0], ())
    ]
    curves = [
        Curve(
            name,
            _PANELS[what][1] * line.values,
            line.color,
            "dash" if line.dashes == "--" else "solid",
            panel=number,
            at=line.x,
        )
        for number, what in enumerate(quantities)
        for name, each in lines.items()
        for line in each.get(what, ())
    ]
    titles = [_PANELS[what][0] for what in quantities]
    return Chart(np.sort(ends)[[0, -1]], "", curves, titles, along="x along the boom (m)")


def _nonzero_quantities(lines: Mapping[str, Mapping[str, Sequence[Line]]]) -> list[str]:
    """Return the quantities that are not zero everywhere."""
    return [
        what
        for what in _PANELS
        if any(line.values.any() for each in lines.values() for line in each.get(what, ()))
    ]
