# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of load charts: capacities over radius, and the range diagram."""

from __future__ import annotations

from math import cos, radians, sin
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib import rc_context
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from protractile.geometry.typography import number
from protractile.runs.chart.cells import Cell, chart_of
from protractile.runs.chart.run import Chart
from protractile.runs.report import theme

# Colour of what governs, by its kind; the colour-blind can distinguish them.
_COLORS = dict(
    zip(
        ("yield", "plate", "column", "pad", "cylinder", "pin", "deflection", "tipping"),
        ("#d55e00", "#e69f00", "#8a6d00", "#cc79a7", "#0072b2", "#56b4e9", "#009e73", "#6a3fd0"),
        strict=True,
    )
)


class Picture(NamedTuple):
    """A picture of a chart."""

    path: Path  #: its file
    title: str  #: what it shows


def pale(kind: str) -> str:
    """Return the colour of the cells that a kind of proof governs, in CSS notation."""
    return str(to_hex(theme.tint(_COLORS.get(kind, theme.FAINT), 0.3)))


def draw(chart: Chart, folder: Path) -> list[Picture]:
    """Draw both pictures into a folder."""
    pictures = []
    with rc_context(theme.RC):
        for name, title, plot in (
            ("capacities", "The chart over the radius, one curve for each length", _over_radius),
            ("range", "Range of the tip; numbers as in the chart", _range),
        ):
            figure = Figure(figsize=(theme.WIDTH, 4.2))
            plot(chart, figure.add_subplot())
            pictures.append(Picture(folder / f"{name}.png", title))
            figure.savefig(pictures[-1].path)
    return pictures


def _value(chart: Chart, cell: Cell) -> float:
    """Return the capacity in t, or with a rated payload the governing utilisation in percent."""
    if chart_of(chart.case).payload is not None:
        return 100.0 * (cell.proofs[0].utilisation or 0.0)
    return 1.0e-3 * (cell.capacity or 0.0)


def _over_radius(chart: Chart, axes: Any) -> None:
    for index, cells in enumerate(chart.cells):
        carrying = [cell for cell in cells if cell.capacity]
        axes.plot(
            [cell.radius for cell in carrying],
            [_value(chart, cell) for cell in carrying],
            color=theme.PALETTE[index % len(theme.PALETTE)],
            marker="o",
            markersize=3,
            label=f"{number(cells[0].length)} m",
        )
    of_payload = chart_of(chart.case).payload is not None
    heading = "governing utilisation (%)" if of_payload else "capacity (t)"
    axes.set(xlabel="radius (m)", ylabel=heading, ylim=(0.0, None))
    axes.legend(title="length")


def _range(chart: Chart, axes: Any) -> None:
    chassis, (least, most) = chart.case.chassis, chart_of(chart.case).angles
    foot = (0.0, 0.0) if chassis is None else (chassis.foot_ahead, chassis.foot_above)
    turns = np.radians(np.linspace(least, most, 60))
    for index, cells in enumerate(chart.cells):
        color = theme.PALETTE[index % len(theme.PALETTE)]
        length = cells[0].length
        arc = foot[0] + length * np.cos(turns), foot[1] + length * np.sin(turns)
        axes.plot(*arc, color=color, linewidth=0.8, linestyle=":")
        carrying = [cell for cell in cells if cell.capacity]
        places = [cell.radius for cell in carrying], [cell.height for cell in carrying]
        axes.plot(*places, color=color, marker=".", label=f"{number(length)} m")
        for cell in carrying[:: max(1, len(carrying) // 4)]:
            axes.annotate(
                number(_value(chart, cell)), (cell.radius, cell.height), fontsize=8, color=color
            )
    longest = max(cells[0].length for cells in chart.cells)
    for angle in (least, most):
        tip = longest * cos(radians(angle)), longest * sin(radians(angle))
        ends = [foot[0], foot[0] + tip[0]], [foot[1], foot[1] + tip[1]]
        axes.plot(*ends, color=theme.FAINT, linewidth=0.8)
    axes.axhline(0.0, color=theme.INK, linewidth=0.8)
    axes.set(xlabel="radius (m)", ylabel="height (m)", aspect="equal")
    axes.legend(title="length", loc="upper right")
