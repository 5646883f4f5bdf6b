# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of a whole deformed boom, and of the first buckling mode of each segment."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from PIL import Image

from protractile.geometry.arrays import Array
from protractile.geometry.typography import join_words, number
from protractile.runs.report import theme
from protractile.runs.report.marks import marks_of
from protractile.runs.report.scene import (
    SECTION_DRAWN,
    Instant,
    Numbers,
    Scene,
)
from protractile.runs.report.sheet import (
    MATTE,
    SHEET,
    UNLIT,
    Camera,
    Sheet,
    Snapshot,
    sharp_edges,
    stage,
    surface,
)

PIXELS = (SHEET[0], 470)

# Percentile of the stresses at the end of the colour scale.
PERCENTILE = 99.0

# Pictures of buckling modes: size in pixels; length of the picture, and largest displacement in it,
# over the height of the section.
MODE_PIXELS = (SHEET[0], 560)
MODE_LENGTH, MODE_DRAWN = 4.0, 0.12


@dataclass(frozen=True, slots=True)
class BoomView:
    """View settings that all pictures of a boom have in common for comparison."""

    scene: Scene  #: scene of the boom in motion
    scale: float  #: magnification of displacements and play
    stresses: Mapping[float, Array]  #: stresses (num_points,) in MPa at each time in s
    largest: float  #: end of the colour scale of stresses in MPa
    camera: Camera  #: camera whose view contains the boom at every instant
    span: tuple[float, float]  #: smallest and largest x of the boom in m
    rest: Any  #: pyvista surface of the undeformed boom
    edges: Any  #: sharp edges of the undeformed boom

    @classmethod
    def of(cls, scene: Scene, instants: Sequence[Instant]) -> BoomView:
        """Return one view for the pictures at several instants."""
        times = [instant.time for instant in instants]
        heights = [displacement[:, 2] for displacement in scene.displacements(times)]
        low, high = min(0.0, np.min(heights)), max(0.0, np.max(heights))
        stresses = dict(zip(times, scene.point_stresses(times), strict=True))
        scale = scene.fitting_scale(times)
        rest = surface(scene.magnify(np.zeros_like(scene.points), scale), scene.triangles)
        begin, end = scene.reach(times)
        half = SECTION_DRAWN * scene.points[:, 2].max()
        off = max((symbol.clearance for symbol in scene.symbols), default=0.0)
        bottom, top = scale * min(low, -off) - 3.0 * half, scale * max(high, off) + 2.0 * half
        width = max(1.1 * (end - begin), (top - bottom) * PIXELS[0] / PIXELS[1])
        centre = np.array([0.5 * (begin + end), 0.0, 0.5 * (bottom + top)])
        return cls(
            scene=scene,
            scale=scale,
            stresses=stresses,
            # The ends of a colour scale must differ, even without stress.
            largest=float(np.percentile([*stresses.values()], PERCENTILE)) or 1.0,
            camera=Camera(centre, width, PIXELS, elevation=10.0),
            span=(begin, end),
            rest=rest,
            edges=sharp_edges(rest),
        )

    def places(self, displacement: Array, time: float) -> Array:
        """Return the displayed points (num_points, 3) for displacements (num_points, 3) in m."""
        places = self.scene.magnify(displacement, self.scale)
        places[:, 0] += self.scene.along(time)
        return places

    def edges_at(self, places: Array) -> Any:
        """Return the sharp edges of the boom at the displayed points, as a pyvista mesh."""
        edges = self.edges.copy()
        edges.points = places[edges["number"]]
        return edges

    def draw_marks(self, sheet: Sheet, places: Array) -> str:
        """Draw symbols and cylinders on a sheet, and return their legend."""
        marks = marks_of(self.scene, self.rest.points, self.scale, 0.0)
        for mark in marks:
            line = self.camera.project(mark.at(places))
            sheet.show_once(*sheet.picture.plot(*line.T, color=mark.color, linewidth=mark.width))
        return join_words(dict.fromkeys(mark.kind for mark in marks)) if marks else ""


