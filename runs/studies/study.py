# SPDX-License-Identifier: LGPL-3.0-or-later
"""The one form of a study: values beside their references, tables of numbers, curves."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

from runs.report.tables import TextTable
from runs.report.theme import fixed, number, repeated

# What a value is held against: a formula, a published value, another code or another theory of
# this project, or its own earlier value.
Kind = Literal["analytic", "external", "other code", "non-regression"]
Cell = str | float | list[float] | None


@dataclass(frozen=True, slots=True)
class Proof:
    """A value beside its reference.

    Args:
        what: is measured, and on what.
        value: measured.
        reference: what it should be, in the same unit.
        unit: of both; empty for a pure number.
        kind: of the reference.
        source: formula, author and year, or the other model.
        allowed: the largest relative error with which it counts as proven.
        order: observed order of convergence, where something was refined.
    """

    what: str
    value: float
    reference: float
    unit: str
    kind: Kind
    source: str
    allowed: float
    order: float | None = None

    @property
    def error(self) -> float:
        """Relative to the reference; the value itself where the reference is zero."""
        return abs(self.value - self.reference) / (abs(self.reference) or 1.0)

    @property
    def holds(self) -> bool:
        """Whether the error is one that is allowed."""
        return self.error <= self.allowed


@dataclass(frozen=True, slots=True)
class Table:
    """Numbers under headings, for people and for programs.

    Args:
        name: of its place in the report and in the JSON file.
        title: above it.
        columns: heading → how its numbers are shown: ".2f" with two decimals, ".3g" with three
            significant digits, "~" repetitions with the digits that they have in common, "" where
            there is text alone.
        rows: a cell for each heading, numbers in the heading's unit; None for none.
        notes: sentences below it.
    """

    name: str
    title: str
    columns: Mapping[str, str]
    rows: Sequence[Sequence[Cell]]
    notes: Sequence[str] = ()

    @property
    def text(self) -> TextTable:
        """For people."""
        forms = list(self.columns.values())
        rows = [tuple(map(_shown, row, forms)) for row in self.rows]
        return TextTable(self.title, list(self.columns), rows, self.notes, name=self.name)

    @property
    def data(self) -> list[dict[str, Any]]:
        """For programs: each row by its headings, as JSON can say it."""
        return [dict(zip(self.columns, map(_plain, row), strict=True)) for row in self.rows]


@dataclass(frozen=True, slots=True)
class Plot:
    """Curves of one figure.

    Args:
        name: of its file.
        title: a line that says what is to be seen.
        x, y: labels with units.
        curves: label → abscissas and ordinates.
        caption: sentences.
        logarithmic: whether both axes are.
    """

    name: str
    title: str
    x: str
    y: str
    curves: Mapping[str, tuple[Sequence[float], Sequence[float]]]
    caption: str
    logarithmic: bool = True


@dataclass(frozen=True, slots=True)
class Study:
    """Everything that one study leaves.

    Args:
        name: of its part of the files.
        title: heading.
        tables: of what was measured.
        proofs: rows of docs/verification.md.
        plots: figures.
    """

    name: str
    title: str
    tables: Sequence[Table] = ()
    proofs: Sequence[Proof] = ()
    plots: Sequence[Plot] = ()

    @property
    def data(self) -> dict[str, list[dict[str, Any]]]:
        """The numbers of each table by its name, as JSON."""
        return {table.name: table.data for table in self.tables}


def _shown(cell: Cell, form: str) -> str:
    if isinstance(cell, str):
        return cell
    if isinstance(cell, list):
        return repeated(cell)
    digits = int(form[1:-1])
    return fixed(cell, digits) if form.endswith("f") else number(cell, digits)


def _plain(cell: Cell) -> Cell:
    if isinstance(cell, str | list) or cell is None:
        return cell
    return float(cell) if math.isfinite(cell) else None
