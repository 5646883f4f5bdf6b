# SPDX-License-Identifier: LGPL-3.0-or-later
"""Names, units and display formats of the results of a model, as annotations of record fields.

>>> from protractile.runs.pipeline.residual_vibration import ResidualVibration
>>> metrics(ResidualVibration)["tip"].title
'residual vibration'
"""

from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from types import UnionType
from typing import ClassVar, get_args, get_type_hints

from protractile.geometry.units import Unit


@dataclass(frozen=True, slots=True)
class Metric:
    """Name, unit and display format of a result, as an annotation of its field."""

    name: str  #: name in files of sweeps; "." for the name of the field; empty to omit the result
    unit: str  #: SI unit in files
    title: str  #: a lower-case phrase for display
    _: KW_ONLY
    shown: str = ""  #: displayed unit; the SI unit unless given
    heading: str = ""  #: heading in tables of reports; empty to omit the result there
    form: str = ".4g"  #: number format in tables of reports
    charted: bool = True  #: True if the result is smooth enough for a chart
    logarithmic: bool = False  #: True for a logarithmic scale in charts

    @property
    def factor(self) -> float:
        """The conversion factor from the SI unit to the displayed unit."""
        return Unit.conversion(self.shown_unit)

    @property
    def shown_unit(self) -> str:
        """The displayed unit, which is "–" for dimensionless numbers."""
        return self.shown or ("–" if self.unit == "1" else self.unit)

    @property
    def unit_of_heading(self) -> str:
        """The displayed unit as part of the heading; empty for dimensionless numbers."""
        return "" if self.unit == "1" else self.shown_unit


class Record:
    """Results of one model, which are one row of a table in reports."""

    __slots__ = ()
    title: ClassVar[str]
    notes: ClassVar[tuple[str, ...]]


def metrics(kind: type) -> dict[str, Metric]:
    """Return the metrics of a record by the names of their fields."""
    hints = get_type_hints(kind, include_extras=True)
    return {
        name: replace(metric, name=name) if metric.name == "." else metric
        for name, hint in hints.items()
        for metric in getattr(hint, "__metadata__", ())
        if isinstance(metric, Metric)
    }


def records(kind: type) -> dict[str, type[Record]]:
    """Return, by field name, the :class:`Record` class of each field that may hold a record."""
    return {
        name: one
        for name, hint in get_type_hints(kind).items()
        for one in (get_args(hint) if isinstance(hint, UnionType) else ())
        if issubclass(one, Record)
    }