def draw_boom(
    view: BoomView, instants: Sequence[Instant], until: float, pace: str = "", part: float = 1.0
) -> Iterator[Image.Image]:
    """Yield pictures of the deformed boom, each above the tip deflection over time.

    The curve of the tip ends at ``until`` in s. ``pace`` is the speed of an animation relative to
    real time, as text; ``part`` is the size factor of the sheet.
    """
    scene, camera = view.scene, view.camera
    time, tip = scene.motion["time"].values, 1.0e3 * scene.motion["tip"].values
    sheet = Sheet(camera.pixels, 325, part)
    sheet.mark_x(camera, *view.span)
    bar = sheet.colour_bar((1110, 150, 420, 40), view.largest, theme.STRESS)
    bar.set_label("von Mises stress (MPa)")
    crane = scene.crane
    curve = sheet.axes(150, 85, 820 if crane is None else 500, 150)
    if crane is not None:
        inset = sheet.axes(720, 20, 330, 190)
        crane.prepare(inset)
    curve.plot(time, tip, color=theme.FAINT, linewidth=2)
    curve.set(xlim=(time[0], until), xlabel="time (s)", ylabel="tip (mm)")
    with stage(camera.pixels, part) as plotter:
        # The undeformed boom is slightly farther from the camera, so that the deformed boom hides
        # it where both coincide.
        behind = view.edges_at(view.rest.points + np.array([0.0, 0.02, 0.0]))
        plotter.add_mesh(behind, color=theme.FAINT, line_width=3.0 * part, **UNLIT)
        boom = view.rest.copy()
        boom["stress"] = np.zeros(boom.n_points)
        colours = {"cmap": theme.STRESS, "clim": (0.0, view.largest)}
        plotter.add_mesh(boom, scalars="stress", **colours, **MATTE)
        edges = view.edges_at(boom.points)
        plotter.add_mesh(edges, color=theme.INK, line_width=2.4 * part, **UNLIT)
        displacements = scene.displacements([instant.time for instant in instants])
        for instant, displacement in zip(instants, displacements, strict=True):
            places = view.places(displacement, instant.time)
            boom.points, edges.points = places, places[edges["number"]]
            boom["stress"] = view.stresses[instant.time]
            sheet.show(camera.render(plotter))
            symbols = view.draw_marks(sheet, places)
            last = int(np.abs(time - instant.time).argmin())
            now: dict[str, Any] = {"color": theme.FORCE, "markersize": 13, "clip_on": False}
            sheet.show_once(
                *curve.plot(time[: last + 1], tip[: last + 1], color=theme.INK, linewidth=3),
                *curve.plot(time[last], tip[last], "o", **now),
            )
            sheet.write(
                instant.heading(scene),
                f"{'seen from above; ' if scene.from_above else ''}displacements and play × "
                f"{view.scale:g}, sections × {SECTION_DRAWN:g}\ngrey: undeformed"
                f"{', as at t = 0' if scene.boom.telescopes else ''}"
                f"{f'; symbols: {symbols}' if symbols else ''}{pace}",
            )
            if crane is not None:
                sheet.show_once(*crane.draw(inset, instant.time))
            yield sheet.image()


def render_buckling(
    views: Sequence[Scene], folder: Path, times: Sequence[float] | None = None
) -> list[Snapshot]:
    """Draw the first buckling mode of each segment: ``buckling-NUMBER.png``, from 1 on.

    If there are requested times, no modes are drawn, since they have no time.
    """
    scene = views[0]
    if scene.buckling is None or times is not None:
        return []
    data, snapshots = scene.buckling, []
    with rc_context(theme.PAGE_RC):
        for segment, factor in zip(
            data["buckled"].values.tolist(), data["buckling_factor"].values.tolist(), strict=True
        ):
            point_numbers = data["buckling_triangles"].values[
                data["buckling_segment"].values == segment
            ]
            used, triangles = np.unique(point_numbers, return_inverse=True)
            path, name = folder / f"buckling-{segment + 1}.png", scene.boom.segments[segment].name
            _draw_mode(
                f"{name}: buckling factor {number(factor)}",
                data["buckling_points"].values[used],
                triangles.reshape(-1, 3).astype(np.int32),
                data["buckling_shape"].values[used].astype(float),
                path,
            )
            caption = (
                f"The first buckling mode of the walls of {name!r} in {scene.model!r}, where they "
                "move most, in the static state with the largest tip deflection. The amplitude is "
                "arbitrary."
            )
            snapshots.append(Snapshot(path, f"Buckling of {name}", caption))
    return snapshots


def _draw_mode(heading: str, points: Array, triangles: Numbers, shape: Array, path: Path) -> None:
    """Draw a mode (num_points, 3) so that the wall which displaces most faces the viewer."""
    size = np.linalg.norm(shape, axis=1)
    most = int(size.argmax())
    height = float(np.ptp(points[:, 2]))
    # Mirroring brings this wall to the front and to the top.
    flip = np.where(points[most, 1:] * [1.0, -1.0] > 0.25 * height, -1.0, 1.0)
    sides = np.array([1.0, *flip])
    deformed_points = sides * (points + MODE_DRAWN * height * shape / size[most])
    half = 0.5 * MODE_LENGTH * height
    low, high = points[:, 0].min(), points[:, 0].max()
    middle = float(np.clip(points[most, 0], min(low + half, high), max(high - half, low)))
    near = np.abs(points[triangles, 0] - middle).max(axis=1) < half
    camera = Camera(
        np.array([middle, 0.0, 0.0]), 1.1 * MODE_LENGTH * height, MODE_PIXELS, elevation=30.0
    )
    sheet = Sheet(camera.pixels, 230)
    sheet.mark_x(camera, max(low, middle - half), min(high, middle + half))
    bar = sheet.colour_bar((1110, 100, 420, 40), 1.0, theme.DEFLECTION)
    bar.set_label("displacement over the largest")
    with stage(camera.pixels) as plotter:
        wall = surface(deformed_points, triangles[near])
        wall["size"] = size / size[most]
        plotter.add_mesh(
            wall, scalars="size", cmap=theme.DEFLECTION, clim=(0.0, 1.0), show_edges=True, **MATTE
        )
        edges = sharp_edges(surface(sides * points, triangles[near]))
        plotter.add_mesh(edges, color=theme.INK, line_width=2.4, **UNLIT)
        sheet.show(camera.render(plotter))
    orientation = " and ".join(np.array(["from behind", "upside down"])[flip < 0.0])
    text = f"; seen {orientation}" if orientation else ""
    sheet.write(heading, f"first mode, magnified{text}")
    sheet.image().save(path)
