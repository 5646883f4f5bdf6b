# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of a whole deformed boom."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from PIL import Image

from protractile.geometry.arrays import Array
from protractile.geometry.typography import join_words
from protractile.runs.report import theme
from protractile.runs.report.marks import marks_of
from protractile.runs.report.scene import (
    SECTION_DRAWN,
    Instant,
    Scene,
)
from protractile.runs.report.sheet import (
    MATTE,
    SHEET,
    UNLIT,
    Camera,
    Sheet,
    sharp_edges,
    stage,
    surface,
)

PIXELS = (SHEET[0], 470)

# Percentile of the stresses at the end of the colour scale.
PERCENTILE = 99.0


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
    scale = ScalarMappable(Normalize(0.0, view.largest), theme.STRESS)
    bar = sheet.figure.colorbar(scale, cax=sheet.axes(1110, 150, 420, 40), orientation="horizontal")
    bar.set_label("von Mises stress (MPa)")
    curve = sheet.axes(150, 85, 820, 150)
    curve.plot(time, tip, color=theme.FAINT, linewidth=2)
    curve.set(xlim=(time[0], until), xlabel="time (s)", ylabel="tip (mm)")
    marks = marks_of(scene, view.rest.points, view.scale, 0.0)
    symbols = join_words(dict.fromkeys(mark.kind for mark in marks)) if marks else ""
    sheet.explain(
        f"{'seen from above; ' if scene.from_above else ''}displacements and play × "
        f"{view.scale:g}, sections × {SECTION_DRAWN:g}\ngrey: undeformed"
        f"{', as at t = 0' if scene.boom.telescopes else ''}"
        f"{f'; symbols: {symbols}' if symbols else ''}{pace}"
    )
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
            for mark in marks:
                line = camera.project(mark.at(places))
                sheet.show_once(
                    *sheet.picture.plot(*line.T, color=mark.color, linewidth=mark.width)
                )
            last = int(np.abs(time - instant.time).argmin())
            now: dict[str, Any] = {"color": theme.FORCE, "markersize": 13, "clip_on": False}
            sheet.show_once(
                *curve.plot(time[: last + 1], tip[: last + 1], color=theme.INK, linewidth=3),
                *curve.plot(time[last], tip[last], "o", **now),
            )
            sheet.entitle(instant.heading(scene))
            yield sheet.image()
