# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of load charts: capacities over radius, and the range diagram."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from protractile.geometry.typography import number
from protractile.runs.case.build import build_boom
from protractile.runs.chart.cells import Cell, chart_of
from protractile.runs.chart.run import Chart
from protractile.runs.pipeline.tipping import luffed_point
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart as Plot
from protractile.runs.report.charts import Curve
from protractile.runs.report.figure_context import Figure

# Colour of what governs, by its kind; the colour-blind can distinguish them.
_COLORS = dict(
    zip(
        ("yield", "plate", "column", "pad", "cylinder", "pin", "deflection", "tipping"),
        ("#d55e00", "#e69f00", "#8a6d00", "#cc79a7", "#0072b2", "#56b4e9", "#009e73", "#6a3fd0"),
        strict=True,
    )
)


def pale(kind: str) -> str:
    """Return the colour of the cells that a kind of proof governs, in CSS notation."""
    return str(to_hex(theme.tint(_COLORS.get(kind, theme.FAINT), 0.3)))


def figures_of(chart: Chart) -> list[Figure]:
    """Return the chart over the radius, and the range diagram."""
    return [_over_radius(chart), _range(chart)]


def _over_radius(chart: Chart) -> Figure:
    heading, curves = "capacity (t)", []
    if chart_of(chart.case).payload is not None:
        heading = "governing utilisation (%)"
    for cells, color in zip(chart.cells, _colors(chart), strict=True):
        carrying = [cell for cell in cells if cell.capacity]
        values = np.array([1.0e-3 * (cell.capacity or 0.0) for cell in carrying])
        if chart_of(chart.case).payload is not None:
            values = np.array([100.0 * (cell.proofs[0].utilisation or 0.0) for cell in carrying])
        at = np.array([cell.radius for cell in carrying])
        curves.append(Curve(_name(cells), values, color, marker="o", at=at))
    farthest = max(cell.radius for cells in chart.cells for cell in cells)
    shown = Plot(np.array([0.0, 1.05 * farthest]), curves, (heading,), along="radius (m)")
    title = "The chart over the radius"
    return Figure("over-radius", title, "One curve for each length.", chart=shown, main=True)


def _range(chart: Chart) -> Figure:
    case, boom = chart.case, build_boom(chart.case)
    foot, turns = luffed_point(case, boom, 0.0, 0.0), np.linspace(*chart_of(case).angles, 60)
    tail, curves = foot._replace(along=0.0), []
    for cells, color in zip(chart.cells, _colors(chart), strict=True):
        tip, carrying = foot._replace(along=cells[0].length), [c for c in cells if c.capacity]
        arc = np.array([tip.at(turn) for turn in turns]).T
        curves.append(Curve("", arc[1], color, ":", at=arc[0], width=1.0))
        at, heights = np.array([(cell.radius, cell.height) for cell in carrying]).reshape(-1, 2).T
        curves.append(Curve(_name(cells), heights, color, "", at=at, marker="o"))
    tip = foot._replace(along=max(cells[0].length for cells in chart.cells))
    for turn in turns[[0, -1]]:
        ends = np.array([tail.at(turn), tip.at(turn)])
        curves.append(Curve("", ends[:, 1], theme.FAINT, at=ends[:, 0], width=1.0))
    abscissas = [x for curve in curves if curve.at is not None for x in curve.at.tolist()]
    extent = np.array([min(abscissas), max(abscissas)])
    shown = Plot(extent, curves, ("height (m)",), along="radius (m)", equal=True)
    caption = "Place of the loaded tip in each cell; dotted: the straight boom."
    return Figure("range", "Range of the tip", caption, chart=shown, main=True)


def _colors(chart: Chart) -> list[str]:
    """Return the colours of the lengths, in CSS notation, from dark to light."""
    return [to_hex(colormaps["viridis"](at)) for at in np.linspace(0.0, 0.9, len(chart.cells))]


def _name(cells: Sequence[Cell]) -> str:
    return f"{number(cells[0].length)} m"
