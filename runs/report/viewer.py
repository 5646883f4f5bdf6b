# SPDX-License-Identifier: LGPL-3.0-or-later
"""The deformed boom in a page of its own: to be turned, with its time to be drawn along."""

from __future__ import annotations

import base64
import gzip
import json
from typing import Any

import numpy as np

from runs.case.schema import Case
from runs.report.charts import packed_plotly
from runs.report.moving_surface import MovingSurface, packed
from runs.report.pages import page

VIEWER = "viewer.html"


def viewer(case: Case, surface: MovingSurface) -> str:
    """The page as HTML: library and numbers inside, no resource from elsewhere.

    Args:
        case: whose boom it is.
        surface: the boom in motion.
    """
    angle = 0.0 if case.gravity is None else case.gravity.angle
    content = json.dumps(
        {name: _plain(value) for name, value in packed(surface.turned(angle)).items()}
    )
    return page(
        "viewer.html",
        title=case.title,
        surface=surface,
        plotly=packed_plotly(),
        content=base64.b64encode(gzip.compress(content.encode(), 6, mtime=0)).decode("ascii"),
    )


def _plain(value: Any) -> Any:
    if isinstance(value, np.ndarray):
        return {
            "kind": value.dtype.name,
            "bytes": base64.b64encode(value.tobytes()).decode("ascii"),
        }
    return value
