# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a run leaves, in the terminal."""

from __future__ import annotations

from collections.abc import Mapping

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from runs.paper.statements import STATEMENTS, Verdict
from runs.pipeline.results import Results
from runs.report.model_tables import model_rows
from runs.report.theme import number

_STYLES = {"reproduced": "green", "contradicted": "red", "undecided": "yellow"}


def print_models(results: Results, console: Console) -> None:
    """Print the table of a run's models, and what they are not worth."""
    models = Table(title=Text(results.case.title), title_justify="left", box=SIMPLE_HEAD)
    models.add_column("model", no_wrap=True)
    for heading in (
        "dofs",
        "first contact s",
        "first tip peak s",
        "mm",
        "energy\nresidual",
        "wall s",
    ):
        models.add_column(heading, justify="right", no_wrap="\n" in heading)
    for row in model_rows(results):
        models.add_row(
            Text(row.name),
            row.degrees_of_freedom,
            row.first_contact,
            row.tip_peak_time,
            row.tip_peak,
            row.energy_residual,
            row.seconds,
        )
    console.print(models)
    for name, model in results.summary["models"].items():
        if errors := model.get("reduction_errors"):
            console.print(
                f"{name}: {model['modes']} coordinates answer as the full shell does, contacts "
                f"within {number(errors['contact_compliance'], 1)}, tip and head within "
                f"{number(errors['readings'], 1)}",
                markup=False,
            )
        if (error := model.get("mesh_error")) is not None:
            console.print(
                f"{name}: the mesh answers where the segments touch as an infinitely fine one "
                f"does, within {number(100.0 * error, 2)} % of what the walls give way",
                markup=False,
            )
    for caution in results.cautions():
        console.print(caution, markup=False)


def print_verdicts(runs: Mapping[str, Results], console: Console) -> None:
    """Print one table of verdicts: on each statement that of the first run that decides it.

    Args:
        runs: by the name of their case; nothing is printed if none judges the paper.
        console: where to.
    """
    judging = {name: results for name, results in runs.items() if results.judges_the_paper}
    if not judging:
        return
    table = Table(title="Statements of the paper", title_justify="left", box=SIMPLE_HEAD)
    table.add_column("id")
    table.add_column("verdict")
    table.add_column("measured", justify="right")
    table.add_column("threshold", justify="right")
    table.add_column("statement", ratio=1)
    for statement in STATEMENTS:
        name, verdict = decisive(judging, statement)
        demanded = " (demanded)" if statement in judging[name].case.demand else ""
        unit = f" ({verdict.unit})" if verdict.unit else ""
        table.add_row(
            statement,
            Text.assemble(
                (f"{verdict.verdict}{demanded}", _STYLES[verdict.verdict]),
                (f"\nin {name}" if len(judging) > 1 else "", "dim"),
            ),
            number(verdict.measured),
            number(verdict.threshold),
            Text.assemble(verdict.statement, (unit, "dim")),
        )
    console.print(table)


def decisive(runs: Mapping[str, Results], statement: str) -> tuple[str, Verdict]:
    """The first run that decides a statement, and its verdict; the first of all if none does."""
    verdicts = [
        (name, verdict)
        for name, results in runs.items()
        for verdict in results.verdicts
        if verdict.id == statement
    ]
    decided = [entry for entry in verdicts if entry[1].verdict != "undecided"]
    return (decided or verdicts)[0]
