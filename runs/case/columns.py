# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two columns of a CSV file, as instruments, programs and spreadsheets write them.

Cells are parted by commas, semicolons or tabs, a number's comma is a decimal one, and what follows
a # is a comment. A heading names the columns, each with its unit behind the name, in brackets,
behind a stroke or ``in``, or in a line of units below.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from runs.case.limits import MOST_TIMES
from runs.case.messages import BadInput, choices
from runs.case.units import Unit
from runs.case.user_files import read_any_text
from runs.process.shown import shown

_SEPARATOR = re.compile(r"sep=(.)", re.IGNORECASE)
_HEADED = re.compile(r"(.*?)\s*(?:\[(.+)\]|\((.+)\)|/(.+)|\bin (.+))")


@dataclass(frozen=True, slots=True)
class Column:
    """What one of the two columns is to hold."""

    name: str  #: in messages
    unit: str  #: of its numbers unless the heading says another of the same dimension
    factor: bool = False  #: whether its numbers are factors unless the heading says such a unit

    def __str__(self) -> str:
        return self.name if self.factor else f"{self.name} in {self.unit}"

    def scale(self, unit: str) -> float:
        """How much of its own unit one of a file's unit is.

        Raises:
            ValueError: it is another dimension, or no unit that is known.
        """
        own, given = Unit.of(self.unit), Unit.of(unit)
        if self.factor and not any(given.dimension):
            return given.factor
        if given.dimension != own.dimension:
            raise ValueError("another quantity")
        return given.factor / own.factor


@dataclass(frozen=True, slots=True)
class Pairs:
    """The numbers of two columns, in their units."""

    values: tuple[tuple[float, float], ...]  #: the first number of each rises
    measured: bool  #: whether the second one is no factor, since its heading says a unit


def read_pairs(
    path: str, key: str, file: str, names: Sequence[str] | None, columns: tuple[Column, Column]
) -> Pairs:
    """Read two columns of a CSV file.

    Args:
        path: of the case file, from which the file's is seen, for messages.
        key: that names the file, for messages.
        file: its path.
        names: of the two columns in its heading; its only two unless given.
        columns: what they are to hold.

    Raises:
        BadInput: the file cannot be read, or holds something else.
    """
    remedy = (
        f"give a CSV file of two columns, {columns[0]} and {columns[1]}; a heading may say other "
        "units"
    )
    place, name = Path(path).parent / file, f"'{shown(file)}'"
    try:
        rows = _rows(read_any_text(place))
        if len(rows) > MOST_TIMES:
            raise _Unfit(f"has {len(rows)} lines; give {MOST_TIMES} at most")
        headings = [rows.pop(0) for _ in range(2) if rows and not any(map(_is_number, rows[0]))]
        chosen, scales, measured = _chosen(headings, names, columns)
        pairs = np.array([[_number(row[i]) for i in chosen] for row in rows])
    except OSError as error:
        what = f"'{shown(str(place))}' cannot be read ({error.strerror}); {remedy}"
        raise BadInput(path, key, what) from None
    except _Unfit as reason:
        raise BadInput(path, key, f"{name} {reason}") from None
    except (ValueError, csv.Error):
        raise BadInput(path, key, f"{name} holds other than numbers; {remedy}") from None
    except IndexError:
        pairs = np.empty((0, 2))
    of_two = names is not None or all(len(row) == 2 for row in (*headings, *rows))
    if len(pairs) < 2 or not of_two or not np.isfinite(pairs).all():
        raise BadInput(path, key, f"{name} has other columns, or one line alone; {remedy}")
    if (np.diff(pairs[:, 0]) <= 0.0).any():
        raise BadInput(path, key, f"the {columns[0].name}s in {name} must rise")
    return Pairs(tuple((float(x), float(y)) for x, y in pairs * scales), measured)


class _Unfit(Exception):
    """What is wrong with a file, behind its name."""


def _rows(text: str) -> list[list[str]]:
    """The cells of all lines but empty ones and comments."""
    lines = [line.partition("#")[0].strip() for line in text.splitlines()]
    lines = [line for line in lines if line]
    if lines and (said := _SEPARATOR.fullmatch(lines[0])):
        separator = said[1]
        del lines[0]
    else:
        separator = next((mark for mark in ";\t" if lines and mark in lines[0]), ",")
    whole = (line.rstrip(separator) for line in lines)
    return [[cell.strip() for cell in row] for row in csv.reader(whole, delimiter=separator)]


def _number(cell: str) -> float:
    return float(cell.replace(",", "."))


def _is_number(cell: str) -> bool:
    with suppress(ValueError):
        _number(cell)
        return True
    return False


def _chosen(
    headings: Sequence[Sequence[str]], names: Sequence[str] | None, columns: Sequence[Column]
) -> tuple[list[int], list[float], bool]:
    """The positions of the two columns, what makes their own units of them, as of :class:`Pairs`.

    Raises:
        _Unfit: a name that is not there, too many columns, a unit that does not fit.
        IndexError: fewer columns than names.
    """
    if not headings:
        if names is not None:
            raise _Unfit("has no heading; leave the names of columns out")
        return [0, 1], [1.0, 1.0], False
    cells = [_split(cell) for cell in headings[0]]
    known = [name for name, _ in cells]
    if names is None and len(known) > 2:
        raise _Unfit(f"has {len(known)} columns; name two of them, of {choices(known)}")
    wanted = known[:2] if names is None else [_split(name)[0] for name in names]
    for name in wanted:
        if known.count(name) != 1:
            raise _Unfit(f"has not one column {name!r}; give {choices(known)}")
    chosen = [known.index(name) for name in wanted]
    units = [headings[1][i] if len(headings) > 1 else cells[i][1] for i in chosen]
    scales = []
    for name, unit, column in zip(wanted, units, columns, strict=True):
        try:
            scales.append(1.0 if unit is None else column.scale(unit.strip("[]()")))
        except ValueError as error:
            raise _Unfit(
                f"has {name!r} in {unit}, which is {error}; give it in {column.unit} or another "
                "unit of the kind"
            ) from None
    measured = columns[1].factor and any(Unit.of(units[1] or "1").dimension)
    return chosen, scales, measured


def _split(cell: str) -> tuple[str, str | None]:
    """Name and unit of a heading."""
    found = _HEADED.fullmatch(cell)
    if found is None:
        return cell, None
    return found[1], next(unit for unit in found.groups()[1:] if unit)
