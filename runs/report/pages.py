# SPDX-License-Identifier: LGPL-3.0-or-later
"""HTML pages of one file, with all pictures and scripts embedded."""

from __future__ import annotations

import base64
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from io import BytesIO
from pathlib import Path
from typing import Any

TEMPLATES = Path(__file__).parent / "templates"
# Largest width in pixels of pictures in a page, twice the width of the page; compression of
# pictures to a third of their size without visible loss.
WIDEST = 1240
_WEBP: dict[str, Any] = {"format": "WEBP", "quality": 85, "method": 1}
# CSS class of cells with each mark.
TONES = {"✓": "yes", "✗": "no", "?": "open"}


def page(template: str | Path, uris: Mapping[str, str] | None = None, **content: Any) -> str:
    """Return a page as HTML, with escaped content.

    The template is a name of this package, or the path of one that extends it; ``content`` has its
    variables. ``uris`` has the data URIs of its pictures by their anchors.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    path = TEMPLATES / template
    environment = Environment(
        loader=FileSystemLoader([path.parent, TEMPLATES]),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.globals |= {"tones": TONES, "remarks": {}, "interactive": (), "uris": uris or {}}
    return environment.get_template(path.name).render(**content)


def file_uris(paths: Mapping[str, Path]) -> dict[str, str]:
    """Return the data URIs of picture files."""
    with ThreadPoolExecutor() as threads:
        return dict(zip(paths, threads.map(_data_uri, paths.values()), strict=True))


def _data_uri(path: Path) -> str:
    from PIL import Image

    if path.suffix.lower() == ".gif":
        return f"data:image/gif;base64,{base_64(path.read_bytes())}"
    smaller = BytesIO()
    picture = Image.open(path).convert("RGB")
    picture.thumbnail((WIDEST, WIDEST))
    picture.save(smaller, **_WEBP)
    return f"data:image/webp;base64,{base_64(smaller.getvalue())}"


def base_64(content: bytes) -> str:
    """Return bytes in base 64."""
    return base64.b64encode(content).decode("ascii")
