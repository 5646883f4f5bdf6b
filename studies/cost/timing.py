# SPDX-License-Identifier: LGPL-3.0-or-later
"""Measurement of wall times of runs that take turns, and writer of tables."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from time import perf_counter
from typing import Any

from rich.console import Console

from protractile.runs.report.tables import Table, write

# Total time in s for which short runs are repeated to measure their mean.
MEASURABLE = 0.05

NOISE = (
    "Medians. The last digit shown is the first that the spread, half the range of the "
    "repetitions, reaches; ~ where the noise exceeds one digit. One repetition shows one digit."
)


def time_in_turns(
    runs: Sequence[Callable[[], object]], most: int, budget: float
) -> list[list[float]]:
    """Return the wall times in s of each run; the runs take turns, ``most`` times at most.

    After a wall time of ``budget`` in s of a run, no repetition of it starts.
    """
    seconds: list[list[float]] = [[] for _ in runs]
    for _ in range(most):
        for run, taken in zip(runs, seconds, strict=True):
            if sum(taken) < budget:
                taken.append(_mean(run))
    return seconds


def _mean(run: Callable[[], object]) -> float:
    count, seconds = 0, 0.0
    start = perf_counter()
    while seconds < MEASURABLE:
        run()
        count += 1
        seconds = perf_counter() - start
    return seconds / count


def write_tables(
    folder: Path,
    name: str,
    title: str,
    data: Mapping[str, Any],
    tables: Iterable[Table],
    console: Console,
) -> None:
    """Print tables one by one, and write them as NAME.json, with further data, and NAME.md."""
    shown = []
    for table in tables:
        table.show(console)
        shown.append(table)
    everything = {**data, **{table.name: table.data for table in shown}}
    write(folder, name, title, everything, [table for table in shown])
