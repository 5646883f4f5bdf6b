# SPDX-License-Identifier: LGPL-3.0-or-later
"""Design charts of a sweep, as PNG.

One varied key: a panel for each quantity, a line for each model. Two keys: a map of each model for
the first three quantities. More: lines over the first key for each combination of the ends of the
others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Literal

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet

from geometry.arrays import Array
from runs.report import theme
from runs.report.figure_context import new_sheet
from runs.sweep.quantities import QUANTITIES, Quantity

# What two keys are mapped for; the others are for checking, and in the files.
MAPPED = QUANTITIES[:3]
# From this ratio of the largest to the smallest value on an axis is logarithmic.
DECADES = 100.0
# Labels along an axis that do not run into one another.
MOST_TICKS = 6
# Contours through fewer values along an axis would be guesses.
LEAST_FOR_CONTOURS = 4

_SUPERSCRIPT = str.maketrans({"^": "", "2": "²", "3": "³", "4": "⁴", "n": "ⁿ"})


def draw(data: xr.Dataset, play_free: Sequence[str], folder: Path) -> None:
    """Draw the charts.

    Args:
        data: of :func:`runs.sweep.output.gather`.
        play_free: models without play.
        folder: where the PNG files go; it must exist.
    """
    keys = [str(dim) for dim in data["failed"].dims if dim != "model"]
    strokes = theme.strokes([str(name) for name in data["model"].values], play_free)
    with matplotlib.rc_context(theme.RC):
        if len(keys) == 2:
            for quantity in MAPPED:
                if np.isfinite(data[quantity.name].values).any():
                    _map(data, quantity, keys, folder)
            return
        ends = [(data[key].values[0], data[key].values[-1]) for key in keys[1:]]
        for count, others in enumerate(product(*ends), start=1):
            there = dict(zip(keys[1:], others, strict=True))
            part = data.sel(there)
            # Where everything failed there is nothing to draw.
            if np.isfinite(part[MAPPED[0].name].values).any():
                title = f"Sweep over {keys[0]}" + "".join(f", {k} {v:g}" for k, v in there.items())
                name = f"sweep-lines-{count}.png" if ends else "sweep-lines.png"
                _lines(part, strokes, title, folder / name)


def draw_frequencies(data: xr.Dataset, path: Path) -> None:
    """Draw frequencies over one key, a panel for each mode.

    Args:
        data: of :func:`runs.sweep.frequencies.gather`.
        path: of the PNG file.
    """
    (key,) = (str(dim) for dim in data.dims if dim not in ("model", "joints", "mode"))
    strokes = theme.strokes([str(name) for name in data["model"].values], ())
    modes = data["mode"].values
    with matplotlib.rc_context(theme.RC):
        sheet, panels = new_sheet(len(modes), 1.2 + 1.8 * len(modes))
        for axes, mode in zip(panels, modes, strict=True):
            for name, stroke in strokes.items():
                for joints, line in (("pressed", "-"), ("tied", "--")):
                    axes.plot(
                        data[key].values,
                        data["frequency"].sel(model=name, joints=joints, mode=mode).values,
                        color=stroke.color,
                        linestyle=line,
                        marker="o",
                        markersize=4.0,
                        label=f"{name}, joints {joints}",
                    )
            axes.set_title(f"mode {mode} (Hz)")
            axes.set_ylim(bottom=0.0)
        _scale(panels[-1], "x", data[key])
        handles, labels = panels[0].get_legend_handles_labels()
        sheet.legend(handles, labels, loc="outside lower left", ncols=2)
        _finish(sheet, f"First frequencies over {key}", path)


def _lines(data: xr.Dataset, strokes: Mapping[str, theme.Stroke], title: str, path: Path) -> None:
    """All quantities over the one key that is left."""
    (key,) = (str(dim) for dim in data["failed"].dims if dim != "model")
    shown = [q for q in QUANTITIES if np.isfinite(data[q.name].values).any()]
    sheet, panels = new_sheet(len(shown), 1.2 + 1.8 * len(shown))
    for axes, quantity in zip(panels, shown, strict=True):
        for name, stroke in strokes.items():
            axes.plot(
                data[key].values,
                quantity.factor * data[quantity.name].sel(model=name).values,
                color=stroke.color,
                linestyle=stroke.linestyle,
                marker="o",
                markersize=4.0,
                label=name,
            )
        axes.set_title(f"{quantity.title} ({quantity.shown_unit})")
        if quantity.logarithmic:
            axes.set_yscale("log")
    _scale(panels[-1], "x", data[key])
    handles, labels = panels[0].get_legend_handles_labels()
    sheet.legend(handles, labels, loc="outside lower left", ncols=2)
    _finish(sheet, title, path)


def _map(data: xr.Dataset, quantity: Quantity, keys: Sequence[str], folder: Path) -> None:
    """One quantity over two keys, a panel for each model that has it, all with one scale."""
    places = (data[keys[0]].values, data[keys[1]].values)
    edges = [_edges(along) for along in places]
    values = quantity.factor * data[quantity.name].transpose("model", keys[1], keys[0])
    failed = data["failed"].transpose("model", keys[1], keys[0])
    known = np.isfinite(values.values).any(axis=(1, 2))
    names = [str(name) for name in values["model"].values[known]]
    sheet, panels = new_sheet(len(names), 1.4 + 2.4 * len(names))
    low, high = float(values.min()), float(values.max())
    for axes, name in zip(panels, names, strict=True):
        # Labels of contours stand where they belong if the scales are known before them.
        _scale(axes, "x", data[keys[0]])
        _scale(axes, "y", data[keys[1]])
        of_model = values.sel(model=name).values
        mesh = axes.pcolormesh(*edges, of_model, vmin=low, vmax=high, cmap="viridis")
        if min(of_model.shape) >= LEAST_FOR_CONTOURS and np.nanmax(of_model) > np.nanmin(of_model):
            lines = axes.contour(*places, of_model, colors="white", linewidths=0.8)
            axes.clabel(lines, fontsize=9.0)
        rows, columns = np.nonzero(failed.sel(model=name).values)
        axes.plot(places[0][columns], places[1][rows], "x", color=theme.INK)
        axes.set(title=name, facecolor=theme.RULE)
        axes.grid(visible=False)
        axes.label_outer()
    sheet.colorbar(mesh, ax=panels, label=f"{quantity.title} ({quantity.shown_unit})", aspect=40)
    left_out = [str(name) for name in values["model"].values[~known]]
    remarks = [
        *([f"grey: no {quantity.title}"] if values[known].isnull().any() else []),
        *(["×: the numerics failed"] if failed[known].values.any() else []),
        *([f"without any: {', '.join(left_out)}"] if left_out else []),
    ]
    sheet.supxlabel("; ".join(remarks), x=0.02, ha="left", fontsize=9.0)
    title = f"{quantity.title[0].upper()}{quantity.title[1:]}: {low:.3g} to {high:.3g} "
    path = folder / f"sweep-{quantity.name.replace('_', '-')}.png"
    _finish(sheet, title + quantity.shown_unit, path)


def _spans_decades(values: Array) -> bool:
    return bool(values[0] > 0.0 and values[-1] >= DECADES * values[0])


def _edges(values: Array) -> Array:
    """(num_values + 1,) bounds half way between rising values, on the scale of their axis."""
    along: Array = np.log(values) if _spans_decades(values) else values
    between = 0.5 * (along[:-1] + along[1:])
    bounds: Array = np.concatenate(
        [[2.0 * along[0] - between[0]], between, [2.0 * along[-1] - between[-1]]]
    )
    return np.asarray(np.exp(bounds)) if _spans_decades(values) else bounds


def _scale(axes: Axes, which: Literal["x", "y"], values: xr.DataArray) -> None:
    """Label an axis with its key and unit; logarithmic where values span decades."""
    unit, places = values.attrs["units"], values.values
    label = str(values.name) + ("" if unit == "1" else f" ({unit.translate(_SUPERSCRIPT)})")
    axes.set(**{f"{which}label": label})
    if _spans_decades(places):
        axes.set(**{f"{which}scale": "log"})
    elif places.size <= MOST_TICKS and np.ptp(np.diff(places)) <= 1.0e-9 * np.ptp(places):
        # Nothing is known between them.
        axes.set(**{f"{which}ticks": places})
    else:
        axes.locator_params(axis=which, nbins=MOST_TICKS)


def _finish(sheet: Sheet, title: str, path: Path) -> None:
    sheet.suptitle(title, x=0.02, ha="left", fontsize=12.0, fontweight="bold", wrap=True)
    sheet.savefig(path)
