# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results of a sweep as dataset, table and charts."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from rich.console import Console

from protractile.analysis.quantities import Quantity, declared_quantities
from protractile.geometry.typography import NONE, number
from protractile.runs.folder.files import (
    atomic_path,
    folder_lock,
    modified_folder,
    write_atomically,
)
from protractile.runs.pipeline.quantities import QUANTITIES
from protractile.runs.pipeline.results import CONVENTIONS
from protractile.runs.pipeline.summary import ModelSummary
from protractile.runs.process.terminal import printable
from protractile.runs.report.document import figure_page
from protractile.runs.report.figures import write_pictures
from protractile.runs.report.tables import Table
from protractile.runs.sweep.distances import DISTANCES, UNTIL
from protractile.runs.sweep.figures import PERMITTED, distance_figures, sweep_figures
from protractile.runs.sweep.points import Plan
from protractile.runs.sweep.run import Outcome

NETCDF = "sweep.nc"
CSV = "sweep.csv"
REPORT = "report.html"

# Decimals of relative differences: a hundredth of a percent.
DIGITS = 4
# Quantities that fit into a terminal of 80 columns.
SHOWN = ("tip_at_rest", "tip_amplitude", "contact_force", "stress")


def gather(plan: Plan, outcomes: Sequence[Outcome]) -> xr.Dataset:
    """Return the outcomes as a dataset over the varied keys, in the units of the case, and models.

    It has the quantities of :mod:`.runs.pipeline.quantities`, NaN where a model has no value, and
    ``failed``, which is 1 for failed models. With a reference model it has the differences from
    this model, and ``compared_until``, the time in s up to which tips are compared. A limit of the
    case is the attribute ``permitted`` of the quantity.
    """
    dims, models = list(plan.coordinates), plan.coordinates["model"]
    quantities = QUANTITIES if plan.reference is None else (*QUANTITIES, *DISTANCES)
    rows = [
        outcome.models.get(name, {})
        | outcome.differences.get(name, {})
        | {"failed": name in outcome.failures}
        for outcome in outcomes
        for name in models
    ]
    shape = *plan.shape, len(models)
    variables: dict[str, Any] = {}
    permitted = {limit.quantity.name: {PERMITTED: limit.permitted} for limit in plan.limits}
    for quantity in quantities:
        values = np.array([row.get(quantity.name) for row in rows], dtype=float).reshape(shape)
        attributes = {"units": quantity.unit, "long_name": quantity.title}
        variables[quantity.name] = dims, values, attributes | permitted.get(quantity.name, {})
    failed = np.array([row["failed"] for row in rows], dtype=np.int8).reshape(shape)
    variables["failed"] = dims, failed, {"long_name": "the computation failed"}
    if plan.reference is not None:
        ends = np.array([outcome.until for outcome in outcomes], dtype=float).reshape(plan.shape)
        until = {"units": "s", "long_name": "tips compared until"}
        variables = {UNTIL: (dims[:-1], ends, until), **variables}
    about = {"Conventions": CONVENTIONS, "title": plan.title}
    return xr.Dataset(variables, coords=plan.coordinates, attrs=about)


def write(plan: Plan, outcomes: Sequence[Outcome], folder: Path) -> xr.Dataset:
    """Write the files of a sweep in place of earlier ones, and return the dataset.

    The files are ``sweep.nc``, ``sweep.csv``, and charts as PNG and in ``report.html``.
    """
    data = gather(plan, outcomes)
    with (
        folder_lock(folder),
        modified_folder(folder) as part,
        atomic_path(part / NETCDF) as netcdf,
        atomic_path(part / CSV) as table,
    ):
        data.to_netcdf(netcdf, engine="scipy")
        *keys, model = data["failed"].dims
        rows = data.drop_vars("failed").to_dataframe([*keys, model]).reset_index()
        # As text, values are not rounded.
        rows[keys] = rows[keys].astype(str)
        names = data[model].values
        rows["failure"] = [outcome.failures.get(name, "") for outcome in outcomes for name in names]
        rows.to_csv(table, index=False, float_format="%.9g", lineterminator="\r\n")
        figures = sweep_figures(data, plan.bonded)
        if plan.reference is not None:
            others = data.drop_sel(model=plan.reference)
            figures += distance_figures(others, plan.reference)
        write_pictures(figures, part)
        write_atomically(part / REPORT, figure_page(plan.title, figures))
    return data


