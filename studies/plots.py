# SPDX-License-Identifier: LGPL-3.0-or-later
"""The curves of a study as figures."""

from __future__ import annotations

from pathlib import Path

from matplotlib import rc_context
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Sheet
from matplotlib.ticker import FixedLocator, FuncFormatter, NullFormatter

from runs.report import theme
from runs.report.figure_context import Figure
from studies.study import Plot

MARKERS = "osD^vPX"


def draw(plot: Plot, folder: Path) -> Figure:
    """Draw a plot.

    Args:
        plot: of a study.
        folder: gets ``NAME.png``.
    """
    with rc_context(theme.RC):
        sheet = Sheet(figsize=(theme.WIDTH, 4.2 + 0.16 * len(plot.curves)))
        FigureCanvasAgg(sheet)
        axes = sheet.add_subplot()
        strokes = theme.strokes(list(plot.curves), [])
        for i, (label, (x, y)) in enumerate(plot.curves.items()):
            # Many points are a curve, few are measurements.
            marker = MARKERS[i % len(MARKERS)] if len(x) <= 20 else ""
            stroke = strokes[label]
            axes.plot(
                x,
                y,
                color=stroke.color,
                linestyle=stroke.linestyle,
                marker=marker,
                markersize=5.0,
                label=label,
            )
        axes.set(xlabel=plot.x, ylabel=plot.y)
        if plot.logarithmic:
            axes.set(xscale="log", yscale="log")
            # Sizes span a decade or less: their own values say more than powers of ten.
            sizes = sorted({float(value) for x, _ in plot.curves.values() for value in x})
            if len(sizes) <= 8:
                axes.xaxis.set_major_locator(FixedLocator(sizes))
                axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
            axes.xaxis.set_minor_formatter(NullFormatter())
        if len(plot.curves) > 1:
            sheet.legend(loc="outside lower left", ncols=1 if len(plot.curves) < 4 else 2)
        sheet.suptitle(plot.title, x=0.02, ha="left", fontsize=12.0, fontweight="bold", wrap=True)
        path = folder / f"{plot.name}.png"
        sheet.savefig(path)
    return Figure(path, plot.title, plot.caption)
