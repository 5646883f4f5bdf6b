# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sensitivity of the results of a beam to each number of a case, by central differences."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
from rich.console import Console

from geometry.typography import TO_PERCENT, join_words
from runs.case import reading as case_file
from runs.case.messages import BadInput
from runs.case.schema import Case
from runs.folder.files import atomic_path, folder_lock, modified_folder
from runs.pipeline.quantities import QUANTITIES
from runs.report.tables import Column, Table
from runs.sweep.points import (
    Plan,
    Plates,
    Point,
    Setting,
    chosen_beam,
    make_points,
    tables_of,
)
from runs.sweep.run import Outcome
from runs.sweep.sampling import SHOWN, results_of
from runs.sweep.variation import Variation, numbers

OPTION = "--sensitivity"
CSV = "sensitivity.csv"
# Relative change by which each number is increased and decreased.
CHANGE = 0.01
# Maximum number of rows in the terminal.
MOST_ROWS = 20
# Relative change of a result below which it counts as round-off.
NONE = 1.0e-7

# Tables that do not describe the boom.
_OTHER = {"time", "model", "observe", "life"}


def plan_changes(
    file: str, models: Sequence[str] | None, mesh_size: float | None
) -> tuple[Plan, list[str]]:
    """Return the plan of a sensitivity analysis, and the keys whose change makes the case invalid.

    The first point is the case itself. Two points follow for each number, below and above it.

    Raises:
        BadInput: the case is invalid, or does not have exactly one model to run.
    """
    case = case_file.load(file)
    models = chosen_beam(case, models)
    if len(models) != 1:
        what = f"{len(models)} models are chosen; name one with --models, a beam say"
        raise BadInput(file, OPTION, what)
    plates: dict[Sequence[Setting], Plates] = {}
    points: list[Point] = [*make_points(case, file, models, mesh_size, [()], plates)]
    rejected_keys = []
    tables = tables_of(case)
    for place, value in numbers({k: v for k, v in tables.items() if k not in _OTHER}):
        if not (isinstance(value, float) and value):
            continue
        values = (1.0 - CHANGE) * value, (1.0 + CHANGE) * value
        variation = Variation(place.name, values, (place,))
        try:
            settings = [[(variation, value)] for value in values]
            points += make_points(case, file, models, mesh_size, settings, plates)
        except BadInput:
            rejected_keys.append(place.name)
    return Plan(file, case.title, (), (), (), points), rejected_keys


def changes(plan: Plan, outcomes: Sequence[Outcome]) -> pd.DataFrame:
    """Return a table of relative changes of results for an increase of each key by 1 %.

    It has a column per result and a row per key that has an effect. Rows are in descending order
    of the largest effect on the main results.
    """
    (results,) = results_of(plan, outcomes).values()
    base, below, above = results.iloc[0], results.iloc[1::2], results.iloc[2::2]
    keys = [point.label.partition("=")[0] for point in plan.points[1::2]]
    parts = (above.to_numpy() - below.to_numpy()) / (2.0 * base.abs().to_numpy())
    table = pd.DataFrame(parts, keys, results.columns).replace([np.inf, -np.inf], np.nan)
    table = table.mask(table.abs() < NONE, 0.0)
    largest = table.reindex(columns=SHOWN).abs().max(axis=1)
    order = largest.sort_values(ascending=False, kind="stable")
    return table.loc[order.index[order > 0.0]].dropna(axis=1, how="all")


def write(data: pd.DataFrame, folder: Path) -> None:
    """Write the relative changes in % to ``sensitivity.csv`` in the folder of a sweep."""
    with folder_lock(folder), modified_folder(folder) as part, atomic_path(part / CSV) as path:
        percent = (TO_PERCENT * data).rename_axis("key").reset_index()
        percent.to_csv(path, index=False, float_format="%.6g", lineterminator="\r\n")


def print_influences(
    data: pd.DataFrame, case: Case, invalid_keys: Sequence[str], console: Console
) -> None:
    """Print the table of the keys with the largest influence."""
    top = data.head(MOST_ROWS)
    columns = [Column("1 % more of", list(top.index))]
    columns += [
        Column(one.title.replace(" ", "\n"), (TO_PERCENT * top[one.name]).tolist(), ".2f")
        for one in QUANTITIES
        if one.name in SHOWN and one.name in top
    ]
    notes = [f"Refused with 1 % more or less: {join_words(invalid_keys)}."] if invalid_keys else []
    if len(data) > len(top):
        notes.append(f"{len(data) - len(top)} more numbers are in {CSV}.")
    title = f"Change of results in % by 1 % of each number: {case.models[0].name}"
    Table(title, columns, notes, "sensitivity").show(console)
