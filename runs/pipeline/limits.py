# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison of the limits of a case with the numbers of a run."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from runs.case.schema import LimitsTable
from runs.pipeline.metrics import Metric
from runs.pipeline.quantities import QUANTITIES, measure
from runs.pipeline.results import Results


@dataclass(frozen=True, slots=True)
class Limit:
    """Smallest or largest permitted value of a quantity."""

    quantity: Metric
    permitted: float  #: permitted value in SI units
    least: bool = False  #: whether larger values are permitted

    @property
    def sign(self) -> str:
        """The sign before the permitted value."""
        return "≥" if self.least else "≤"

    def __str__(self) -> str:
        """Return quantity, sign and permitted value: ``tip deflection ≤ 900 mm``."""
        return f"{self.quantity.title} {self.sign} {self.shown(self.permitted)}"

    def shown(self, value: float | None) -> str:
        """Return a value in SI units as text in the displayed unit; empty without a value."""
        unit = self.quantity.shown_unit
        return "" if value is None else f"{self.quantity.factor * value:.4g} {unit}"

    def permits(self, value: float) -> bool:
        """Return whether a value in SI units is within the limit."""
        return value >= self.permitted if self.least else value <= self.permitted


@dataclass(frozen=True, slots=True)
class LimitCheck:
    """Limit with the numbers of models in SI units; the decisive model comes first."""

    limit: Limit
    values: Mapping[str, float]

    @property
    def decisive(self) -> tuple[str, float] | None:
        """The first model with its number; None if no model has one."""
        return next(iter(self.values.items()), None)

    @property
    def holds(self) -> bool:
        """True if the decisive number is within the limit; False without a number."""
        return self.decisive is not None and self.limit.permits(self.decisive[1])


def limits_of(table: LimitsTable | None) -> list[Limit]:
    """Return the limits of a case."""
    given = {} if table is None else table.model_dump(exclude_none=True)
    least = LimitsTable.LEAST
    return [
        Limit(one, given[one.name], one.name in least) for one in QUANTITIES if one.name in given
    ]


def check_limits(results: Results) -> Iterator[LimitCheck]:
    """Yield the limits of a run's case with the numbers of its leading models."""
    limits = limits_of(results.case.limits)
    found = {name: measure(results, name) for name in results.leading_models if limits}
    for limit in limits:
        numbers = {name: one[limit.quantity.name] for name, one in found.items()}
        yield LimitCheck(limit, {name: one for name, one in numbers.items() if one is not None})
