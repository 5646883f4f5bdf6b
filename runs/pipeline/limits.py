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
    least: bool = False  #: True for a smallest permitted value

    @property
    def sign(self) -> str:
        """The relation, ≥ or ≤."""
        return "≥" if self.least else "≤"

    def __str__(self) -> str:
        """Return quantity, relation and permitted value: ``tip deflection ≤ 900 mm``."""
        return f"{self.quantity.title} {self.sign} {self.shown(self.permitted)}"

    def shown(self, value: float | None) -> str:
        """Return a value in SI units as text in the displayed unit; empty without a value."""
        unit = self.quantity.shown_unit
        return "" if value is None else f"{self.quantity.factor * value:.4g} {unit}"

    def permits(self, value: float) -> bool:
        """Return True if a value in SI units is within the limit."""
        return value >= self.permitted if self.least else value <= self.permitted


@dataclass(frozen=True, slots=True)
class LimitCheck:
    """Limit and the values of the models in SI units. The first model with a value decides."""

    limit: Limit
    values: Mapping[str, float]

    @property
    def decisive(self) -> tuple[str, float] | None:
        """The first model with a value, and the value; None if no model has one."""
        return next(iter(self.values.items()), None)

    @property
    def holds(self) -> bool:
        """True if the decisive value is within the limit; False without a value."""
        return self.decisive is not None and self.limit.permits(self.decisive[1])


def case_limits(table: LimitsTable | None) -> list[Limit]:
    """Return the limits of a case."""
    values = {} if table is None else table.model_dump(exclude_none=True)
    least = LimitsTable.LEAST
    return [
        Limit(one, values[one.name], one.name in least) for one in QUANTITIES if one.name in values
    ]


def check_limits(results: Results) -> Iterator[LimitCheck]:
    """Yield the limits of the case with the values of the main models of the run."""
    limits = case_limits(results.case.limits)
    quantities = {name: measure(results, name) for name in results.main_models if limits}
    for limit in limits:
        numbers = {name: one[limit.quantity.name] for name, one in quantities.items()}
        yield LimitCheck(limit, {name: one for name, one in numbers.items() if one is not None})
