# SPDX-License-Identifier: LGPL-3.0-or-later
"""Interactive curves over time (zoom, hover, hide) beside their static pictures.

A page carries plotly.js once, compressed, and the numbers of each chart as 32-bit floats: seven
digits of the values in the netCDF file.
"""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np

from geometry.arrays import Array

# A curve with more samples is reduced to the minimum and maximum of each of half as many intervals:
# more than a screen has columns.
MOST = 12_000


@dataclass(frozen=True, slots=True)
class Curve:
    """One line of a chart.

    Args:
        name: of the model or of another source.
        values: (num_times,) in the unit of the chart.
        color: as CSS has it.
        dashes: by plotly's name.
        shown: whether the curve is visible at first, else on demand.
        panel: position of its panel.
        band: (num_times,) each, lower and upper limit.
        at: (num_times,) its own abscissa; that of the chart unless given.
    """

    name: str
    values: Array
    color: str
    dashes: str = "solid"
    shown: bool = True
    panel: int = 0
    band: tuple[Array, Array] | None = None
    at: Array | None = None


@dataclass(frozen=True, slots=True)
class Chart:
    """Curves over a common time, in panels above one another.

    Args:
        time: (num_times,) in s, or another abscissa.
        heading: of the ordinate, with its unit.
        curves: of all panels.
        panels: their titles.
        window: of time shown at first, in s; all of it unless given.
        along: heading of the abscissa.
    """

    time: Array
    heading: str
    curves: Sequence[Curve]
    panels: Sequence[str] = ("",)
    window: tuple[float, float] | None = None
    along: str = "time (s)"

    @property
    def thinned(self) -> bool:
        """Whether the chart leaves out samples."""
        return self.time.size > MOST

    @property
    def data(self) -> dict[str, Any]:
        """Content of the chart for the script of the page."""
        return {
            "time": _packed(self.time, "<f8"),
            "heading": self.heading,
            "along": self.along,
            "panels": list(self.panels),
            "window": self.window,
            "curves": [self._curve(curve) for curve in self.curves],
        }

    def _curve(self, curve: Curve) -> dict[str, Any]:
        found: dict[str, Any] = {
            "name": curve.name,
            "color": curve.color,
            "dashes": curve.dashes,
            "shown": curve.shown,
            "panel": curve.panel,
        }
        if curve.at is not None:
            found["time"] = _packed(curve.at, "<f8")
        elif self.thinned:
            kept = extremes(curve.values, MOST // 2)
            return found | {
                "time": _packed(self.time[kept], "<f8"),
                "values": _packed(curve.values[kept], "<f4"),
            }
        if curve.band is not None:
            found |= {"low": _packed(curve.band[0], "<f4"), "high": _packed(curve.band[1], "<f4")}
        return found | {"values": _packed(curve.values, "<f4")}


def extremes(values: Array, stretches: int) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return sorted numbers (num_kept,) of the minimum and maximum sample of each interval."""
    ends = np.linspace(0, values.size, stretches + 1).astype(int)
    known = np.nan_to_num(values)
    kept = {
        start + int(found(known[start:end]))
        for start, end in pairwise(ends)
        for found in (np.argmin, np.argmax)
    }
    return np.array(sorted(kept | {0, values.size - 1}))


def packed_charts(charts: Mapping[str, Chart]) -> str:
    """Return all charts of a page by the names of their figures, as JSON escaped for HTML."""
    text = json.dumps({name: chart.data for name, chart in charts.items()}, allow_nan=False)
    return text.replace("<", "\\u003c")


@cache
def packed_plotly() -> str:
    """Return plotly.js from its wheel, compressed, in base 64."""
    from plotly.offline import get_plotlyjs

    return base64.b64encode(gzip.compress(get_plotlyjs().encode(), 9, mtime=0)).decode("ascii")


def _packed(values: Array, form: str) -> str:
    return base64.b64encode(np.asarray(values).astype(form).tobytes()).decode("ascii")
