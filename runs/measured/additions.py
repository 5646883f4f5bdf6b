# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison with measured channels in the report of a run."""

from __future__ import annotations

from protractile.dynamics.failure import NumericsError
from protractile.runs.measured.keys import Keys
from protractile.runs.pipeline.results import Results
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report.additions import Addition


def judge(results: Results) -> Addition:
    """Return the tables of the comparison of a beam; none if it cannot be computed."""
    if not (isinstance(results.case, Keys) and results.case.measured):
        return Addition()
    from protractile.runs.measured.compare import compare

    try:
        return Addition(tables=compare(results.case).tables)
    except (BadInput, NumericsError):
        return Addition()
