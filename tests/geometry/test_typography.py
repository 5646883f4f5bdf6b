# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers as people read them."""

from geometry.typography import digits, signed


def test_digits_never_need_an_exponent() -> None:
    """Reference: by hand."""
    shown = [digits(value) for value in (1023.4, 22.68, 0.0, -5.0, 1.0e6, 0.012345)]
    assert shown == ["1020", "22.7", "0", "−5", "1000000", "0.0123"]
    assert digits(123456.0, 4) == "123500"


def test_minus_signs_are_no_hyphens() -> None:
    """Reference: Unicode, MINUS SIGN."""
    assert signed("-1.5") == "\N{MINUS SIGN}1.5"
