# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of the first buckling mode of each segment of a shell, at its largest displacement."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib import rc_context
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from geometry.arrays import Array
from runs.report import theme
from runs.report.formatting import number
from runs.report.scene import Numbers, Scene
from runs.report.sheet import MATTE, SHEET, Camera, Sheet, sharp_edges, stage, surface

PIXELS = (SHEET[0], 560)

# Length of the picture, and largest displacement in it, over the height of the section.
_LENGTH, _DRAWN = 4.0, 0.12


def render_buckling(
    views: Sequence[Scene], folder: Path, times: Sequence[float] | None = None
) -> list[Path]:
    """Draw the first buckling mode of each segment: ``buckling-NUMBER.png``, from 1 on.

    Args:
        views: scenes of a shell, see :meth:`Scene.views`.
        folder: folder of the pictures.
        times: requested times; if there are any, no modes are drawn, since they have no time.
    """
    scene = views[0]
    if scene.buckling is None or times is not None:
        return []
    data, paths = scene.buckling, []
    with rc_context(theme.PAGE_RC):
        for segment, factor in zip(
            data["buckled"].values.tolist(), data["buckling_factor"].values.tolist(), strict=True
        ):
            point_numbers = data["buckling_triangles"].values[
                data["buckling_segment"].values == segment
            ]
            used, triangles = np.unique(point_numbers, return_inverse=True)
            paths.append(folder / f"buckling-{segment + 1}.png")
            _draw(
                f"{scene.boom.segments[segment].name}: buckling factor {number(factor)}",
                data["buckling_points"].values[used],
                triangles.reshape(-1, 3).astype(np.int32),
                data["buckling_shape"].values[used].astype(float),
                paths[-1],
            )
    return paths


def _draw(heading: str, points: Array, triangles: Numbers, shape: Array, path: Path) -> None:
    """Draw a mode (num_points, 3) with the wall of its largest displacement in front."""
    size = np.linalg.norm(shape, axis=1)
    most = int(size.argmax())
    height = float(np.ptp(points[:, 2]))
    # Mirror images turn this wall to the front and to the top.
    flip = np.where(points[most, 1:] * [1.0, -1.0] > 0.25 * height, -1.0, 1.0)
    sides = np.array([1.0, *flip])
    moved = sides * (points + _DRAWN * height * shape / size[most])
    half = 0.5 * _LENGTH * height
    low, high = points[:, 0].min(), points[:, 0].max()
    middle = float(np.clip(points[most, 0], min(low + half, high), max(high - half, low)))
    near = np.abs(points[triangles, 0] - middle).max(axis=1) < half
    camera = Camera(np.array([middle, 0.0, 0.0]), 1.1 * _LENGTH * height, PIXELS, elevation=30.0)
    sheet = Sheet(camera.pixels, 230)
    sheet.mark_x(camera, max(low, middle - half), min(high, middle + half))
    bar = sheet.figure.colorbar(
        ScalarMappable(Normalize(0.0, 1.0), theme.DEFLECTION),
        cax=sheet.axes(1110, 100, 420, 40),
        orientation="horizontal",
    )
    bar.set_label("displacement over the largest")
    with stage(camera.pixels) as plotter:
        wall = surface(moved, triangles[near])
        wall["size"] = size / size[most]
        plotter.add_mesh(
            wall, scalars="size", cmap=theme.DEFLECTION, clim=(0.0, 1.0), show_edges=True, **MATTE
        )
        edges = sharp_edges(surface(sides * points, triangles[near]))
        plotter.add_mesh(edges, color=theme.INK, line_width=2.4, lighting=False)
        sheet.show(camera.render(plotter))
    seen = " and ".join(
        name
        for name, turned in zip(("from behind", "upside down"), flip < 0.0, strict=True)
        if turned
    )
    sheet.write(heading, f"first mode, magnified{f'; seen {seen}' if seen else ''}")
    sheet.image().save(path)
