# SPDX-License-Identifier: LGPL-3.0-or-later
"""The sections of a boom beside one another, to one scale."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from geometry.arrays import Array
from geometry.boom import Boom
from geometry.section import Plate, Section
from runs.report import theme

# So many sections can be seen beside one another.
MOST = 8
# m between two, as a part of the largest one's width.
GAP = 0.35


def shown_sections(boom: Boom) -> list[tuple[str, Section]]:
    """Colour and section of each segment whose plates are known."""
    return [
        (theme.PALETTE[number % len(theme.PALETTE)], segment.section)
        for number, segment in enumerate(boom.segments)
        if segment.section is not None
    ][:MOST]


def draw_sections(axes: Axes, sections: Sequence[tuple[str, Section]]) -> None:
    """Each with its plates as thick as they are, and its size in mm below."""
    widest = max(section.size("y") for _, section in sections)
    lowest = min(section.reach("z")[0] for _, section in sections)
    pitch = (1.0 + GAP) * widest
    small = 9.0 if len(sections) < 4 else 8.0
    for number, (color, section) in enumerate(sections):
        for plate in section.plates:
            corners = _thick(plate) + np.array([number * pitch, 0.0])
            axes.add_patch(Polygon(corners, closed=True, facecolor=color, edgecolor=color, lw=0.3))
        size = f"{1e3 * section.size('z'):.0f} × {1e3 * section.size('y'):.0f}"
        below = f"{size}\n{_walls(section)}"
        axes.annotate(
            below,
            (number * pitch, 1.03 * lowest),
            (0, -3),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=small,
        )
    axes.set_xlim(-0.6 * pitch, (len(sections) - 0.4) * pitch)
    highest = max(section.reach("z")[1] for _, section in sections)
    axes.set_ylim(1.6 * lowest, 1.05 * highest)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.set_title("sections to scale; mid-lines\nand walls in mm", fontsize=10.0)


def _thick(plate: Plate) -> Array:
    """(4, 2) corners of a plate as thick as it is, longer by half of that at both ends."""
    start, end = np.array(plate.start), np.array(plate.end)
    half = 0.5 * plate.thickness * plate.tangent
    across = np.array([-half[1], half[0]])
    start, end = start - half, end + half
    return np.array([start - across, end - across, end + across, start + across])


def _walls(section: Section) -> str:
    """How thick they are in mm, by name where webs, which carry what acts along z, differ."""
    webs = {number for number, _ in section.carriers("z")}
    thick = [round(1e3 * plate.thickness, 1) for plate in section.plates]
    web, flange = (
        ", ".join(f"{t:g}" for t in sorted({t for i, t in enumerate(thick) if (i in webs) == one}))
        for one in (True, False)
    )
    if not flange or web == flange:
        return web
    both = "flanges\n" if "," in flange else "flange "
    return f"web {web}\n{both}{flange}"
