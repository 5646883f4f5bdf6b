# SPDX-License-Identifier: LGPL-3.0-or-later
"""Interface to the client that evaluates runs, here :mod:`runs.paper`.

The client adds its part to reports and prints verdicts. Only this module and
:mod:`runs.case.schema`, which adds the client's keys to every case, import it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

    from runs.pipeline.results import Results
    from runs.report.pages import Addition


def judge(results: Results) -> Addition:
    """Return the client's additions to the report of a run."""
    from runs.paper import rules, verdicts

    return verdicts.addition(results.case, rules.judge(results))


def show(judged: Mapping[str, Addition], console: Console) -> int:
    """Print the client's verdicts on runs, each run by its file; return the exit status."""
    from runs.paper.verdicts import show

    return show(judged, console)
