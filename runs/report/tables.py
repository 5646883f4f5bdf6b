# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of text, for the terminal, for the report and as Markdown."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table as Grid
from rich.text import Text

from runs.folder.files import write_whole
from runs.report.numerals import NONE, count, fixed, number, repeated

# Letters that fit in a line of the report with its usual font, on a telephone, and in a file.
ROOMY, NARROW = 115, 40
WIDE = 180


def wide_console() -> Console:
    """Where to print tables: as wide as they are where nobody watches."""
    console = Console()
    return console if console.is_terminal else Console(width=WIDE)


@dataclass(frozen=True, slots=True)
class TextTable:
    """A table whose cells are text already.

    Args:
        title: above it.
        headings: of the columns; the first column is flush left, the others are right.
        rows: as long as the headings each; a cell may have several lines.
        notes: sentences below it.
        name: of its place in the report.
        strong: texts of cells that stand out.
    """

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    notes: Sequence[str] = ()
    name: str = ""
    strong: Sequence[str] = ()

    @property
    def anchor(self) -> str:
        """What a link in the report points to."""
        return f"table-{self.name}"

    @property
    def crowded(self) -> bool:
        """Whether it takes smaller letters to fit the report's page."""
        return self._letters > ROOMY

    @property
    def stacked(self) -> bool:
        """Whether a telephone shows its rows one below the other, each cell with its heading."""
        return self._letters > NARROW

    @property
    def _letters(self) -> int:
        """In a line; headings are broken between words, cells where they say so."""
        letters = [
            max(len(part) for part in ("", *heading.split(), *"\n".join(column).split("\n")))
            for heading, *column in zip(self.headings, *self.rows, strict=True)
        ]
        return sum(letters, start=2 * len(letters))

    def show(self, console: Console) -> None:
        """Print it."""
        table = Grid(title=Text(self.title), title_justify="left", box=SIMPLE_HEAD)
        for i, heading in enumerate(self.headings):
            table.add_column(heading, justify="right" if i else "left")
        for row in self.rows:
            table.add_row(*map(Text, row))
        console.print(table)
        for note in self.notes:
            console.print(Text(note))

    def markdown(self) -> str:
        """A heading, the table, the notes."""
        ruler = [":--", *["--:"] * (len(self.headings) - 1)]
        lines = [f"| {' | '.join(row)} |" for row in (self.headings, ruler, *self.rows)]
        lines = [line.replace("\n", " ") for line in lines]
        return "\n".join(
            [f"## {self.title}", "", *lines, "", *(f"{note}\n" for note in self.notes)]
        )


# Text, a number, repetitions of one, or none.
Cell = str | float | list[float] | None
# The same as JSON says it, which knows no number that is not finite.
Plain = str | float | list[float | None] | None


@dataclass(frozen=True, slots=True)
class Column:
    """Numbers under a heading.

    Args:
        heading: with the unit in its second line.
        cells: one for each row; None for none, a text for what is no number; repetitions are shown
            with the digits that they have in common, whatever the form.
        form: ".2f" with two decimals, ".3g" with three significant digits, else a count.
        factor: from the unit of the numbers to that of the heading.
    """

    heading: str
    cells: Sequence[Cell]
    form: str = ""
    factor: float = 1.0

    @property
    def text(self) -> list[str]:
        """The cells as they are shown."""
        return [self._shown(cell) for cell in self.cells]

    def _shown(self, cell: Cell) -> str:
        if isinstance(cell, str):
            return cell
        if cell is None:
            return NONE
        if isinstance(cell, list):
            return repeated([self.factor * one for one in cell])
        if not self.form:
            return count(cell)
        digits = int(self.form[1:-1])
        if self.form.endswith("f"):
            return fixed(cell, digits, self.factor)
        return number(self.factor * cell, digits)


@dataclass(frozen=True, slots=True)
class Table:
    """Numbers for people and for programs; as :class:`TextTable`, but for the columns.

    A column may end before the others: there are none of its numbers then.
    """

    title: str
    columns: Sequence[Column]
    notes: Sequence[str] = ()
    name: str = ""
    strong: Sequence[str] = ()

    @classmethod
    def of_rows(
        cls,
        name: str,
        title: str,
        columns: Mapping[str, str],
        rows: Sequence[Sequence[Cell]],
        notes: Sequence[str] = (),
    ) -> Table:
        """From rows whose numbers are in the units of the headings.

        Args:
            name, title, notes: of the table.
            columns: heading → form of its numbers.
            rows: a cell for each heading.
        """
        parts = [
            Column(heading, [row[i] for row in rows], form)
            for i, (heading, form) in enumerate(columns.items())
        ]
        return cls(title, parts, notes, name)

    @property
    def data(self) -> list[dict[str, Plain]]:
        """Each row by its headings, in their units, as JSON can say it.

        Raises:
            ValueError: a heading is that of two columns.
        """
        columns = [[_plain(cell, of.factor) for cell in of.cells] for of in self.columns]
        headings = [of.heading for of in self.columns]
        if len({*headings}) < len(headings):
            raise ValueError(f"{self.title}: two columns have the same heading, of {headings}")
        return [dict(zip(headings, row, strict=True)) for row in zip_longest(*columns)]

    @property
    def text(self) -> TextTable:
        """As it is shown."""
        rows = list(zip_longest(*(column.text for column in self.columns), fillvalue=NONE))
        headings = tuple(column.heading for column in self.columns)
        return TextTable(self.title, headings, rows, self.notes, self.name, self.strong)


def _plain(cell: Cell, factor: float) -> Plain:
    """A cell in the unit of its heading; whole numbers stay so where that is their own."""
    if isinstance(cell, str) or cell is None:
        return cell
    if isinstance(cell, list):
        return [_number(one, factor) for one in cell]
    return _number(cell, factor)


def _number(value: float, factor: float) -> float | None:
    if isinstance(value, int) and factor == 1.0:
        return value
    return float(factor * value) if math.isfinite(value) else None


def as_json(data: Any) -> str:
    """Return data as the text of a JSON file."""
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def write(
    folder: Path, name: str, title: str, data: Mapping[str, Any], tables: Sequence[TextTable]
) -> None:
    """Write NAME.json and NAME.md, each whole or not at all.

    Args:
        folder: made where it is missing.
        name: of the files.
        title: heading of the Markdown file.
        data: what the tables are made of.
        tables: in their order.
    """
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        "json": as_json(data),
        "md": "\n".join([f"# {title}\n", *(table.markdown() for table in tables)]),
    }
    for suffix, text in texts.items():
        write_whole(folder / f"{name}.{suffix}", text)
