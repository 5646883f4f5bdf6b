# SPDX-License-Identifier: LGPL-3.0-or-later
"""Convergence of values on successively finer meshes, and their limit (Roache 1994)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

from protractile.runs.report.tables import Table
from studies.study import Kind, Verification

# Safety factor of a grid convergence index of three or more grids (Roache 1998).
SAFETY = 1.25
# Observed order below which the values do not converge.
LEAST_ORDER = 0.5


class Reference(NamedTuple):
    """Reference value, and the permitted relative error."""

    value: float
    kind: Kind
    source: str
    allowed: float


@dataclass(frozen=True, slots=True)
class Refined:
    """Values of a quantity on successively finer meshes."""

    what: str  #: name of the quantity
    unit: str  #: unit of the values; empty for a pure number, or if the source gives none
    sizes: Sequence[float]  #: sizes of the meshes, decreasing by a constant ratio
    values: Sequence[float]  #: value on each mesh
    reference: Reference | None = None  #: reference of the finest, if known

    @classmethod
    def by_edges(
        cls,
        what: str,
        unit: str,
        edges: Sequence[int],
        values: Sequence[float],
        reference: Reference,
    ) -> Refined:
        """Return the values on meshes with numbers of edges, with sizes over the finest one's."""
        sizes = [edges[-1] / n for n in edges]
        return cls(f"{what}, {edges[-1]} edges", unit, sizes, values, reference)

    @property
    def order(self) -> float:
        """Observed order on the three finest meshes; NaN without monotonic convergence."""
        if len(self.values) < 3:
            return math.nan
        coarse, medium, fine = self.values[-3:]
        earlier, later = medium - coarse, fine - medium
        if later == 0.0 or earlier / later <= 1.0:
            return math.nan
        return math.log(earlier / later) / math.log(self._ratio)

    @property
    def limit(self) -> float:
        """Extrapolated value at mesh size zero (Richardson 1911); NaN without an order."""
        medium, fine = self.values[-2:]
        return fine + (fine - medium) / self._shrinking

    @property
    def index(self) -> float:
        """Grid convergence index of the finest mesh, relative to its value."""
        medium, fine = self.values[-2:]
        return SAFETY * abs((fine - medium) / fine) / self._shrinking

    @property
    def converges(self) -> bool:
        """Whether the values on the meshes converge."""
        return self.order > LEAST_ORDER  # False where there is none

    @property
    def best(self) -> float:
        """Extrapolated value; without convergence, the value of the finest mesh."""
        return self.limit if self.converges else self.values[-1]

    @property
    def errors(self) -> list[float]:
        """Error of each mesh, relative to the reference; without a reference, to the limit."""
        exact = self.limit if self.reference is None else self.reference.value
        return [abs(value / exact - 1.0) for value in self.values]

    @property
    def verification(self) -> Verification:
        """Return the verification of the finest mesh against the reference."""
        assert self.reference is not None
        value, kind, source, allowed = self.reference
        order = self.order if math.isfinite(self.order) else None
        return Verification(
            self.what, self.values[-1], value, self.unit, kind, source, allowed, order
        )

    def against_limit(self, what: str, size: float, finest: str, allowed: float) -> Verification:
        """Return the verification of a mesh of a size against the limit of refinement.

        If there is no limit, the reference is the finest mesh, with the name ``finest``.

        Raises:
            ValueError: the values do not converge.
        """
        if not self.converges and size == self.sizes[-1]:
            raise ValueError(f"{what}: the finest mesh would be held against itself")
        value = self.values[self.sizes.index(size)]
        source = "limit of its refinement (Richardson 1911)" if self.converges else finest
        order = self.order if self.converges else None
        return Verification(what, value, self.best, self.unit, "other code", source, allowed, order)

    @property
    def _ratio(self) -> float:
        return self.sizes[-2] / self.sizes[-1]

    @property
    def _shrinking(self) -> float:
        return math.pow(self._ratio, self.order) - 1.0


def refined_table(
    name: str, title: str, found: Sequence[Refined], mesh: str, notes: Sequence[str] = ()
) -> Table:
    """Return a table with one row per quantity: its values, order, limit and index.

    Quantities have values on all sizes or only on the finest. ``mesh`` is the format of the name of
    a mesh size, such as "edges × {:g}".
    """
    sizes = max((one.sizes for one in found), key=len)
    columns = {
        "quantity": "", **{mesh.format(size): ".6g" for size in sizes}, "order": ".2f",
        "limit": ".6g", "GCI (%)": ".3f",
    }  # fmt: skip
    return Table.of_rows(
        name,
        title,
        columns,
        [
            (
                f"{one.what} ({one.unit})" if one.unit else one.what,
                *[None] * (len(sizes) - len(one.values)),
                *one.values,
                one.order,
                one.limit,
                100.0 * one.index,
            )
            for one in found
        ],
        notes,
    )
