# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of docs/gallery.md from finished runs.

``python -m studies.gallery`` writes docs/gallery from the folders ``paper``, ``spatial``,
``three-segments`` and ``convergence`` of runs/out, which ``make verify convergence`` writes, and
``hoist-sweep``, ``slew-sweep`` and ``chart-crane-chart``, which ``make gallery`` writes.
"""

from __future__ import annotations

import csv
import sys
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from matplotlib import pyplot as plt
from matplotlib import rc_context
from matplotlib.patches import Patch
from PIL import Image

from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_MILLI, amount
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.folder.files import atomic_path
from protractile.runs.pipeline.results import FIELDS, Results, read_fields
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.terminal import show_notices
from protractile.runs.report import theme
from protractile.runs.report.boom_drawing import save_drawing
from protractile.runs.report.opengl import require_opengl
from protractile.runs.report.scene import (
    SAME_PLACE,
    Instant,
    Overlap,
    Scene,
    rigid_motion,
    round_scale,
)
from protractile.runs.report.sheet import MATTE, MESHED, SHEET, Camera, Sheet, stage, surface

RUNS, GALLERY = Path("runs/out"), Path("docs/gallery")
MODEL = "shell"

# View of the mesh: elevation in degrees, and metres to each side of the overlap.
PIXELS, ELEVATION, BESIDE = (SHEET[0], 660), 28.0, 0.9

# Limit of the drawn distortion of sections, as a fraction of the outer section's height.
CHANGE_DRAWN = 0.05

# Run and file of each picture of the gallery.
COPIED = {
    "boom-first-peak": ("paper", "snapshots/boom-first-peak.png"),
    "stress-history": ("paper", f"figures/stress-{MODEL}.png"),
    "space-from-the-side": ("spatial", "snapshots/boom-first-peak.png"),
    "space-from-above": ("spatial", "snapshots/boom-above-first-peak.png"),
    "three-segments": ("three-segments", "snapshots/boom-first-peak.png"),
    "benchmarks": ("convergence", "figures/benchmarks.png"),
    "load-chart": ("chart-crane-chart", "figures/over-radius.png"),
}


def pictures(runs: Path) -> Iterator[tuple[str, Image.Image]]:
    """Yield the name and the image of each picture, from a folder with the folders of runs.

    Raises:
        BadInput: a run or one of its pictures is missing.
    """
    for name, (run, picture) in COPIED.items():
        path = runs / run / picture
        if not path.is_file():
            raise BadInput(
                str(path), "file", "missing; run the case with its shell, or make verify"
            )
        yield name, Image.open(path).convert("RGB")
    with TemporaryDirectory() as folder:
        drawing = Path(folder) / "lift.png"
        case = str(CASES / "lift.toml")
        save_drawing(case_file.load(case), case, str(drawing))
        yield "lift", Image.open(drawing).convert("RGB")
    yield "crane-speeds", draw_speeds(runs)
    results = Results.load(runs / "paper")
    motion = results.trajectories.sel(model=MODEL)
    scene = Scene.views(read_fields(runs / "paper" / FIELDS), motion, results.case)[0]
    (overlap,) = scene.overlaps
    require_opengl()
    with rc_context(theme.PAGE_RC):
        yield "mesh", draw_mesh(scene, overlap)
        force = abs(motion["contact_force_peak"]).max("station")
        instant = Instant(float(force["time"][force.argmax()]), "largest contact force")
        yield "sections-largest-force", draw_sections(scene, instant, overlap)


def draw_speeds(runs: Path) -> Image.Image:
    """Draw φ₂ over the hoisting speed, and the swing of the load over the slewing speed.

    Raises:
        BadInput: a sweep is missing.
    """
    panels = (
        ("hoist", "hoist.speed", "rope_factor", 1.3, "speed of hoisting (m/s)", "factor φ₂"),
        ("slew", "slew.speed", "swing_aside", 1.0, "speed of slewing (deg/s)", "swing aside (m)"),
    )
    with rc_context(theme.RC):
        sheet, axes = plt.subplots(1, len(panels), figsize=(8.1, 3.2), layout="constrained")
        for panel, (case, key, quantity, limit, along, up) in zip(axes, panels, strict=True):
            path = runs / f"{case}-sweep" / "sweep.csv"
            if not path.is_file():
                raise BadInput(str(path), "file", "missing; run make gallery")
            with path.open(newline="", encoding="utf-8") as file:
                rows = [(float(row[key]), float(row[quantity])) for row in csv.DictReader(file)]
            panel.plot(*zip(*rows, strict=True), "o-", color=theme.INNER)
            panel.axhline(limit, color=theme.INK, linewidth=1.2, linestyle=":")
            panel.set(xlabel=along, ylabel=up)
        drawn = BytesIO()
        sheet.savefig(drawn, dpi=100)
        plt.close(sheet)
    return Image.open(drawn).convert("RGB")


def draw_mesh(scene: Scene, overlap: Overlap) -> Image.Image:
    """Draw the triangles at an overlap without the outer walls that hide the inner segment."""
    assert scene.stress is not None
    corners = scene.points[scene.triangles]
    inside = scene.points[scene.owner == overlap.inner, 0].min()
    outside = scene.points[scene.owner == overlap.outer, 0].max()
    middle, width = 0.5 * (inside + outside), outside - inside + 2.0 * BESIDE
    shown = (np.abs(corners[..., 0] - middle) < 0.5 * width + 0.3).all(axis=1)
    _, across, up = scene.stress.outward.T
    hiding = (scene.segment == overlap.outer) & ((up > 0.5) | (across < -0.5))
    shown &= ~(hiding & (corners[..., 0].mean(axis=1) > inside - 0.2))
    sheet = Sheet(PIXELS, floor=90)
    camera = Camera(np.array([middle, 0.0, 0.0]), width, PIXELS, ELEVATION)
    legend = []
    with stage(PIXELS) as plotter:
        for number, color in ((overlap.outer, theme.OUTER), (overlap.inner, theme.INNER)):
            mine = scene.segment == number
            half = surface(scene.points, scene.triangles[mine & shown])
            plotter.add_mesh(half, color=color, **(MATTE | MESHED))
            label = f"{scene.boom.segments[number].name}: {mine.sum()} triangles"
            legend.append(Patch(color=color, label=label))
        sheet.show(camera.render(plotter))
    sheet.figure.legend(
        handles=legend, loc="upper center", bbox_to_anchor=(0.5, 0.87), ncols=2, frameon=False
    )
    sheet.mark_x(camera, middle - 0.45 * width, middle + 0.45 * width)
    edges = np.linalg.norm(np.roll(corners, 1, axis=1) - corners, axis=2)
    sheet.entitle("the mesh at the overlap, to scale")
    sheet.explain(
        f"edges of {np.median(edges.min(axis=1)):.2g} m; walls of the outer segment are taken away "
        "to show the inner one\nmesh lines lie where the segments touch and where the outer "
        "segment ends",
    )
    return sheet.image()


def draw_sections(scene: Scene, instant: Instant, overlap: Overlap) -> Image.Image:
    """Draw the distortion of the sections at the stations of an overlap."""
    moved = scene.displacement(instant.time)
    now = scene.motion.isel(station=[one.index for one in overlap.stations]).sel(
        time=instant.time, method="nearest"
    )
    stations = now["station"].values.tolist()
    both = {overlap.outer: theme.OUTER, overlap.inner: theme.INNER}
    outlines = {(n, x): change_of_shape(scene, moved, n, x) for x in stations for n in both}
    height = 2.0 * scene.half_height(overlap.outer)
    largest = max(float(np.abs(change).max()) for _, change in outlines.values())
    scale = round_scale(CHANGE_DRAWN * height / max(largest, 1.0e-12))
    sheet = Sheet(PIXELS, floor=90)
    sheet.picture.remove()
    panels = sheet.figure.subplots(1, len(stations), sharey=True, squeeze=False)[0]
    forces = np.nan_to_num(now["contact_force"].values)
    for panel, x, force in zip(panels, stations, forces, strict=True):
        for number, color in both.items():
            places, change = outlines[number, x]
            at_rest = {"color": theme.FAINT, "linewidth": 1.5, "linestyle": "--"}
            panel.plot(*(TO_MILLI * places).T, **at_rest)
            drawn = TO_MILLI * (places + scale * change)
            name = scene.boom.segments[number].name
            panel.plot(*drawn.T, color=color, linewidth=4.0, label=name)
        where = "above" if force > 0.0 else "below"
        touch = f"contact {where} with {amount(abs(force), 'N')}" if force else "no contact"
        panel.set_title(f"x = {x:g} m: {touch}")
        panel.set(aspect="equal", xlabel="y (mm)")
    panels[0].set_ylabel("z (mm)")
    handles, labels = panels[0].get_legend_handles_labels()
    sheet.figure.legend(handles, labels, loc="lower center", ncols=2, frameon=False)
    sheet.figure.subplots_adjust(left=0.09, right=0.98, top=0.78, bottom=0.19, wspace=0.08)
    sheet.entitle(instant.heading(scene))
    sheet.explain(
        f"sections at the stations; drawn: changes of shape × {scale:g}, "
        "without what moves and turns each section as a whole\n"
        f"straight from node to node; dashed: undeformed; "
        f"largest change {TO_MILLI * largest:.2g} mm",
    )
    return sheet.image()


def change_of_shape(scene: Scene, moved: Array, segment: int, x: float) -> tuple[Array, Array]:
    """Return y and z in m of a closed outline, and its distortion, (num_points + 1, 2) each.

    The rigid motion of the section is subtracted. ``moved`` (num_points, 3) are displacements in
    m, ``x`` is the x of a mesh line in m.
    """
    assert scene.stress is not None
    walls = (scene.segment == segment) & (scene.stress.wall < len(scene.stress.plates[segment]))
    mine = np.unique(scene.triangles[walls])
    mine = mine[np.abs(scene.points[mine, 0] - x) < SAME_PLACE]
    places, change = scene.points[mine, 1:], moved[mine, 1:]
    across, up, turn = rigid_motion(places, change)
    change = change - np.stack([across - turn * places[:, 1], up + turn * places[:, 0]], axis=1)
    order = np.arctan2(places[:, 1], places[:, 0]).argsort()
    around = np.append(order, order[0])
    return places[around], change[around]


def main() -> int:
    """Write the gallery; return the exit status."""
    show_notices()
    GALLERY.mkdir(parents=True, exist_ok=True)
    try:
        for name, picture in pictures(RUNS):
            path = GALLERY / f"{name}.png"
            with atomic_path(path) as part:
                # A page loads all of them; more colours are not visible.
                picture.quantize(256).save(part, format="PNG", optimize=True)
            print(f"{path}  {path.stat().st_size // 1000} kB")
    except BadInput as error:
        print(f"gallery: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
