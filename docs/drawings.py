# SPDX-License-Identifier: LGPL-3.0-or-later
"""Drawings of the keys of a case file, into docs/drawings: ``python docs/drawings.py``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

FOLDER = Path(__file__).parent / "drawings"
OUTER, INNER, PAD, KEY = "#0072b2", "#d55e00", "#555555", "#a00040"


class Drawing:
    """A figure of parts and dimensions.

    Args:
        width: width in inches.
        height: height in inches.
    """

    def __init__(self, width: float, height: float) -> None:
        self.figure = Figure((width, height))
        self.axes: Axes = self.figure.subplots()
        self.axes.set_aspect("equal")
        self.axes.axis("off")
        self.keys: set[str] = set()  #: keys of the case file that dimensions show

    def box(self, x: float, y: float, width: float, height: float, colour: str) -> None:
        """Draw a rectangle with its lower left corner at (x, y)."""
        edge = Rectangle((x, y), width, height, edgecolor=colour, facecolor=f"{colour}22", lw=1.5)
        self.axes.add_patch(edge)

    def line(self, *points: tuple[float, float], colour: str = "k", width: float = 1.0) -> None:
        """Draw a polyline through points (x, y)."""
        self.axes.plot(*zip(*points, strict=True), color=colour, lw=width, solid_capstyle="butt")

    def text(self, x: float, y: float, text: str, colour: str = "k") -> None:
        """Write centred text at (x, y)."""
        self.axes.text(x, y, text, color=colour, ha="center", va="center", size=8)

    def measure(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        key: str,
        shift: tuple[float, float] = (0.0, 0.12),
        more: str = "",
    ) -> None:
        """Draw a dimension line from start to end.

        Args:
            start: one end (x, y).
            end: the other end (x, y).
            key: the key of the case file that holds this length.
            shift: position of the label relative to the middle of the line.
            more: further text of the label.
        """
        self.keys |= {name.strip() for name in key.split(",")}
        arrow = {"arrowstyle": "<->", "color": KEY, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
        self.axes.annotate("", start, end, arrowprops=arrow, annotation_clip=False)
        middle = (np.add(start, end) / 2.0 + shift).tolist()
        self.text(middle[0], middle[1], key + more, KEY)

    def point(self, at: tuple[float, float], key: str, label: tuple[float, float]) -> None:
        """Label a place with a key, with a thin line from the label to the place."""
        self.keys |= {name.strip() for name in key.split(",")}
        arrow = {"arrowstyle": "-", "color": KEY, "lw": 0.6}
        self.axes.annotate(
            key, at, label, color=KEY, ha="center", va="center", size=8, arrowprops=arrow
        )

    def support(self, x: float, y: float) -> None:
        """Draw a pinned support whose top is at (x, y)."""
        triangle = [(x, y), (x - 0.14, y - 0.26), (x + 0.14, y - 0.26)]
        self.axes.add_patch(Polygon(triangle, fill=False))
        self.line((x - 0.22, y - 0.26), (x + 0.22, y - 0.26), width=1.5)

    def save(self, name: str, folder: Path) -> set[str]:
        """Write NAME.svg into a folder, and return the keys that it shows."""
        self.axes.autoscale_view()
        with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": name}):
            self.figure.savefig(
                folder / f"{name}.svg",
                bbox_inches="tight",
                facecolor="white",
                metadata={"Date": None},
            )
        return self.keys


def boom(folder: Path) -> set[str]:
    """Draw places along a boom: segments, joint, stations, support, load."""
    d = Drawing(8.0, 3.2)
    d.box(0, 0, 6.0, 1.0, OUTER)
    d.box(4.4, 0.14, 5.6, 0.72, INNER)
    d.text(2.2, 0.5, "outer segment", OUTER)
    d.text(8.2, 0.5, "inner segment", INNER)
    for x in (4.6, 5.8):
        for y in (0.0, 0.86):
            d.box(x - 0.15, y, 0.3, 0.14, PAD)
    d.support(0.0, 0.0)
    d.measure((0, 1.55), (6.0, 1.55), "length")
    d.measure((4.4, 2.2), (10.0, 2.2), "length")
    d.measure((6.0, 1.55), (10.0, 1.55), "extension")
    d.measure((4.4, -0.45), (6.0, -0.45), "overlap", (0, -0.2))
    d.keys.discard("overlap")
    d.measure((4.4, -1.0), (4.6, -1.0), "stations", (0.0, -0.25), " = [{ tail = 0.2 }, …")
    d.measure((5.8, -1.0), (6.0, -1.0), "head", (1.0, 0.0), " = 0.2")
    for x, top in ((0, 1.7), (6, 1.7), (4.4, 2.35), (10, 2.35)):
        d.line((x, -1.1 if x in (4.4, 6) else 0), (x, top), colour="#999999", width=0.5)
    d.text(4.4, 2.5, "tail")
    d.text(10.0, 2.5, "head, tip")
    d.text(6.25, 1.22, "head")
    arrow = {"arrowstyle": "->", "color": "k", "lw": 1.2}
    d.axes.annotate("", (0.9, -0.75), (0, -0.75), arrowprops=arrow)
    d.text(1.05, -0.75, "x")
    d.axes.annotate("", (0.0, 2.2), (0, 1.3), arrowprops=arrow)
    d.text(0.0, 2.35, "z")
    d.axes.annotate("", (9.6, 0.86), (9.6, 1.45), arrowprops={**arrow, "color": KEY})
    d.point((9.6, 1.45), "magnitude", (8.6, 1.25))
    d.text(8.6, 1.02, "(negative: down)", KEY)
    return d.save("boom", folder)


def station(folder: Path) -> set[str]:
    """Draw a cross-section at a station: walls, pads, play, shim, offset."""
    d = Drawing(7.0, 4.6)
    # Walls as filled plates: outer box 4 x 3.6, inner box 3 x 2.4, pads on the inner walls.
    for (w, h), t, colour in (((4.4, 4.0), 0.12, OUTER), ((3.2, 2.6), 0.1, INNER)):
        for y in (-h / 2, h / 2):
            d.box(-w / 2, y - t / 2, w, t, colour)
        for x in (-w / 2, w / 2):
            d.box(x - t / 2, -h / 2, t, h, colour)
    for side in (-1, 1):
        for x in (-1.4, 0.6):
            d.box(x, 1.35 if side > 0 else -1.75, 0.8, 0.4, PAD)
    top, bottom = 1.94, -1.94
    d.measure((-1.0, 1.75), (-1.0, top), "play_above", (-0.55, 0.0))
    d.measure((1.0, -1.75), (1.0, bottom), "play", (0.05, -0.38), " − play_above")
    d.measure((0.6, 1.1), (1.4, 1.1), "width", (0.0, -0.14))
    d.measure((1.4, 1.1), (1.6, 1.1), "offset", (-0.05, -0.36))
    d.measure((0.48, 1.35), (0.48, 1.75), "thickness", (-0.5, 0.0))
    d.line((1.6, 0.95), (1.6, 1.3), colour=KEY, width=0.5)
    d.measure((1.65, -0.2), (2.14, -0.2), "lateral_play_right", (1.35, 0.0))
    d.measure((-2.14, -0.7), (-1.65, -0.7), "lateral_play", (1.2, 0.0), "\n− lateral_play_right")
    d.measure((-2.6, -2.0), (-2.6, 2.0), "height", (-0.4, 0.0))
    d.measure((-2.2, -2.4), (2.2, -2.4), "width", (0.0, -0.18))
    for x in (-2.2, 2.2):
        d.line((x, -2.05), (x, -2.5), colour="#999999", width=0.5)
    for y in (-2.0, 2.0):
        d.line((-2.25, y), (-2.7, y), colour="#999999", width=0.5)
    d.point((2.6, 2.0), "flange", (3.2, 2.0))
    d.line((2.2, 2.0), (2.85, 2.0), colour=KEY, width=0.5)
    d.point((2.2, 1.2), "web", (2.9, 1.2))
    arrow = {"arrowstyle": "->", "color": "k", "lw": 1.0}
    d.axes.annotate("", (0.7, 0.0), (0, 0), arrowprops=arrow)
    d.axes.annotate("", (0, 0.7), (0, 0), arrowprops=arrow)
    d.text(0.82, 0.0, "y")
    d.text(0.0, 0.82, "z")
    return d.save("station", folder)


def pads(folder: Path) -> set[str]:
    """Draw an overlap from the side: length, shim and place of pads."""
    d = Drawing(7.0, 2.9)
    for y in (0.0, 2.2):
        d.box(0.0, y, 6.0, 0.1, OUTER)
    for y in (0.5, 1.7):
        d.box(1.2, y, 7.0, 0.1, INNER)
    d.box(1.2, 0.15, 0.9, 0.35, PAD)
    d.box(1.2, 1.8, 0.9, 0.25, PAD)
    d.box(5.1, 0.25, 0.9, 0.25, PAD)
    d.box(5.1, 1.8, 0.9, 0.25, PAD)
    d.measure((5.1, 1.45), (6.0, 1.45), "length", (0.0, -0.18))
    d.measure((1.0, 0.15), (1.0, 0.25), "shim", (-0.35, 0.0))
    d.line((1.0, 0.25), (2.3, 0.25), colour=KEY, width=0.5)
    d.line((1.0, 0.15), (2.3, 0.15), colour=KEY, width=0.5)
    d.measure((5.55, 2.05), (5.55, 2.2), "play_above", (1.1, 0.0))
    d.text(3.6, 1.1, "inner segment", INNER)
    d.text(3.6, 2.45, "outer segment", OUTER)
    for x, label, key in ((1.2, 'station "tail"', 1.2), (6.0, 'station "head"', 6.0)):
        d.line((x, -0.35), (x, 2.6), colour="#999999", width=0.5)
        d.text(key, -0.5, label)
    return d.save("pads", folder)


def cylinder(folder: Path) -> set[str]:
    """Draw a luffing cylinder with its lug, ground point and the pin of the foot."""
    d = Drawing(7.0, 3.4)
    d.box(0, 0, 7.0, 0.9, OUTER)
    d.line((-0.6, 0.45), (7.6, 0.45), colour="#777777", width=0.6)
    d.text(7.75, 0.45, "axis")
    lug, ground = (3.6, -0.7), (1.2, -2.6)
    d.line((3.3, 0.0), lug, (3.9, 0.0))
    d.line(lug, ground, width=3.5, colour="#333333")
    d.support(*ground)
    d.line((-0.2, 0.0), (0.0, -0.35), (0.2, 0.0))
    d.support(0.0, -0.35)
    d.measure((4.2, 0.45), (4.2, -0.7), "depth", (0.42, -0.2))
    d.line(lug, (4.35, -0.7), colour="#999999", width=0.5)
    d.measure((-0.5, 0.45), (-0.5, -0.35), "depth", (-1.1, 0.0), "\n(of the support)")
    d.line((0.0, -0.35), (-0.6, -0.35), colour="#999999", width=0.5)
    d.measure((0.0, 1.3), (3.6, 1.3), "x")
    d.line((3.6, 0.9), (3.6, 1.4), colour="#999999", width=0.5)
    d.line((0.0, 0.9), (0.0, 1.4), colour="#999999", width=0.5)
    d.measure((0.0, -3.15), (1.2, -3.15), "ground", (0.15, -0.22), "[0]")
    d.line((1.2, -2.6), (1.2, -3.25), colour="#999999", width=0.5)
    d.line((0.0, -0.6), (0.0, -3.25), colour="#999999", width=0.5)
    d.measure((5.6, 0.45), (5.6, -2.6), "ground", (0.9, 0.0), "[1] < 0")
    d.line((1.3, -2.6), (5.7, -2.6), colour="#999999", width=0.5)
    d.text(3.3, -1.75, "stiffness", KEY)
    d.keys.add("stiffness")
    return d.save("cylinder", folder)


def sections(folder: Path) -> set[str]:
    """Draw the shapes of a section by their mid-lines."""
    d = Drawing(8.0, 3.0)

    def outline(x: float, points: Sequence[tuple[float, float]], name: str) -> None:
        corners = [(x + y, z) for y, z in points]
        d.line(*corners, corners[0], colour=OUTER, width=2.5)
        d.text(x, -1.75, name)

    outline(0.0, [(-0.8, -1), (0.8, -1), (0.8, 1), (-0.8, 1)], '"box"')
    d.measure((-0.8, -1.25), (0.8, -1.25), "width", (0.0, -0.18))
    d.measure((-1.05, -1), (-1.05, 1), "height", (-0.38, 0.0))
    d.point((0.0, 1.0), "flange", (0.0, 1.4))
    d.point((0.8, 0.4), "web", (0.4, 0.4))
    outline(3.0, [(-0.8, -1), (0.8, -1), (0.8, 1), (-0.8, 1)], '"unequal box"')
    d.point((3.0, 1.0), "top", (3.0, 1.4))
    d.point((3.0, -1.0), "bottom", (3.0, -1.4))
    d.point((3.8, 0.4), "web", (3.4, 0.4))
    outline(5.9, [(-0.5, -1), (0.5, -1), (1, 0), (0.5, 1), (-0.5, 1), (-1, 0)], '"hexagon"')
    d.measure((5.4, 1.2), (6.4, 1.2), "flat", (0.0, 0.17))
    d.measure((4.9, 0.0), (6.9, 0.0), "width", (0.0, 0.17))
    c = 0.45
    octagon = [(-0.9 + c, -1), (0.9 - c, -1), (0.9, -1 + c), (0.9, 1 - c)]
    octagon += [(0.9 - c, 1), (-0.9 + c, 1), (-0.9, 1 - c), (-0.9, -1 + c)]
    outline(8.8, octagon, '"octagon"')
    d.measure((9.7 - c, 1.2), (9.7, 1.2), "chamfer", (0.1, 0.17))
    d.line((9.7, 0.5), (9.7, 1.3), colour="#999999", width=0.5)
    # A bend of three plates that touch the circle of the radius.
    radius, half = 0.7, np.pi / 12.0
    at = radius / np.cos(half) * np.array([1.0, 1.0, 1.0])
    turns = np.array([half, 3 * half, 5 * half]) - np.pi / 2.0
    right = [(0.9 - radius + r * np.cos(a), -1 + radius + r * np.sin(a)) for r, a in
             zip(at, turns, strict=True)]  # fmt: skip
    left = [(-y, z) for y, z in reversed(right)]
    outline(11.6, [*right, (0.9, 1), (-0.9, 1), *left], '"U"')
    d.measure((11.8, -0.3), (11.8 + 0.495, -0.795), "radius", (-0.42, 0.12))
    d.point((11.6 + right[1][0], right[1][1]), "facets", (12.9, -1.3))
    return d.save("sections", folder)


def draw(folder: Path = FOLDER) -> set[str]:
    """Write all drawings, and return the keys that they show."""
    folder.mkdir(exist_ok=True)
    return set().union(*(draw(folder) for draw in (boom, station, pads, cylinder, sections)))


if __name__ == "__main__":
    draw()
