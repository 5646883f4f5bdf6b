# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of text, for the terminal, for the report and as Markdown."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from runs.folder.files import whole

# Letters that fit in a line of the report with its usual font, and in one of a file.
ROOMY = 115
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
        statements: of the paper, S1 … S11, that it bears on.
    """

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    notes: Sequence[str] = ()
    name: str = ""
    statements: Sequence[str] = ()

    @property
    def anchor(self) -> str:
        """What a link in the report points to."""
        return f"table-{self.name}"

    @property
    def crowded(self) -> bool:
        """Whether it takes smaller letters to fit the report's page."""
        # Headings are broken between words, cells where they say so.
        letters = [
            max(len(part) for part in (*heading.split(), *"\n".join(column).split("\n")))
            for heading, *column in zip(self.headings, *self.rows, strict=True)
        ]
        return sum(letters) + 2 * len(letters) > ROOMY

    def show(self, console: Console) -> None:
        """Print it."""
        table = Table(title=Text(self.title), title_justify="left", box=SIMPLE_HEAD)
        for number, heading in enumerate(self.headings):
            table.add_column(heading, justify="right" if number else "left")
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
        "json": json.dumps(data, indent=1, ensure_ascii=False, allow_nan=False) + "\n",
        "md": "\n".join([f"# {title}\n", *(table.markdown() for table in tables)]),
    }
    for suffix, text in texts.items():
        with whole(folder / f"{name}.{suffix}") as part:
            part.write_text(text, encoding="utf-8")
