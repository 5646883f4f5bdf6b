# SPDX-License-Identifier: LGPL-3.0-or-later
"""A blank figure and a blank view per run, which take longer than the motion of beams."""

from PIL import Image

# For a process of its own, before it runs a command.
ONE_BLANK_FIGURE = """
from protractile.runs.report import figures, output, theme
from tests.unprinted import blank
figures.FIGURES = figures.FIGURES[-1:]
theme.Canvas.print_figure = blank
output.viewer = lambda run: "<!doctype html>"
"""


def blank(canvas: object, filename: str, **_: object) -> None:
    """Stand in for :meth:`.runs.report.theme.Canvas.print_figure`."""
    Image.new("L", (8, 8)).save(filename, "png")
