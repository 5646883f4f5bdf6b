# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two pictures of a deformed shell: the whole boom, and an overlap cut open."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.patches import Patch
from PIL import Image

from shell_model import picture_theme as theme
from shell_model.deformation import SAME_PLACE, MovingShell, Overlap, round_scale
from shell_model.picture_theme import Camera, Scene, Sheet, Triangles

Array = npt.NDArray[np.float64]

# The whole boom: displacements are drawn up to this part of its length, sections so many times
# larger, of which the play takes up to this part.
DISPLACEMENT_DRAWN, SECTION_DRAWN, PLAY_OF_SECTION = 0.2, 2.0, 0.5

# An overlap: a clearance is drawn up to this part of the outer section's height; room in m beside
# the stations.
CLEARANCE_DRAWN, MARGIN = 0.08, 0.6

BOOM_PIXELS, OVERLAP_PIXELS = (theme.SHEET[0], 470), (theme.SHEET[0], 625)


class Instant(NamedTuple):
    """A time in s, and what happens then."""

    time: float
    title: str = ""

    def heading(self, tip: float) -> str:
        """What stands above a picture; ``tip`` is its deflection in m."""
        title = f"{self.title}:  " if self.title else ""
        return f"{title}t = {self.time:.3f} s,  tip {1.0e3 * tip:+.1f} mm"


@dataclass(frozen=True, slots=True)
class BoomView:
    """What the pictures of a boom share, so that they can be compared.

    Args:
        scale: of displacements and play.
        deflections: the smallest and the largest one in mm.
        camera: sees the boom at every instant.
    """

    scale: float
    deflections: tuple[float, float]
    camera: Camera

    @classmethod
    def of(cls, shell: MovingShell, instants: Iterable[Instant]) -> BoomView:
        """The view for pictures of these instants."""
        low, high = 0.0, SAME_PLACE
        for instant in instants:
            deflection = shell.displacement(instant.time)[:, 2]
            low, high = min(low, deflection.min()), max(high, deflection.max())
        begin, end = shell.points[:, 0].min(), shell.points[:, 0].max()
        half = SECTION_DRAWN * shell.points[:, 2].max()
        play = sum(overlap.clearance for overlap in shell.overlaps)
        scale = round_scale(
            min(
                DISPLACEMENT_DRAWN * (end - begin) / max(high, -low),
                PLAY_OF_SECTION * half / max(play, SAME_PLACE),
            )
        )
        bottom, top = scale * low - 3.0 * half, scale * high + 2.0 * half
        width = max(1.1 * (end - begin), (top - bottom) * BOOM_PIXELS[0] / BOOM_PIXELS[1])
        centre = np.array([0.5 * (begin + end), 0.0, 0.5 * (bottom + top)])
        camera = Camera(centre, width, BOOM_PIXELS, elevation=10.0)
        return cls(scale, (1.0e3 * low, 1.0e3 * high), camera)


def draw_boom(
    shell: MovingShell, instants: Iterable[Instant], view: BoomView, until: float
) -> Iterator[Image.Image]:
    """The deformed boom, above the deflection of its tip in time.

    Args:
        shell: in motion.
        instants: of the pictures.
        view: scale, colours, camera.
        until: last time in s of the tip's curve.
    """
    camera = view.camera
    time, tip = shell.motion["time"].values, shell.motion["tip"].values
    sheet = Sheet(camera.pixels, floor=325)
    sheet.mark_x(camera, shell.points[:, 0].min(), shell.points[:, 0].max())
    bar = sheet.figure.colorbar(
        ScalarMappable(Normalize(*view.deflections), theme.DEFLECTION),
        cax=sheet.axes(1110, 150, 420, 40),
        orientation="horizontal",
    )
    bar.set_label("deflection (mm)")
    curve = sheet.axes(150, 85, 820, 150)
    curve.plot(time, 1.0e3 * tip, color=theme.FAINT, linewidth=2)
    (past,) = curve.plot([], [], color=theme.INK, linewidth=3)
    (now,) = curve.plot([], [], "o", color=theme.FORCE, markersize=13, clip_on=False)
    curve.set(xlim=(time[0], until), xlabel="time (s)", ylabel="tip (mm)")
    with Scene(camera.pixels) as scene:
        # A little behind the boom, or it would shine through where that hardly moves.
        rest = shell.drawn(np.zeros_like(shell.points), view.scale, SECTION_DRAWN)
        rest[:, 1] += 0.02
        scene.outline("rest", rest, shell.triangles, theme.FAINT, 1.5)
        for number, held in enumerate(shell.supports()):
            scene.surface(f"support {number}", *_wedge(held, SECTION_DRAWN), color=theme.INK)
        for instant in instants:
            moved = shell.displacement(instant.time)
            places = shell.drawn(moved, view.scale, SECTION_DRAWN)
            scene.surface(
                "boom",
                places,
                shell.triangles,
                scalars=1.0e3 * moved[:, 2],
                cmap=theme.DEFLECTION,
                clim=view.deflections,
            )
            scene.outline("edges", places, shell.triangles, theme.INK, 1.2)
            sheet.show(scene.seen_by(camera))
            last = int(np.abs(time - instant.time).argmin())
            past.set_data(time[: last + 1], 1.0e3 * tip[: last + 1])
            now.set_data(time[[last]], 1.0e3 * tip[[last]])
            sheet.write(
                instant.heading(float(tip[last])),
                f"drawn: displacements and play × {view.scale:g}, sections × {SECTION_DRAWN:g}; "
                "grey: at rest; black: supports",
            )
            yield sheet.image()


