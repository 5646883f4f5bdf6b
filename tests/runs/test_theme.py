# SPDX-License-Identifier: LGPL-3.0-or-later
"""Colours can be told apart."""

import numpy as np
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
    drawn = theme.strokes([*names, "bonded"], ["bonded"])
    assert len(set(drawn.values())) == len(names) + 1
