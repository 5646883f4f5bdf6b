# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of an overlap that is cut open: who presses whom."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.patches import Patch
from PIL import Image

from geometry.arrays import Array, Mask
from geometry.typography import digits
from shell_model.pictures import theme as theme
from shell_model.pictures.boom import Instant
from shell_model.pictures.deformation import SAME_PLACE, MovingShell, Overlap
from shell_model.pictures.theme import Camera, Scene, Sheet, Triangles, round_scale

# A clearance is drawn up to this part of the outer section's height; room in m beside the stations.
CLEARANCE_DRAWN, MARGIN = 0.08, 0.6

PIXELS = (theme.SHEET[0], 625)

# A peak that is not above its mean by this factor is the mean.
PEAK = 1.02

# Lengths of the arrows, and what is left for them above and below the section, in pixels.
SHORTEST, LONGEST, ARROW_ROOM = 60.0, 110.0, 120.0


class Look(NamedTuple):
    """How the halves of the boxes and the cut through the flanges are drawn."""

    half: Mapping[str, Any]
    cut: str


@dataclass(frozen=True, slots=True)
class OverlapView:
    """What the pictures of an overlap share.

    Args:
        shell: in motion.
        overlap: one of the shell's.
        pixels: width and height of the picture.
        scale: of displacements and play.
        width: of what is seen in m.
        behind: (num_triangles,) what is left when the half before the cut is taken away.
    """

    shell: MovingShell
    overlap: Overlap
    pixels: tuple[int, int]
    scale: float
    width: float
    behind: Mask

    @classmethod
    def of(
        cls,
        shell: MovingShell,
        instants: Sequence[Instant],
        overlap: Overlap,
        pixels: tuple[int, int],
    ) -> OverlapView:
        """The view that shows all stations of an overlap, and forces there at these instants."""
        half = shell.half_height(overlap.outer)
        scale = round_scale(CLEARANCE_DRAWN * 2.0 * half / max(overlap.clearance, SAME_PLACE))
        stations = shell.motion["station"].values[overlap.stations]
        flanges = [shell.flange_in_plane(overlap.outer, side) for side in (-1, 1)]
        tallest = 0.0
        between = (float(stations.min()), float(stations.max()))
        for instant in instants:
            places = shell.drawn(shell.beside(instant.time, overlap.outer, between), scale)
            tallest = max(tallest, np.ptp(_ends([places[line] for line in flanges], stations)))
        tallest += shell.wall(overlap)
        room = tallest * pixels[0] / (pixels[1] - 2.0 * ARROW_ROOM)
        width = max(float(np.ptp(stations)) + 2.0 * MARGIN, room)
        corners = shell.points[shell.triangles]
        middle = 0.5 * (stations.min() + stations.max())
        behind = (np.abs(corners[..., 0] - middle) < width).all(axis=1)
        behind &= corners[..., 1].mean(axis=1) > 0.0
        return cls(shell, overlap, pixels, scale, width, behind)

    @property
    def motion(self) -> xr.Dataset:
        """The trajectories, of the overlap's stations alone."""
        return self.shell.motion.isel(station=self.overlap.stations)

    @property
    def middle(self) -> float:
        """x between the stations in m."""
        stations = self.motion["station"].values
        return float(0.5 * (stations.min() + stations.max()))

    @property
    def names(self) -> tuple[str, str]:
        """Of the outer and of the inner segment."""
        return self.shell.names[self.overlap.outer], self.shell.names[self.overlap.inner]

    @property
    def explanation(self) -> str:
        """What one has to know to read lengths."""
        where = "seen from above, " if self.shell.from_above else ""
        return (
            f"{where}cut open; drawn: play and what moves beside {self.names[0]} × {self.scale:g}, "
            "walls not to scale"
        )

    def places(self, time: float) -> Array:
        """(num_points, 3) where the points are drawn at a time (s), in m."""
        stations = self.motion["station"].values
        between = (float(stations.min()), float(stations.max()))
        moved = self.shell.beside(time, self.overlap.outer, between)
        return self.shell.drawn(moved, self.scale)

    def camera(self, places: Array) -> Camera:
        """Looks at the outer segment where it is drawn, at its stations."""
        flanges = [places[self.shell.flange_in_plane(self.overlap.outer, side)] for side in (-1, 1)]
        height = np.mean(_ends(flanges, self.motion["station"].values))
        centre = np.array([self.middle, 0.0, height])
        return Camera(centre, self.width, self.pixels, elevation=8.0)

    def draw(
        self,
        scene: Scene,
        sheet: Sheet,
        time: float,
        looks: Mapping[int, Look],
        split: Callable[[Array, Triangles], tuple[Array, Triangles]] = lambda *same: same,
    ) -> None:
        """Put both segments and the forces between them on a sheet.

        Args:
            scene: in which they stand.
            sheet: gets the picture.
            time: in s.
            looks: of the outer and of the inner segment, by their numbers.
            split: what the points and triangles of a half box become before they are coloured.
        """
        shell, wall = self.shell, self.shell.wall(self.overlap)
        places = self.places(time)
        flanges = {}
        for number, look in looks.items():
            half_box = shell.triangles[self.behind & (shell.segment == number)]
            points, triangles = split(places, half_box)
            scene.surface(f"half {number}", points, triangles, **{**theme.MESHED, **look.half})
            for side in (-1, 1):
                line = flanges[number, side] = places[shell.flange_in_plane(number, side)]
                cut = _band(line, wall)
                scene.surface(f"cut {number} {side}", *cut, color=look.cut, lighting=False)
                rim = theme.sharp_edges(*cut)
                scene.outline(f"rim {number} {side}", cut[0], rim, theme.INK, 2.0)
        outer = {side: flanges[self.overlap.outer, side] for side in (-1, 1)}
        camera = self.camera(places)
        sheet.show(scene.seen_by(camera))
        sheet.mark_x(camera, self.middle - 0.475 * self.width, self.middle + 0.475 * self.width)
        self._draw_forces(sheet, camera, time, outer)

    def _draw_forces(
        self, sheet: Sheet, camera: Camera, time: float, outer: Mapping[int, Array]
    ) -> None:
        """Arrows at the flanges of the outer segment, lines (num_points, 3) by their side."""
        sheet.clear_arrows()
        strongest = np.abs(self.motion["contact_force"].values).max()
        now = self.motion.sel(time=time, method="nearest")
        forces = np.nan_to_num(now["contact_force"].values)
        peaks = now["contact_force_peak"].values
        for x, force, peak in zip(now["station"].values, forces, peaks, strict=True):
            if force == 0.0:
                continue
            side = int(np.sign(force))
            outside = _at(outer[side], x)
            outside[2] += 0.5 * side * self.shell.wall(self.overlap)
            sheet.arrow(
                camera.project(outside),
                side * (SHORTEST + (LONGEST - SHORTEST) * abs(force) / strongest),
                _forces(abs(force), abs(peak)),
            )

    def heading(self, instant: Instant) -> str:
        """What stands above a picture."""
        now = self.motion.sel(time=instant.time, method="nearest")
        return instant.heading(self.shell, float(now["tip"]))

    def forces_explained(self, time: float) -> str:
        """What the arrows' numbers are, or that there are none at a time (s)."""
        now = self.motion.sel(time=time, method="nearest")
        if not np.nan_to_num(now["contact_force"].values).any():
            return "no contact here"
        interval = float(np.diff(self.motion["time"].values[:2])[0])
        return (
            f"forces: mean of the last {1.0e3 * interval:.3g} ms; peak: what a blow reaches in it, "
            "for microseconds"
        )


