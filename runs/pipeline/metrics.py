# SPDX-License-Identifier: LGPL-3.0-or-later
"""Display formats of a model's numbers, declared beside the fields of their records.

>>> from runs.pipeline.residual_vibration import ResidualVibration
>>> metrics(ResidualVibration)["tip"].title
'residual vibration'
"""

from __future__ import annotations

from dataclasses import dataclass
from types import UnionType
from typing import ClassVar, get_args, get_type_hints


@dataclass(frozen=True, slots=True)
class Metric:
    """A number of a model in sweeps and tables; an annotation of the field that holds it."""

    name: str  #: in files of sweeps, which omit the number where this is empty
    unit: str  #: in files, SI
    title: str  #: a lower-case phrase for display
    factor: float  #: from the SI unit to the displayed one
    shown_unit: str  #: of tables and charts
    logarithmic: bool = False  #: whether it spans decades
    charted: bool = True  #: whether it is smooth enough for a chart
    heading: str = ""  #: of its column in tables of reports, which omit it without
    form: str = ".4g"  #: format of the numbers there

    @property
    def unit_of_heading(self) -> str:
        """Unit below the heading; empty for dimensionless numbers."""
        return "" if self.unit == "1" else self.shown_unit


class Record:
    """Numbers of one model that reports show as a table, with a row for each model."""

    __slots__ = ()
    title: ClassVar[str]
    notes: ClassVar[tuple[str, ...]]


def metrics(kind: type) -> dict[str, Metric]:
    """Return the metrics of a record by the names of their fields."""
    hints = get_type_hints(kind, include_extras=True)
    return {
        name: metric
        for name, hint in hints.items()
        for metric in getattr(hint, "__metadata__", ())
        if isinstance(metric, Metric)
    }


def records(kind: type) -> dict[str, type[Record]]:
    """Return the kinds of the fields of a class that are a :class:`Record` or None, by name."""
    return {
        name: one
        for name, hint in get_type_hints(kind).items()
        for one in (get_args(hint) if isinstance(hint, UnionType) else ())
        if issubclass(one, Record)
    }
