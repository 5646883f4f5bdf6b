# SPDX-License-Identifier: LGPL-3.0-or-later
"""Histories of loads and accelerations in a case file."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from dynamics.excitation import History, PiecewiseLinear, Ramp, Sine, Step
from geometry.boom_error import BoomError
from geometry.fields import In, Number, Positive
from runs.case.limits import MOST_TIMES, CaseTable, Text, error_at

Times = Annotated[tuple[tuple[Number, Number], ...], In("s", "1")]


class HistoryTable(CaseTable):
    """History over time; constant from t = 0 on unless a key is given."""

    ramp: Annotated[Positive, In("s")] | None = None
    """the time in s of the rise to the full value"""
    frequency: Annotated[Positive, In("Hz")] | None = None
    """the frequency of a sine in Hz"""
    half_sine: Annotated[Positive, In("s")] | None = None
    """the duration in s of a pulse of half a sine from t = 0 on; 0 afterwards"""
    table: Annotated[Times, Field(min_length=2, max_length=MOST_TIMES)] | None = None
    """pairs of a time in s and a factor, linear between them and constant beyond"""
    file: Text | None = None
    """a CSV file of such pairs; its path is relative to the case file"""
    columns: tuple[Text, Text] | None = None
    """the names of the columns of times and factors in the heading of the file; not needed if the
    file has only two columns"""

    # Key of the quantity that the history multiplies.
    amount: ClassVar[str]

    @model_validator(mode="after")
    def _has_an_amount(self) -> Self:
        # A file with the unit of the quantity makes this key superfluous.
        if self.file is None and self.amount not in self.model_fields_set:
            raise error_at(self, "missing", self.amount)
        return self


def build_history(where: str, table: HistoryTable) -> History:
    """Return the history of a load or of an acceleration.

    Raises:
        BoomError: keys contradict one another, or the table is invalid.
    """
    keys = ("ramp", "frequency", "half_sine", "table")
    present_keys = [key for key in keys if getattr(table, key) is not None]
    if len(present_keys) > 1:
        raise BoomError(
            f"{where}.{present_keys[1]}", f"{present_keys[0]} is given; leave one of them out"
        )
    if table.ramp is not None:
        return Ramp(table.ramp)
    if table.frequency is not None:
        return Sine(table.frequency)
    if table.half_sine is not None:
        return Sine(0.5 / table.half_sine, end=table.half_sine)
    if table.table is not None:
        times, factors = zip(*table.table, strict=True)
        try:
            return PiecewiseLinear(times, factors)
        except ValueError as error:
            raise BoomError(f"{where}.table", str(error)) from None
    return Step()