def draw_overlap(
    shell: MovingShell, instants: Sequence[Instant], overlap: Overlap
) -> Iterator[Image.Image]:
    """An overlap without its half before the plane of bending, and what presses where."""
    view = OverlapView.of(shell, instants, overlap, PIXELS)
    sheet = Sheet(PIXELS, floor=90)
    sheet.figure.legend(
        handles=[
            Patch(color=theme.OUTER, label=view.names[0]),
            Patch(color=theme.INNER, label=view.names[1]),
            Patch(color=theme.FORCE, label=f"force of {view.names[1]} on {view.names[0]}"),
        ],
        loc="upper center",
        bbox_to_anchor=(0.5, 0.86),
        ncols=3,
        frameon=False,
    )
    looks = {
        overlap.outer: Look({"color": theme.OUTER}, theme.OUTER),
        overlap.inner: Look({"color": theme.INNER}, theme.INNER),
    }
    with Scene(PIXELS) as scene:
        for instant in instants:
            view.draw(scene, sheet, instant.time, looks)
            forces = view.forces_explained(instant.time)
            sheet.write(view.heading(instant), f"{view.explanation}\n{forces}")
            yield sheet.image()


def _forces(mean: float, peak: float) -> str:
    """In kN of forces in N, the peak where it is another number."""
    text = f"{digits(1e-3 * mean)} kN"
    return text if peak < PEAK * mean else f"{text}\n(peak {digits(1e-3 * peak)} kN)"


def _band(line: Array, thickness: float) -> tuple[Array, Triangles]:
    """Points and triangles of the wall that is cut along a line (num_points, 3), in m.

    A hair before the plane of bending, in which the halves of the boxes end.
    """
    halves = [line + np.array([0.0, -0.002, side * 0.5 * thickness]) for side in (-1.0, 1.0)]
    low = np.arange(len(line) - 1, dtype=np.int32)
    high = low + len(line)
    lower = np.stack([low, low + 1, high + 1], axis=1)
    upper = np.stack([low, high + 1, high], axis=1)
    return np.concatenate(halves), np.concatenate([lower, upper]).astype(np.int32)


def _ends(flanges: Sequence[Array], stations: Array) -> tuple[float, float]:
    """The lowest and the highest z in m of flanges, each (num_points, 3), at the stations."""
    heights = [_at(line, x)[2] for line in flanges for x in stations]
    return min(heights), max(heights)


def _at(line: Array, x: float) -> Array:
    """(3,) place in m at which a line (num_points, 3) passes x."""
    return np.array([np.interp(x, line[:, 0], line[:, i]) for i in range(3)])
