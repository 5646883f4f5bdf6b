# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reader of two columns of a CSV file from an instrument, a program or a spreadsheet.

Commas, semicolons, tabs or spaces separate cells. A comma within a number is a decimal comma; one
that may separate thousands is an error. Text
after a # is a comment. A heading names the columns and may give their units: in brackets, after a
slash or ``in``, or in a second line.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from difflib import get_close_matches
from math import pi
from pathlib import Path

import numpy as np

from protractile.geometry.typography import choices
from protractile.geometry.units import Unit
from protractile.runs.case.limits import MOST_TIMES
from protractile.runs.case.user_files import read_any_text
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.terminal import shorten

_SEPARATOR = re.compile(r"sep=(.)", re.IGNORECASE)
# Spaces that separate two cells: not next to a comma, before a bracket or slash, or after a slash.
_SPACES = re.compile(r"(?<![\s,/])\s+(?![\s,\[(/])")
# Numbers whose commas or points may separate thousands.
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3}|\.\d{3})+")
_HEADING = re.compile(r"(.*?)\s*(?:\[(.+)\]|\((.+)\)|/(.+)|\bin (.+))")

# Units of angles in degrees, which have no dimension.
_ANGLES = {"deg": 1.0, "°": 1.0, "rad": 180.0 / pi}


@dataclass(frozen=True, slots=True)
class FileColumn:
    """Quantity and unit that a column must contain."""

    name: str  #: name of the column in messages
    unit: str  #: unit of the numbers, if the heading gives no other
    factor: bool = False  #: True if numbers without a unit in the heading are dimensionless
    gaps: bool = False  #: True if lines without a number in this column are left out

    def __str__(self) -> str:
        return self.name if self.factor or self.unit == "1" else f"{self.name} in {self.unit}"

    def scale(self, unit: str) -> float:
        """Return the conversion factor from a unit in the file to the unit of the column.

        Raises:
            ValueError: the unit is unknown, or of another dimension.
        """
        if self.unit in _ANGLES and unit in _ANGLES:
            return _ANGLES[unit] / _ANGLES[self.unit]
        expected, actual = Unit.of(self.unit), Unit.of(unit)
        if self.unit in _ANGLES:
            raise ValueError("no unit of an angle")
        if self.factor and not any(actual.dimension):
            return actual.factor
        if actual.dimension != expected.dimension:
            raise ValueError("another quantity")
        return actual.factor / expected.factor


@dataclass(frozen=True, slots=True)
class Pairs:
    """Pairs of numbers from two columns, in the columns' units."""

    values: tuple[tuple[float, float], ...]  #: the first numbers of the pairs increase
    has_unit: bool  #: True if the second column has a unit, so that its numbers are no factors


def read_pairs(
    path: str,
    key: str,
    file: str,
    names: Sequence[str] | None,
    columns: tuple[FileColumn, FileColumn],
) -> Pairs:
    """Read two columns of a CSV file.

    Args:
        path: path of the case file; the path of the CSV file is relative to it.
        key: key of the CSV file, for messages.
        file: path of the CSV file.
        names: names of the two columns in the heading; not needed if the file has only two.
        columns: expected content of the two columns.

    Raises:
        BadInput: the file cannot be read, or its content is invalid.
    """
    remedy = (
        f"give a CSV file of two columns, {columns[0]} and {columns[1]}; a heading may say other "
        "units"
    )
    place, name = Path(path).parent / file, f"'{shorten(file)}'"
    try:
        rows = _rows(read_any_text(place))
        if len(rows) > MOST_TIMES:
            raise _FileError(f"has {len(rows)} lines", f"give {MOST_TIMES} at most")
        headings = [rows.pop(0) for _ in range(2) if rows and not rows[0].has_number]
        indices, scales, has_unit = _choose_columns(headings, names, columns)
        if columns[1].gaps:
            rows = [row for row in rows if not row.is_empty(indices[1])]
        for row in rows:
            row.check_columns(indices, headings[0] if names and headings else None)
        _check_thousands(rows, indices)
        pairs = np.array([[row.number(i) for i in indices] for row in rows])
        if len(rows) < 2:
            raise _FileError("has fewer than two lines of numbers")
        falls = np.flatnonzero(np.diff(pairs[:, 0]) <= 0.0)
        if falls.size:
            line = rows[falls[0] + 1].line
            what = f"has a {columns[0].name} in line {line} that "
            if pairs[falls[0] + 1, 0] == pairs[falls[0], 0]:
                raise _FileError(f"{what}repeats the one before", "give each once")
            raise _FileError(f"{what}does not rise", "sort them")
    except OSError as error:
        what = f"'{shorten(str(place))}' cannot be read ({error.strerror}); {remedy}"
        raise BadInput(path, key, what) from None
    except _FileError as content_error:
        what = f"{name} {content_error.what}; {content_error.remedy or remedy}"
        raise BadInput(path, key, what) from None
    except (ValueError, csv.Error):
        raise BadInput(path, key, f"{name} is no text; {remedy}") from None
    return Pairs(tuple((float(x), float(y)) for x, y in pairs * scales), has_unit)


class _FileError(Exception):
    """Error in the content of a file. The default remedy is a file with the right columns.

    The message does not quote the content: a wrong path may name a private file.
    """

    def __init__(self, what: str, remedy: str = "") -> None:
        super().__init__(what)
        self.what, self.remedy = what, remedy


