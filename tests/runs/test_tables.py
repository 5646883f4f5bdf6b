# SPDX-License-Identifier: LGPL-3.0-or-later
"""A table of text is the same table in the terminal, in Markdown and in the report."""

from __future__ import annotations

from io import StringIO

import pytest
from rich.console import Console

from runs.report.tables import ROOMY, TextTable

TABLE = TextTable(
    "Peaks", ("model", "first\nmm"), [("beam", "1 s\n2 mm"), ("[b]", "–")], ("A note.",), "peaks"
)


def test_markdown_has_one_line_a_row() -> None:
    assert TABLE.markdown().splitlines() == [
        "## Peaks", "", "| model | first mm |", "| :-- | --: |", "| beam | 1 s 2 mm |",
        "| [b] | – |", "", "A note.",
    ]  # fmt: skip


def test_the_terminal_shows_cells_as_they_are() -> None:
    console = Console(file=StringIO(), width=60)
    TABLE.show(console)
    assert isinstance(console.file, StringIO)
    lines = [line.split() for line in console.file.getvalue().splitlines()]
    assert ["beam", "1", "s"] in lines
    assert ["[b]", "–"] in lines


@pytest.mark.parametrize(("letters", "crowded"), [(ROOMY - 4, False), (ROOMY - 3, True)])
def test_a_table_that_needs_smaller_letters_is_known(letters: int, crowded: bool) -> None:
    """Reference: two columns, the longest line of each and two letters between them."""
    first, second = letters // 2, letters - letters // 2
    row = ("x" * first, "\n".join(["y", "y" * second]))
    assert TextTable("", ("a", "b"), [("x", "y"), row]).crowded is crowded


def test_so_is_one_with_longer_words_above_its_columns() -> None:
    heading = f"{'x' * (ROOMY - 5)} {'y' * (ROOMY - 5)}"
    assert not TextTable("", ("a", heading), [("x", "y")]).crowded
    assert TextTable("", ("a", f"x{heading}"), [("x", "y")]).crowded
