# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of what does not show in motion: the mesh, and how sections change their shape."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from PIL import Image

from geometry.typography import digits
from shell_model.pictures import theme as theme
from shell_model.pictures.boom import Instant
from shell_model.pictures.deformation import MovingShell, Overlap
from shell_model.pictures.theme import Camera, Scene, Sheet, round_scale

PIXELS = (theme.SHEET[0], 660)

# Degrees from which one looks down on a mesh, and metres to each side of the overlap.
ELEVATION, BESIDE = 28.0, 0.9

# Changes of shape are drawn up to this part of the outer section's height.
CHANGE_DRAWN = 0.05


def draw_mesh(shell: MovingShell, overlap: Overlap) -> Image.Image:
    """The triangles at an overlap; those walls of the outer segment that hide the inner one are
    left out.
    """
    corners = shell.points[shell.triangles]
    inside = shell.points[shell.members[overlap.inner], 0].min()
    outside = shell.points[shell.members[overlap.outer], 0].max()
    middle = 0.5 * (inside + outside)
    width = outside - inside + 2.0 * BESIDE
    shown = (np.abs(corners[..., 0] - middle) < 0.5 * width + 0.3).all(axis=1)
    _, across, up = shell.stress.outward.T
    hiding = (up > 0.5) | (across < -0.5)
    hiding &= corners[..., 0].mean(axis=1) > inside - 0.2
    sheet = Sheet(PIXELS, floor=90)
    counts = [int((shell.segment == n).sum()) for n in (overlap.outer, overlap.inner)]
    sheet.figure.legend(
        handles=[
            Patch(color=color, label=f"{name}: {count} triangles")
            for color, name, count in zip(
                (theme.OUTER, theme.INNER),
                (shell.names[n] for n in (overlap.outer, overlap.inner)),
                counts,
                strict=True,
            )
        ],
        loc="upper center",
        bbox_to_anchor=(0.5, 0.87),
        ncols=2,
        frameon=False,
    )
    camera = Camera(np.array([middle, 0.0, 0.0]), width, PIXELS, ELEVATION)
    with Scene(PIXELS) as scene:
        for number, color in ((overlap.outer, theme.OUTER), (overlap.inner, theme.INNER)):
            mine = shown & (shell.segment == number)
            if number == overlap.outer:
                mine &= ~hiding
            scene.surface(
                f"{number}", shell.points, shell.triangles[mine], color=color, **theme.MESHED
            )
        sheet.show(scene.seen_by(camera))
    sheet.mark_x(camera, middle - 0.45 * width, middle + 0.45 * width)
    edges = np.linalg.norm(np.roll(corners, 1, axis=1) - corners, axis=2)
    short = float(np.median(edges.min(axis=1)))
    sheet.write(
        "the mesh at the overlap, to scale",
        f"edges of {short:.2g} m; walls of the outer segment are taken away to show the inner "
        "one\nmesh lines lie where the segments touch and where the outer segment ends",
    )
    return sheet.image()


def draw_sections(shell: MovingShell, instant: Instant, overlap: Overlap) -> Image.Image:
    """How the sections at the stations of an overlap change their shape."""
    moved = shell.displacement(instant.time)
    motion = shell.motion.isel(station=overlap.stations)
    now = motion.sel(time=instant.time, method="nearest")
    stations = motion["station"].values
    outlines = {
        (number, x): shell.change_of_shape(moved, number, float(x))
        for x in stations
        for number in (overlap.outer, overlap.inner)
    }
    height = 2.0 * shell.half_height(overlap.outer)
    largest = max(float(np.abs(change).max()) for _, change in outlines.values())
    scale = round_scale(CHANGE_DRAWN * height / max(largest, 1.0e-12))
    size = theme.SHEET[0] / theme.DPI, theme.SHEET[1] / theme.DPI
    figure = Figure(figsize=size, dpi=theme.DPI)
    canvas: Any = FigureCanvasAgg(figure)
    axes = figure.subplots(1, stations.size, sharey=True, squeeze=False)[0]
    for panel, x in zip(axes, stations, strict=True):
        for number, color, name in (
            (overlap.outer, theme.OUTER, shell.names[overlap.outer]),
            (overlap.inner, theme.INNER, shell.names[overlap.inner]),
        ):
            places, change = outlines[number, x]
            panel.plot(*(1.0e3 * places).T, color=theme.FAINT, linewidth=1.5, linestyle="--")
            drawn = 1.0e3 * (places + scale * change)
            panel.plot(*drawn.T, color=color, linewidth=4.0, label=name)
        force = float(np.nan_to_num(now["contact_force"].sel(station=x).values))
        where = {1.0: "above", -1.0: "below", 0.0: ""}[float(np.sign(force))]
        touch = f"contact {where} with {digits(1e-3 * abs(force))} kN" if force else "no contact"
        panel.set_title(f"x = {x:g} m: {touch}")
        panel.set(aspect="equal", xlabel="y (mm)")
    axes[0].set_ylabel("z (mm)")
    handles, labels = axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=2, frameon=False)
    figure.subplots_adjust(left=0.09, right=0.98, top=0.78, bottom=0.19, wspace=0.08)
    figure.text(
        0.5,
        0.98,
        instant.heading(shell, float(now["tip"])),
        size=26,
        weight="bold",
        ha="center",
        va="top",
    )
    figure.text(
        0.5,
        0.925,
        f"sections at the stations; drawn: changes of shape × {scale:g}, "
        "without what moves and turns each section as a whole\n"
        f"straight from node to node; dashed: at rest; largest change {1.0e3 * largest:.2g} mm",
        size=19,
        ha="center",
        va="top",
    )
    canvas.draw()
    return Image.fromarray(np.asarray(canvas.buffer_rgba())[..., :3].copy())
