# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a run leaves, in the terminal."""

from __future__ import annotations

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from runs.pipeline.results import Results
from runs.report.model_tables import model_rows
from runs.report.theme import number


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
                f"{name}: the mesh answers where the segments touch as an infinitely fine one "
                f"does, within {number(100.0 * error, 2)} % of what the walls give way",
                markup=False,
            )
    for caution in results.cautions():
        console.print(caution, markup=False)
