# SPDX-License-Identifier: LGPL-3.0-or-later
"""A table of text is the same table in the terminal, in Markdown and in the report."""

import json
import math
import re

import numpy as np
import pytest

from runs.report.tables import ROOMY, Column, Table
from tests.runs.summaries import printed

ROWS = [("beam", "1 s\n2 mm"), ("[b]", "–")]
TABLE = Table.of_rows("peaks", "Peaks", ("model", "first\nmm"), ROWS, ("A note.",))


def test_markdown_has_one_line_a_row() -> None:
    assert TABLE.markdown().splitlines() == [
        "## Peaks", "", "| model | first mm |", "| :-- | --: |", "| beam | 1 s 2 mm |",
        "| [b] | – |", "", "A note.",
    ]  # fmt: skip


def test_the_terminal_shows_cells_as_they_are() -> None:
    lines = [line.split() for line in printed(TABLE.show, width=60).splitlines()]
    assert ["beam", "1", "s"] in lines
    assert ["[b]", "–"] in lines


@pytest.mark.parametrize(("letters", "crowded"), [(ROOMY - 4, False), (ROOMY - 3, True)])
def test_wide_table_is_detected(letters: int, crowded: bool) -> None:
    """Reference: two columns, the longest line of each and two letters between them."""
    first, second = letters // 2, letters - letters // 2
    row = ("x" * first, "\n".join(["y", "y" * second]))
    assert Table.of_rows("", "", ("a", "b"), [("x", "y"), row]).crowded is crowded


def test_so_is_one_with_longer_words_above_its_columns() -> None:
    heading = f"{'x' * (ROOMY - 5)} {'y' * (ROOMY - 5)}"
    assert not Table.of_rows("", "", ("a", heading), [("x", "y")]).crowded
    assert Table.of_rows("", "", ("a", f"x{heading}"), [("x", "y")]).crowded


def test_rows_are_in_the_units_of_their_headings_as_json_says_them() -> None:
    columns = (
        Column("model", ["beam", "shell"]),
        Column("steps", [7, np.int64(8)]),
        Column("wall", [[0.5, math.inf], 0.25], ".1f", "ms"),
        Column("peak", [2, math.nan], ".1f", "mm"),
        Column("shorter", [None]),
    )
    data = Table("Found", columns).data
    assert json.dumps(data) == (
        '[{"model": "beam", "steps": 7, "wall\\nms": [500.0, null], "peak\\nmm": 2000.0, '
        '"shorter": null}, {"model": "shell", "steps": 8.0, "wall\\nms": 250.0, '
        '"peak\\nmm": null, "shorter": null}]'
    )


def test_repetitions_are_shown_in_the_unit_of_their_heading() -> None:
    """Reference: half the range, 10 ms, leaves two digits of the median."""
    assert Column("wall", [[0.41, 0.42, 0.43]], ".1f", "ms").text == ["420"]


def test_data_do_not_lose_a_column_to_one_of_the_same_heading() -> None:
    table = Table("Peaks", (Column("mm", [1.0]), Column("mm", [2.0])))
    assert table.rows == [("1", "2")]
    message = re.escape("Peaks: two columns have the same heading, of ['mm', 'mm']")
    with pytest.raises(ValueError, match=f"^{message}$"):
        assert table.data
