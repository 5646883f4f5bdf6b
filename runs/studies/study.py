# SPDX-License-Identifier: LGPL-3.0-or-later
"""The one form of a study: values beside their references, tables of numbers, curves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from runs.report.tables import Plain, Table

# What a value is held against: a formula, a published value, another code or another theory of
# this project, or its own earlier value.
Kind = Literal["analytic", "external", "other code", "non-regression"]


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
    def data(self) -> dict[str, list[dict[str, Plain]]]:
        """The numbers of each table by its name, as JSON."""
        return {table.name: table.data for table in self.tables}
