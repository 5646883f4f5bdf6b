# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures along the boom: static deflections and section forces, envelopes, modes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from protractile.analysis.states import StaticResult
from protractile.geometry.typography import TO_MILLI, with_minus_signs
from protractile.runs.pipeline.design_results import ModelDesignResults
from protractile.runs.report import formatting, theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.figure_context import (
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


def at_rest(run: FigureContext) -> list[Figure]:
    """Draw static deflection and section forces, with and without play."""
    designs = dict(_main_designs(run))
    farthest = {name: design.farthest_static for name, design in designs.items()}
    rests = {name: rest for name, rest in farthest.items() if rest is not None}
    if not rests:
        return []
    curves = [
        curve
        for name, rest in rests.items()
        for curve in rest_curves(rest, name, run.line_styles[name].color)
    ]
    # The boom without play has no static state at the end of telescoping.
    bonded = [
        rest
        for name in rests
        if name in run.with_play
        for rest in designs[name].static_bonded
        if rest.time == rests[name].time
    ]
    if bonded and not rests.keys() & set(run.bonded):
        curves += rest_curves(bonded[0], "without play", theme.PLAY_FREE)
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
    return _draw_panels(run, curves, "at-rest", title, caption)


def envelopes(run: FigureContext) -> list[Figure]:
    """Draw the envelopes of the section forces in motion."""
    curves = [
        _curve(what, name, envelope.x, side[what], run.line_styles[name].color)
        for name, design in _main_designs(run)
        if design.motion is not None
        for envelope in design.motion.envelopes
        for side in (envelope.low, envelope.high)
        for what in _FORCES
        if what in side
    ]
    caption = (
        "Minimum and maximum of the section forces over the run, along each segment; signs as in "
        "the figure of the static state." + initial_position_note(run.case)
    )
    return _draw_panels(run, curves, "envelopes", "Section forces in motion", caption)


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


def rest_curves(rest: StaticResult, name: str, color: str) -> list[Curve]:
    """Return the curves of a static state along the boom, with ``name`` in the legend."""
    return [
        _curve(what, name, diagram.x, values, color)
        for diagram in rest.diagrams
        for what, values in {"normal": diagram.normal, **diagram.curves}.items()
        if what in _PANELS
    ]


def _curve(what: str, name: str, x: list[float], values: list[float], color: str) -> Curve:
    linestyle = "--" if color == theme.PLAY_FREE else "-"
    number, in_units = [*_PANELS].index(what), _PANELS[what][1] * np.array(values)
    return Curve(name, in_units, color, linestyle, panel=number, at=np.array(x))


def _draw_panels(
    run: FigureContext, curves: Sequence[Curve], stem: str, title: str, caption: str
) -> list[Figure]:
    """Draw the figure of :func:`chart_along`; nothing if all quantities are zero."""
    if not any(curve.values.any() for curve in curves):
        return []
    chart = chart_along(curves)
    sheet, panels = new_sheet(len(chart.panels), 1.2 + 1.4 * len(chart.panels))
    for axes, heading in zip(panels, chart.panels, strict=True):
        axes.set_title(heading)
    for curve in chart.curves:
        look: dict[str, Any] = {"color": curve.color, "linestyle": curve.linestyle}
        assert curve.at is not None
        panels[curve.panel].plot(curve.at, curve.values, label=curve.name, **look)
    panels[-1].set_xlabel(chart.along)
    return [run.finish(sheet, panels[0], stem, title, caption, part="rest", chart=chart)]


def chart_along(curves: Sequence[Curve]) -> Chart:
    """Return the chart of curves along the boom, with a panel for each quantity that is not zero.

    The panel of a curve is the number of its quantity, as in :func:`rest_curves`. If all are zero,
    the first quantity has a panel.
    """
    kept = sorted({curve.panel for curve in curves if curve.values.any()}) or [0]
    shown = [
        replace(curve, panel=panel)
        for panel, number in enumerate(kept)
        for curve in curves
        if curve.panel == number
    ]
    x = np.sort(np.concatenate([curve.at for curve in shown if curve.at is not None]))
    titles = [title for title, _ in _PANELS.values()]
    return Chart(
        x[[0, -1]], "", shown, [titles[number] for number in kept], along="x along the boom (m)"
    )
