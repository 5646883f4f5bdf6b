# SPDX-License-Identifier: LGPL-3.0-or-later
"""HTML pages of one file each: every picture and script inside, no resource from elsewhere."""

from __future__ import annotations

import base64
from io import BytesIO
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from PIL import Image

# A picture in a page is a third as large as on the disk, and looks the same; it has at most twice
# as many pixels as the page is wide for it.
WIDEST = 1240
_WEBP: dict[str, Any] = {"format": "WEBP", "quality": 85, "method": 1}
# How a verdict is marked, and the class of the mark.
MARKS = {"reproduced": "✓", "contradicted": "✗", "undecided": "?"}


def page(template: str, **content: Any) -> str:
    """A page as HTML; what it shows is escaped.

    Args:
        template: file in ``runs/report/templates``.
        content: what the template asks for.
    """
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["data_uri"] = _data_uri
    environment.globals |= {"marks": MARKS, "tones": {mark: kind for kind, mark in MARKS.items()}}
    return environment.get_template(template).render(**content)


def _data_uri(path: Path) -> str:
    if path.suffix.lower() == ".gif":
        return f"data:image/gif;base64,{_text(path.read_bytes())}"
    smaller = BytesIO()
    picture = Image.open(path).convert("RGB")
    picture.thumbnail((WIDEST, WIDEST))
    picture.save(smaller, **_WEBP)
    return f"data:image/webp;base64,{_text(smaller.getvalue())}"


def _text(content: bytes) -> str:
    return base64.b64encode(content).decode("ascii")
