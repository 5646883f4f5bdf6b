# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of text, for the terminal and as Markdown."""

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

from runs.output import whole


@dataclass(frozen=True, slots=True)
class TextTable:
    """A table whose cells are text already.

    Args:
        title: above it.
        headings: of the columns; the first column is flush left, the others are right.
        rows: as long as the headings each.
        notes: sentences below it.
    """

    title: str
    headings: Sequence[str]
    rows: Sequence[Sequence[str]]
    notes: Sequence[str] = ()

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
