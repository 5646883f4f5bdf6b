# SPDX-License-Identifier: LGPL-3.0-or-later
"""Style of figures; a model has the same colour in all figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import Any

from matplotlib.patheffects import AbstractPathEffect, withStroke

# Width of a figure in inches. A telephone shows it at half the size, where 11 pt stay readable.
WIDTH = 5.4
DPI = 150

INK = "#222222"
RULE = "#d9d9d9"
PLAY_FREE = "#6b6b6b"
FAINT = "#a8a8a8"

# Colours of Okabe and Ito (2008) without those that are too pale for lines, with a darker purple
# and two further colours.
PALETTE = ("#0072b2", "#d55e00", "#009e73", "#111111", "#b0568c", "#6a3fd0", "#8a6d00")

# Colours of two segments and their contact force, which the colour-blind can distinguish.
OUTER, INNER, FORCE = "#56b4e9", "#e69f00", "#b03000"
# Outlines of letters on a picture.
OUTLINED: list[AbstractPathEffect] = [withStroke(linewidth=3, foreground="white")]
# Colour maps of deflections and of stresses; zero is light.
DEFLECTION, STRESS = "viridis_r", "cividis_r"

# Smooth scale of maps (viridis), and colours between the levels of a scale with levels.
SCALE = ("#440154", "#3b528b", "#21918c", "#5ec962", "#fde725")
SHADES = ("#fff3c4", "#f6b26b", "#b8577a", "#3b1f5c")

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
    # Axes have full numbers, without an offset.
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
    # Long lines are split, since they overflow the path buffer of the renderer.
    "agg.path.chunksize": 1_000_000,
}

# Texts in SVG pictures are text, and the same picture has the same bytes.
SVG_RC: dict[Any, Any] = {"svg.fonttype": "none", "svg.hashsalt": "protractile"}

# Style of sheets with VTK's pictures, which are as wide as a screen.
PAGE_RC: dict[Any, Any] = {
    name: value for name, value in RC.items() if name.endswith(("color", "top", "right"))
} | {"font.size": 20.0}


def segment_color(number: int) -> str:
    """Return the colour of a segment by its number, the same in all figures."""
    # Models have the first colours of the palette.
    return PALETTE[-1 - number % len(PALETTE)]


def tint(color: str, strength: float) -> str:
    """Return a colour ``#rrggbb`` mixed with white; strength 1 is the pure colour."""
    parts = bytes.fromhex(color[1:])
    return "#" + bytes(round(255.0 + strength * (part - 255.0)) for part in parts).hex()


@dataclass(frozen=True, slots=True)
class LineStyle:
    """Colour and dash pattern of one model's lines."""

    color: str
    linestyle: str = "-"


def line_styles(models: Sequence[str], bonded: Sequence[str]) -> dict[str, LineStyle]:
    """Return colour and dashes of each model, the same in all figures.

    Names are in the order of the case. The curves of ``bonded`` models, without play, are grey and
    dashed.
    """
    # If the palette is too short, its colours are repeated with dashes.
    looks = cycle(LineStyle(color, dashes) for dashes in ("-", "-.", ":") for color in PALETTE)
    return {name: LineStyle(PLAY_FREE, "--") if name in bonded else next(looks) for name in models}
