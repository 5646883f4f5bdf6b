# SPDX-License-Identifier: LGPL-3.0-or-later
"""A film of only three frames, to save time in every process."""

from typing import Any
from unittest.mock import patch

from protractile.runs.report import snapshots
from protractile.runs.report.sheet import Snapshot
from protractile.runs.report.snapshots import render_motion


def render_short(*given: Any) -> list[Snapshot]:
    """Stand in for :func:`.runs.report.snapshots.render_motion`."""
    with patch.object(snapshots, "FRAMES", 3):
        return render_motion(*given)
