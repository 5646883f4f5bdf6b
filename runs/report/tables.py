# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables for the terminal, the report, Markdown files and programs."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from itertools import chain, zip_longest
from pathlib import Path
from textwrap import fill
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.measure import Measurement
from rich.table import Table as Grid
from rich.text import Text

from protractile.geometry.typography import (
    DECIMALS,
    NONE,
    SHOWN,
    count,
    fixed,
    in_shown_unit,
    number,
    repeated,
)
from protractile.geometry.units import Unit
from protractile.runs.folder.files import write_atomically

if TYPE_CHECKING:
    import pandas as pd

# Characters per line in the report, on a telephone, and in a file.
ROOMY, NARROW = 115, 40
WIDE = 180
# Numbers of characters above which cells break, of which the first that fits is taken.
_LONGEST = 40, 30, 20, 12, 0
# Spaces at which no line breaks, for example between a number and its unit.
_KEPT_SPACE = re.compile(
    r"(?<=\d) (?=[^\W\d]{1,3}\b|[%×])|(?<=×) (?=\d)|(?<=\b\w) (?=[=≤≥])|(?<=[=≤≥]) (?=[−\d])"
)


class Amount(NamedTuple):
    """Cell of a column with several units: a number, its unit, and a mark such as ``*``."""

    value: float  #: number in ``unit``
    unit: str  #: displayed unit
    digits: int = 3  #: number of significant digits
    mark: str = ""

    @classmethod
    def of(cls, value: float, unit: str, mark: str = "") -> Amount:
        """Return the cell of a number in an SI unit, in its display unit."""
        return cls(round(in_shown_unit(value, unit), DECIMALS), SHOWN[unit], mark=mark)

    def __str__(self) -> str:
        return f"{number(self.value, self.digits)} {self.unit}".strip() + self.mark


# Type of a cell: text, a number, repeated measurements of a number, or None.
Cell = str | float | list[float] | Amount | None
# Type of a cell in JSON, which has no infinity or NaN.
Plain = str | float | list[float | None] | None


@dataclass(frozen=True, slots=True)
class Column:
    """Column of a table."""

    title: str  #: the heading
    #: one cell per row: a number in SI units, text, or None for an empty cell; repeated
    #: measurements are displayed as their median, rounded by their spread
    cells: Sequence[Cell]
    #: number format: ".2f" for two decimals, ".3g" for three significant digits, empty for a count
    form: str = ""
    #: displayed unit, such as "kN m" or "% of the range"; empty to leave numbers as they are
    unit: str = ""

    @property
    def heading(self) -> str:
        """The title, with the unit in its second line."""
        if not self.unit or not self.title:
            return self.title or self.unit
        between = ", " if "\n" in self.title else "\n"
        return f"{self.title}{between}{self.unit}"

    @property
    def words(self) -> str:
        """The title in one line."""
        return self.title.replace("-\n", "").replace("\n", " ")

    @property
    def factor(self) -> float:
        """The conversion factor from SI units to the unit of the heading; 1 for other words."""
        with suppress(ValueError):
            return Unit.conversion(self.unit.partition(" of ")[0])
        return 1.0

    @property
    def text(self) -> list[str]:
        """The cells as displayed."""
        return [self._shown(cell) for cell in self.cells]

    @property
    def plain(self) -> list[Plain]:
        """The cells in the unit of the heading."""
        return [self._plain(cell) for cell in self.cells]

    @property
    def units(self) -> list[Column]:
        """The column of the units of amounts; none for other cells."""
        units = [cell.unit if isinstance(cell, Amount) else None for cell in self.cells]
        return [Column(f"{self.heading}\nunit", units)] if any(units) else []

    def _shown(self, cell: Cell) -> str:
        if isinstance(cell, str | Amount):
            return str(cell)
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

    def _plain(self, cell: Cell) -> Any:
        """Return a cell in the displayed unit; without conversion an integer stays an integer."""
        if isinstance(cell, Amount):
            return cell.value
        if isinstance(cell, list):
            return [self._plain(part) for part in cell]
        if cell is None or isinstance(cell, str) or (isinstance(cell, int) and self.factor == 1.0):
            return cell
        return float(self.factor * cell) if math.isfinite(cell) else None


