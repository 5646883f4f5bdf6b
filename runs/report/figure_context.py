# SPDX-License-Identifier: LGPL-3.0-or-later
"""Context of all figures of a run: data, one line style per model, sheets, files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass
from functools import cached_property
from itertools import cycle
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet

from protractile.geometry.arrays import Array
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.results import Results
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.labels import tip_directions

if TYPE_CHECKING:
    pass

# Parts of the report to which figures belong.
Part = Literal["case", "motion", "rest", "horizons", "numerics"]

# Width of the curves of other models over the width of the curves of main models.
BACKGROUND_WIDTH = 0.5
# Duration of a close-up over the time of the first peak.
CLOSE_UP = 1.3
# Minimum span of an axis, as a fraction of the scale of its quantity.
MIN_SPAN = 0.02
# Line styles of drives.
EXTENSIONS = ("-", "--", "-.", ":")
# Number of characters that fit into one of two columns of a legend.
LEGEND_CHARACTERS = 30
THINNED = (
    " The chart has the minimum and maximum of intervals of each curve; trajectories.nc has all "
    "samples."
)


@dataclass(frozen=True, slots=True)
class Figure:
    """Picture on the disk with title and caption."""

    path: Path  #: path of the PNG or GIF file
    title: str  #: title of one line
    caption: str  #: caption in sentences
    part: Part = "motion"  #: part of the report to which the figure belongs
    chart: Chart | None = None  #: interactive chart of the same curves

    @property
    def anchor(self) -> str:
        """The target of links in the report."""
        return f"figure-{self.path.stem}"


class FigureContext:
    """Data, folder and line styles for the figures of a run."""

    def __init__(self, results: Results, folder: Path) -> None:
        self.case = results.case
        self.data = results.trajectories
        self.ensembles = results.ensembles
        self.summary = results.summary.models
        self.regular = results.case.regular
        self.folder = folder
        self.time = np.asarray(self.data["time"].values, dtype=float)
        self.models = [str(name) for name in self.data["model"].values]
        self.bonded = [model.name for model in results.case.models if model.bonded]
        self.with_play = [name for name in self.models if name not in self.bonded]
        self.line_styles = theme.line_styles(self.models, self.bonded)
        self.labels = {name: name for name in self.models} | {
            model.name: f"{model.name} ({'shell' if model.meshed else 'beam'})"
            for model in results.case.models
            if model.bonded
        }
        self.rows = results.rows
        self.curves = results.curves
        self.main_models = results.main_models

    def result(self, name: str, variable: str) -> Array:
        """Return a result of a model (num_times,), or (num_times, num_stations) at stations."""
        values = self.data[variable].sel(model=name)
        return np.asarray(values.transpose("time", ...).values, dtype=float)

    def stations(self) -> list[str]:
        """Return the title of each station's panel."""
        places = self.data["station"]
        lateral = places["direction"] == "y" if "direction" in places.coords else places.isnull()
        return [
            f"x = {x:g} m{', lateral' if is_lateral else ''}"
            for x, is_lateral in zip(places.values, lateral.values, strict=True)
        ]

    def line(
        self,
        axes: Axes,
        name: str,
        x: Array,
        y: Array,
        linewidth: float = 1.5,
        marker: str = "",
        alone: bool = False,
    ) -> None:
        """Draw the curve of a model, without dashes if it is ``alone`` in its panel."""
        style = self.line_styles[name]
        behind = not alone and name not in self.main_models
        axes.plot(
            x,
            y,
            color=style.color,
            linestyle="-" if alone else style.linestyle,
            linewidth=BACKGROUND_WIDTH * linewidth if behind else linewidth,
            zorder=1.9 if behind else 2.0,
            marker=marker,
            markersize=2.5,
            label=self.labels[name],
        )

    def curve(self, name: str, values: Array, panel: int = 0, **more: Any) -> Curve:
        """Return the curve of a model for a chart, with values in the unit of the axis."""
        color, linestyle = astuple(self.line_styles[name])
        shown = name in self.main_models
        return Curve(self.labels[name], values, color, linestyle, shown, panel, **more)

    def over_time(
        self, panels: int, height: float, end: float | None = None, share_y: bool = False
    ) -> tuple[Sheet, list[Axes]]:
        """Return a sheet with panels over time, in which a second axis has extensions of drives.

        The height of the sheet is in inches. The time axis ends at ``end`` in s, by default at the
        end of the run. With ``share_y`` the panels have a common vertical scale.
        """
        sheet, column = new_sheet(panels, height, share_y)
        column[-1].set(xlabel="time (s)", xlim=(0.0, self.time[-1] if end is None else end))
        # Segments with the same extension share a line.
        together: dict[tuple[float, ...], list[str]] = {}
        for suffix, inner in self.case.driven_segments.items():
            if f"extension{suffix}" in self.data:
                travel = self.result(self.models[0], f"extension{suffix}")
                together.setdefault(tuple(travel.tolist()), []).append(inner)
        look: dict[str, Any] = {"color": theme.INK, "linewidth": 0.9, "alpha": 0.5}
        for axes in column if together else ():
            beside = axes.twinx()
            for (along, names), dashes in zip(together.items(), cycle(EXTENSIONS), strict=False):
                label = f"extension of {', '.join(names)}"
                beside.plot(self.time, along, linestyle=dashes, label=label, **look)
            beside.set_ylabel("extension (m)")
            beside.grid(visible=False)
            beside.spines["right"].set_visible(True)
        return sheet, column

    @cached_property
    def tips(self) -> list[str]:
        """The displacements of the tip, largest amplitude first."""
        return tip_directions(self.data)

    @property
    def stays_in_contact(self) -> bool:
        """True if no contact opens, so that no impact amplifies small differences."""
        touching = self.with_play if "contact_force" in self.data else ()
        forces = [self.result(name, "contact_force") for name in touching]
        return all(bool((np.nan_to_num(force) != 0.0).all()) for force in forces)

    @property
    def first_peak_window(self) -> float:
        """The end in s of a close-up of the first tip peaks; without peaks, the end of the run."""
        times = (self.summary[name].first_peak[self.tips[0]].time for name in self.models)
        peaks = [time for time in times if time is not None]
        end = float(self.time[-1])
        return min(float(f"{CLOSE_UP * max(peaks):.2g}"), end) if peaks else end

    def finish(
        self,
        sheet: Sheet,
        legend_of: Axes | None,
        stem: str,
        title: str,
        caption: str,
        part: Part = "motion",
        chart: Chart | None = None,
    ) -> Figure:
        """Add title and legend to a sheet, write its file, and return the figure."""
        if legend_of is not None:
            named: dict[str, Artist] = {}
            for axes in sheet.axes:
                handles, labels = axes.get_legend_handles_labels()
                named = dict(zip(labels, handles, strict=True)) | named
            columns = 2 if max(map(len, named)) <= LEGEND_CHARACTERS else 1
            sheet.legend([*named.values()], [*named], loc="outside lower left", ncols=columns)
        sheet.suptitle(title, x=0.02, ha="left", fontsize=12.0, fontweight="bold", wrap=True)
        path = self.folder / f"{stem}.png"
        # An existing file shows the same data.
        if not path.exists():
            sheet.savefig(path)
        if chart is not None and chart.thinned:
            caption += THINNED
        return Figure(path, title, caption, part, chart)


def new_sheet(panels: int, height: float, share_y: bool = False) -> tuple[Sheet, list[Axes]]:
    """Return a sheet with panels above one another, which share the time axis.

    The height is in inches; with ``share_y`` the panels have a common vertical scale.
    """
    sheet = Sheet(figsize=(theme.WIDTH, height))
    theme.Canvas(sheet)
    column = sheet.subplots(panels, 1, sharex=True, sharey=share_y, squeeze=False)
    return sheet, list(column[:, 0])


def widen_limits(axes: Axes) -> None:
    """Widen the limits of an axis around an almost constant curve, to hide round-off."""
    low, high = axes.get_ylim()
    least = MIN_SPAN * max(abs(low), abs(high))
    if high - low < least:
        middle = 0.5 * (low + high)
        axes.set_ylim(middle - 0.5 * least, middle + 0.5 * least)


def highest(values: Sequence[float] | Array) -> float:
    """Return the largest finite value; NaN without finite values."""
    finite = np.asarray(values)[np.isfinite(values)]
    return float(finite.max()) if finite.size else float("nan")


def initial_position_note(case: Case) -> str:
    """Return a note that x is the position at t = 0; empty without telescoping."""
    return " Positions x are at t = 0 and move with their segments." if case.driven_segments else ""
