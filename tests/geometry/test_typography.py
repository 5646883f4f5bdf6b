# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers and lists as people read them."""

from geometry.typography import digits, join_words, with_minus_signs


def test_digits_never_need_an_exponent() -> None:
    """Reference: by hand."""
    shown = [digits(value) for value in (1023.4, 22.68, 0.0, -5.0, 1.0e6, 0.012345)]
    assert shown == ["1020", "22.7", "0", "−5", "1000000", "0.0123"]
    assert digits(123456.0, 4) == "123500"


def test_minus_signs_are_no_hyphens() -> None:
    """Reference: Unicode, MINUS SIGN."""
    assert with_minus_signs("-1.5") == "\N{MINUS SIGN}1.5"


def test_the_last_of_several_follows_an_and() -> None:
    """Reference: by hand."""
    assert [join_words("abc"[:count]) for count in (1, 2, 3)] == ["a", "a and b", "a, b and c"]
