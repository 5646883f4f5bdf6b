# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far models are from the reference, over what is varied: lines and maps with their levels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Final, Literal, TypeVar

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure as Sheet
from numpy.typing import NDArray

from runs.pipeline.metrics import Metric
from runs.report import theme
from runs.report.figure_context import new_sheet
from runs.sweep.figures import RC, at_ends, finish, finish_lines, in_shown_units, marked, scale_axis
from runs.sweep.quantities import DISTANCES, LEVELS, TIP_OFF, UNTIL

_Word = TypeVar("_Word", bound=str)

# Below the first level, between them, beyond the last one.
_SHADES = ("#2e7d32", "#a5c882", "#f2c14e", "#b23a2e")
# In percent: more is as bad, and less as good.
_MOST, _LEAST = 100.0, 0.01
# Where letters stand at the first and the last place along an axis.
_SIDES: Final = ("left", "right")
_ENDS: Final = ("bottom", "top")
# Inches of a map beside another one.
_COLUMN = 3.6


def draw_distances(data: xr.Dataset, reference: str, folder: Path) -> None:
    """Draw them as PNG: over one key a panel of lines of each, over more maps of each.

    Args:
        data: of :func:`runs.sweep.output.gather`, without the reference.
        reference: its name.
        folder: where the files go; it must exist.
    """
    data = in_shown_units(data)
    keys = [str(dim) for dim in data["failed"].dims if dim != "model"]
    with matplotlib.rc_context(RC):
        if len(keys) > 1:
            for quantity in _known(data):
                _maps(data, quantity, keys, reference, folder)
        elif _known(data):
            title = f"Distance from {reference} over {keys[0]}"
            _lines(data, keys[0], title, folder / "sweep-distances.png")


def _known(data: xr.Dataset) -> list[Metric]:
    return [one for one in DISTANCES if np.isfinite(data[one.name].values).any()]


def _lines(data: xr.Dataset, key: str, title: str, path: Path) -> None:
    shown = _known(data)
    strokes = theme.strokes([str(name) for name in data["model"].values], ())
    sheet, panels = new_sheet(len(shown), 1.2 + 1.8 * len(shown))
    for axes, quantity in zip(panels, shown, strict=True):
        for name, stroke in strokes.items():
            off = quantity.factor * data[quantity.name].sel(model=name).values
            marked(axes, data[key], np.maximum(off, _LEAST), stroke, name)
        for level in LEVELS:
            axes.axhline(level, color=theme.INK, linewidth=0.8, linestyle=":")
        axes.set(title=f"{quantity.title} (%)", yscale="log")
        axes.set_yticks(LEVELS, [f"{level:g}" for level in LEVELS])
    finish_lines(sheet, panels, data[key], title, path)


def _maps(
    data: xr.Dataset, quantity: Metric, keys: Sequence[str], reference: str, folder: Path
) -> None:
    """One distance over the last two keys, for each model that has it and, side by side, each
    combination of the ends of the keys before them.
    """
    *before, x, y = keys
    parts = [data.sel(there) for there in at_ends(data, before)]
    values = quantity.factor * data[quantity.name]
    known = [name for name in values["model"].values if np.isfinite(values.sel(model=name)).any()]
    sheet, grid = _sheet(len(known), len(parts))
    for part, column in zip(parts, grid.T, strict=True):
        for axes, name in zip(column, known, strict=True):
            scale_axis(axes, "x", data[x])
            scale_axis(axes, "y", data[y])
            off = quantity.factor * part[quantity.name].sel(model=name).transpose(y, x)
            shade = _shade(axes, off)
            if quantity.name == TIP_OFF:
                _say_until_when(axes, part[UNTIL].transpose(y, x), float(data[UNTIL].max()))
            axes.label_outer()
        where = ", ".join(f"{key} {part[key].item():g}" for key in before)
        column[0].set_title("\n".join(filter(None, [where, column[0].get_title(loc="left")])))
    sheet.colorbar(shade, ax=grid, label=f"{quantity.title} (%)", aspect=40)
    if quantity.name == TIP_OFF and data[UNTIL].min() < data[UNTIL].max():
        until = f"compared until {data[UNTIL].max():g} s, or until where seconds stand"
        sheet.supxlabel(until, x=0.02, ha="left", fontsize=9.0)
    title = f"Distance from {reference}: {quantity.title}"
    finish(sheet, title, folder / f"sweep-{quantity.name.replace('_', '-')}.png")


def _sheet(rows: int, columns: int) -> tuple[Sheet, NDArray[np.object_]]:
    """A sheet with (rows, columns) panels that share their axes."""
    width = theme.WIDTH + (columns - 1) * _COLUMN
    sheet = Sheet(figsize=(width, 1.4 + 2.2 * rows))
    theme.Canvas(sheet)
    return sheet, sheet.subplots(rows, columns, sharex=True, sharey=True, squeeze=False)


def _shade(axes: Axes, off: xr.DataArray) -> ContourSet:
    """A map in percent, with its levels and from where to where it goes."""
    y, x = (off[dim].values for dim in off.dims)
    least, most = float(off.min()), float(off.max())
    levels = [0.0, *LEVELS, _MOST]
    shade = axes.contourf(x, y, np.clip(off, 0.0, _MOST), levels=levels, colors=_SHADES)
    if least < LEVELS[-1] and most > LEVELS[0]:
        lines = axes.contour(x, y, off, levels=LEVELS, colors="black")
        axes.clabel(lines, fmt="%g %%", fontsize=9.0)
    name = off["model"].item()
    axes.set(title=f"{name}: {least:.2g} to {most:.2g} %", facecolor=theme.RULE)
    return shade


def _say_until_when(axes: Axes, until: xr.DataArray, longest: float) -> None:
    """The seconds up to which tips are compared, where these are fewer than elsewhere."""
    y, x = (until[dim].values for dim in until.dims)
    for row, column in np.argwhere(until.values < longest):
        text = f"{until.values[row, column]:.1f} s"
        ha, va = _inwards(column, x.size, _SIDES), _inwards(row, y.size, _ENDS)
        axes.text(x[column], y[row], text, fontsize=7.0, ha=ha, va=va)


def _inwards(place: int, count: int, outer: tuple[_Word, _Word]) -> _Word | Literal["center"]:
    """How letters are aligned that are not to leave a panel."""
    return outer[0] if place == 0 else outer[1] if place == count - 1 else "center"
