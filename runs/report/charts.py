# SPDX-License-Identifier: LGPL-3.0-or-later
"""Charts as data: curves and maps in panels, shown interactively by plotly.

The same data are drawn as pictures by :mod:`.static_charts`. A page contains plotly.js once,
compressed, and the data of each chart as 32-bit floats with seven digits.
"""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain, pairwise
from math import ceil
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from protractile.geometry.arrays import Array
from protractile.runs.report import theme
from protractile.runs.report.pages import base_64

# Maximum number of samples of a curve. A longer curve is reduced to the minimum and maximum of half
# as many intervals, still more than a screen has columns.
MOST = 12_000
# Heights in pixels of a panel, and of axis and legend below all panels.
PANEL, BELOW = 150, 314
# Level of gzip, half as slow as the usual one for pages that are 2 % larger.
LEVEL = 4
# Height in pixels of a row of the legend.
_LEGEND_ROW = 30
# Distance between panels over the height.
GAP = 0.14
# Plotly's names of matplotlib's line styles and markers.
_DASHES = {"-": "solid", "--": "dash", "-.": "dashdot", ":": "dot"}
_MARKERS = {"o": "circle", "v": "triangle-down", "s": "square"}


@dataclass(frozen=True, slots=True)
class Curve:
    """Curve of a chart."""

    name: str  #: name of the model or of another source; empty for a curve outside the legend
    values: Array  #: (num_times,) in the unit of the panel
    color: str  #: colour in CSS notation
    linestyle: str = "-"  #: line style of matplotlib; empty for markers alone
    shown: bool = True  #: True if the curve is visible at first, False if only on demand
    panel: int = 0  #: index of its panel
    band: tuple[Array, Array] | None = None  #: lower and upper limit (num_times,) of a band
    at: Array | None = None  #: abscissa (num_times,); the abscissa of the chart unless given
    width: float = 1.8  #: width of the line in pixels
    marker: str = ""  #: marker of matplotlib: ``o``, ``v`` or ``s``
    filled: bool = False  #: True for a filled polygon


class Vertical(NamedTuple):
    """Vertical line through all panels."""

    at: float  #: abscissa
    color: str  #: colour in CSS notation
    linestyle: str  #: line style of matplotlib


@dataclass(frozen=True, slots=True)
class Map:
    """Cells of values over two keys, in a panel of its own."""

    values: Array  #: (num_ordinates, num_abscissas), NaN where there is no value
    texts: npt.NDArray[np.str_]  #: (num_ordinates, num_abscissas) texts in the cells
    limit: float | None = None  #: value at which a line is drawn


@dataclass(frozen=True, slots=True)
class Keys:
    """Values of the two keys of maps, and the scale of their colours."""

    heading: str  #: heading of the ordinate
    abscissas: Sequence[str]  #: labels of the columns
    ordinates: Sequence[str]  #: labels of the rows
    title: str  #: quantity of the cells, with its unit
    low: float  #: value of the first colour
    high: float  #: value of the last colour
    levels: Sequence[float] = ()  #: values at which the colour changes; none for a smooth scale


