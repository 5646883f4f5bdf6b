# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables for the terminal, the report, Markdown and programs."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table as Grid
from rich.text import Text

from geometry.typography import TO_KILO, TO_MEGA, TO_MICRO, TO_MILLI, TO_PERCENT
from runs.folder.files import write_whole
from runs.report.formatting import NONE, count, fixed, number, repeated

if TYPE_CHECKING:
    import pandas as pd

# Characters that fit in a line of the report with its usual font, on a telephone, and in a file.
ROOMY, NARROW = 115, 40
WIDE = 180

# Conversion from SI units to those in headings; others are SI units.
_FACTORS = {"%": TO_PERCENT, "mm": TO_MILLI, "mrad": TO_MILLI, "ms": TO_MILLI, "µs": TO_MICRO}
_FACTORS |= dict.fromkeys(("kN", "kW", "kJ"), TO_KILO)
_FACTORS |= dict.fromkeys(("MPa", "MN", "MN/m"), TO_MEGA)

# A cell: text, a number, repetitions of one, or none.
Cell = str | float | list[float] | None
# The same in JSON, without numbers that are not finite.
Plain = str | float | list[float | None] | None


def wide_console() -> Console:
    """Return the console for tables, as wide as the tables where the output is no terminal."""
    console = Console()
    return console if console.is_terminal else Console(width=WIDE)


@dataclass(frozen=True, slots=True)
class Column:
    """Numbers or text under a heading.

    Args:
        title: the heading.
        cells: one for each row, numbers in SI units; None for none, a text for what is no number;
            repetitions are shown with the digits that they have in common, whatever the form.
        form: ".2f" with two decimals, ".3g" with three significant digits, else a count.
        unit: in which the numbers are shown, "kN m" or "% of the range" say; empty where they stay
            as they are.
    """

    title: str
    cells: Sequence[Cell]
    form: str = ""
    unit: str = ""

    @property
    def heading(self) -> str:
        """Title, with the unit in its second line."""
        if not self.unit or not self.title:
            return self.title or self.unit
        between = ", " if "\n" in self.title else "\n"
        return f"{self.title}{between}{self.unit}"

    @property
    def factor(self) -> float:
        """Conversion factor from SI units to the unit of the heading."""
        return _FACTORS.get(self.unit.partition(" ")[0], 1.0)

    @property
    def text(self) -> list[str]:
        """Cells as displayed."""
        return [self._shown(cell) for cell in self.cells]

    @property
    def plain(self) -> list[Plain]:
        """Cells in the unit of the heading."""
        return [self._plain(cell) for cell in self.cells]

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

    def _plain(self, cell: Cell) -> Plain:
        if isinstance(cell, list):
            return [self._number(one) for one in cell]
        return cell if isinstance(cell, str) or cell is None else self._number(cell)

    def _number(self, value: float) -> float | None:
        """Return a number, an integer where the cell is one and keeps its unit."""
        if isinstance(value, int) and self.factor == 1.0:
            return value
        return float(self.factor * value) if math.isfinite(value) else None


@dataclass(frozen=True, slots=True)
class Table:
    """A table for people and for programs.

    Args:
        title: above it.
        columns: the first is flush left, the others are right; one that ends before the others has
            none of its cells then. A cell may have several lines.
        notes: sentences below it.
        name: of its place in the report.
        strong: texts of cells that stand out.
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
        columns: Mapping[str, str] | Sequence[str],
        rows: Sequence[Sequence[Cell]],
        notes: Sequence[str] = (),
    ) -> Table:
        """Return the table of rows whose numbers are in the units of the headings.

        Args:
            name, title, notes: of the table.
            columns: heading → format of its numbers; headings alone where all cells are text.
            rows: a cell for each heading.
        """
        forms = columns if isinstance(columns, Mapping) else dict.fromkeys(columns, "")
        parts = [
            Column(heading, [row[i] for row in rows], form)
            for i, (heading, form) in enumerate(forms.items())
        ]
        return cls(title, parts, notes, name)

    @property
    def headings(self) -> tuple[str, ...]:
        """Headings of the columns, with the unit in the second line."""
        return tuple(column.heading for column in self.columns)

    @property
    def rows(self) -> list[tuple[str, ...]]:
        """Cells as displayed, row by row."""
        return list(zip_longest(*(column.text for column in self.columns), fillvalue=NONE))

    @property
    def frame(self) -> pd.DataFrame:
        """Cells by their headings, numbers in their units; None for empty cells.

        Raises:
            ValueError: two columns have the same heading.
        """
        import pandas as pd

        headings = [*self.headings]
        if len({*headings}) < len(headings):
            raise ValueError(f"{self.title}: two columns have the same heading, of {headings}")
        cells = [pd.Series(column.plain, dtype=object) for column in self.columns]
        frame = pd.concat(cells, axis=1, keys=headings)
        return frame.where(frame.notna(), None)

    @property
    def data(self) -> list[dict[str, Plain]]:
        """Rows of :attr:`frame`, as JSON values."""
        return [
            {str(heading): cell for heading, cell in row.items()}
            for row in self.frame.to_dict("records")
        ]

    @property
    def anchor(self) -> str:
        """Target of links in the report."""
        return f"table-{self.name}"

    @property
    def crowded(self) -> bool:
        """Whether the table needs smaller letters to fit the report's page."""
        return self._letters > ROOMY

    @property
    def stacked(self) -> bool:
        """Whether a telephone shows its rows one below the other, each cell with its heading."""
        return self._letters > NARROW

    @property
    def _letters(self) -> int:
        """Characters in a line; headings are broken between words, cells at their line breaks."""
        letters = [
            max(len(part) for part in ("", *of.heading.split(), *"\n".join(of.text).split("\n")))
            for of in self.columns
        ]
        return sum(letters, start=2 * len(letters))

    def show(self, console: Console) -> None:
        """Print the table."""
        if self.title:
            # The title of a grid would be broken at the width of its columns.
            console.print(Text(self.title, style="italic"))
        grid = Grid(box=SIMPLE_HEAD, pad_edge=False)
        for i, heading in enumerate(self.headings):
            # Small numbers stay on one line: 1 × 10⁻¹².
            whole = i == 0 or ("\n" in heading and any(" × 10" in row[i] for row in self.rows))
            grid.add_column(heading, justify="right" if i else "left", no_wrap=whole)
        for row in self.rows:
            grid.add_row(*map(Text, row))
        console.print(grid)
        for note in self.notes:
            console.print(Text(note))

    def markdown(self) -> str:
        """Return heading, table and notes as Markdown."""
        ruler = [":--", *["--:"] * (len(self.headings) - 1)]
        lines = [f"| {' | '.join(row)} |" for row in (self.headings, ruler, *self.rows)]
        lines = [line.replace("\n", " ") for line in lines]
        return "\n".join(
            [f"## {self.title}", "", *lines, "", *(f"{note}\n" for note in self.notes)]
        )


def as_json(data: Any) -> str:
    """Return data as the text of a JSON file."""
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def write(
    folder: Path, name: str, title: str, data: Mapping[str, Any], tables: Sequence[Table]
) -> None:
    """Write NAME.json and NAME.md, each completely or not at all.

    Args:
        folder: made where it is missing.
        name: of the files.
        title: heading of the Markdown file.
        data: of the tables.
        tables: in their order.
    """
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        "json": as_json(data),
        "md": "\n".join([f"# {title}\n", *(table.markdown() for table in tables)]),
    }
    for suffix, text in texts.items():
        write_whole(folder / f"{name}.{suffix}", text)