@dataclass(frozen=True, slots=True)
class _FileLine:
    """Cells of a line of the file that is neither empty nor a comment."""

    line: int  #: line number, from 1
    cells: list[str]  #: cells without empty ones at the end
    width: int  #: number of cells with these

    @property
    def has_number(self) -> bool:
        return any(map(_is_number, self.cells))

    def is_empty(self, column: int) -> bool:
        """Return True if a cell is empty or NaN."""
        return column >= len(self.cells) or self.cells[column].lower() in ("", "nan")

    def check_columns(self, indices: Sequence[int], heading: _FileLine | None) -> None:
        """Check that the line has the columns of a heading; without one, only the chosen ones."""
        count, given = len(self.cells), self.width
        columns = "1 column" if count == 1 else f"{count} columns"
        if heading is None and count != len(indices):
            raise _FileError(f"has {columns} in line {self.line}")
        if heading is not None and not {count, given} & {len(heading.cells), heading.width}:
            what = f"has {columns} in line {self.line} and {len(heading.cells)} in the heading"
            raise _FileError(what, "give each line all columns, numbers without further commas")
        if count <= max(indices):
            raise _FileError(f"has {columns} in line {self.line}")

    def number(self, column: int) -> float:
        """Return the number in a cell; raise :class:`_FileError` if there is none."""
        with suppress(ValueError):
            number = _number(self.cells[column])
            if np.isfinite(number):
                return number
        raise _FileError(f"has no finite number in line {self.line}, column {column + 1}")


def _rows(text: str) -> list[_FileLine]:
    """Return the cells of all lines except empty lines and comments."""
    numbered = enumerate(text.splitlines(), start=1)
    lines = [(number, line.partition("#")[0].strip()) for number, line in numbered]
    lines = [(number, line) for number, line in lines if line]
    if lines and (declaration := _SEPARATOR.fullmatch(lines[0][1])):
        separator = declaration[1]
        del lines[0]
    else:
        separator = next((mark for mark in ";\t" if lines and mark in lines[0][1]), ",")
        # The last line decides, since a heading may have spaces between words.
        last = _SPACES.split(lines[-1][1]) if lines else []
        if separator == "," and len(last) > 1 and all(map(_is_number, last)):
            rows = [(number, _SPACES.split(line)) for number, line in lines]
            return [_FileLine(number, cells, len(cells)) for number, cells in rows]
    return [
        _FileLine(
            number,
            [cell.strip() for cell in next(csv.reader([cut], delimiter=separator))],
            len(next(csv.reader([line], delimiter=separator))),
        )
        for number, line in lines
        if (cut := line.rstrip(separator))
    ]


def _check_thousands(rows: Sequence[_FileLine], indices: Sequence[int]) -> None:
    """Check that no number has separators of thousands.

    A comma in ``-1,500`` is a decimal comma if another number of the file has one; a point in
    ``1.500`` is a decimal point if no number has a decimal comma.

    Raises:
        _FileError: a comma or a point may separate thousands.
    """
    cells = [(row.line, i, row.cells[i]) for row in rows for i in indices]
    with_comma = [cell for cell in cells if "," in cell[2]]
    doubtful = [cell for cell in cells if with_comma and _THOUSANDS.fullmatch(cell[2])]
    if len([cell for cell in doubtful if "," in cell[2]]) < len(with_comma):
        doubtful = [cell for cell in doubtful if "." in cell[2]]
    if doubtful:
        line, i, cell = doubtful[0]
        mark = "comma" if "," in cell else "point"
        raise _FileError(
            f"has a {mark} in line {line}, column {i + 1} that may separate thousands",
            "write numbers with a decimal mark only, such as 1500 or 1.5",
        )


def _number(cell: str) -> float:
    return float(cell.replace(",", "."))


def _is_number(cell: str) -> bool:
    with suppress(ValueError):
        _number(cell)
        return True
    return False


def _choose_columns(
    headings: Sequence[_FileLine], names: Sequence[str] | None, columns: Sequence[FileColumn]
) -> tuple[list[int], list[float], bool]:
    """Return indices, unit factors and ``has_unit`` (see :class:`Pairs`) of the two columns.

    Raises:
        _FileError: a name is missing, a unit does not fit, or there are too many columns.
    """
    if not headings:
        if names is not None:
            raise _FileError("has no heading", "leave the names of columns out")
        return [0, 1], [1.0, 1.0], False
    heading = headings[0]
    cells = [_split_heading(cell) for cell in heading.cells]
    column_names = [name for name, _ in cells]
    if names is None:
        if len(column_names) > 2:
            what = f"has {len(column_names)} columns in line {heading.line}"
            raise _FileError(what, "name two of them")
        indices = [0, 1]
    else:
        indices = []
        for name, _ in map(_split_heading, names):
            if name not in column_names:
                near = get_close_matches(name, column_names) or column_names
                what = f"has no column {shorten(name)!r} in line {heading.line}"
                raise _FileError(what, f"give {choices(near)}")
            if (count := column_names.count(name)) > 1:
                what = f"has {count} columns {shorten(name)!r} in line {heading.line}"
                raise _FileError(what, "name columns that it has once")
            indices.append(column_names.index(name))
    for row in headings:
        row.check_columns(indices, heading if names is not None else None)
    of_units = headings[-1]
    units = [cells[i][1] if of_units is heading else of_units.cells[i] for i in indices]
    scales = []
    for i, unit, column in zip(indices, units, columns, strict=True):
        try:
            scales.append(1.0 if unit is None else column.scale(unit.strip("[]()")))
        except ValueError as error:
            raise _FileError(
                f"has a unit in line {of_units.line}, column {i + 1} that is {error}",
                f"give {column.unit} or another unit of the kind",
            ) from None
    has_unit = columns[1].factor and any(Unit.of(units[1] or "1").dimension)
    return indices, scales, has_unit


def _split_heading(cell: str) -> tuple[str, str | None]:
    match = _HEADING.fullmatch(cell)
    if match is None:
        return cell, None
    return match[1], next(unit for unit in match.groups()[1:] if unit)
