# SPDX-License-Identifier: LGPL-3.0-or-later
"""Design charts of a sweep.

With one varied key, each quantity has a panel and each model a line. With two keys, each quantity
has a chart with a map for each model. With more keys, there are lines over the first key for each
combination of the first and last values of the others. Quantities that do not change are omitted.
"""

from __future__ import annotations

import re
from collections.abc import Hashable, Iterator, Sequence
from itertools import chain, product

import numpy as np
import numpy.typing as npt
import xarray as xr

from protractile.analysis.quantities import Quantity
from protractile.geometry.arrays import Array
from protractile.geometry.typography import SHOWN, in_shown_unit, number
from protractile.runs.pipeline.quantities import QUANTITIES
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve, Keys, Map
from protractile.runs.report.figure_context import Figure
from protractile.runs.sweep.distances import DISTANCES, LEVELS, TIP_DEVIATION, UNTIL

CHARTED = [quantity for quantity in QUANTITIES if quantity.charted]
# Name of the attribute of a variable that has the limit of the quantity.
PERMITTED = "permitted"
# Maximum number of cells along each axis of a map whose texts are readable.
MOST_CELLS = 10
# Limits of the largest value, between which a quantity is in its display unit.
_DISPLAYED = {"N": (1.0e3, np.inf), "N m": (1.0e3, np.inf), "Pa": (1.0e5, np.inf),
              "N/m": (1.0e6, np.inf), "m": (np.nextafter(0.0, 1.0), 1.0)}  # fmt: skip
# Relative change below which a quantity counts as constant.
SAME = 1.0e-6
# Ratio of the largest to the smallest value above which an axis is logarithmic.
DECADES = 100.0
# Largest and smallest difference in percent in charts; others are clipped.
_MOST, _LEAST = 100.0, 0.01

# Names of keys in charts, if they do not follow from the key.
_WORDS = {"gravity.acceleration": "gravity", "damping.modal": "modal damping"}

_SUPERSCRIPT = str.maketrans({"^": "", "2": "²", "3": "³", "4": "⁴", "n": "ⁿ"})


def sweep_figures(data: xr.Dataset, bonded: Sequence[str]) -> list[Figure]:
    """Return the charts of a sweep: curves over the first key, or maps over two keys.

    ``bonded`` are the names of the models without play.
    """
    data = in_display_units(data)
    keys = [str(dim) for dim in data["failed"].dims if dim != "model"]
    if len(keys) == 2:
        return [*chain(*(_maps(data, one, keys) for one in _varying_quantities(data)))]
    figures = []
    for count, selection in enumerate(_at_ends(data, keys[1:]), start=1):
        part = data.sel(selection)
        # There is no chart if all points failed.
        if changing := _varying_quantities(part):
            where = "".join(f", {_quantity(key)} {value:g}" for key, value in selection.items())
            name = f"sweep-lines-{count}" if selection else "sweep-lines"
            title = f"Sweep over {_quantity(keys[0])}{where}"
            figures.append(_lines(part, keys[0], changing, bonded, name, title))
    return figures


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


def distance_figures(data: xr.Dataset, reference: str) -> list[Figure]:
    """Return charts of differences from a reference: lines over one key, maps over several.

    ``data`` is without the reference.
    """
    data = in_display_units(data)
    keys = [str(dim) for dim in data["failed"].dims if dim != "model"]
    available = [one for one in DISTANCES if np.isfinite(data[one.name].values).any()]
    if len(keys) > 1:
        return [*chain(*(_maps(data, one, keys, reference, LEVELS) for one in available))]
    if not available:
        return []
    shown = data.assign(
        {one.name: np.maximum(data[one.name], _LEAST / one.factor) for one in available}
    )
    title = f"Deviation from {reference} over {_quantity(keys[0])}"
    return [_lines(shown, keys[0], available, (), "sweep-distances", title, LEVELS)]


def _lines(
    data: xr.Dataset,
    key: str,
    quantities: Sequence[Quantity],
    bonded: Sequence[str],
    name: str,
    title: str,
    levels: Sequence[float] = (),
) -> Figure:
    """Return lines of quantities over a key, a panel for each, with their limits or levels."""
    x, curves, panels = data[key].values, [], []
    styles = theme.line_styles([str(model) for model in data["model"].values], bonded)
    for panel, one in enumerate(quantities):
        for model, style in styles.items():
            values = one.factor * data[one.name].sel(model=model).values
            look = style.color, style.linestyle
            curves.append(Curve(model, values, *look, panel=panel, marker="o"))
        permitted = _permitted(data, one)
        panels.append(f"{one.title} ({one.shown_unit})" + ", dotted: limit" * bool(permitted))
        curves += [
            Curve("", np.full(x.size, level), theme.INK, ":", panel=panel, width=1.2)
            for level in (levels if permitted is None else [permitted])
        ]
    logarithmic = [i for i, one in enumerate(quantities) if one.logarithmic or levels]
    decades = bool(x[0] > 0.0 and x[-1] >= DECADES * x[0])
    chart = Chart(x, curves, panels, None, _heading(data[key]), logarithmic, decades)
    return Figure(name, title, "", chart=chart, main=True)


