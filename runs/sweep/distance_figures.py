# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far models are from the reference, over what is varied: lines and maps with their levels."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib
import numpy as np
import xarray as xr

from runs.report import theme
from runs.report.figure_context import new_sheet
from runs.sweep.distances import DISTANCES, LEVELS
from runs.sweep.figures import RC, finish, in_shown_units, over_first_key, scale_axis
from runs.sweep.quantities import Quantity

# Below the first level, between them, beyond the last one.
_SHADES = ("#2e7d32", "#a5c882", "#f2c14e", "#b23a2e")
# In percent: more is as bad, and less as good.
_MOST, _LEAST = 100.0, 0.01


def draw_distances(data: xr.Dataset, reference: str, folder: Path) -> None:
    """Draw them as PNG: over two keys a map of each distance, else a panel of lines.

    Args:
        data: of :func:`runs.sweep.output.gather`, without the reference.
        reference: its name.
        folder: where the files go; it must exist.
    """
    data = in_shown_units(data)
    keys = [str(dim) for dim in data["failed"].dims if dim != "model"]
    with matplotlib.rc_context(RC):
        if len(keys) == 2:
            for quantity in _known(data):
                _map(data, quantity, keys, reference, folder)
            return
        for part, where, number in over_first_key(data, keys):
            if _known(part):
                title = f"Distance from {reference} {where}"
                _lines(part, keys[0], title, folder / f"sweep-distances{number}.png")


def _known(data: xr.Dataset) -> list[Quantity]:
    return [one for one in DISTANCES if np.isfinite(data[one.name].values).any()]


def _lines(data: xr.Dataset, key: str, title: str, path: Path) -> None:
    shown = _known(data)
    strokes = theme.strokes([str(name) for name in data["model"].values], ())
    sheet, panels = new_sheet(len(shown), 1.2 + 1.8 * len(shown))
    for axes, quantity in zip(panels, shown, strict=True):
        for name, stroke in strokes.items():
            off = quantity.factor * data[quantity.name].sel(model=name).values
            axes.plot(
                data[key].values,
                np.maximum(off, _LEAST),
                color=stroke.color,
                linestyle=stroke.linestyle,
                marker="o",
                markersize=4.0,
                label=name,
            )
        for level in LEVELS:
            axes.axhline(level, color=theme.INK, linewidth=0.8, linestyle=":")
        axes.set(title=f"{quantity.title} (%)", yscale="log")
        axes.set_yticks(LEVELS, [f"{level:g}" for level in LEVELS])
    scale_axis(panels[-1], "x", data[key])
    handles, labels = panels[0].get_legend_handles_labels()
    sheet.legend(handles, labels, loc="outside lower left", ncols=2)
    finish(sheet, title, path)


def _map(
    data: xr.Dataset, quantity: Quantity, keys: Sequence[str], reference: str, folder: Path
) -> None:
    """One distance over two keys, a panel for each model that has it."""
    values = quantity.factor * data[quantity.name].transpose("model", keys[1], keys[0])
    known = [name for name in values["model"].values if np.isfinite(values.sel(model=name)).any()]
    places = data[keys[0]].values, data[keys[1]].values
    sheet, panels = new_sheet(len(known), 1.4 + 2.2 * len(known))
    for axes, name in zip(panels, known, strict=True):
        scale_axis(axes, "x", data[keys[0]])
        scale_axis(axes, "y", data[keys[1]])
        off = values.sel(model=name).values
        least, most = float(np.nanmin(off)), float(np.nanmax(off))
        shade = axes.contourf(
            *places, np.clip(off, 0.0, _MOST), levels=[0.0, *LEVELS, _MOST], colors=_SHADES
        )
        if least < LEVELS[-1] and most > LEVELS[0]:
            lines = axes.contour(*places, off, levels=LEVELS, colors="black")
            axes.clabel(lines, fmt="%g %%", fontsize=9.0)
        axes.set(title=f"{name}: {least:.2g} to {most:.2g} %", facecolor=theme.RULE)
        axes.label_outer()
    sheet.colorbar(shade, ax=panels, label=f"{quantity.title} (%)", aspect=40)
    title = f"Distance from {reference}: {quantity.title}"
    finish(sheet, title, folder / f"sweep-{quantity.name.replace('_', '-')}.png")
