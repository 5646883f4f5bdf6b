# SPDX-License-Identifier: LGPL-3.0-or-later
"""Interactive charts of curves by plotly, in addition to static pictures.

A page contains plotly.js once, compressed, and the data of each chart as 32-bit floats with seven
digits.
"""

from __future__ import annotations

import base64
import gzip
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import chain, pairwise
from typing import Any

import numpy as np

from protractile.geometry.arrays import Array
from protractile.runs.report import theme

# Maximum number of samples of a curve. A longer curve is reduced to the minimum and maximum of half
# as many intervals, still more than a screen has columns.
MOST = 12_000
# Heights in pixels of a panel, and of axis and legend below all panels.
PANEL, BELOW = 150, 314
# Distance between panels over the height.
GAP = 0.14
# Plotly's names of matplotlib's line styles.
_DASHES = {"-": "solid", "--": "dash", "-.": "dashdot", ":": "dot"}


@dataclass(frozen=True, slots=True)
class Curve:
    """Curve of a chart."""

    name: str  #: name of the model or of another source
    values: Array  #: (num_times,) in the unit of the chart
    color: str  #: colour in CSS notation
    linestyle: str = "-"  #: line style of matplotlib
    shown: bool = True  #: True if the curve is visible at first, False if only on demand
    panel: int = 0  #: index of its panel
    band: tuple[Array, Array] | None = None  #: lower and upper limit (num_times,) of a band
    at: Array | None = None  #: abscissa (num_times,); the abscissa of the chart unless given


@dataclass(frozen=True, slots=True)
class Chart:
    """Chart of curves over a common time, in panels above one another."""

    time: Array  #: (num_times,) in s, or another abscissa
    heading: str  #: heading of the ordinate, with its unit
    curves: Sequence[Curve]  #: curves of all panels
    panels: Sequence[str] = ("",)  #: titles of the panels
    #: initially visible time window in s; the whole time unless given
    window: tuple[float, float] | None = None
    along: str = "time (s)"  #: heading of the abscissa

    @property
    def thinned(self) -> bool:
        """True if the chart omits samples."""
        return self.time.size > MOST

    @property
    def figure(self) -> Any:
        """The figure as an object of plotly, which checks it."""
        from plotly.graph_objects import Figure

        return Figure(self.plain)

    @property
    def plain(self) -> dict[str, Any]:
        """The figure as JSON data; the common abscissa is in ``layout.meta.x``."""
        count = len(self.panels)
        layout: dict[str, Any] = {
            "template": "none",
            "meta": {"x": self.time},
            "font": {"family": "system-ui, sans-serif", "size": 13, "color": theme.INK},
            "hovermode": "x unified",
            "height": BELOW + PANEL * count,
            "margin": {"l": 62, "r": 12, "t": 26, "b": 120},
            "legend": {"orientation": "h", "yref": "container", "y": 0.01, "yanchor": "bottom"},
            "xaxis": {
                "title": {"text": self.along, "standoff": 8},
                "anchor": _axis("y", count - 1),
                "hoverformat": ".5g",
                "gridcolor": theme.RULE,
                "range": self.window or self.time[[0, -1]],
            },
        }
        for number, title in enumerate(self.panels):
            top = 1.0 - number / count
            layout[_axis("yaxis", number)] = {
                "title": {"text": self.heading, "standoff": 6},
                "domain": [
                    max(top - (1.0 - GAP * (number < count - 1)) / count, 0.0),
                    top - GAP / count * (number > 0),
                ],
                "exponentformat": "none",
                "gridcolor": theme.RULE,
            }
            layout.setdefault("annotations", []).append(
                {"text": f"<b>{title}</b>", "xref": "paper", "x": 0, "xanchor": "left",
                 "yref": f"{_axis('y', number)} domain", "y": 1, "yanchor": "bottom",
                 "showarrow": False}
            )  # fmt: skip
        first = {curve.name: curve for curve in reversed(self.curves)}
        traces = (self._traces(curve, curve is first[curve.name]) for curve in self.curves)
        return {"data": [*chain.from_iterable(traces)], "layout": layout}

    def _traces(self, curve: Curve, named: bool) -> Iterator[dict[str, Any]]:
        """Yield the traces of a curve: its band and its line, in the legend if ``named``."""
        common: dict[str, Any] = {
            "type": "scatter",
            "mode": "lines",
            "yaxis": _axis("y", curve.panel),
            "legendgroup": curve.name,
            "visible": True if curve.shown else "legendonly",
        }
        values, dashes = curve.values, _DASHES[curve.linestyle]
        if curve.at is not None:
            common["x"] = curve.at
        elif self.thinned:
            kept = extremes(values, MOST // 2)
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
        yield common | {
            "y": values.astype(np.float32),
            "name": curve.name,
            "showlegend": named,
            "line": {"color": curve.color, "dash": dashes, "width": 1.8, "simplify": False},
            "hovertemplate": f"%{{y:.5g}}<extra>{curve.name}</extra>",
        }


def _axis(name: str, panel: int) -> str:
    """Return the name in plotly of the axis of a panel: ``y``, ``y2`` and so on."""
    return f"{name}{panel + 1 if panel else ''}"


def extremes(values: Array, intervals: int) -> np.ndarray[Any, np.dtype[np.intp]]:
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
    from plotly.io.json import to_json_plotly

    return str(to_json_plotly({name: chart.figure.to_dict() for name, chart in charts.items()}))


@cache
def pack_plotly() -> str:
    """Return plotly.js from its wheel, compressed, in base 64."""
    from plotly.offline import get_plotlyjs

    return compress(get_plotlyjs())


def compress(text: str) -> str:
    """Return a text compressed by gzip, in base 64."""
    return base64.b64encode(gzip.compress(text.encode(), 6, mtime=0)).decode("ascii")