def conclude(plan: Plan, outcomes: Sequence[Outcome], folder: Path, console: Console) -> None:
    """Write the files of :func:`write`, and print the table of :func:`print_ranges`."""
    data = write(plan, outcomes, folder)
    print(printable(str(folder / CSV)))
    print_ranges(data, plan, console)


def print_ranges(data: xr.Dataset, plan: Plan, console: Console) -> None:
    """Print ranges of results, met limits, and differences of models."""
    keys = [variable.name for variable in data.coords.values() if variable.name != "model"]
    by_name = {quantity.name: quantity for quantity in QUANTITIES}
    quantities, residual = [by_name[name] for name in SHOWN], by_name["energy_residual"]
    rows = []
    for name in data["model"].values:
        values = data.sel(model=name)
        ranges = [_range(values[quantity.name], quantity) for quantity in quantities]
        worst = number(float(values[residual.name].max()), 1)
        rows.append((str(name), *ranges, worst, _where_largest(values["tip_amplitude"], keys)))
    # Headings are narrow, so that 80 columns suffice.
    headings = [
        *(f"{quantity.title} {quantity.shown_unit}" for quantity in quantities),
        residual.title,
        "farthest at",
    ]
    Table.of_rows(
        "sweep",
        f"Sweep over {', '.join(keys)}: {data['failed'].size // data['model'].size} points",
        ("model", *(heading.replace(" ", "\n") for heading in headings)),
        rows,
    ).show(console)
    for limit, name in product(plan.limits, data["model"].values):
        numbers = data[limit.quantity.name].sel(model=name).values.ravel()
        num_met = sum(limit.is_met_by(value) for value in numbers)
        line = f"{name}: {limit} at {num_met} of {numbers.size} points"
        console.print(line, markup=False, highlight=False)
    if plan.reference is not None:
        _print_distances(data, plan.reference, console)


def _print_distances(data: xr.Dataset, reference: str, console: Console) -> None:
    others = [str(name) for name in data["model"].values if name != reference]
    rows = [
        (
            name,
            *(
                _range(data[distance.name].sel(model=name).round(DIGITS), distance)
                for distance in DISTANCES
            ),
        )
        for name in others
    ]
    headings = [
        f"{distance.title} {distance.shown_unit}".replace(" ", "\n") for distance in DISTANCES
    ]
    title = f"Distances from {reference}"
    Table.of_rows("distances", title, ("model", *headings), rows).show(console)
    until = _range(data[UNTIL], Quantity(UNTIL, "s", ""))
    step_error = data["step_error"].sel(model=reference).round(DIGITS)
    difference = _range(step_error, declared_quantities(ModelSummary)["step_error"])
    if until != NONE:
        console.print(f"tips are compared until {until} s", markup=False, highlight=False)
    if difference != NONE:
        line = f"the time step changes the tip of {reference} by {difference} % of its range"
        console.print(line, markup=False, highlight=False)


def _range(values: xr.DataArray, quantity: Quantity) -> str:
    finite = quantity.factor * values.values[np.isfinite(values.values)]
    if not finite.size:
        return NONE
    ends = (number(float(finite.min())), number(float(finite.max())))
    return "…".join(dict.fromkeys(ends))


def _where_largest(values: xr.DataArray, keys: Sequence[str]) -> str:
    if not np.isfinite(values.values).any():
        return NONE
    place = np.unravel_index(np.nanargmax(values.values), values.shape)
    return "\n".join(f"{values[key].values[i]:g}" for key, i in zip(keys, place, strict=True))
