# SPDX-License-Identifier: LGPL-3.0-or-later
"""HTML pages of one file each: every picture inside, no script, no resource from elsewhere."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined

_MEDIA = {".png": "image/png", ".gif": "image/gif"}
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
    picture = base64.b64encode(path.read_bytes()).decode("ascii")
    return f"data:{_MEDIA[path.suffix.lower()]};base64,{picture}"
