# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures along the boom: static deflections and section forces, envelopes, modes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from protractile.analysis.curves import HIGH, LOW, Curves
from protractile.analysis.modes import MOTIONS
from protractile.analysis.rows import EXTENDED, FARTHEST, INITIAL, REST
from protractile.dynamics.line import LineQuantity
from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_MILLI, number, with_minus_signs
from protractile.geometry.units import Unit
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.figure_context import (
    Figure,
    FigureContext,
    initial_position_note,
)
from protractile.runs.report.labels import extension_note

# Title and unit of each quantity's panel.
_PANELS: Mapping[str, tuple[str, str]] = {
    "deflection": ("deflection", "mm"),
    "lateral": ("lateral deflection", "mm"),
    "normal": ("normal force N", "kN"),
    "shear": ("shear force V", "kN"),
    "moment": ("bending moment M", "kN m"),
    "lateral_moment": ("lateral bending moment M", "kN m"),
    "torque": ("torque T", "kN m"),
}
# Quantities of an envelope.
_FORCES: tuple[LineQuantity, ...] = ("normal", "shear", "moment", "lateral_moment", "torque")
# Quantity that is drawn for each kind of mode.
_DISPLACED = {motion: name for name, motion in MOTIONS.items()}
# Number of modes in the figure.
MODES = 4


def at_rest(run: FigureContext) -> list[Figure]:
    """Show static deflection and section forces, with and without play."""
    farthest = run.rows.where(state=FARTHEST, model=run.main_models)
    tips = {row.model: row for row in farthest.where(quantity="tip")}
    if not tips:
        return []
    static = run.curves.where(state=[REST, EXTENDED])
    curves = [
        curve
        for name, tip in tips.items()
        for curve in rest_curves(
            static.where(model=name, play=True, time=tip.time), name, run.line_styles[name].color
        )
    ]
    # The boom without play has no static state at the end of telescoping.
    with_play = next((tip for name, tip in tips.items() if name in run.with_play), None)
    if with_play is not None and not tips.keys() & set(run.bonded):
        bonded = static.where(model=with_play.model, play=False, time=with_play.time)
        curves += rest_curves(bonded, "without play", theme.PLAY_FREE)
    caption = (
        "Static state with the largest tip deflection: deflection and section forces. Positive: "
        "normal force in tension, shear force that acts upwards on the part nearer the base, "
        "moment with tension at the top. In an overlap each segment has its own curve."
        + initial_position_note(run.case)
        + extension_note(run.case, [tip.time for tip in tips.values()])
    )
    far = max(tips.values(), key=lambda tip: abs(tip.value))
    lateral = farthest.where(model=far.model, quantity="tip_lateral").largest
    both = [f"{TO_MILLI * far.value:.1f} mm"]
    both += [f"lateral {TO_MILLI * lateral.value:.1f} mm"] if lateral and lateral.value else []
    tip_text = with_minus_signs(", ".join(both))
    title = f"Static state under the loads at {far.time:g} s: tip at {tip_text} in {far.model}"
    return _figure(curves, "at-rest", title, caption, main=True)


def envelopes(run: FigureContext) -> list[Figure]:
    """Show the envelopes of the section forces in motion."""
    curves = [
        _curve(what, curve.model, curve.x, curve.values[what], run.line_styles[curve.model].color)
        for curve in run.curves.where(model=run.main_models, play=True, state=[LOW, HIGH])
        for what in _FORCES
        if what in curve.values
    ]
    caption = (
        "Minimum and maximum of the section forces over the run, along each segment; signs as in "
        "the figure of the static state." + initial_position_note(run.case)
    )
    return _figure(curves, "envelopes", "Section forces in motion", caption)


def mode_shapes(run: FigureContext) -> list[Figure]:
    """Show the first modes of the first main model that has modes."""
    of_models = run.rows.where(
        model=run.main_models, state=INITIAL, play=True, quantity="frequency"
    )
    if not of_models:
        return []
    name = of_models[0].model
    modes = of_models.where(model=name)[:MODES]
    curves = [
        Curve(shape.segment, values, theme.segment_color(place), panel=panel, at=shape.x)
        for panel, mode in enumerate(modes)
        for place, shape in enumerate(run.curves.where(model=name, state=f"mode {panel + 1}"))
        if (values := shape.values.get(_DISPLACED[mode.part])) is not None
    ]
    panels = [f"{number(mode.value, 4)} Hz, {mode.part}" for mode in modes]
    caption = (
        f"First modes of {name!r} in the static state at t = 0, with the contacts that are closed "
        "there. Each segment has its colour; the amplitude is arbitrary."
    )
    chart = _chart(curves, panels)
    return [Figure("modes", "Mode shapes with closed contacts", caption, "rest", chart)]


def rest_curves(static: Curves, name: str, color: str) -> list[Curve]:
    """Return the curves of a static state along the boom, with ``name`` in the legend."""
    return [
        _curve(what, name, curve.x, values, color)
        for curve in static
        for what, values in curve.values.items()
        if what in _PANELS
    ]


def _curve(what: str, name: str, x: Array, values: Array, color: str) -> Curve:
    linestyle = "--" if color == theme.PLAY_FREE else "-"
    panel, in_units = [*_PANELS].index(what), Unit.conversion(_PANELS[what][1]) * values
    return Curve(name, in_units, color, linestyle, panel=panel, at=x)


def _figure(
    curves: Sequence[Curve], name: str, title: str, caption: str, main: bool = False
) -> list[Figure]:
    """Return the figure of :func:`chart_along`; nothing if all quantities are zero."""
    if not any(curve.values.any() for curve in curves):
        return []
    return [Figure(name, title, caption, "rest", chart_along(curves), main=main)]


def chart_along(curves: Sequence[Curve]) -> Chart:
    """Return the chart of curves along the boom, with a panel for each quantity that is not zero.

    The panel of a curve is the number of its quantity, as in :func:`rest_curves`. If all are zero,
    the first quantity has a panel.
    """
    kept = sorted({curve.panel for curve in curves if curve.values.any()}) or [0]
    shown = [
        replace(curve, panel=panel)
        for panel, old in enumerate(kept)
        for curve in curves
        if curve.panel == old
    ]
    titles = [f"{title} ({unit})" for title, unit in _PANELS.values()]
    return _chart(shown, [titles[old] for old in kept])


def _chart(curves: Sequence[Curve], panels: Sequence[str]) -> Chart:
    x = np.sort(np.concatenate([curve.at for curve in curves if curve.at is not None]))
    return Chart(x[[0, -1]], curves, panels, along="x along the boom (m)")
