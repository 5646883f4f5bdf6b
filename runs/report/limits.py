# SPDX-License-Identifier: LGPL-3.0-or-later
"""Limits of a case in the report and in the terminal."""

from __future__ import annotations

from collections.abc import Iterator

from runs.pipeline.quantities import check_limits
from runs.pipeline.results import Results
from runs.report.tables import Column, Table


def limit_table(results: Results) -> Table | None:
    """Return the table of the limits of a case, with the values of the main models."""
    checks = list(check_limits(results))
    if not checks:
        return None
    columns = [
        Column("limit", [str(check.limit) for check in checks]),
        Column("satisfied", ["✓" if check.holds else "✗" for check in checks]),
    ]
    columns += [
        Column(name, [check.limit.format(check.values.get(name)) for check in checks])
        for name in results.main_models
    ]
    notes = [f"{results.main_models[0]} governs; if it has no value, the next model governs."]
    return Table("Limits of the case", columns, notes, "limits", ["✗"])


def limit_faults(results: Results) -> Iterator[str]:
    """Yield a line with key, value and model for each limit that is exceeded."""
    for check in check_limits(results):
        if check.holds:
            continue
        what = "no model has such a result"
        if check.decisive is not None:
            model, value = check.decisive
            what = f"{check.limit.format(value)} in {model}; the case demands {check.limit}"
        yield f"limits.{check.limit.quantity.name}: {what}"
