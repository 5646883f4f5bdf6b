# SPDX-License-Identifier: LGPL-3.0-or-later
"""A film of few frames, whatever process draws it; how many it has is a matter of time alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any
from unittest.mock import patch

from shell_model.pictures import rendering


def render_short_film(*given: Any) -> list[Path]:
    """As :func:`shell_model.pictures.rendering.render_film`."""
    with patch.object(rendering, "FRAMES", 3):
        return rendering.render_film(*given)


RENDERED = rendering.render_stills, render_short_film
