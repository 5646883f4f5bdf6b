# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a client adds to the report of a run, and prints after it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from protractile.runs import clients
from protractile.runs.report.pages import TEMPLATES

if TYPE_CHECKING:
    from rich.console import Console

    from protractile.runs.pipeline.results import Results
    from protractile.runs.report.tables import Table


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
    tables: Sequence[Table] = ()  #: tables of the chapter on readings


def judge(results: Results) -> Addition:
    """Return what clients add to the report of a run: tables of all, the rest of the first one."""
    judged = [client.judge(results) for client in clients.modules("additions")]
    first = next(iter(judged), Addition())
    return replace(first, tables=[table for one in judged for table in one.tables])


def show(judged: Mapping[str, Addition], console: Console) -> int:
    """Print the judgements of the first client on runs, by file name; return the exit status."""
    shown = (client.show(judged, console) for client in clients.modules("additions"))
    return next(shown, 0)
