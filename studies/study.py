# SPDX-License-Identifier: LGPL-3.0-or-later
"""Common form of a study: values with references, tables and curves."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from typing import Literal, NamedTuple, ParamSpec

from rich.console import Console

from protractile.runs.report.tables import WIDE, Plain, Table

# Callback with the next step of a study.
Progress = Callable[[str], None]

# Kind of reference: a measurement, a formula, a published value, another code, another theory of
# this project, or an earlier value.
Kind = Literal["measured", "analytic", "external", "other code", "non-regression"]
# Last fields of a verification, which several may share: kind, source, and permitted error.
Criterion = tuple[Kind, str, float]


class Verification(NamedTuple):
    """Comparison of a computed value with a reference value."""

    what: str  #: quantity, and the model
    value: float  #: computed value
    reference: float  #: exact or expected value, in the same unit
    unit: str  #: unit of both; empty for a pure number
    kind: Kind  #: kind of the reference
    source: str  #: formula, author and year, or the other model
    allowed: float  #: largest permitted relative error
    order: float | None = None  #: observed order of convergence, if there was a refinement

    @property
    def error(self) -> float:
        """Relative error; the absolute value if the reference is zero."""
        return abs(self.value - self.reference) / (abs(self.reference) or 1.0)

    @property
    def holds(self) -> bool:
        """Whether the error is at most the permitted error."""
        return self.error <= self.allowed


class Plot(NamedTuple):
    """Curves of one figure."""

    name: str  #: name of the file
    title: str  #: line above the figure
    #: Labels with units.
    x: str
    y: str
    #: Label → abscissas and ordinates.
    curves: Mapping[str, tuple[Sequence[float], Sequence[float]]]
    caption: str  #: caption in sentences
    logarithmic: bool = True  #: whether both axes are logarithmic


class Study(NamedTuple):
    """Results of one study."""

    name: str  #: name in the output files
    title: str  #: heading
    tables: Sequence[Table] = ()  #: tables of values
    verifications: Sequence[Verification] = ()  #: rows of docs/verification.md
    plots: Sequence[Plot] = ()  #: figures

    @property
    def data(self) -> dict[str, list[dict[str, Plain]]]:
        """Numbers of each table by its name, as JSON."""
        return {table.name: table.data for table in self.tables}


def wide_console() -> Console:
    """Return the console for tables, which is wide enough for them without a terminal."""
    console = Console()
    return console if console.is_terminal else Console(width=WIDE)


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
