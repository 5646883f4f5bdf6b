# SPDX-License-Identifier: LGPL-3.0-or-later
"""Context of all figures of a run: data, one line style per model, charts over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import astuple, dataclass
from functools import cached_property
from itertools import cycle
from typing import Any, Literal

import numpy as np
from matplotlib.figure import Figure as Sheet

from protractile.geometry.arrays import Array
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.results import Results
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.labels import tip_directions
from protractile.runs.report.static_charts import draw_chart

# Parts of the report to which figures belong.
Part = Literal["case", "motion", "rest"]

# Duration of a close-up over the time of the first peak.
CLOSE_UP = 1.3
# Line styles of drives.
EXTENSIONS = ("-", "--", "-.", ":")
THINNED = (
    " The chart has the minimum and maximum of intervals of each curve; trajectories.nc has all "
    "samples."
)


@dataclass(frozen=True, slots=True)
class Figure:
    """Chart or drawing of a report, with title and caption."""

    name: str  #: name of its file without suffix, and of the target of links
    title: str  #: title of one line
    caption: str  #: caption in sentences
    part: Part = "motion"  #: part of the report to which the figure belongs
    chart: Chart | None = None  #: chart; None for a drawing
    drawing: Callable[[], Sheet] | None = None  #: function that draws, in place of a chart
    main: bool = False  #: True if a report has it also as a picture

    @property
    def anchor(self) -> str:
        """The target of links in the report."""
        return f"figure-{self.name}"

    def draw(self) -> Sheet:
        """Return the picture of the figure; the style of the theme must be set."""
        if self.drawing is not None:
            return self.drawing()
        assert self.chart is not None
        return draw_chart(self.chart, self.title)


class FigureContext:
    """Data and line styles for the figures of a run."""

    def __init__(self, results: Results) -> None:
        self.case = results.case
        self.data = results.trajectories
        self.ensembles = results.ensembles
        self.summary = results.summary.models
        self.regular = results.case.regular
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

    def curve(self, name: str, values: Array, panel: int = 0, **more: Any) -> Curve:
        """Return the curve of a model for a chart, with values in the unit of its panel."""
        color, linestyle = astuple(self.line_styles[name])
        shown = name in self.main_models
        return Curve(self.labels[name], values, color, linestyle, shown, panel, **more)

    def over_time(self, panels: Sequence[str], curves: Sequence[Curve], **more: Any) -> Chart:
        """Return a chart of curves over time, with a further panel for the extension of drives."""
        # Segments with the same extension share a line.
        together: dict[tuple[float, ...], list[str]] = {}
        for suffix, inner in self.case.driven_segments.items():
            if f"extension{suffix}" in self.data:
                travel = self.result(self.models[0], f"extension{suffix}")
                together.setdefault(tuple(travel.tolist()), []).append(inner)
        extensions = [
            Curve(f"extension of {', '.join(names)}", np.array(along), theme.INK, dashes,
                  panel=len(panels), width=1.0)
            for (along, names), dashes in zip(together.items(), cycle(EXTENSIONS), strict=False)
        ]  # fmt: skip
        titles = [*panels, *["extension (m)"] * bool(extensions)]
        return Chart(self.time, [*curves, *extensions], titles, **more)

    def results_over_time(self, panels: Mapping[str, tuple[str, float]]) -> Chart:
        """Return the chart of results in all models, of which each has a panel.

        ``panels`` has the result and the factor to its unit by the title of the panel.
        """
        curves = [
            self.curve(name, factor * self.result(name, result), panel)
            for panel, (result, factor) in enumerate(panels.values())
            for name in self.models
        ]
        return self.over_time([*panels], curves)

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


def initial_position_note(case: Case) -> str:
    """Return a note that x is the position at t = 0; empty without telescoping."""
    return " Positions x are at t = 0 and move with their segments." if case.driven_segments else ""
