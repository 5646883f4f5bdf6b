# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows: the extreme of a quantity at a place of a model, in one tidy table.

Static results, peaks, the effect of play, pads, utilisations, life and proofs are selections of it.
"""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from protractile.analysis.labelled import Labelled
from protractile.analysis.measure import Measured, measure
from protractile.analysis.quantities import MEASURED, PROVED, Quantity
from protractile.analysis.states import States

if TYPE_CHECKING:
    import pandas as pd

# Values that differ by less than this fraction of the largest one count as equal.
_ROUND_OFF = 1.0e-9
# Smallest static value for which a dynamic factor is given, as a fraction of the maximum in motion.
LEAST_STATIC = 1.0e-3

#: Labels of static states: under the loads at t = 0, under all extremes of the loads, at the
#: largest and smallest extension, and the one of them with the largest tip deflection.
INITIAL, REST, EXTENDED, FARTHEST = "initial", "rest", "extended", "farthest"
#: Label of a motion.
MOTION = "motion"
#: Name of beam elements in the contacts of the first model with play, beside the models of a case.
BEAM = "beam estimate"
#: Start of the labels of combinations and of spectra, before their names.
COMBINATION, SPECTRUM = "combination ", "spectrum "


class Row(NamedTuple):
    """Extreme of a quantity at a place, over the states of a model."""

    model: str  #: name of the model
    state: str  #: label of the states; of a proof that of the governing combination or spectrum
    play: bool  #: False for the boom without play
    #: name of the quantity, a key of :data:`.analysis.quantities.MEASURED` or ``PROVED``
    quantity: str
    part: str  #: part of the boom
    place: str  #: place within the part, for example a station, the side of a pad, or a mode
    value: float  #: value with the largest magnitude in SI units, with its sign
    x: float | None = None  #: position of the value in m, None for a whole part
    y: float | None = None  #: lateral position of an outer fibre in m
    z: float | None = None  #: vertical position of an outer fibre in m
    time: float | None = None  #: time of the value in s
    limit: float | None = None  #: permitted value in SI units

    @property
    def utilisation(self) -> float | None:
        """The magnitude over the permitted value; None without one."""
        return None if self.limit is None else abs(self.value) / self.limit

    @property
    def of(self) -> Quantity:
        """The quantity with its unit and titles."""
        return MEASURED.get(self.quantity) or PROVED[self.quantity]

    @property
    def key(self) -> tuple[str, str, str]:
        """What the row measures: quantity, part and place."""
        return self.quantity, self.part, self.place


# Columns of files.
_COLUMNS = [*Row._fields, "unit", "utilisation"]


class Rows(Labelled[Row]):
    """Rows of a run, of a check or of proofs.

    >>> rows = pt.statics(boom).rows
    >>> reaction = rows.where(quantity="reaction", state="rest").largest
    >>> reaction.part, reaction.place, reaction.of.title
    ('arm', 'at 0 m', 'transverse reaction')
    """

    __slots__ = ()

    @property
    def largest(self) -> Row | None:
        """The row with the largest magnitude; None without rows."""
        return max(self, key=lambda row: abs(row.value), default=None)

    @property
    def governing(self) -> Row | None:
        """The row with the largest utilisation, then magnitude; None without rows."""
        return max(self, key=lambda row: (row.utilisation or 0.0, abs(row.value)), default=None)

    def at_rest(self, moved: Row) -> float | None:
        """Return the magnitude of the largest static value of a row in motion; None without one."""
        static = (
            abs(row.value)
            for row in self
            if row.key == moved.key
            and (row.model, row.play) == (moved.model, moved.play)
            and row.state in (REST, EXTENDED)
        )
        return max(static, default=None)

    def dynamic_factor(self, moved: Row) -> float | None:
        """Return the magnitude in motion over the static one; None if that is close to zero."""
        rest = self.at_rest(moved) or 0.0
        return abs(moved.value) / rest if rest > LEAST_STATIC * abs(moved.value) else None

    @property
    def frame(self) -> pd.DataFrame:
        """The rows as a table, with units and utilisations."""
        import pandas as pd

        frame = pd.DataFrame(self, columns=Row._fields)
        frame.insert(7, "unit", [row.of.unit for row in self])
        return frame.assign(utilisation=[row.utilisation for row in self])

    def save(self, path: Path) -> None:
        """Write a table of comma-separated values, with units and utilisations."""
        with path.open("w", encoding="utf-8", newline="") as file:
            table = csv.writer(file, lineterminator="\n")
            table.writerow(_COLUMNS)
            table.writerows([*row, row.of.unit, row.utilisation] for row in self)

    @classmethod
    def load(cls, path: Path) -> Self:
        """Read a table of :meth:`save`.

        Raises:
            OSError, ValueError, KeyError: the file cannot be read, or is damaged.
        """
        with path.open(encoding="utf-8", newline="") as file:
            try:
                lines = [*csv.reader(file)]
            except csv.Error as error:
                raise ValueError(error) from None
        if lines[:1] != [_COLUMNS] or any(len(line) != len(_COLUMNS) for line in lines):
            raise ValueError(f"a line has other columns than {', '.join(_COLUMNS)}")
        return cls(map(_row, lines[1:]))


def _row(line: list[str]) -> Row:
    model, state, play, quantity, part, place, value, *others = line[: len(Row._fields)]
    numbers = (float(other) if other else None for other in others)
    played = {"True": True, "False": False}[play]
    if quantity not in MEASURED and quantity not in PROVED:
        raise KeyError(quantity)
    return Row(model, state, played, quantity, part, place, float(value), *numbers)


def extremes(
    measured: Iterable[Measured], model: str, state: str, play: bool = True
) -> Iterator[Row]:
    """Yield the row with the extreme of each measured quantity; none without values.

    Of equal extremes the first one counts, of different limits that with the largest utilisation;
    one without a limit counts only if those with a limit are 0.
    """
    rows: dict[tuple[str, str, str], Row] = {}
    for measurement in measured:
        if measurement.values.size == 0:
            continue
        sign = -1.0 if MEASURED[measurement.quantity].lowest else 1.0
        sizes = sign * np.abs(measurement.values)
        at_least = sizes.max() - _ROUND_OFF * abs(sizes.max())
        step, column = np.unravel_index(int((sizes >= at_least).argmax()), sizes.shape)
        x, y, z = (None if at is None else float(at[column]) for at in measurement.places)
        row = Row(
            model, state, play, measurement.quantity, measurement.part, measurement.place,
            float(measurement.values[step, column]), x, y, z,
            None if measurement.time is None else float(measurement.time[step]), measurement.limit,
        )  # fmt: skip
        other = rows.setdefault(row.key, row)
        limited, first = (bool(each.limit and each.value) for each in (row, other))
        size, largest = (abs(each.value) / (each.limit or 1.0) for each in (row, other))
        larger = sign * (size - largest) > _ROUND_OFF * largest
        if larger if limited == first else limited:
            rows[row.key] = row
    yield from rows.values()


def static_rows(states: States, model: str, state: str = REST, play: bool = True) -> Iterator[Row]:
    """Yield the extremes of static states, and those of the first one at t = 0."""
    if state == REST:
        yield from extremes(measure(states.at([0])), model, INITIAL, play)
    yield from extremes(measure(states), model, state, play)
