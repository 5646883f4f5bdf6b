# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of charts by matplotlib, for paper and for readers without JavaScript."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from typing import Any

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import BoundaryNorm, Colormap, ListedColormap, Normalize
from matplotlib.figure import Figure as Sheet

from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve, Keys, Map
from protractile.runs.report.pages import base_64

# Intervals into which a long curve is divided in a picture; the extremes of each are drawn.
INTERVALS = 700
# Heights in inches: of a panel with curves and with a map, of titles and axis, of a legend's line.
PANEL, MAP, TITLES, LEGEND_LINE = 1.6, 2.4, 1.2, 0.22
# Height in inches of the panel of a chart that has only one.
ALONE = 2.4
# Number of characters that fit into one of two columns of a legend.
LEGEND_CHARACTERS = 30
# Maximum number of labels along an axis of a map.
MOST_LABELS = 8


def draw_chart(chart: Chart, title: str) -> Sheet:
    """Return the sheet of a chart below its title."""
    count = len(chart.panels)
    names = dict.fromkeys(curve.name for curve in chart.curves if curve.name)
    columns = 2 if max(map(len, names), default=0) <= LEGEND_CHARACTERS else 1
    lines = -(-len(names) // columns) if len(names) > 1 else 0
    panel = MAP if chart.maps else ALONE if count == 1 else PANEL
    sheet = Sheet(figsize=(theme.WIDTH, TITLES + panel * count + LEGEND_LINE * lines))
    panels = sheet.subplots(count, 1, sharex=True, squeeze=False)[:, 0]
    for axes in panels[1 : chart.common]:
        axes.sharey(panels[0])
    for axes, heading in zip(panels, chart.panels, strict=True):
        axes.set_title(heading)
        for vertical in chart.verticals:
            look: dict[str, Any] = {"color": vertical.color, "linestyle": vertical.linestyle}
            axes.axvline(vertical.at, linewidth=0.9, **look)
    draw_curves([*panels], chart)
    for number in chart.logarithmic:
        panels[number].set_yscale("log")
        for formatter in (panels[number].yaxis.set_major_formatter,
                          panels[number].yaxis.set_minor_formatter):  # fmt: skip
            formatter(_label)
    if chart.keys is not None:
        for axes, cells in zip(panels, chart.maps, strict=True):
            _draw_map(axes, chart.keys, cells)
        colors = ScalarMappable(*_scale(chart.keys))
        sheet.colorbar(colors, ax=[*panels], label=chart.keys.title, aspect=40)
    elif chart.decades:
        panels[-1].set_xscale("log")
        panels[-1].xaxis.set_major_formatter(_label)
    else:
        panels[-1].set_xlim(*(chart.window or chart.time[[0, -1]]))
    panels[-1].set_xlabel(chart.along)
    if lines:
        handles = {
            label: handle
            for axes in reversed(panels)
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        sheet.legend([handles[name] for name in names], [*names],
                     loc="outside lower left", ncols=columns)  # fmt: skip
    sheet.suptitle(title, x=0.02, ha="left", fontsize=12.0, fontweight="bold", wrap=True)
    return sheet


def draw_curves(panels: Sequence[Axes], chart: Chart) -> None:
    """Draw the curves of a chart in its panels."""
    for curve in chart.curves:
        _draw_curve(panels[curve.panel], chart, curve)


def _label(value: float, _: int | None) -> str:
    """Return the label of a logarithmic axis, at one to three numbers of each decade."""
    return f"{value:g}" if f"{value:e}"[0] in "125" else ""


def _draw_curve(axes: Axes, chart: Chart, curve: Curve) -> None:
    """Draw a curve with its band."""
    x = chart.time if curve.at is None else curve.at
    kept = chart.kept(curve, INTERVALS) if x.size > 2 * INTERVALS else np.arange(x.size)
    look: dict[str, Any] = {"color": curve.color, "label": curve.name or None}
    if curve.filled:
        axes.fill(x, curve.values, facecolor=theme.tint(curve.color, 0.25), edgecolor=curve.color)
        return
    if curve.band is not None:
        low, high = curve.band
        axes.fill_between(x[kept], low[kept], high[kept], color=curve.color, alpha=0.2, linewidth=0)
    look |= {
        "linestyle": curve.linestyle or "none",
        "linewidth": (0.8 if curve.shown else 0.4) * curve.width,
        "marker": curve.marker,
        "markersize": 3.0 if curve.linestyle else 7.0,
        "zorder": 2.0 if curve.shown else 1.9,
    }
    axes.plot(x[kept], curve.values[kept], **look)


def _scale(keys: Keys) -> tuple[Normalize, Colormap]:
    """Return the scale of the colours of maps."""
    if not keys.levels:
        return Normalize(keys.low, keys.high), matplotlib.colormaps["viridis"]
    bounds = [keys.low, *keys.levels, keys.high]
    return BoundaryNorm(bounds, len(bounds) - 1), ListedColormap(theme.SHADES)


def _draw_map(axes: Axes, keys: Keys, cells: Map) -> None:
    """Draw the cells of a map with their texts, and the line of its limit."""
    norm, colors = _scale(keys)
    axes.pcolormesh(cells.values, norm=norm, cmap=colors)
    for (row, column), text in np.ndenumerate(cells.texts):
        red, green, blue, _ = colors(norm(np.nan_to_num(cells.values[row, column])))
        dark = np.isfinite(cells.values[row, column]) and red + green + blue < 1.4
        ink: dict[str, Any] = {"color": "white" if dark else theme.INK, "fontsize": 8.5}
        axes.text(column + 0.5, row + 0.5, text, ha="center", va="center", **ink)
    if cells.limit is not None:
        middles = [np.arange(count) + 0.5 for count in cells.values.shape[::-1]]
        axes.contour(*middles, cells.values, [cells.limit], colors="red", linestyles=":")
    for axis, labels in ((axes.xaxis, keys.abscissas), (axes.yaxis, keys.ordinates)):
        shown = range(0, len(labels), -(-len(labels) // MOST_LABELS))
        axis.set_ticks([i + 0.5 for i in shown], [labels[i] for i in shown])
    axes.set(ylabel=keys.heading, facecolor=theme.RULE)
    axes.grid(visible=False)


def svg_uri(sheet: Sheet) -> str:
    """Return a sheet as the data URI of an SVG picture."""
    content = BytesIO()
    with matplotlib.rc_context(theme.RC | theme.SVG_RC):
        sheet.savefig(content, format="svg", metadata={"Date": None})
    return f"data:image/svg+xml;base64,{base_64(content.getvalue())}"
