# SPDX-License-Identifier: LGPL-3.0-or-later
"""Whatever a text holds, what is shown of it is one printable line of a bounded length."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from runs.process.shown import LONGEST, message, shown


@given(st.text(st.characters(), max_size=2000))
def test_a_message_is_one_short_printable_line(text: str) -> None:
    line = message(text)
    assert line.startswith("protractile: ")
    assert line.isprintable()
    assert len(line) < LONGEST


def test_controls_are_escaped() -> None:
    assert shown("a\x1b[31mb\u202ec\udcff é") == "a\\x1b[31mb\\u202ec\\udcff é"


def test_the_middle_goes_and_both_ends_stay() -> None:
    """Reference: analytic, the name of a file at the end of a long path."""
    assert (
        shown("/" + "long/" * 100 + "case.toml", 41) == "/long/long/long/lo ... ong/long/case.toml"
    )
    assert shown("a" * 41, 41) == "a" * 41
