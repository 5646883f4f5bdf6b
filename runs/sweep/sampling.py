# SPDX-License-Identifier: LGPL-3.0-or-later
"""Scatter of results under the tolerances of a case, and their sensitivity to each number.

Tolerances are normal distributions, ``{ mean = 0.003, sd = 0.0005 }``. Samples are scrambled Sobol
points (Owen 1998), mapped to normal quantiles. A linear map then gives them the exact means and
variances and no correlation (moment matching, Barraquand 1995), so that the mean and the standard
deviation of a linear result are exact. Sensitivities are central differences, one-sided where a
side is refused.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd
from rich.console import Console

from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_PERCENT, join_words
from protractile.runs.case import reading as case_file
from protractile.runs.case.schema import Case
from protractile.runs.folder.files import atomic_path, folder_lock, modified_folder
from protractile.runs.pipeline.quantities import QUANTITIES
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.terminal import printable
from protractile.runs.report.tables import Column, Table
from protractile.runs.sweep.points import (
    Plan,
    Plates,
    Point,
    Setting,
    chosen_beam,
    make_points,
    tables_of,
)
from protractile.runs.sweep.run import Outcome
from protractile.runs.sweep.variation import MOST_POINTS, Place, Variation, numbers, with_size

OPTION = "--samples"
SAMPLES, CSV = "samples.csv", "sampling.csv"
CHANGES_CSV = "sensitivity.csv"
# Seed of the scrambling, by which all runs have the same points.
SEED = 0
# Quantiles in the table.
QUANTILES = (0.05, 0.25, 0.5, 0.75, 0.95)
# Results in the terminal, also of sensitivities.
SHOWN = ("tip_at_rest", "tip", "stress", "contact_force", "first_frequency")
# Ratio of standard deviation to mean below which a result has no scatter.
NONE = 1.0e-9

# Relative change by which each number is increased and decreased.
CHANGE = 0.01
# Signs of the changes.
SIDES = (-1, 1)
# Notes on the keys of refused points, by the signs of the valid changes.
_REFUSED = {
    (): "Refused with 1 % less and with 1 % more: {}.",
    (1,): "Refused with 1 % less, so that the change is that with 1 % more: {}.",
    (-1,): "Refused with 1 % more, so that the change is that with 1 % less: {}.",
}
# Maximum number of rows in the terminal.
MOST_ROWS = 20
# Relative change of a result below which it counts as round-off.
ROUND_OFF = 1.0e-7
# Tables that do not describe the boom.
_OTHER = {"time", "model", "observe", "life"}


def plan_samples(
    file: str, models: Sequence[str] | None, mesh_size: float | None, count: int
) -> tuple[Plan, pd.DataFrame]:
    """Return the plan of the samples, and a table of the sampled numbers in the case's units.

    Raises:
        BadInput: the case is invalid or has no distribution, the count is no power of 2 between the
            number of distributions and :data:`MOST_POINTS`, or a sample is invalid.
    """
    spreads, case = case_file.load_spreads(file), case_file.load(file)
    if not spreads:
        what = (
            "the case has no number with a mean and an sd; give one, for example "
            "{ mean = 0.003, sd = 0.0005 }"
        )
        raise BadInput(file, OPTION, what)
    places = [Place(spread.steps) for spread in spreads]
    check_count(count, len(spreads), file)
    values = normal_points(len(spreads), count) * [spread.sd for spread in spreads]
    values += [spread.mean for spread in spreads]
    variations = [
        Variation(place.name, tuple(column), (with_size(place, case),))
        for place, column in zip(places, values.T.tolist(), strict=True)
    ]
    return plan_points(case, file, models, mesh_size, variations, values)


def plan_points(
    case: Case,
    file: str,
    models: Sequence[str] | None,
    mesh_size: float | None,
    variations: Sequence[Variation],
    values: Array,
) -> tuple[Plan, pd.DataFrame]:
    """Return the plan of samples, and a table of the sampled numbers in the case's units.

    Args:
        case, file: the checked case, and its file for messages.
        models, mesh_size: as in :func:`.runs.sweep.points.plan`; by default the last beam.
        variations: the sampled numbers.
        values: their values (num_samples, num_variations).

    Raises:
        BadInput: the case has no beam, or a sample is invalid.
    """
    settings: list[Sequence[Setting]] = [
        list(zip(variations, row, strict=True)) for row in values.tolist()
    ]
    names = chosen_beam(case, models)
    if not names:
        raise BadInput(file, OPTION, "the case has no beam; name a model with --models")
    try:
        points = list(make_points(case, file, names, mesh_size, settings))
    except BadInput as fault:
        key = fault.key.removeprefix("--vary ")
        what = f"a sample is not valid, {key}: {fault.what}; give a smaller sd"
        raise BadInput(file, OPTION, what) from None
    samples = pd.DataFrame(values, columns=[variation.key for variation in variations])
    return Plan(file, case.title, (), (), (), points), samples


def check_count(count: int, dimensions: int, file: str) -> None:
    """Check a number of samples.

    Raises:
        BadInput: it is no power of 2 between the dimensions and :data:`MOST_POINTS`.
    """
    least = dimensions + 1
    if not least < count <= MOST_POINTS or count & (count - 1):
        example = max(64, 1 << least.bit_length())
        what = (
            f"must be a power of 2 above {least} and at most {MOST_POINTS}, such as {example}, "
            f"got {count}"
        )
        raise BadInput(file, OPTION, what)


def normal_points(dimensions: int, count: int) -> Array:
    """Return samples (count, dimensions) of mean 0, variance 1 and no correlation."""
    from scipy.stats import norm, qmc

    uniform = qmc.Sobol(dimensions, seed=SEED).random(count)
    points = norm.ppf(uniform)
    points -= points.mean(axis=0)
    covariance = np.atleast_2d(np.cov(points, rowvar=False))
    return np.asarray(np.linalg.solve(np.linalg.cholesky(covariance), points.T).T)


def results_of(plan: Plan, outcomes: Sequence[Outcome]) -> dict[str, pd.DataFrame]:
    """Return a table of results in SI units by model, with a row per point, a column per result."""
    names = [quantity.name for quantity in QUANTITIES if quantity.charted]
    return {
        model: pd.DataFrame(
            [outcome.models.get(model, {}) for outcome in outcomes], columns=names, dtype=float
        ).dropna(axis=1, how="all")
        for model in plan.coordinates["model"]
    }


def scatter(results: pd.DataFrame) -> pd.DataFrame:
    """Return a table of mean, standard deviation and quantiles, with a row per varying result."""
    parts = np.nanquantile(results, QUANTILES, axis=0, method="hazen")
    table = pd.DataFrame(parts.T, results.columns, QUANTILES)
    table.insert(0, "mean", results.mean())
    table.insert(1, "sd", results.std())
    return table[table["sd"] > NONE * table["mean"].abs()]


def conclude_samples(
    samples: pd.DataFrame, plan: Plan, outcomes: Sequence[Outcome], folder: Path, console: Console
) -> None:
    """Write ``samples.csv`` and ``sampling.csv``, and print the main statistics."""
    results = results_of(plan, outcomes)
    several = {
        "sample": {name: pd.concat([samples, frame], axis=1) for name, frame in results.items()},
        "result": {name: scatter(frame) for name, frame in results.items()},
    }
    with (
        folder_lock(folder),
        modified_folder(folder) as part,
        atomic_path(part / SAMPLES) as points,
        atomic_path(part / CSV) as table,
    ):
        for (of_row, frames), path in zip(several.items(), (points, table), strict=True):
            whole_table = pd.concat(frames, names=["model", of_row])
            whole_table.to_csv(path, float_format="%.9g", lineterminator="\r\n")
    print(printable(str(folder / CSV)))
    for model, statistics in several["result"].items():
        rows = [
            (f"{one.title} ({one.shown_unit})", *(one.factor * statistics.loc[one.name]).tolist())
            for one in QUANTITIES
            if one.name in SHOWN and one.name in statistics.index
        ]
        forms = {"": ""} | dict.fromkeys(("mean", "sd"), ".4g")
        forms |= {f"{100.0 * part:g} %": ".4g" for part in QUANTILES}
        title = f"Scatter of results over {len(plan.points)} samples: {model}"
        Table.of_rows("sampling", title, forms, rows).show(console)


class Change(NamedTuple):
    """A number of the case that is decreased and increased."""

    key: str  #: its key
    #: Index of the point with the number decreased (-1) or increased (+1), of the valid ones.
    points: Mapping[int, int]

    def relative(self, results: pd.DataFrame) -> pd.Series[float]:
        """Return the relative changes of results for an increase of the number by 1 %.

        They are central differences, or one-sided where a side has no result. The first row of
        ``results`` is the case itself.
        """
        base = results.iloc[0]
        below, above = (
            results.iloc[self.points[side]] if side in self.points else base * np.nan
            for side in SIDES
        )
        differences = 0.5 * (above - below), above - base, base - below
        first, *others = (difference / base.abs() for difference in differences)
        for share in others:
            first = first.fillna(share)
        return first


def plan_changes(
    file: str, models: Sequence[str] | None, mesh_size: float | None
) -> tuple[Plan, list[Change]]:
    """Return the plan of a sensitivity analysis, and the changed numbers with their points.

    The first point is the case itself. A changed number that makes the case invalid has no point.

    Raises:
        BadInput: the case is invalid, or does not have exactly one model to run.
    """
    case = case_file.load(file)
    models = chosen_beam(case, models)
    if len(models) != 1:
        what = f"{len(models)} models are chosen; name one with --models, a beam say"
        raise BadInput(file, "--sensitivity", what)
    plates: dict[Sequence[Setting], Plates] = {}
    points: list[Point] = [*make_points(case, file, models, mesh_size, [()], plates)]
    changed_numbers = []
    tables = tables_of(case)
    for place, value in numbers({k: v for k, v in tables.items() if k not in _OTHER}):
        if not (isinstance(value, float) and value):
            continue
        indices: dict[int, int] = {}
        values = {side: (1.0 + side * CHANGE) * value for side in SIDES}
        variation = Variation(place.name, tuple(values.values()), (place,))
        for side, changed in values.items():
            settings = [[(variation, changed)]]
            with suppress(BadInput):
                points += make_points(case, file, models, mesh_size, settings, plates)
                indices[side] = len(points) - 1
        changed_numbers.append(Change(place.name, indices))
    return Plan(file, case.title, (), (), (), points), changed_numbers


def changes(
    plan: Plan, changed_numbers: Sequence[Change], outcomes: Sequence[Outcome]
) -> pd.DataFrame:
    """Return a table of relative changes of results for an increase of each number by 1 %.

    It has a column per result and a row per key that has an effect. Rows are in descending order
    of the largest effect on the main results.
    """
    (results,) = results_of(plan, outcomes).values()
    parts = [number.relative(results) for number in changed_numbers if number.points]
    keys = [number.key for number in changed_numbers if number.points]
    table = pd.DataFrame(parts, columns=results.columns).set_axis(keys)
    table = table.replace([np.inf, -np.inf], np.nan)
    table = table.mask(table.abs() < ROUND_OFF, 0.0)
    largest = table.reindex(columns=SHOWN).abs().max(axis=1)
    order = largest.sort_values(ascending=False, kind="stable")
    return table.loc[order.index[order > 0.0]].dropna(axis=1, how="all")


def conclude_changes(
    changed_numbers: Sequence[Change],
    plan: Plan,
    outcomes: Sequence[Outcome],
    folder: Path,
    console: Console,
) -> None:
    """Write the relative changes in % to ``sensitivity.csv``, and print the largest ones."""
    data = changes(plan, changed_numbers, outcomes)
    with (
        folder_lock(folder),
        modified_folder(folder) as part,
        atomic_path(part / CHANGES_CSV) as path,
    ):
        percent = (TO_PERCENT * data).rename_axis("key").reset_index()
        percent.to_csv(path, index=False, float_format="%.6g", lineterminator="\r\n")
    print(printable(str(folder / CHANGES_CSV)))
    top = data.head(MOST_ROWS)
    columns = [Column("1 % more of", list(top.index))]
    columns += [
        Column(quantity.title.replace(" ", "\n"), (TO_PERCENT * top[quantity.name]).tolist(), ".2f")
        for quantity in QUANTITIES
        if quantity.name in SHOWN and quantity.name in top
    ]
    notes = []
    for valid, words in _REFUSED.items():
        if keys := [number.key for number in changed_numbers if (*number.points,) == valid]:
            notes.append(words.format(join_words(keys)))
    if len(data) > len(top):
        notes.append(f"{len(data) - len(top)} more numbers are in {CHANGES_CSV}.")
    title = f"Change of results in % by 1 % of each number: {plan.points[0].case.models[0].name}"
    Table(title, columns, notes, "sensitivity").show(console)
