# SPDX-License-Identifier: LGPL-3.0-or-later
"""The figures of a run, as PNG. Each says beside its drawing which statements it bears on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib

from runs.pipeline.results import Results
from runs.report import theme
from runs.report.boom_drawing import boom
from runs.report.contact_figures import contact_peaks, first_contacts, friction
from runs.report.deflection_figures import close_up, heads, lateral_tip, tip
from runs.report.drive_figures import drives
from runs.report.energy_figures import energies, residuals
from runs.report.figure_context import Figure, Pen
from runs.report.horizon_figures import horizons, slow_peaks
from runs.report.rest_figures import at_rest, envelopes, mode_shapes
from runs.report.stress_figures import stress_history

FIGURES: Sequence[Callable[[Pen], list[Figure]]] = (
    boom,
    tip,
    close_up,
    heads,
    lateral_tip,
    slow_peaks,
    horizons,
    first_contacts,
    contact_peaks,
    friction,
    drives,
    stress_history,
    at_rest,
    envelopes,
    mode_shapes,
    energies,
    residuals,
)


def draw(results: Results, folder: Path) -> list[Figure]:
    """Draw all figures of a run that it has the numbers for.

    Args:
        results: one run.
        folder: where the PNG files go; it must exist. Those that are there stay as they are.
    """
    with matplotlib.rc_context(theme.RC):
        pen = Pen(results, folder)
        return [figure for figures in FIGURES for figure in figures(pen)]
