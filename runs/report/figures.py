# SPDX-License-Identifier: LGPL-3.0-or-later
"""Figures of a run, and their files in PNG."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import matplotlib

from protractile.runs.pipeline.results import Results
from protractile.runs.report import boom_drawing, force_figures, motion_figures, rest_figures, theme
from protractile.runs.report.figure_context import THINNED, Figure, FigureContext

FOLDER = "figures"

# Functions that describe some figures of a run.
FIGURES: Sequence[Callable[[FigureContext], list[Figure]]] = (
    boom_drawing.boom,
    motion_figures.tip,
    motion_figures.close_up,
    motion_figures.heads,
    force_figures.first_contacts,
    force_figures.drives,
    force_figures.hoisting,
    force_figures.stress_history,
    rest_figures.at_rest,
    rest_figures.envelopes,
    rest_figures.mode_shapes,
)


def figures_of(results: Results) -> list[Figure]:
    """Return all figures for which a run has data."""
    context = FigureContext(results)
    figures = [figure for describe in FIGURES for figure in describe(context)]
    return [
        replace(figure, caption=figure.caption + THINNED * figure.chart.thinned)
        if figure.chart
        else figure
        for figure in figures
    ]


def write_pictures(figures: Iterable[Figure], folder: Path) -> None:
    """Write a PNG file of each figure to the new folder ``figures`` of a folder."""
    shutil.rmtree(folder / FOLDER, ignore_errors=True)
    (folder / FOLDER).mkdir()
    with matplotlib.rc_context(theme.RC):
        for figure in figures:
            figure.draw().savefig(folder / FOLDER / f"{figure.name}.png")
