# SPDX-License-Identifier: LGPL-3.0-or-later
"""The deformed boom in a page of its own: to be turned, with its time to be drawn along."""

from __future__ import annotations

import base64
import gzip
import json
from importlib.util import find_spec
from typing import Any

import numpy as np

from runs.pipeline.comparisons import leading
from runs.pipeline.run import Run
from runs.report.charts import packed_plotly
from runs.report.extruded import of_beam
from runs.report.moving_surface import MOST_POINTS, MovingSurface, packed
from runs.report.pages import page

VIEWER = "viewer.html"


def viewer(run: Run) -> str | None:
    """The page as HTML: library and numbers inside, no resource from elsewhere.

    None without plotly, and of a mesh that is too fine for a page.
    """
    surface = _surface(run) if find_spec("plotly") else None
    if surface is None:
        return None
    case = run.results.case
    angle = 0.0 if case.gravity is None else case.gravity.angle
    surface = surface.drawn_out(run.results.boom).turned(angle)
    content = json.dumps({name: _plain(value) for name, value in packed(surface).items()})
    return page(
        "viewer.html",
        title=case.title,
        surface=surface,
        plotly=packed_plotly(),
        content=base64.b64encode(gzip.compress(content.encode(), 6, mtime=0)).decode("ascii"),
    )


def _surface(run: Run) -> MovingSurface | None:
    """The first shell in motion, or the beam that is read first; none of a finer mesh."""
    results = run.results
    for name, shell in run.shells.items():
        if shell.fields.sizes["point"] > MOST_POINTS:
            return None
        return MovingSurface.of_shell(shell.fields, results.trajectories.sel(model=name))
    first = leading(results.case, list(run.beams))
    with_play = [m.name for m in results.ran if m.name in first and not m.play_free]
    name = [*first, *with_play][-1]
    return of_beam(results.boom, name, run.beams[name])


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return {
            "kind": value.dtype.name,
            "bytes": base64.b64encode(value.tobytes()).decode("ascii"),
        }
    return value
