# SPDX-License-Identifier: LGPL-3.0-or-later
"""One table of verdicts over several runs, in the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from runs.paper.statements import STATEMENTS
from runs.report.numerals import NONE, number
from runs.report.verdict import Verdict

_STYLES = {"reproduced": "green", "contradicted": "red", "undecided": "yellow"}


def print_verdicts(runs: Mapping[str, Sequence[Verdict]], console: Console) -> None:
    """Print one table of verdicts: on each statement that of the first run that decides it.

    Args:
        runs: the verdicts by the name of their case; nothing is printed if there are none.
        console: where to.
    """
    judging = [name for name, verdicts in runs.items() if verdicts]
    if not judging:
        return
    table = Table(title="Statements of the paper", title_justify="left", box=SIMPLE_HEAD)
    table.add_column("id")
    table.add_column("verdict")
    table.add_column("measured", justify="right")
    table.add_column("threshold", justify="right")
    table.add_column("statement", ratio=1)
    found = decisive(runs)
    by_then = any(verdict.then for _, verdict in found)
    if by_then:
        table.add_column("as computed then", ratio=1)
    for name, verdict in found:
        demanded = " (demanded)" if verdict.demanded else ""
        unit = f" ({verdict.unit})" if verdict.unit else ""
        table.add_row(
            verdict.id,
            Text.assemble(
                (f"{verdict.verdict}{demanded}", _STYLES[verdict.verdict]),
                (f"\nin {name}" if len(judging) > 1 else "", "dim"),
            ),
            number(verdict.measured),
            number(verdict.threshold),
            Text.assemble(verdict.statement, (unit, "dim")),
            *((verdict.then or NONE,) if by_then else ()),
        )
    console.print(table)


def decisive(runs: Mapping[str, Sequence[Verdict]]) -> list[tuple[str, Verdict]]:
    """Each statement's verdict, and the run that gives it.

    That is the first run that decides it; the first of all if none does.
    """
    found: dict[str, tuple[str, Verdict]] = {}
    for name, verdicts in runs.items():
        for verdict in verdicts:
            first = found.setdefault(verdict.id, (name, verdict))[1]
            if first.verdict == "undecided" != verdict.verdict:
                found[verdict.id] = name, verdict
    return [found[statement] for statement in STATEMENTS if statement in found]
