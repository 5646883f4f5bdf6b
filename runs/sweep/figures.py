# SPDX-License-Identifier: LGPL-3.0-or-later
"""Design charts of a sweep, as PNG.

One varied key: a panel for each quantity, a line for each model. Two keys: a map of each model for
each quantity. More: lines over the first key for each combination of the ends of the others. What
does not change, and what is noise, is left out. Where the one key is how fast a boom is drawn out,
its swing over the speed has a chart of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Literal

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet

from geometry.arrays import Array
from geometry.typography import TO_KILO, TO_MEGA, TO_MILLI
from runs.pipeline.metrics import Metric
from runs.report import theme
from runs.report.figure_context import new_sheet
from runs.report.numerals import number
from runs.sweep.quantities import QUANTITIES
from runs.sweep.swings import draw_swings

CHARTED = [quantity for quantity in QUANTITIES if quantity.charted]
# Numbers along axes are whole: none is to be added to another one at their end.
RC = {**theme.RC, "axes.formatter.useoffset": False}
# Cells of a map that can be read, along each axis.
MOST_CELLS = 10
# From so many of a unit on, or below so many, the numbers of a key are shown in another one.
_LARGE = {"N": (1.0e3, TO_KILO, "kN"), "N m": (1.0e3, TO_KILO, "kN m"),
          "Pa": (1.0e5, TO_MEGA, "MPa"), "N/m": (1.0e6, 1.0e-6, "kN/mm")}  # fmt: skip
_SMALL = {"m": (1.0, TO_MILLI, "mm")}
# What changes by less than this part is the same.
SAME = 1.0e-6
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
    data = in_shown_units(data)
    keys = [str(dim) for dim in data["failed"].dims if dim != "model"]
    strokes = theme.strokes([str(name) for name in data["model"].values], play_free)
    with matplotlib.rc_context(RC):
        if len(keys) == 2:
            for quantity in _changing(data):
                _map(data, quantity, keys, folder)
            return
        for part, where, number in over_first_key(data, keys):
            # Where everything failed there is nothing to draw.
            if _changing(part):
                _lines(part, strokes, f"Sweep {where}", folder / f"sweep-lines{number}.png")
        if len(keys) == 1:
            draw_swings(data, strokes, folder / "sweep-swing.png")


def over_first_key(data: xr.Dataset, keys: Sequence[str]) -> Iterator[tuple[xr.Dataset, str, str]]:
    """The data at each combination of the ends of all keys but the first, where that is, in words,
    and the number behind the name of its file.
    """
    for count, there in enumerate(at_ends(data, keys[1:]), start=1):
        where = f"over {keys[0]}" + "".join(f", {k} {v:g}" for k, v in there.items())
        yield data.sel(there), where, f"-{count}" if there else ""


def at_ends(data: xr.Dataset, keys: Sequence[str]) -> Iterator[dict[str, float]]:
    """Each combination of the ends of some keys; one of nothing where there are none."""
    ends = [(data[key].values[0], data[key].values[-1]) for key in keys]
    for values in product(*ends):
        yield dict(zip(keys, values, strict=True))


def _changing(data: xr.Dataset) -> list[Metric]:
    """Those that a chart says something of; where nothing changes, all that are known."""
    known = [one for one in CHARTED if np.isfinite(data[one.name].values).any()]

    def changes(one: Metric) -> bool:
        values = data[one.name]
        keys = [dim for dim in values.dims if dim != "model"]
        spans = (values.max(keys) - values.min(keys)).values
        return bool(np.nanmax(spans) > SAME * np.nanmax(np.abs(values.values)))

    return [one for one in known if changes(one)] or known


def in_shown_units(data: xr.Dataset) -> xr.Dataset:
    """The same with keys in mm, kN and so forth where their numbers are of that size."""
    coordinates = {}
    for name, along in data.coords.items():
        unit = along.attrs.get("units", "")
        largest = float(np.abs(along.values).max()) if unit in {*_LARGE, *_SMALL} else 0.0
        for known, fits in ((_LARGE, largest.__ge__), (_SMALL, largest.__lt__)):
            bound, factor, shown = known.get(unit, (0.0, 0.0, ""))
            if shown and largest and fits(bound):
                # As a person would write them.
                values = np.array([float(f"{factor * value:.12g}") for value in along.values])
                coordinates[name] = (along.dims, values, {**along.attrs, "units": shown})
    return data.assign_coords(coordinates)


def draw_frequencies(data: xr.Dataset, path: Path) -> None:
    """Draw frequencies over one key, a panel for each mode.

    Args:
        data: of :func:`runs.sweep.frequencies.gather`.
        path: of the PNG file.
    """
    data = in_shown_units(data)
    (key,) = (str(dim) for dim in data.dims if dim not in ("model", "joints", "mode"))
    strokes = theme.strokes([str(name) for name in data["model"].values], ())
    modes = data["mode"].values
    with matplotlib.rc_context(RC):
        sheet, panels = new_sheet(len(modes), 1.2 + 1.8 * len(modes))
        for axes, mode in zip(panels, modes, strict=True):
            for name, stroke in strokes.items():
                for joints, line in (("pressed", "-"), ("tied", "--")):
                    values = data["frequency"].sel(model=name, joints=joints, mode=mode).values
                    pen = theme.Stroke(stroke.color, line)
                    marked(axes, data[key], values, pen, f"{name}, joints {joints}")
            axes.set_title(f"mode {mode} (Hz)")
            axes.set_ylim(bottom=0.0)
        finish_lines(sheet, panels, data[key], f"First frequencies over {key}", path)


def _lines(data: xr.Dataset, strokes: Mapping[str, theme.Stroke], title: str, path: Path) -> None:
    """All quantities over the one key that is left."""
    (key,) = (str(dim) for dim in data["failed"].dims if dim != "model")
    shown = _changing(data)
    sheet, panels = new_sheet(len(shown), 1.2 + 1.8 * len(shown))
    for axes, quantity in zip(panels, shown, strict=True):
        for name, stroke in strokes.items():
            values = quantity.factor * data[quantity.name].sel(model=name).values
            marked(axes, data[key], values, stroke, name)
        axes.set_title(f"{quantity.title} ({quantity.shown_unit})")
        if quantity.logarithmic:
            axes.set_yscale("log")
    finish_lines(sheet, panels, data[key], title, path)


def _map(data: xr.Dataset, quantity: Metric, keys: Sequence[str], folder: Path) -> None:
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
        scale_axis(axes, "x", data[keys[0]])
        scale_axis(axes, "y", data[keys[1]])
        of_model = values.sel(model=name).values
        mesh = axes.pcolormesh(*edges, of_model, vmin=low, vmax=high, cmap="viridis")
        if max(of_model.shape) <= MOST_CELLS:
            _label_cells(axes, places, of_model, 0.5 * (low + high))
        elif min(of_model.shape) >= LEAST_FOR_CONTOURS and np.nanmax(of_model) > np.nanmin(
            of_model
        ):
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
    finish(sheet, title + quantity.shown_unit, path)


def _label_cells(axes: Axes, places: tuple[Array, Array], values: Array, middle: float) -> None:
    """The value in each cell, white on dark ones."""
    for row, column in np.argwhere(np.isfinite(values)):
        value = float(values[row, column])
        axes.text(
            places[0][column],
            places[1][row],
            number(value),
            ha="center",
            va="center",
            fontsize=8.5,
            color="white" if value < middle else theme.INK,
        )


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


def scale_axis(axes: Axes, which: Literal["x", "y"], values: xr.DataArray) -> None:
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


def finish(sheet: Sheet, title: str, path: Path) -> None:
    """Give a sheet its title, and write it."""
    sheet.suptitle(title, x=0.02, ha="left", fontsize=12.0, fontweight="bold", wrap=True)
    sheet.savefig(path)


def marked(
    axes: Axes, along: xr.DataArray, values: Array, stroke: theme.Stroke, label: str
) -> None:
    """A line whose points are seen."""
    (line,) = axes.plot(along.values, values, marker="o", markersize=4.0, label=label)
    line.set(color=stroke.color, linestyle=stroke.linestyle)


def finish_lines(
    sheet: Sheet, panels: Sequence[Axes], along: xr.DataArray, title: str, path: Path
) -> None:
    """Give panels of the same lines their axis, their legend and their title, and write them."""
    scale_axis(panels[-1], "x", along)
    handles, labels = panels[0].get_legend_handles_labels()
    sheet.legend(handles, labels, loc="outside lower left", ncols=2)
    finish(sheet, title, path)
