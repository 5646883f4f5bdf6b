# SPDX-License-Identifier: LGPL-3.0-or-later
"""Metrics: display formats of a model's results, annotations of the fields of records.

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
    """Display format of one number of a model, as an annotation of its field."""

    name: str  #: name in the files of sweeps, which omit the number if it is empty
    unit: str  #: SI unit in files
    title: str  #: a lower-case phrase for display
    factor: float  #: factor from the SI unit to the displayed one
    shown_unit: str  #: title in tables and charts
    logarithmic: bool = False  #: whether charts have a logarithmic scale
    charted: bool = True  #: whether the number is smooth enough for a chart
    heading: str = ""  #: heading in tables of reports, which omit the number if it is empty
    form: str = ".4g"  #: number format in tables of reports

    @property
    def unit_of_heading(self) -> str:
        """The unit below the heading; empty for dimensionless numbers."""
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
    """Return the record classes of a class's fields of type :class:`Record` or None, by name."""
    return {
        name: one
        for name, hint in get_type_hints(kind).items()
        for one in (get_args(hint) if isinstance(hint, UnionType) else ())
        if issubclass(one, Record)
    }
