# SPDX-License-Identifier: LGPL-3.0-or-later
"""Interface to the client that judges runs: :mod:`.runs.paper`.

The client adds chapters to reports and prints lines. Only this module and :mod:`.runs.case.schema`
import it; the latter adds the keys of the client to every case.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from protractile.runs.pipeline.results import Results
    from protractile.runs.report.pages import Addition


def judge(results: Results) -> Addition:
    """Return the content that the client adds to the report of a run."""
    from protractile.runs.paper import rules, verdicts

    return verdicts.addition(results.case, rules.judge(results))


def show(judged: Mapping[str, Addition], console: Console) -> int:
    """Print the judgements of the client on runs, by file name, and return the exit status."""
    from protractile.runs.paper.verdicts import show

    return show(judged, console)
