# SPDX-License-Identifier: LGPL-3.0-or-later
"""Verdicts as additions to the report of a run and to the terminal."""

from __future__ import annotations

from protractile.runs.paper import rules
from protractile.runs.paper.verdicts import addition
from protractile.runs.paper.verdicts import show as show
from protractile.runs.pipeline.results import Results
from protractile.runs.report.additions import Addition


def judge(results: Results) -> Addition:
    """Return the verdicts on a run as additions to its report."""
    return addition(results.case, rules.judge(results))
