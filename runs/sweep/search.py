# SPDX-License-Identifier: LGPL-3.0-or-later
"""Bisection for the value of a key at which a quantity reaches a bound, ``--until 'tip<0.9'``."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from itertools import pairwise
from pathlib import Path

import numpy as np
from rich.console import Console

from protractile.geometry.typography import choices
from protractile.geometry.units import scale
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context, Sentence
from protractile.runs.cautions.response import wall_shares
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.quantities import QUANTITIES, Limit
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.terminal import Progress
from protractile.runs.report.tables import Table
from protractile.runs.sweep.points import Plan
from protractile.runs.sweep.run import Outcome, run_points

OPTION = "--until"
# Width of the final bracket as a fraction of its larger end.
CLOSE = 1.0e-3

_BOUND = re.compile(r"\s*([a-z_]+)\s*(<|>)=?\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*")


def parse_bound(text: str, plan: Plan) -> Limit:
    """Read a bound on a quantity of sweeps, in the unit of the case.

    Raises:
        BadInput: the text is invalid, or the plan has several keys or models.
    """
    quantities = {quantity.name: quantity for quantity in QUANTITIES}
    match = _BOUND.fullmatch(text)
    if match is None:
        what = f"{text!r} is not understood; give QUANTITY<NUMBER or QUANTITY>NUMBER"
        raise BadInput(plan.file, OPTION, what)
    if match[1] not in quantities:
        what = f"{match[1]!r} is no quantity of a sweep; give {choices([*quantities])}"
        raise BadInput(plan.file, OPTION, what)
    for several, what, remedy in (
        (plan.variations, "keys vary", "give one --vary"),
        (plan.coordinates["model"], "models run", "name one with --models"),
    ):
        if len(several) != 1:
            raise BadInput(plan.file, OPTION, f"{len(several)} {what}; {remedy}")
    quantity = quantities[match[1]]
    si = scale(float(match[3]), plan.points[0].case.system.size(quantity.unit))
    return Limit(quantity, si, least=match[2] == ">")


def run_until(
    plan: Plan,
    bound: Limit | None,
    plan_of: Callable[[Sequence[str]], Plan],
    folder: Path,
    pool: Executor,
    progress: Progress,
    cache: Cache | None,
) -> tuple[Plan, list[Outcome]]:
    """Run a plan, and bisect until two values enclose the bound closely.

    Args:
        plan: plan of the first values.
        bound: bound of a quantity that the first values enclose; None for no bisection.
        plan_of: function that returns the plan of other variations KEY=VALUES.
        folder, pool, progress, cache: see :func:`.runs.sweep.run.run_points`.

    Returns:
        The plan with the values of all steps, and its outcomes.

    Raises:
        BadInput: the first values do not enclose the bound exactly once, or a point has no value.
    """
    while True:
        outcomes = run_points(plan, folder, pool, progress, cache)
        if bound is None:
            return plan, outcomes
        low, high = _bracket(plan, outcomes, bound)
        values = plan.variations[0].values
        if values[high] - values[low] <= CLOSE * max(abs(values[low]), abs(values[high])):
            return plan, outcomes
        middle = 0.5 * (values[low] + values[high])
        values_text = ",".join(map(repr, (*values, middle)))
        plan = plan_of([f"{plan.variations[0].key}={values_text}"])


def numbers(plan: Plan, outcomes: Sequence[Outcome], bound: Limit) -> list[float]:
    """Return the limited quantity at each point of the sweep, in SI units.

    Raises:
        BadInput: a point has no value.
    """
    values = []
    for point, outcome in zip(plan.points, outcomes, strict=True):
        (model,) = plan.coordinates["model"]
        value = outcome.models.get(model, {}).get(bound.quantity.name)
        if value is None:
            what = f"{model} has no {bound.quantity.title} at {point.label}"
            raise BadInput(plan.file, OPTION, what)
        values.append(value)
    return values


def _bracket(plan: Plan, outcomes: Sequence[Outcome], bound: Limit) -> tuple[int, int]:
    """Return the indices of the two adjacent values that enclose the bound."""
    values = numbers(plan, outcomes, bound)
    within = [bound.is_met_by(value) for value in values]
    changes = [pair for pair in pairwise(range(len(values))) if within[pair[0]] != within[pair[1]]]
    if len(changes) == 1:
        return changes[0]
    key = plan.variations[0].key
    span = f"{bound.format(min(values))} to {bound.format(max(values))}"
    passes, times = ("passes", f" {len(changes)} times") if changes else ("does not pass", "")
    what = (
        f"{bound.quantity.title} {passes} {bound.format(bound.permitted)}{times} over {key}, where "
        f"it is {span}; give values of {key} around one place where it does"
    )
    raise BadInput(plan.file, OPTION, what)


def print_bracket(plan: Plan, outcomes: Sequence[Outcome], bound: Limit, console: Console) -> None:
    """Print the two values that enclose the bound, and a note if the quantity is not monotonic."""
    results, key = np.array(numbers(plan, outcomes, bound)), plan.variations[0].key
    quantity, values = bound.quantity, plan.variations[0].values
    rows = [
        (
            f"{values[i]:.6g}",
            quantity.factor * results[i],
            "✓" if bound.is_met_by(results[i]) else "✗",
        )
        for i in _bracket(plan, outcomes, bound)
    ]
    unit = f" ({plan.units[0]})" if plan.units[0] else ""
    columns = {
        f"{key}{unit}": "",
        f"{quantity.title}\n{quantity.shown_unit}": ".5g",
        "satisfied": "",
    }
    signs = np.sign(np.diff(results))
    note = f"The {quantity.title} is not monotonic over {key}: other values may meet it, too."
    notes = [note] if (signs > 0.0).any() and (signs < 0.0).any() else []
    notes += rigid_wall_cautions(plan.points[0].case, plan.coordinates["model"][0])
    Table.of_rows("search", f"Bracket of {key}: {bound}", columns, rows, notes).show(console)


def rigid_wall_cautions(case: Case, name: str) -> list[str]:
    """Return a caution if a beam ignores walls under pads that change the tip considerably."""
    model = next(model for model in case.models if model.name == name)
    context = Context(case, build_boom(case))
    return [
        f"caution: {share} {name} has rigid walls: the bound is unsafe; take a shell"
        for share in (() if model.needs_shell else wall_shares(context))
        if not isinstance(share, Sentence)
    ]
