# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers are written for people."""

import math

import pytest

from runs.report.formatting import fixed, number, scientific


@pytest.mark.parametrize(
    ("number", "digits", "expected"),
    [(8.3e-5, 1, "8 × 10⁻⁵"), (2.41e6, 3, "2.41 × 10⁶"), (1e-6, 3, "1 × 10⁻⁶")],
)
def test_powers_of_ten_are_set_as_such(number: float, digits: int, expected: str) -> None:
    assert scientific(number, digits) == expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (None, "–"), (math.nan, "–"), (0.0, "0"), (0.498484, "0.498"), (8.7669, "8.77"),
        (2000, "2000"), (45485.3, "45500"), (2.41e6, "2.41 × 10⁶"), (6.4836e-15, "6.48 × 10⁻¹⁵"),
        (-0.00042, "−4.2 × 10⁻⁴"), (-3.5, "−3.5"),
    ],
)  # fmt: skip
def test_numbers_have_so_many_digits(value: float | None, expected: str) -> None:
    assert number(value) == expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [(None, "–"), (math.inf, "–"), (0.1684, "168.4"), (-0.002, "−2.0"), (-4e-5, "0.0")],
)
def test_numbers_have_so_many_decimals(value: float | None, expected: str) -> None:
    assert fixed(value, 1, 1000.0) == expected
