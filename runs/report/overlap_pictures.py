# SPDX-License-Identifier: LGPL-3.0-or-later
"""Picture of the overlap with the largest contact force, cut open."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.patches import Patch
from PIL import Image

from protractile.geometry.arrays import Array
from protractile.geometry.typography import amount
from protractile.runs.report import theme
from protractile.runs.report.scene import SAME_PLACE, Instant, Overlap, Scene, round_scale
from protractile.runs.report.sheet import (
    MATTE,
    MESHED,
    SHEET,
    UNLIT,
    Camera,
    Sheet,
    sharp_edges,
    stage,
    surface,
)

# Limits of the magnified clearance and of magnified wall displacements relative to the outer
# segment, both as fractions of the height of the outer section; margin beside the stations in m.
CLEARANCE_DRAWN, DISPLACEMENT_DRAWN, MARGIN = 0.08, 0.25, 0.6

PIXELS = (SHEET[0], 625)

# A peak force is shown beside the mean if it exceeds the mean by this factor.
PEAK = 1.02

# Lengths in pixels of the shortest and the longest arrow; room for arrows above and below.
SHORTEST, LONGEST, ARROW_ROOM = 60.0, 110.0, 120.0


@dataclass(frozen=True)
class OverlapView:
    """Sectional view of an overlap at a time."""

    scene: Scene  #: scene of the boom in motion
    overlap: Overlap  #: an overlap of the scene
    time: float  #: time in s

    @classmethod
    def of_largest_force(cls, scenes: Sequence[Scene], time: float) -> OverlapView | None:
        """Return the view of the overlap with the largest contact force at a time in s.

        Return None if drives move all overlaps, since a view does not follow their stations.
        """
        views = [
            cls(scene, overlap, time)
            for scene in scenes
            for overlap in scene.overlaps
            if not scene.telescopes(overlap)
        ]
        return max(views, key=lambda view: float(np.abs(view.forces).max()), default=None)

    @cached_property
    def motion(self) -> xr.Dataset:
        """The trajectories at the stations of the overlap."""
        return self.scene.motion.isel(station=[station.index for station in self.overlap.stations])

    @property
    def forces(self) -> Array:
        """The contact forces (num_stations,) in N, 0 without contact."""
        now = self.motion["contact_force"].sel(time=self.time, method="nearest")
        return np.nan_to_num(now.values)

    @property
    def midpoint(self) -> float:
        """The x in m of the centre between the stations."""
        return 0.5 * (min(self.overlap.centres) + max(self.overlap.centres))

    @property
    def numbers(self) -> tuple[int, int]:
        """The numbers of the outer and the inner segment."""
        return self.overlap.outer, self.overlap.inner

    @cached_property
    def displacements(self) -> Array:
        """The displacements (num_points, 3) in m relative to the outer segment."""
        between = min(self.overlap.centres), max(self.overlap.centres)
        return self.scene.relative_displacements(self.time, self.overlap.outer, between)

    @cached_property
    def scale(self) -> float:
        """The largest round magnification within the limits for drawn displacements and play."""
        height = 2.0 * self.scene.half_height(self.overlap.outer)
        half = 0.5 * np.ptp(self.overlap.centres) + MARGIN
        near = np.abs(self.scene.points[:, 0] - self.midpoint) <= half
        near &= np.isin(self.scene.owner, self.numbers)
        largest = float(np.abs(self.displacements[near]).max())
        return round_scale(
            height
            * min(
                CLEARANCE_DRAWN / max(self.overlap.clearance, SAME_PLACE),
                DISPLACEMENT_DRAWN / max(largest, SAME_PLACE),
            )
        )

    @cached_property
    def places(self) -> Array:
        """The displayed points (num_points, 3) in m."""
        return self.scene.magnify(self.displacements, self.scale, 1.0)

    @cached_property
    def camera(self) -> Camera:
        """The camera, whose view contains the stations and the arrows."""
        flanges = [self.flange(self.overlap.outer, side) for side in (-1, 1)]
        heights = [_point_at(line, x)[2] for line in flanges for x in self.overlap.centres]
        low, high = min(heights), max(heights)
        room = (high - low + self.scene.wall(self.overlap)) * PIXELS[0]
        width = max(
            float(np.ptp(self.overlap.centres)) + 2.0 * MARGIN,
            room / (PIXELS[1] - 2.0 * ARROW_ROOM),
        )
        centre = np.array([self.midpoint, 0.0, 0.5 * (low + high)])
        return Camera(centre, width, PIXELS, elevation=8.0)

    def flange(self, segment: int, side: int) -> Array:
        """Return the displayed line (num_points, 3) in m where the cut meets a flange."""
        return np.asarray(self.places[self.scene.flange_in_plane(segment, side)])

    def draw_segments(self, plotter: Any) -> None:
        """Draw the half of both segments behind the cut, and the cut walls."""
        scene, wall = self.scene, self.scene.wall(self.overlap)
        corners = scene.points[scene.triangles]
        behind = (np.abs(corners[..., 0] - self.midpoint) < self.camera.width).all(axis=1)
        behind &= corners[..., 1].mean(axis=1) > 0.0
        for number, color in zip(self.numbers, (theme.OUTER, theme.INNER), strict=True):
            half = surface(self.places, scene.triangles[behind & (scene.segment == number)])
            plotter.add_mesh(half, color=color, **(MATTE | MESHED))
            for side in (-1, 1):
                cut = _band(self.flange(number, side), wall)
                plotter.add_mesh(cut, color=color, **UNLIT)
                plotter.add_mesh(sharp_edges(cut), color=theme.INK, line_width=4.0, **UNLIT)

    def draw_forces(self, sheet: Sheet) -> str:
        """Draw the forces of the inner on the outer segment; return a sentence on them."""
        if not self.forces.any():
            return "no contact here"
        strongest = np.abs(self.motion["contact_force"].values).max()
        interval = float(np.diff(self.motion["time"].values[:2])[0])
        meaning = f"forces: mean of the last {1.0e3 * interval:.3g} ms"
        peaks = self.motion["contact_force_peak"].sel(time=self.time, method="nearest").values
        for x, force, peak in zip(self.overlap.centres, self.forces, peaks, strict=True):
            if force == 0.0:
                continue
            side = int(np.sign(force))
            outside = _point_at(self.flange(self.overlap.outer, side), x)
            outside[2] += 0.5 * side * self.scene.wall(self.overlap)
            length = SHORTEST + (LONGEST - SHORTEST) * abs(force) / strongest
            text = amount(abs(force), "N")
            if abs(peak) >= PEAK * abs(force):
                text += f"\n(peak {amount(abs(peak), 'N')})"
            sheet.arrow(self.camera.project(outside), side * length, text)
        impact = (np.abs(peaks) >= PEAK * np.abs(self.forces)) & (self.forces != 0.0)
        return f"{meaning}; peak: maximum of a short impact" if impact.any() else meaning


def draw_overlap(scenes: Sequence[Scene], instant: Instant) -> Image.Image | None:
    """Draw the overlap with the largest contact force at an instant; None without one.

    The first scene is that from the side.
    """
    view = OverlapView.of_largest_force(scenes, instant.time)
    if view is None:
        return None
    outer, inner = (view.scene.boom.segments[number].name for number in view.numbers)
    labels = {theme.OUTER: outer, theme.INNER: inner, theme.FORCE: f"force of {inner} on {outer}"}
    view_name = "seen from above, " if view.scene.from_above else ""
    sheet, half = Sheet(PIXELS, floor=90), 0.475 * view.camera.width
    sheet.mark_x(view.camera, view.midpoint - half, view.midpoint + half)
    sheet.figure.legend(
        handles=[Patch(color=color, label=label) for color, label in labels.items()],
        loc="upper center",
        bbox_to_anchor=(0.5, 0.86),
        ncols=3,
        frameon=False,
    )
    with stage(PIXELS) as plotter:
        view.draw_segments(plotter)
        sheet.show(view.camera.render(plotter))
    sheet.entitle(instant.heading(scenes[0]))
    sheet.explain(
        f"{view_name}cut open; play and displacements relative to {outer} × {view.scale:g}, "
        f"walls not to scale\n{view.draw_forces(sheet)}",
    )
    return sheet.image()


def _band(line: Array, thickness: float) -> Any:
    """Return the cut wall along a line (num_points, 3) in m as a pyvista surface.

    It lies slightly in front of the cut, so that the walls do not hide it.
    """
    low, high = (line + np.array([0.0, -0.002, 0.5 * side * thickness]) for side in (-1.0, 1.0))
    number = np.arange(len(line) - 1, dtype=np.int32)
    quads = np.stack([number, number + 1, number + 1 + len(line), number + len(line)], axis=1)
    return surface(np.concatenate([low, high]), quads)


def _point_at(line: Array, x: float) -> Array:
    """Return the point (3,) in m of a line (num_points, 3) at x."""
    return np.array([np.interp(x, line[:, 0], line[:, i]) for i in range(3)])
