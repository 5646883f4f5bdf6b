# SPDX-License-Identifier: LGPL-3.0-or-later
"""Colours can be told apart, and numbers are written for people."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from runs.report import theme


def test_colours_can_be_told_apart() -> None:
    """Reference: external, WCAG 2.1. A graphical object needs a contrast of 3 to the paper."""
    for colour in (*theme.PALETTE, theme.PLAY_FREE, theme.LOSS):
        linear = [
            c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)
        ]
        luminance = float(np.dot(linear, [0.2126, 0.7152, 0.0722]))
        assert 1.05 / (luminance + 0.05) > 3.0, colour


def test_more_models_than_colours_still_differ() -> None:
    names = [f"model {i}" for i in range(3 * len(theme.PALETTE))]
    drawn = theme.strokes([*names, "tied"], ["tied"])
    assert len(set(drawn.values())) == len(names) + 1


@pytest.mark.parametrize(
    ("number", "digits", "expected"),
    [(8.3e-5, 1, "8 × 10⁻⁵"), (2.41e6, 3, "2.41 × 10⁶"), (1e-6, 3, "1 × 10⁻⁶")],
)
def test_powers_of_ten_are_set_as_such(number: float, digits: int, expected: str) -> None:
    assert theme.scientific(number, digits) == expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        (None, "–"),
        (math.nan, "–"),
        (0.0, "0"),
        (0.498484, "0.498"),
        (8.7669, "8.77"),
        (2000, "2000"),
        (45485.3, "45500"),
        (2.41e6, "2.41 × 10⁶"),
        (6.4836e-15, "6.48 × 10⁻¹⁵"),
        (-0.00042, "−4.2 × 10⁻⁴"),
        (-3.5, "−3.5"),
    ],
)
def test_numbers_have_so_many_digits(value: float | None, expected: str) -> None:
    assert theme.number(value) == expected


@pytest.mark.parametrize(
    ("value", "expected"),
    [(None, "–"), (math.inf, "–"), (0.1684, "168.4"), (-0.002, "−2.0"), (-4e-5, "0.0")],
)
def test_numbers_have_so_many_decimals(value: float | None, expected: str) -> None:
    assert theme.fixed(value, 1, 1000.0) == expected
