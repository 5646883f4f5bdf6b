# SPDX-License-Identifier: LGPL-3.0-or-later
"""A film of only three frames, to save time in every process."""

from pathlib import Path
from typing import Any
from unittest.mock import patch

from protractile.runs.report import snapshots


def render_short_film(*given: Any) -> list[Path]:
    """Stand in for :func:`.runs.report.snapshots.render_film`."""
    with patch.object(snapshots, "FRAMES", 3):
        return snapshots.render_film(*given)


RENDERED = snapshots.render_stills, render_short_film