@dataclass(frozen=True, slots=True)
class Chart:
    """Chart of curves over a common abscissa, or of maps, in panels above one another."""

    time: Array  #: (num_times,) in s, or another abscissa
    curves: Sequence[Curve] = ()  #: curves of all panels
    panels: Sequence[str] = ("",)  #: titles of the panels, with units
    #: initially visible window of the abscissa; all of it unless given
    window: tuple[float, float] | None = None
    along: str = "time (s)"  #: heading of the abscissa
    logarithmic: Sequence[int] = ()  #: indices of the panels with a logarithmic ordinate
    decades: bool = False  #: True for a logarithmic abscissa
    equal: bool = False  #: True for equal scales of both axes
    common: int = 0  #: number of the first panels that have the same scale
    verticals: Sequence[Vertical] = ()  #: vertical lines
    maps: Sequence[Map] = ()  #: a map for each panel, in place of curves
    keys: Keys | None = None  #: keys of the maps

    @property
    def thinned(self) -> bool:
        """True if the chart omits samples."""
        return self.time.size > MOST

    @property
    def plain(self) -> dict[str, Any]:
        """The figure of plotly as JSON values and arrays; its abscissa is in ``layout.meta.x``."""
        count = len(self.panels)
        along: dict[str, Any] = {
            "title": {"text": self.along, "standoff": 8},
            "anchor": _axis("y", count - 1),
            "hoverformat": ".5g",
            "gridcolor": theme.RULE,
        }
        if self.keys is not None:
            along |= _labels(self.keys.abscissas)
        elif self.decades:
            along |= {"type": "log"}
        else:
            along |= {"range": self.window or self.time[[0, -1]].tolist()}
        # Two rows of four names fit below the axis.
        rows = ceil(len({curve.name for curve in self.curves if curve.name}) / 4)
        more = _LEGEND_ROW * max(0, rows - 2)
        layout: dict[str, Any] = {
            "template": "none",
            "meta": {"x": self.time},
            "font": {"family": "system-ui, sans-serif", "size": 13, "color": theme.INK},
            "hovermode": "x unified" if self.keys is None else "closest",
            "height": BELOW + PANEL * count + more,
            "margin": {"l": 62, "r": 12, "t": 26, "b": 120 + more},
            "legend": {"orientation": "h", "yref": "container", "y": 0.01, "yanchor": "bottom"},
            "xaxis": along,
            "annotations": [],
            "shapes": [
                {"type": "line", "x0": x, "x1": x, "yref": "paper", "y0": 0, "y1": 1,
                 "line": {"color": color, "dash": _DASHES[dashes], "width": 1}}
                for x, color, dashes in self.verticals
            ],
        }  # fmt: skip
        for number, title in enumerate(self.panels):
            top = 1.0 - number / count
            layout[_axis("yaxis", number)] = {
                "domain": [
                    max(top - (1.0 - GAP * (number < count - 1)) / count, 0.0),
                    top - GAP / count * (number > 0),
                ],
                "type": "log" if number in self.logarithmic else "linear",
                "exponentformat": "none",
                "gridcolor": theme.RULE,
            }
            if self.equal:
                layout[_axis("yaxis", number)]["scaleanchor"] = "x"
            if 0 < number < self.common:
                layout[_axis("yaxis", number)]["matches"] = "y"
            if self.keys is not None:
                heading = {"title": {"text": self.keys.heading, "standoff": 6}}
                layout[_axis("yaxis", number)] |= heading | _labels(self.keys.ordinates)
            layout["annotations"].append(
                {"text": f"<b>{title}</b>", "xref": "paper", "x": 0, "xanchor": "left",
                 "yref": f"{_axis('y', number)} domain", "y": 1, "yanchor": "bottom",
                 "showarrow": False}
            )  # fmt: skip
        first = {curve.name: curve for curve in reversed(self.curves)}
        traces = (self._traces(curve, curve is first[curve.name]) for curve in self.curves)
        cells = (_cells(self.keys, panel, cells) for panel, cells in enumerate(self.maps))
        if self.keys is not None:
            layout["coloraxis"] = {
                "cmin": self.keys.low,
                "cmax": self.keys.high,
                "colorscale": _colour_scale(self.keys),
                "colorbar": {"title": {"text": self.keys.title, "side": "right"}, "thickness": 14},
            }
        return {"data": [*chain.from_iterable(traces), *chain.from_iterable(cells)],
                "layout": layout}  # fmt: skip

    def _traces(self, curve: Curve, named: bool) -> Iterator[dict[str, Any]]:
        """Yield the traces of a curve: its band and its line, in the legend if ``named``."""
        common: dict[str, Any] = {
            "type": "scatter",
            "mode": "+".join(["lines"] * bool(curve.linestyle) + ["markers"] * bool(curve.marker)),
            "yaxis": _axis("y", curve.panel),
            "legendgroup": curve.name,
            "visible": True if curve.shown else "legendonly",
        }
        values, dashes = curve.values, _DASHES.get(curve.linestyle, "solid")
        if curve.at is not None:
            common["x"] = curve.at
        elif self.thinned:
            kept = self.kept(curve, MOST // 2)
            common["x"], values = self.time[kept], values[kept]
        for fill, limit in zip(("none", "tonexty"), curve.band or (), strict=False):
            if self.thinned:
                break
            yield common | {
                "y": limit.astype(np.float32),
                "line": {"width": 0},
                "fill": fill,
                "fillcolor": f"{curve.color}33",
                "hoverinfo": "skip",
                "showlegend": False,
            }
        line = common | {
            "y": values.astype(np.float32),
            "name": curve.name,
            "showlegend": named and bool(curve.name),
            "line": {"color": curve.color, "dash": dashes, "width": curve.width, "simplify": False},
            "hovertemplate": f"%{{y:.5g}}<extra>{curve.name}</extra>",
        }
        if curve.marker:
            line["marker"] = {
                "symbol": _MARKERS[curve.marker],
                "color": curve.color,
                "size": 4 if curve.linestyle else 8,
            }
        if curve.filled:
            line |= {"fill": "toself", "fillcolor": f"{curve.color}40", "hoveron": "fills"}
        yield line

    def kept(self, curve: Curve, intervals: int) -> npt.NDArray[np.intp]:
        """Return the ascending indices (num_kept,) of the samples of a shortened curve."""
        if curve.band is not None:
            # Both limits of a band have common abscissas.
            return np.linspace(0, curve.values.size - 1, 2 * intervals).astype(np.intp)
        return extremes(curve.values, intervals)


def _labels(labels: Sequence[str]) -> dict[str, Any]:
    """Return the labels of an axis at 0, 1, 2 and so on."""
    return {"tickvals": [*range(len(labels))], "ticktext": [*labels], "showgrid": False}


def _colour_scale(keys: Keys) -> list[tuple[float, str]]:
    """Return colours at fractions of the range of a scale, without transitions at its levels."""
    ends = [keys.low, *keys.levels, keys.high]
    parts = [(end - keys.low) / ((keys.high - keys.low) or 1.0) for end in ends]
    if not keys.levels:
        return [(i / (len(theme.SCALE) - 1), color) for i, color in enumerate(theme.SCALE)]
    return [
        (place, color)
        for color, between in zip(theme.SHADES, pairwise(parts), strict=False)
        for place in between
    ]


def _cells(keys: Keys | None, panel: int, cells: Map) -> Iterator[dict[str, Any]]:
    """Yield the traces of a map: its cells and the line of its limit."""
    assert keys is not None
    common = {
        "yaxis": _axis("y", panel),
        "x": [*range(len(keys.abscissas))],
        "z": cells.values.astype(np.float32),
    }
    yield common | {
        "type": "heatmap",
        "coloraxis": "coloraxis",
        "text": cells.texts,
        "texttemplate": "%{text}",
        "hovertemplate": "%{z:.5g}<extra></extra>",
    }
    if cells.limit is not None:
        yield common | {
            "type": "contour",
            "contours": {"coloring": "none", "start": cells.limit, "end": cells.limit, "size": 1.0},
            "line": {"color": "red", "dash": "dot", "width": 2},
            "hoverinfo": "skip",
            "showlegend": False,
        }


def _axis(name: str, panel: int) -> str:
    """Return the name in plotly of the axis of a panel: ``y``, ``y2`` and so on."""
    return f"{name}{panel + 1 if panel else ''}"


def extremes(values: Array, intervals: int) -> npt.NDArray[np.intp]:
    """Return the ascending indices (num_kept,) of the extreme samples in each interval."""
    ends = np.linspace(0, values.size, intervals + 1).astype(int)
    finite = np.nan_to_num(values)
    kept = {
        start + int(extreme(finite[start:end]))
        for start, end in pairwise(ends)
        for extreme in (np.argmin, np.argmax)
    }
    return np.array(sorted(kept | {0, values.size - 1}))


def pack_charts(charts: Mapping[str, Chart]) -> str:
    """Return charts by the names of their figures as JSON that is escaped for HTML."""
    text = json.dumps({name: chart.plain for name, chart in charts.items()}, default=typed)
    return text.replace("<", "\\u003c")


def typed(values: npt.NDArray[Any]) -> Any:
    """Return an array as JSON values: numbers as plotly's typed array, texts as a list."""
    if values.dtype.kind not in "iuf":
        return values.tolist()
    packed = {"dtype": values.dtype.str[1:], "bdata": base_64(values.tobytes())}
    return packed | {"shape": str(values.shape)[1:-1]} if values.ndim > 1 else packed


@cache
def pack_plotly() -> str:
    """Return plotly.js from its wheel, compressed, in base 64."""
    from plotly.offline import get_plotlyjs

    return compress(get_plotlyjs())


def compress(text: str) -> str:
    """Return a text compressed by gzip, in base 64."""
    return base_64(gzip.compress(text.encode(), LEVEL, mtime=0))
