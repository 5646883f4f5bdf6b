# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a run leaves, in the terminal."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from geometry.typography import TO_MILLI, TO_PERCENT
from runs.pipeline.results import Results
from runs.process.terminal import message, say, shown
from runs.report.model_tables import model_table
from runs.report.numerals import number

# Columns of the models' table that fit a terminal → their headings there.
SHOWN = {
    "model": "model",
    "degrees of freedom": "dofs",
    "first contact\ns": "first contact s",
    "first tip peak\ns": "first tip peak s",
    "\nmm": "mm",
    "energy residual\nof the work": "energy\nresidual",
    "wall time\ns": "wall s",
}


def print_models(results: Results, console: Console) -> None:
    """Print the table of a run's models, and what they are not worth."""
    found = model_table(results)
    columns = [column for column in found.columns if column.heading in SHOWN]
    title = Text(results.case.title)
    models = Table(title=title, title_justify="left", box=SIMPLE_HEAD, pad_edge=False)
    for i, column in enumerate(columns):
        heading = SHOWN[column.heading]
        justify: Literal["left", "right"] = "right" if i else "left"
        models.add_column(heading, justify=justify, no_wrap=i == 0 or "\n" in heading)
    for row in replace(found, columns=columns).text.rows:
        models.add_row(*map(Text, row))
    console.print(models)
    for name, model in results.summary.models.items():
        if errors := model.reduction_errors:
            console.print(
                f"{name}: {model.modes} coordinates answer as the full shell does, contacts "
                f"within {number(errors['contact_compliance'], 1)}, tip and head within "
                f"{number(errors['readings'], 1)}",
                markup=False,
            )
        if (error := model.mesh_error) is not None:
            console.print(
                f"{name}: where the segments touch, the walls give way by "
                f"{number(TO_PERCENT * error, 2)} % more or less than on an infinitely fine mesh",
                markup=False,
            )
    _print_swings(results, console)
    for caution in results.summary.cautions:
        console.print(caution, markup=False)


def _print_swings(results: Results, console: Console) -> None:
    """Print how far the tip swings in each model that is drawn out."""
    for name, own in results.summary.answers.models.items():
        if (swing := own.swing) is None:
            continue
        levels = swing.where_begun, swing.where_ended
        ends = (number(None if level is None else TO_MILLI * level) for level in levels)
        console.print(
            f"{name}: drawn out at {number(swing.speed)} m/s in the mean the tip swings by "
            f"{number(TO_MILLI * swing.tip)} mm, at rest by {' and '.join(ends)} mm where that "
            "begins and ends",
            markup=False,
            highlight=False,
        )


def say_what_failed(file: str, results: Results) -> int:
    """Print a line for all models that failed; return the exit status."""
    numbers = {model.name: i for i, model in enumerate(results.case.models, start=1)}
    failures = results.summary.failures
    if not failures:
        return 0
    first, *others = (f"model[{numbers[name]}]" for name in failures)
    too = f"{', '.join(others)} failed, too; first " if others else ""
    say(message(f"{shown(file)}: {too}{first}: {next(iter(failures.values()))}"))
    return 3
