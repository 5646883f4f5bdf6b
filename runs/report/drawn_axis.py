# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far segments are drawn out, beside what a figure shows over time."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import cycle

from matplotlib.axes import Axes

from geometry.typography import listed
from runs.case.schema import Case
from runs.pipeline.at_rest import AtRest
from runs.report import theme
from runs.report.figure_context import Pen


def drawn_axis(pen: Pen, axes: Axes) -> None:
    """How far segments are drawn out, on a second axis to the right."""
    # Segments that go together are one line.
    together: dict[tuple[float, ...], list[str]] = {}
    for suffix, inner in pen.case.driven.items():
        if f"drawn_out{suffix}" in pen.data:
            drawn = pen.of(pen.models[0], f"drawn_out{suffix}")
            together.setdefault(tuple(drawn.tolist()), []).append(inner)
    if not together:
        return
    beside = axes.twinx()
    for (way, names), dashes in zip(together.items(), cycle(("-", "--", "-.", ":")), strict=False):
        label = f"{', '.join(names)} drawn out"
        beside.plot(
            pen.time, way, color=theme.INK, linewidth=0.9, linestyle=dashes, alpha=0.5, label=label
        )
    beside.set_ylabel("drawn out (m)")
    beside.grid(visible=False)
    beside.spines["right"].set_visible(True)


def of_start(case: Case) -> str:
    """A sentence for what stands over x, or is named by it; empty where nothing is drawn out."""
    return " Places are those of t = 0, and go with their segments." if case.driven else ""


def of_rests(case: Case, rests: Iterable[AtRest]) -> str:
    """A sentence for how far a boom is drawn out where it rests; empty where nothing is."""
    times = [f"{time:g}" for time in sorted({rest.time for rest in rests})]
    return f" Drawn out as it is at {listed(times)} s." if case.driven and times else ""
