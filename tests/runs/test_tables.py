# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables in the terminal, in Markdown and in the report, and numbers in them."""

import json
import math
import re

import numpy as np
import pytest

from runs.report.formatting import fixed, number, scientific
from runs.report.tables import ROOMY, Column, Table
from tests.runs.summaries import printed

ROWS = [("beam", "1 s\n2 mm"), ("[b]", "–")]
TABLE = Table.of_rows("peaks", "Peaks", ("model", "first\nmm"), ROWS, ("A note.",))


def test_markdown_has_one_line_a_row_and_the_terminal_all_cells() -> None:
    assert TABLE.markdown().splitlines() == [
        "## Peaks", "", "| model | first mm |", "| :-- | --: |", "| beam | 1 s 2 mm |",
        "| [b] | – |", "", "A note.",
    ]  # fmt: skip
    lines = [line.split() for line in printed(TABLE.show, width=60).splitlines()]
    assert ["beam", "1", "s"] in lines
    assert ["[b]", "–"] in lines


def test_words_of_headings_are_whole_in_a_narrow_terminal() -> None:
    """Reference: by hand. With three spaces between columns the table needs 35 characters."""
    headings = ["contact", "dynamic", "factor", "mode"]
    table = Table("", [Column(one, [1.0], ".2f") for one in headings])
    assert printed(table.show, width=30).split()[:4] == headings


def test_wide_table_is_detected() -> None:
    """Reference: two columns, the longest line of each and two letters between them."""
    for letters, crowded in ((ROOMY - 4, False), (ROOMY - 3, True)):
        first, second = letters // 2, letters - letters // 2
        row = ("x" * first, "\n".join(["y", "y" * second]))
        assert Table.of_rows("", "", ("a", "b"), [("x", "y"), row]).crowded is crowded
    # So is one with longer words above its columns.
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


@pytest.mark.parametrize(
    ("shown", "expected"),
    [
        (scientific(8.3e-5, 1), "8 × 10⁻⁵"), (scientific(2.41e6, 3), "2.41 × 10⁶"),
        (scientific(1e-6, 3), "1 × 10⁻⁶"), (number(None), "–"), (number(math.nan), "–"),
        (number(0.0), "0"), (number(0.498484), "0.498"), (number(8.7669), "8.77"),
        (number(2000), "2000"), (number(45485.3), "45500"), (number(2.41e6), "2.41 × 10⁶"),
        (number(6.4836e-15), "6.48 × 10⁻¹⁵"), (number(-0.00042), "−4.2 × 10⁻⁴"),
        (number(-3.5), "−3.5"), (fixed(None, 1, 1000.0), "–"), (fixed(math.inf, 1, 1000.0), "–"),
        (fixed(0.1684, 1, 1000.0), "168.4"), (fixed(-0.002, 1, 1000.0), "−2.0"),
        (fixed(-4e-5, 1, 1000.0), "0.0"),
    ],
)  # fmt: skip
def test_numbers_have_so_many_digits_or_decimals(shown: str, expected: str) -> None:
    assert shown == expected
