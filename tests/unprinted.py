# SPDX-License-Identifier: LGPL-3.0-or-later
"""A blank figure and a blank view per run, which take longer than the motion of beams."""

from pathlib import Path
from typing import IO

from PIL import Image

# For a process of its own, before it runs a command.
ONE_BLANK_FIGURE = """
from matplotlib.figure import Figure
from protractile.runs.report import figures, output
from tests.unprinted import blank
figures.FIGURES = figures.FIGURES[-1:]
Figure.savefig = blank
output.viewer = lambda run: "<!doctype html>"
"""


def blank(sheet: object, target: Path | IO[bytes], format: str = "png", **_: object) -> None:
    """Stand in for :meth:`matplotlib.figure.Figure.savefig`."""
    if format == "svg":
        assert not isinstance(target, Path)
        target.write(b'<svg xmlns="http://www.w3.org/2000/svg"/>')
    else:
        Image.new("L", (8, 8)).save(target, "png")
