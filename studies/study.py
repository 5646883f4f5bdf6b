# SPDX-License-Identifier: LGPL-3.0-or-later
"""Common form of a study: values beside their references, tables of numbers, curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Literal, ParamSpec

from runs.report.tables import Plain, Table

# Callback with the next step of a study.
Progress = Callable[[str], None]

# Kind of reference: a measurement, a formula, a published value, another code, another theory of
# this project, or an earlier value.
Kind = Literal["measured", "analytic", "external", "other code", "non-regression"]
# Last fields of a verification, which several may share: kind, source, and permitted error.
Criterion = tuple[Kind, str, float]


@dataclass(frozen=True, slots=True)
class Verification:
    """Value beside its reference."""

    what: str  #: measured quantity, and the model
    value: float  #: measured
    reference: float  #: exact or expected value, in the same unit
    unit: str  #: unit of both; empty for a pure number
    kind: Kind  #: kind of the reference
    source: str  #: formula, author and year, or the other model
    allowed: float  #: largest permitted relative error
    order: float | None = None  #: observed order of convergence, if there was a refinement

    @property
    def error(self) -> float:
        """Error relative to the reference; the value itself if the reference is zero."""
        return abs(self.value - self.reference) / (abs(self.reference) or 1.0)

    @property
    def holds(self) -> bool:
        """Whether the error is within the permitted one."""
        return self.error <= self.allowed


@dataclass(frozen=True, slots=True)
class Plot:
    """Curves of one figure."""

    name: str  #: of its file
    title: str  #: line above the figure
    #: Labels with units.
    x: str
    y: str
    #: Label → abscissas and ordinates.
    curves: Mapping[str, tuple[Sequence[float], Sequence[float]]]
    caption: str  #: sentences
    logarithmic: bool = True  #: whether both axes are


@dataclass(frozen=True, slots=True)
class Study:
    """Results of one study."""

    name: str  #: of its part of the files
    title: str  #: heading
    tables: Sequence[Table] = ()  #: measured values
    verifications: Sequence[Verification] = ()  #: rows of docs/verification.md
    plots: Sequence[Plot] = ()  #: figures

    @property
    def data(self) -> dict[str, list[dict[str, Plain]]]:
        """Numbers of each table by its name, as JSON."""
        return {table.name: table.data for table in self.tables}


Piece = Table | Verification | Plot
_Given = ParamSpec("_Given")


def define_study(
    name: str, title: str
) -> Callable[[Callable[_Given, Iterable[Piece]]], Callable[_Given, Study]]:
    """Make a study from a generator of tables, verifications and plots."""

    def define(parts: Callable[_Given, Iterable[Piece]]) -> Callable[_Given, Study]:
        @wraps(parts)
        def study(*args: _Given.args, **kwargs: _Given.kwargs) -> Study:
            found = list(parts(*args, **kwargs))
            tables = [part for part in found if isinstance(part, Table)]
            verifications = [part for part in found if isinstance(part, Verification)]
            return Study(
                name, title, tables, verifications, [p for p in found if isinstance(p, Plot)]
            )

        return study

    return define