def _maps(
    data: xr.Dataset,
    quantity: Quantity,
    keys: Sequence[str],
    reference: str = "",
    levels: Sequence[float] = (),
) -> list[Figure]:
    """Return maps of a quantity over the last two keys, for each model with values.

    There is a map for each combination of the first and last values of the other keys. With
    ``levels`` in percent the values are clipped at 100 %. There is no figure without maps.
    """
    *outer_keys, x, y = keys
    permitted, unit = _permitted(data, quantity), quantity.shown_unit
    longest = float(data[UNTIL].max()) if quantity.name == TIP_DEVIATION else 0.0
    panels, maps, empty = [], [], []
    for selection in _at_ends(data, outer_keys):
        part = data.sel(selection)
        where = "".join(f", {_quantity(key)} {value:g}" for key, value in selection.items())
        for name in part["model"].values:
            of_model = part.sel(model=name).transpose(y, x, ...)
            cells = quantity.factor * of_model[quantity.name].values
            if not np.isfinite(cells).any():
                empty.append(f"{name}{where}")
                continue
            least, most = np.nanmin(cells), np.nanmax(cells)
            marks = np.where(of_model["failed"].values > 0, "×", "")
            if longest:
                until = of_model[UNTIL].values
                times = np.array([[f"{time:.1f} s" for time in row] for row in until])
                marks = np.where(until < longest, times, marks)
            known = permitted is not None and least < permitted < most
            shown = np.clip(cells, 0.0, _MOST) if levels else cells
            maps.append(Map(shown, _texts(cells, marks), permitted if known else None))
            panels.append(f"{name}{where}: {least:.3g} to {most:.3g} {unit}")
    texts = [text for cells in maps for text in cells.texts.ravel()]
    remarks = [
        *([f"grey: no {quantity.title}"] if any(np.isnan(m.values).any() for m in maps) else []),
        *([] if permitted is None else [f"red, dotted: limit of {permitted:.4g} {unit}"]),
        *(["×: the computation failed"] if any("×" in text for text in texts) else []),
        *([f"no values: {', '.join(empty)}"] if empty else []),
        *([f"s: time up to which tips are compared; elsewhere {longest:g} s"] if longest else []),
    ]
    if not maps:
        return []
    low, high = 0.0, _MOST
    if not levels:
        low = float(min(np.nanmin(cells.values) for cells in maps))
        high = float(max(np.nanmax(cells.values) for cells in maps))
    columns, rows = ([f"{value:g}" for value in data[key].values] for key in (x, y))
    scale = f"{quantity.title} ({unit})"
    keys_of_maps = Keys(_heading(data[y]), columns, rows, scale, low, high, levels)
    chart = Chart(data[x].values, panels=panels, along=_heading(data[x]), maps=maps,
                  keys=keys_of_maps)  # fmt: skip
    title = (
        f"{quantity.title[0].upper()}{quantity.title[1:]}{f' from {reference}' * bool(reference)}"
    )
    name = f"sweep-{quantity.name.replace('_', '-')}"
    return [Figure(name, title, "; ".join(remarks), chart=chart, main=True)]


def _texts(cells: Array, marks: npt.NDArray[np.str_]) -> npt.NDArray[np.str_]:
    """Return the texts of cells: their values, if there are few of them, and given marks."""
    few = max(cells.shape) <= MOST_CELLS
    return np.array(
        [
            ["\n".join(filter(None, [number(v) if few and np.isfinite(v) else "", mark]))
             for v, mark in zip(row, row_of_marks, strict=True)]
            for row, row_of_marks in zip(cells.tolist(), marks.tolist(), strict=True)
        ]
    )  # fmt: skip


def _quantity(key: Hashable) -> str:
    """Return a key in words: ``joint[1].play`` becomes *play, joint 1*."""
    if key in _WORDS:
        return _WORDS[str(key)]
    *path, what = re.sub(r"\[(\d+)\]", r" \1", str(key)).replace("_", " ").split(".")
    part = " ".join(path)
    if part in ("", "joint"):
        return what
    return f"{what}, {part}" if part[-1].isdigit() else f"{part} {what}"


def _heading(values: xr.DataArray) -> str:
    """Return the heading of an axis: a key in words with its unit."""
    unit = values.attrs["units"]
    return _quantity(values.name) + ("" if unit == "1" else f" ({unit.translate(_SUPERSCRIPT)})")