def _wedge(held: Array, section: float) -> tuple[Array, Triangles]:
    """Points and triangles of a support: a prism whose edge carries the bottom flange.

    Args:
        held: (num_points, 3) in m, the outline that is held.
        section: how many times larger sections are drawn.
    """
    x, y, z = held[0, 0], section * held[:, 1].max(), section * held[:, 2].min()
    size = 0.7 * abs(z)
    profile = np.array([[x, z], [x - size, z - 2.0 * size], [x + size, z - 2.0 * size]])
    points = np.array([[px, across, pz] for across in (-y, y) for px, pz in profile])
    sides = [(0, 3, 4), (0, 4, 1), (1, 4, 5), (1, 5, 2), (2, 5, 3), (2, 3, 0)]
    return points, np.array([(0, 1, 2), (3, 5, 4), *sides], dtype=np.int32)


def draw_overlap(
    shell: MovingShell, instants: Iterable[Instant], overlap: Overlap
) -> Iterator[Image.Image]:
    """An overlap without its half before the plane of bending, and what presses where.

    Args:
        shell: in motion.
        instants: of the pictures.
        overlap: one of the shell's.
    """
    motion = shell.motion.isel(station=overlap.stations)
    stations = motion["station"].values
    strongest = np.abs(motion["contact_force"].values).max()
    interval = float(np.diff(motion["time"].values[:2])[0])
    half, wall = shell.half_height(overlap.outer), shell.wall(overlap)
    scale = round_scale(CLEARANCE_DRAWN * 2.0 * half / max(overlap.clearance, SAME_PLACE))
    middle = 0.5 * (stations[0] + stations[-1])
    # Above and below the section, half its height is left for the forces at least.
    room = 4.0 * half * OVERLAP_PIXELS[0] / OVERLAP_PIXELS[1]
    width = max(float(np.ptp(stations)) + 2.0 * MARGIN, room)
    corners = shell.points[shell.triangles]
    behind = (np.abs(corners[..., 0] - middle) < width).all(axis=1)
    behind &= corners[..., 1].mean(axis=1) > 0.0

    sheet = Sheet(OVERLAP_PIXELS, floor=90)
    sheet.figure.legend(
        handles=[
            Patch(color=theme.OUTER, label="outer segment"),
            Patch(color=theme.INNER, label="inner segment"),
            Patch(color=theme.FORCE, label="force of the inner segment on the outer one"),
        ],
        loc="upper center",
        bbox_to_anchor=(0.5, 0.86),
        ncols=3,
        frameon=False,
    )
    with Scene(OVERLAP_PIXELS) as scene:
        for instant in instants:
            places = shell.drawn(shell.displacement(instant.time), scale)
            flanges = {}
            for number, color in ((overlap.outer, theme.OUTER), (overlap.inner, theme.INNER)):
                half_box = shell.triangles[behind & (shell.segment == number)]
                scene.surface(f"half {number}", places, half_box, color=color, **theme.MESHED)
                for side in (-1, 1):
                    line = flanges[number, side] = places[shell.flange_in_plane(number, side)]
                    cut = _band(line, wall)
                    scene.surface(f"cut {number} {side}", *cut, color=color, lighting=False)
                    scene.outline(f"rim {number} {side}", *cut, theme.INK, 2.0)
            height = np.mean([_at(line, middle)[2] for line in flanges.values()])
            camera = Camera(np.array([middle, 0.0, height]), width, OVERLAP_PIXELS, elevation=8.0)
            sheet.show(scene.seen_by(camera))
            sheet.mark_x(camera, middle - 0.475 * width, middle + 0.475 * width)
            sheet.clear_arrows()
            now = motion.sel(time=instant.time, method="nearest")
            forces = np.nan_to_num(now["contact_force"].values)
            for x, force, peak in zip(
                stations, forces, now["contact_force_peak"].values, strict=True
            ):
                if force == 0.0:
                    continue
                side = int(np.sign(force))
                outside = _at(flanges[overlap.outer, side], x)
                outside[2] += 0.5 * side * wall
                sheet.arrow(
                    camera.project(outside),
                    side * (50.0 + 60.0 * abs(force) / strongest),
                    f"{abs(force) / 1.0e3:.3g} kN\n(peak {abs(peak) / 1.0e3:.3g} kN)",
                )
            touching = "" if forces.any() else ",  no contact"
            sheet.write(
                instant.heading(float(now["tip"])) + touching,
                f"cut open; drawn: displacements and play × {scale:g}, walls not to scale\n"
                f"forces: mean of the last {1.0e3 * interval:.3g} ms, and the peak in them",
            )
            yield sheet.image()


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


def _at(line: Array, x: float) -> Array:
    """(3,) place in m at which a line (num_points, 3) passes x."""
    return np.array([np.interp(x, line[:, 0], line[:, i]) for i in range(3)])
