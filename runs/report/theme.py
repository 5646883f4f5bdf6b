# SPDX-License-Identifier: LGPL-3.0-or-later
"""Style of figures: readable on a telephone, one colour per model everywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.patheffects import AbstractPathEffect, withStroke

# A telephone shows a figure about half as wide as drawn: 11 pt stay readable.
WIDTH = 5.4
DPI = 150

INK = "#222222"
RULE = "#d9d9d9"
PLAY_FREE = "#6b6b6b"
FAINT = "#a8a8a8"
# Colours of energy losses, beside those of the models.
LOSS = "#8c6d1f"

# Okabe and Ito (2008), without colours too pale for lines on white; the purple is slightly darker,
# and a violet and an ochre extend it to more models.
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#111111", "#b0568c", "#6a3fd0", "#8a6d00")

# Colours of two segments and their contact force, safe for the colour-blind.
OUTER, INNER, FORCE = "#56b4e9", "#e69f00", "#b03000"
# Outline of letters above a picture.
OUTLINED: list[AbstractPathEffect] = [withStroke(linewidth=3, foreground="white")]
# Colour maps of deflections and of stresses, light at zero.
DEFLECTION, STRESS = "viridis_r", "cividis_r"

RC: dict[Any, Any] = {
    "figure.dpi": DPI,
    "savefig.dpi": DPI,
    "figure.constrained_layout.use": True,
    "figure.facecolor": "white",
    "font.family": "DejaVu Sans",
    "font.size": 11.0,
    "text.color": INK,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    # Numbers along axes are written in full, without an offset at the end of the axis.
    "axes.formatter.useoffset": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 11.0,
    "axes.titleweight": "bold",
    "grid.color": RULE,
    "grid.linewidth": 0.6,
    "xtick.color": INK,
    "ytick.color": INK,
    "lines.linewidth": 1.5,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "legend.fontsize": 11.0,
    # The longest trajectories overflow the renderer's path buffer unless cut into pieces; the gap
    # between two pieces must be too short to be visible.
    "agg.path.chunksize": 1_000_000,
}

# Style of sheets around VTK's pictures, which are shown at the width of a screen.
PAGE_RC: dict[Any, Any] = {
    name: value for name, value in RC.items() if name.endswith(("color", "top", "right"))
} | {"font.size": 20.0}


class Canvas(FigureCanvasAgg):
    """Canvas that saves a sheet with a single drawing, where matplotlib otherwise needs two."""

    def print_figure(self, filename: Any, *_: Any, **__: Any) -> None:
        """Write a PNG file, whatever the ending of its name."""
        canvas: Any = self
        canvas.print_png(filename)


def segment_color(number: int) -> str:
    """Return the colour of a segment in the order of the boom, the same in all figures."""
    return PALETTE[number % len(PALETTE)]


def tint(color: str, strength: float) -> tuple[float, float, float]:
    """Return a colour mixed with white; strength 1 leaves it unchanged."""
    red, green, blue = to_rgb(color)
    paper = 1.0 - strength
    return strength * red + paper, strength * green + paper, strength * blue + paper


@dataclass(frozen=True, slots=True)
class Stroke:
    """Colour and dash pattern of one model's lines."""

    color: str
    linestyle: str = "-"


def strokes(models: Sequence[str], bonded: Sequence[str]) -> dict[str, Stroke]:
    """Return a stroke for each model, independent of the models in a figure.

    Args:
        models: names in the order of the case.
        bonded: those without play, which are the background of the others: grey, dashed.
    """
    with_play = [name for name in models if name not in bonded]
    drawn = {name: Stroke(PLAY_FREE, "--") for name in bonded}
    for i, name in enumerate(with_play):
        # Beyond the palette the colours are repeated, dashed.
        again, color = divmod(i, len(PALETTE))
        drawn[name] = Stroke(PALETTE[color], ("-", "-.", ":")[again % 3])
    return {name: drawn[name] for name in models}
