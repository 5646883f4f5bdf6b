# SPDX-License-Identifier: LGPL-3.0-or-later
"""The client that evaluates runs, the paper: its part of the report, its verdicts.

Nothing else imports it except :mod:`runs.case.schema`, which adds its keys to every case.
Another client would replace the names here and there.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from runs.pipeline.results import Results
    from runs.report.pages import Addition


def judge(results: Results, folder: Path | None = None) -> Addition:
    """Return what the client adds to the report of a run.

    Args:
        results: of the run.
        folder: of a finished run, which may hold the client's files.

    Raises:
        BadInput: one of these files is damaged, or of another case.
    """
    from runs.paper import readings, rules, verdicts

    found, case = rules.judge(results), results.case
    if folder is None:
        return verdicts.addition(case, found)
    found = verdicts.beside(found, folder, case)
    return verdicts.addition(case, found, readings.load(folder, case))


def show(judged: Mapping[str, Addition], console: Console) -> int:
    """Print the client's verdicts on runs, by their file; return the exit status."""
    from runs.paper.verdicts import show

    return show(judged, console)
