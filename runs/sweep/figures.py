# SPDX-License-Identifier: LGPL-3.0-or-later
"""Design charts of a sweep, as PNG.

With one varied key, each quantity has a panel and each model a line. With two keys, each quantity
has a map for each model. With more keys, there are lines over the first key for each combination of
the first and last values of the others. Quantities that do not change are omitted.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path
from typing import Any, Literal

import matplotlib
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.contour import ContourSet
from matplotlib.figure import Figure as Sheet

from protractile.analysis.quantities import Quantity
from protractile.geometry.arrays import Array
from protractile.geometry.typography import SHOWN, in_shown_unit, number
from protractile.runs.pipeline.quantities import QUANTITIES
from protractile.runs.report import theme
from protractile.runs.report.figure_context import new_sheet
from protractile.runs.sweep.distances import DISTANCES, LEVELS, TIP_DEVIATION, UNTIL

CHARTED = [quantity for quantity in QUANTITIES if quantity.charted]
# Name of the attribute of a variable that has the limit of the quantity.
PERMITTED = "permitted"
# Maximum number of readable cells of a map along each axis.
MOST_CELLS = 10
# Limits of the largest value, between which a quantity is in its display unit.
_DISPLAYED = {"N": (1.0e3, np.inf), "N m": (1.0e3, np.inf), "Pa": (1.0e5, np.inf),
              "N/m": (1.0e6, np.inf), "m": (np.nextafter(0.0, 1.0), 1.0)}  # fmt: skip
# Relative change below which a quantity counts as constant.
SAME = 1.0e-6
# Ratio of the largest to the smallest value above which an axis is logarithmic.
DECADES = 100.0
# Maximum number of labels along an axis.
MOST_TICKS = 6
# Minimum number of values along each axis for contour lines.
LEAST_FOR_CONTOURS = 4

# Colours between the levels of differences; larger differences are darker.
_SHADES = ("#fff3c4", "#f6b26b", "#b8577a", "#3b1f5c")
# Largest and smallest difference in percent in charts; others are clipped.
_MOST, _LEAST = 100.0, 0.01
# Width in inches of each additional column of maps.
_COLUMN = 3.6

# Names of keys in charts, if they do not follow from the key.
_WORDS = {"gravity.acceleration": "gravity", "damping.modal": "modal damping"}

_SUPERSCRIPT = str.maketrans({"^": "", "2": "²", "3": "³", "4": "⁴", "n": "ⁿ"})


def draw(data: xr.Dataset, bonded: Sequence[str], folder: Path) -> None:
    """Draw the charts of a sweep: curves over the first key, or maps over two keys.

    ``bonded`` are the names of the models without play.
    """
    data = in_display_units(data)
    keys = [str(dim) for dim in data["failed"].dims if dim != "model"]
    line_styles = _line_styles(data, bonded)
    with matplotlib.rc_context(theme.RC):
        if len(keys) == 2:
            for quantity in _varying_quantities(data):
                _map(data, quantity, keys, folder)
            return
        for count, selection in enumerate(_at_ends(data, keys[1:]), start=1):
            part = data.sel(selection)
            # Nothing to draw if all points failed.
            if changing := _varying_quantities(part):
                sheet, panels = _lines(part, keys[0], changing, line_styles)
                for axes, quantity in zip(panels, changing, strict=True):
                    axes.set_yscale("log" if quantity.logarithmic else "linear")
                    if (permitted := _permitted(part, quantity)) is not None:
                        axes.axhline(permitted, **theme.LIMIT)
                        axes.set_title(f"{axes.get_title(loc='left')}, dotted: limit")
                where = "".join(f", {_quantity(key)} {value:g}" for key, value in selection.items())
                name = f"sweep-lines-{count}.png" if selection else "sweep-lines.png"
                _finish(sheet, f"Sweep over {_quantity(keys[0])}{where}", folder / name)


def _permitted(data: xr.Dataset, quantity: Quantity) -> float | None:
    """Return the limit of a quantity in its displayed unit; None if it has no limit."""
    permitted = data[quantity.name].attrs.get(PERMITTED)
    return None if permitted is None else float(quantity.factor * permitted)


def _at_ends(data: xr.Dataset, keys: Sequence[str]) -> Iterator[dict[str, float]]:
    """Yield each combination of the first and last values of keys; ``{}`` if there are no keys."""
    ends = [(data[key].values[0], data[key].values[-1]) for key in keys]
    for values in product(*ends):
        yield dict(zip(keys, values, strict=True))


def _varying_quantities(data: xr.Dataset) -> list[Quantity]:
    """Return the quantities that change over the keys, or all with values if none changes."""
    available = [charted for charted in CHARTED if np.isfinite(data[charted.name].values).any()]

    def changes(charted: Quantity) -> bool:
        values = data[charted.name]
        keys = [dim for dim in values.dims if dim != "model"]
        spans = (values.max(keys) - values.min(keys)).values
        return bool(np.nanmax(spans) > SAME * np.nanmax(np.abs(values.values)))

    return [charted for charted in available if changes(charted)] or available


def in_display_units(data: xr.Dataset) -> xr.Dataset:
    """Return the data with the values of keys in displayed units, such as mm or kN."""
    coordinates = {}
    for name, along in data.coords.items():
        if (unit := along.attrs.get("units")) not in _DISPLAYED:
            continue
        least, limit = _DISPLAYED[unit]
        if least <= np.abs(along.values).max() < limit:
            # Values are rounded to readable numbers.
            shown = [in_shown_unit(value, unit) for value in along.values]
            values = np.array([float(f"{value:.12g}") for value in shown])
            coordinates[name] = (along.dims, values, {**along.attrs, "units": SHOWN[unit]})
    return data.assign_coords(coordinates)


def draw_distances(data: xr.Dataset, reference: str, folder: Path) -> None:
    """Draw the differences of models from a reference: lines over one key, maps over several.

    ``data`` is without the reference.
    """
    data = in_display_units(data)
    keys = [str(dim) for dim in data["failed"].dims if dim != "model"]
    available = [
        distance for distance in DISTANCES if np.isfinite(data[distance.name].values).any()
    ]
    with matplotlib.rc_context(theme.RC):
        if len(keys) > 1:
            for quantity in available:
                _distance_maps(data, quantity, keys, reference, folder)
        elif available:
            floor = {
                distance.name: np.maximum(data[distance.name], _LEAST / distance.factor)
                for distance in available
            }
            shown = data.assign(floor)
            sheet, panels = _lines(shown, keys[0], available, _line_styles(data, ()))
            for axes in panels:
                for level in LEVELS:
                    axes.axhline(level, color=theme.INK, linewidth=0.8, linestyle=":")
                axes.set_yscale("log")
                axes.set_yticks(LEVELS, [f"{level:g}" for level in LEVELS])
            title = f"Deviation from {reference} over {_quantity(keys[0])}"
            _finish(sheet, title, folder / "sweep-distances.png")


def _line_styles(data: xr.Dataset, bonded: Sequence[str]) -> dict[str, theme.LineStyle]:
    return theme.line_styles([str(name) for name in data["model"].values], bonded)


def _lines(
    data: xr.Dataset,
    key: str,
    quantities: Sequence[Quantity],
    line_styles: Mapping[str, theme.LineStyle],
) -> tuple[Sheet, list[Axes]]:
    """Return a figure and its panels, one for each quantity over a key, with a line per model."""
    sheet, panels = new_sheet(len(quantities), 1.2 + 1.8 * len(quantities))
    for axes, shown in zip(panels, quantities, strict=True):
        for name, style in line_styles.items():
            values = shown.factor * data[shown.name].sel(model=name)
            (line,) = axes.plot(data[key], values, marker="o", markersize=4.0, label=name)
            line.set(color=style.color, linestyle=style.linestyle)
        axes.set_title(f"{shown.title} ({shown.shown_unit})")
    _scale_axis(panels[-1], "x", data[key])
    handles, labels = panels[0].get_legend_handles_labels()
    sheet.legend(handles, labels, loc="outside lower left", ncols=2)
    return sheet, panels


def _map(data: xr.Dataset, quantity: Quantity, keys: Sequence[str], folder: Path) -> None:
    """Draw maps of a quantity over two keys, one for each model with values, on a common scale."""
    x, y = (data[key] for key in keys)
    values = quantity.factor * data[quantity.name].transpose("model", *keys[::-1])
    permitted = _permitted(data, quantity)
    failed = data["failed"].transpose("model", *keys[::-1])
    has_values = np.isfinite(values.values).any(axis=(1, 2))
    names = [str(name) for name in values["model"].values[has_values]]
    sheet, panels = new_sheet(len(names), 1.4 + 2.4 * len(names))
    low, high = float(values.min()), float(values.max())
    for axes, name in zip(panels, names, strict=True):
        # Scales must be set before contours, whose labels would be misplaced otherwise.
        _scale_axis(axes, "x", x)
        _scale_axis(axes, "y", y)
        cells = values.sel(model=name).values
        edges = _edges(x.values), _edges(y.values)
        mesh = axes.pcolormesh(*edges, cells, vmin=low, vmax=high, cmap="viridis")
        if max(cells.shape) <= MOST_CELLS:
            for row, column in np.argwhere(np.isfinite(cells)):
                value = float(cells[row, column])
                color = "white" if value < 0.5 * (low + high) else theme.INK
                centred: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 8.5}
                axes.text(x.values[column], y.values[row], number(value), color=color, **centred)
        elif min(cells.shape) >= LEAST_FOR_CONTOURS and np.nanmax(cells) > np.nanmin(cells):
            lines = axes.contour(x.values, y.values, cells, colors="white", linewidths=0.8)
            axes.clabel(lines, fontsize=9.0)
        if permitted is not None and np.nanmin(cells) < permitted < np.nanmax(cells):
            axes.contour(x.values, y.values, cells, [permitted], colors="red", linestyles=":")
        rows, columns = np.nonzero(failed.sel(model=name).values)
        axes.plot(x.values[columns], y.values[rows], "x", color=theme.INK)
        axes.set(title=name, facecolor=theme.RULE)
        axes.grid(visible=False)
        axes.label_outer()
    sheet.colorbar(mesh, ax=panels, label=f"{quantity.title} ({quantity.shown_unit})", aspect=40)
    without_values = [str(name) for name in values["model"].values[~has_values]]
    remarks = [
        *([f"grey: no {quantity.title}"] if values[has_values].isnull().any() else []),
        *([] if permitted is None else [f"red, dotted: limit of {permitted:.4g}"]),
        *(["×: the computation failed"] if failed[has_values].values.any() else []),
        *([f"no values: {', '.join(without_values)}"] if without_values else []),
    ]
    sheet.supxlabel("; ".join(remarks), x=0.02, ha="left", fontsize=9.0)
    title = f"{quantity.title[0].upper()}{quantity.title[1:]}: {low:.3g} to {high:.3g} "
    _finish(sheet, title + quantity.shown_unit, folder / _name(quantity))


def _distance_maps(
    data: xr.Dataset, quantity: Quantity, keys: Sequence[str], reference: str, folder: Path
) -> None:
    """Draw maps of a difference over the last two keys, for each model with values.

    There is a map for each combination of the first and last values of the other keys.
    """
    *outer_keys, x, y = keys
    parts = [data.sel(selection) for selection in _at_ends(data, outer_keys)]
    values = quantity.factor * data[quantity.name]
    model_names = [
        name for name in values["model"].values if np.isfinite(values.sel(model=name)).any()
    ]
    width = theme.WIDTH + (len(parts) - 1) * _COLUMN
    sheet = Sheet(figsize=(width, 1.4 + 2.2 * len(model_names)))
    theme.Canvas(sheet)
    grid = sheet.subplots(len(model_names), len(parts), sharex=True, sharey=True, squeeze=False)
    for part, column in zip(parts, grid.T, strict=True):
        for axes, name in zip(column, model_names, strict=True):
            _scale_axis(axes, "x", data[x])
            _scale_axis(axes, "y", data[y])
            difference = quantity.factor * part[quantity.name].sel(model=name).transpose(y, x)
            shade = _shade(axes, difference)
            if quantity.name == TIP_DEVIATION:
                _write_ends(axes, part[UNTIL].transpose(y, x), float(data[UNTIL].max()))
            axes.label_outer()
        where = ", ".join(f"{_quantity(key)} {part[key].item():g}" for key in outer_keys)
        column[0].set_title("\n".join(filter(None, [where, column[0].get_title(loc="left")])))
    sheet.colorbar(shade, ax=grid, label=f"{quantity.title} (%)", aspect=40)
    if quantity.name == TIP_DEVIATION and data[UNTIL].min() < data[UNTIL].max():
        until = (
            f"in the maps: time up to which tips are compared; elsewhere {data[UNTIL].max():g} s"
        )
        sheet.supxlabel(until, x=0.02, ha="left", fontsize=9.0)
    title = f"{quantity.title[0].upper()}{quantity.title[1:]} from {reference}"
    _finish(sheet, title, folder / _name(quantity))


def _shade(axes: Axes, difference: xr.DataArray) -> ContourSet:
    """Draw a map of differences in percent, with contour lines at ``LEVELS``."""
    y, x = (difference[dim].values for dim in difference.dims)
    least, most = float(difference.min()), float(difference.max())
    levels = [0.0, *LEVELS, _MOST]
    shade = axes.contourf(x, y, np.clip(difference, 0.0, _MOST), levels=levels, colors=_SHADES)
    if least < LEVELS[-1] and most > LEVELS[0]:
        lines = axes.contour(x, y, difference, levels=LEVELS, colors=theme.INK)
        for label in axes.clabel(lines, fmt="%g %%", fontsize=9.0):
            label.set_path_effects(theme.OUTLINED)
    name = difference["model"].item()
    axes.set(title=f"{name}: {least:.2g} to {most:.2g} %", facecolor=theme.RULE)
    return shade


def _write_ends(axes: Axes, until: xr.DataArray, longest: float) -> None:
    """Write the time up to which tips are compared at points where it is below the longest."""
    y, x = (until[dim].values for dim in until.dims)
    for row, column in np.argwhere(until.values < longest):
        text = f"{until.values[row, column]:.1f} s"
        # The text at the edge of a panel stays within the panel.
        style: dict[str, Any] = {
            "ha": {0: "left", x.size - 1: "right"}.get(column, "center"),
            "va": {0: "bottom", y.size - 1: "top"}.get(row, "center"),
        }
        axes.text(x[column], y[row], text, fontsize=7.0, path_effects=theme.OUTLINED, **style)


def _spans_decades(values: Array) -> bool:
    return bool(values[0] > 0.0 and values[-1] >= DECADES * values[0])


def _edges(values: Array) -> Array:
    """Return the bounds (num_values + 1,) of map cells around ascending values."""
    positions: Array = np.log(values) if _spans_decades(values) else values
    outer = np.pad(positions, 1, mode="reflect", reflect_type="odd")
    bounds: Array = 0.5 * (outer[:-1] + outer[1:])
    return np.asarray(np.exp(bounds)) if _spans_decades(values) else bounds


def _quantity(key: Hashable) -> str:
    """Return a key in words: ``joint[1].play`` becomes *play, joint 1*."""
    if key in _WORDS:
        return _WORDS[str(key)]
    *path, what = re.sub(r"\[(\d+)\]", r" \1", str(key)).replace("_", " ").split(".")
    part = " ".join(path)
    if part in ("", "joint"):
        return what
    return f"{what}, {part}" if part[-1].isdigit() else f"{part} {what}"


def _scale_axis(axes: Axes, which: Literal["x", "y"], values: xr.DataArray) -> None:
    """Label an axis with quantity and unit, and make it logarithmic if values span decades."""
    unit, places = values.attrs["units"], values.values
    label = _quantity(values.name) + ("" if unit == "1" else f" ({unit.translate(_SUPERSCRIPT)})")
    axes.set(**{f"{which}label": label})
    if _spans_decades(places):
        axes.set(**{f"{which}scale": "log"})
    elif places.size <= MOST_TICKS and np.ptp(np.diff(places)) <= 1.0e-9 * np.ptp(places):
        # The axis has labels only at the values of the sweep.
        axes.set(**{f"{which}ticks": places})
    else:
        axes.locator_params(axis=which, nbins=MOST_TICKS)


def _finish(sheet: Sheet, title: str, path: Path) -> None:
    sheet.suptitle(title, x=0.02, ha="left", fontsize=12.0, fontweight="bold", wrap=True)
    sheet.savefig(path)


def _name(quantity: Quantity) -> str:
    return f"sweep-{quantity.name.replace('_', '-')}.png"
