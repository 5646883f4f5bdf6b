# SPDX-License-Identifier: LGPL-3.0-or-later
"""Values on ever finer meshes beside a reference that is known."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from runs.report.tables import TextTable
from runs.report.theme import fixed, number
from runs.studies.grid_convergence import GridConvergence
from runs.studies.study import Kind, Plot, Proof

RATIO = 2.0


@dataclass(frozen=True, slots=True)
class Refined:
    """A value on ever finer meshes beside its reference.

    Args:
        what: it is.
        unit: of the values; empty where the source names none.
        edges: along a side, each twice the one before.
        values: one for each mesh.
        reference: what it should be.
        kind, source: of the reference.
        allowed: relative error of the finest mesh.
    """

    what: str
    unit: str
    edges: Sequence[int]
    values: Sequence[float]
    reference: float
    kind: Kind
    source: str
    allowed: float

    @property
    def errors(self) -> list[float]:
        """Relative to the reference, with their signs."""
        return [value / self.reference - 1.0 for value in self.values]

    @property
    def order(self) -> float | None:
        """Observed on the three finest meshes; None where values do not go one way."""
        if len(self.values) < 3:
            return None
        order = GridConvergence.of(self.values, RATIO).order
        return order if math.isfinite(order) else None

    @property
    def proof(self) -> Proof:
        """The finest mesh against the reference."""
        return Proof(
            what=f"{self.what}, {self.edges[-1]} edges",
            value=self.values[-1],
            reference=self.reference,
            unit=self.unit,
            kind=self.kind,
            source=self.source,
            allowed=self.allowed,
            order=self.order,
        )


def refined_table(
    name: str, title: str, found: Sequence[Refined], notes: Sequence[str]
) -> TextTable:
    """One row a mesh."""
    rows = []
    for one in found:
        for i, (edges, value, error) in enumerate(
            zip(one.edges, one.values, one.errors, strict=True)
        ):
            last = i == len(one.edges) - 1
            unit = f" ({one.unit})" if one.unit else ""
            rows.append(
                (
                    f"{one.what}{unit}" if i == 0 else "",
                    str(edges),
                    number(value, 6),
                    number(one.reference, 6) if i == 0 else "",
                    fixed(error, 3, 100.0),
                    fixed(one.order, 2) if last else "",
                )
            )
    return TextTable(
        title, ("what", "edges", "value", "reference", "error (%)", "order"), rows, notes, name=name
    )


def refined_plot(name: str, title: str, found: Sequence[Refined], caption: str) -> Plot:
    """Error against the length of an edge.

    Args:
        name, title, caption: of the figure.
        found: its curves.
    """
    curves = {
        one.what: ([1.0 / n for n in one.edges], [abs(error) for error in one.errors])
        for one in found
    }
    return Plot(name, title, "length of an edge over that of the side", "error", curves, caption)
