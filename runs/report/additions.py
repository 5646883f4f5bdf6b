# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a client adds to the report of a run, and prints after it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from protractile.runs import clients
from protractile.runs.report.pages import TEMPLATES

if TYPE_CHECKING:
    from rich.console import Console

    from protractile.runs.pipeline.results import Results


@dataclass(frozen=True, slots=True)
class Addition:
    """Content that a client adds to the report of a run."""

    #: path of a template that extends ``report.html`` and fills its blocks ``added_…``
    template: Path = TEMPLATES / "report.html"
    content: Mapping[str, Any] = field(default_factory=dict)  #: further variables of the template
    #: sentences below tables and figures, by anchor
    remarks: Mapping[str, str] = field(default_factory=dict)
    #: contents of further files in the folder of the run, by name
    files: Mapping[str, str] = field(default_factory=dict)


def judge(results: Results) -> Addition:
    """Return what the first client that judges runs adds to the report of a run."""
    judged = (client.judge(results) for client in clients.modules("additions"))
    return next(judged, Addition())


def show(judged: Mapping[str, Addition], console: Console) -> int:
    """Print the judgements of the client on runs, by file name, and return the exit status."""
    shown = (client.show(judged, console) for client in clients.modules("additions"))
    return next(shown, 0)