@dataclass(frozen=True, slots=True)
class Table:
    """Table for people and for programs."""

    title: str  #: title above the table
    #: columns; the first is aligned left, the others right; missing cells at the end of a column
    #: are empty
    columns: Sequence[Column]
    notes: Sequence[str] = ()  #: sentences below the table
    name: str = ""  #: name of its anchor in the report
    strong: Sequence[str] = ()  #: texts of highlighted cells

    @classmethod
    def of_rows(
        cls,
        name: str,
        title: str,
        columns: Mapping[str, str] | Sequence[str | tuple[str, ...]],
        rows: Sequence[Sequence[Cell]],
        notes: Sequence[str] = (),
        sparse: bool = False,
    ) -> Table:
        """Return a table from rows with a cell for each column.

        Columns are titles, titles with number format and unit as in :class:`Column`, or number
        formats by title. With ``sparse``, columns without values are left out.
        """
        pairs = columns.items() if isinstance(columns, Mapping) else columns
        parts = [
            Column(head, [row[i] for row in rows], *more)
            for i, (head, *more) in enumerate((p,) if isinstance(p, str) else p for p in pairs)
        ]
        if sparse:
            parts = [part for part in parts if any(cell is not None for cell in part.cells)]
        return cls(title, parts, notes, name)

    @property
    def headings(self) -> tuple[str, ...]:
        """The headings of the columns, with units in the second line."""
        return tuple(column.heading for column in self.columns)

    @property
    def rows(self) -> list[tuple[str, ...]]:
        """The cells as displayed, row by row."""
        return list(zip_longest(*(column.text for column in self.columns), fillvalue=NONE))

    @property
    def frame(self) -> pd.DataFrame:
        """The table as a data frame, with numbers in displayed units and None for empty cells.

        A column of several units has its numbers, and is followed by a column of their units.

        Raises:
            ValueError: two columns have the same heading.
        """
        import pandas as pd

        columns = [*chain(*((column, *column.units) for column in self.columns))]
        headings = [column.heading for column in columns]
        if len({*headings}) < len(headings):
            raise ValueError(f"{self.title}: two columns have the same heading, of {headings}")
        cells = [pd.Series(column.plain, dtype=object) for column in columns]
        frame = pd.concat(cells, axis=1, keys=headings)
        return frame.where(frame.notna(), None)

    @property
    def flat_frame(self) -> pd.DataFrame:
        """The :attr:`frame` with headings of one line."""
        return self.frame.rename(columns=lambda heading: heading.replace("\n", ", "))

    @property
    def data(self) -> list[dict[Any, Plain]]:
        """The rows of :attr:`frame` as JSON values."""
        return list(self.frame.to_dict("records"))

    @property
    def anchor(self) -> str:
        """The target of links in the report."""
        return f"table-{self.name}"

    @property
    def crowded(self) -> bool:
        """True if the table needs smaller letters to fit the report's page."""
        return self._letters > ROOMY

    @property
    def stacked(self) -> bool:
        """True if a telephone shows the cells of a row below one another, with their headings."""
        return self._letters > NARROW

    def _widths(self, longest: float = math.inf) -> list[int]:
        """Return the number of characters of each column whose headings break at spaces.

        Lines of cells with more than ``longest`` characters break, too, but no numbers with units.
        """
        widths = []
        for column in self.columns:
            parts = ["", *column.heading.split()]
            for line in "\n".join(column.text).split("\n"):
                kept = _KEPT_SPACE.sub("\N{NO-BREAK SPACE}", line)
                parts += kept.split(" ") if len(line) > longest else [line]
            widths.append(max(map(len, parts)))
        return widths

    @property
    def _letters(self) -> int:
        """The number of characters in a line, if headings break at spaces."""
        return sum(self._widths(), start=2 * len(self.columns))

    def show(self, console: Console) -> None:
        """Print the table."""
        if self.title:
            # Printed separately, since rich would break the title at the width of the table.
            console.print(Text(self.title, style="italic"))
        grid = Grid(box=SIMPLE_HEAD, pad_edge=False)
        # Headings break first, then the longest cells.
        room = console.width - len(self.columns) - 1
        choices = (self._widths(longest) for longest in _LONGEST)
        widths = next((of for of in choices if sum(of) <= room), [0] * len(self.columns))
        for i, (heading, width) in enumerate(zip(self.headings, widths, strict=True)):
            justify: Literal["left", "right"] = "right" if i else "left"
            grid.add_column(heading, justify=justify, no_wrap=not width and i == 0, min_width=width)
        for row in self.rows:
            grid.add_row(*map(Text, row))
        unlimited = console.options.update(max_width=WIDE)
        # Narrow gaps save rich from breaking headings, or even words.
        if Measurement.get(console, unlimited, grid).maximum > console.width:
            grid.padding = 0
        console.print(grid)
        for note in self.notes:
            print_text(console, note)

    def _repr_html_(self) -> str:
        import pandas as pd

        grid = pd.DataFrame(self.rows, columns=self.headings).to_html(index=False, border=0)
        notes = "".join(f"<br>{escape(note)}" for note in self.notes)
        return f"<p><b>{escape(self.title)}</b>{notes}</p>{grid}"

    def markdown(self) -> str:
        """Return heading, table and notes as Markdown."""
        ruler = [":--", *["--:"] * (len(self.headings) - 1)]
        lines = [f"| {' | '.join(row)} |" for row in (self.headings, ruler, *self.rows)]
        lines = [line.replace("\n", " ") for line in lines]
        return "\n".join(
            [f"## {self.title}", "", *lines, "", *(f"{note}\n" for note in self.notes)]
        )


def print_text(console: Console, text: str) -> None:
    """Print a text in lines that keep numbers and their units together."""
    kept = _KEPT_SPACE.sub("\N{NO-BREAK SPACE}", text)
    lines = fill(kept, console.width, break_on_hyphens=False)
    console.print(Text(lines.replace("\N{NO-BREAK SPACE}", " ")))


def as_json(data: Any) -> str:
    """Return data as JSON text."""
    return json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def write(
    folder: Path, name: str, title: str, data: Mapping[str, Any], tables: Sequence[Table]
) -> None:
    """Write NAME.json and NAME.md atomically.

    The folder is created if it is missing. The JSON file has the data, the Markdown file the title
    and the tables.
    """
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        "json": as_json(data),
        "md": "\n".join([f"# {title}\n", *(table.markdown() for table in tables)]),
    }
    for suffix, text in texts.items():
        write_atomically(folder / f"{name}.{suffix}", text)
