# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of a whole deformed boom, and what all pictures of a shell say about their time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from PIL import Image

from geometry.arrays import Array
from geometry.typography import signed
from shell_model.pictures import theme as theme
from shell_model.pictures.deformation import (
    DOWN,
    MASS,
    SAME_PLACE,
    SPRING,
    UP,
    Lug,
    MovingShell,
    Sign,
    Stop,
)
from shell_model.pictures.theme import Camera, Scene, Sheet, Triangles, round_scale, sharp_edges

# The whole boom: displacements are drawn up to this part of its length, sections so many times
# larger, of which the play takes up to this part.
DISPLACEMENT_DRAWN, SECTION_DRAWN, PLAY_OF_SECTION = 0.2, 2.0, 0.5

PIXELS = (theme.SHEET[0], 470)

# Lengths in pixels of what a mass hangs by, and of arrows.
ROPE, PUSH = 34.0, 60.0


class Instant(NamedTuple):
    """A time in s, and what happens then."""

    time: float
    title: str = ""

    def heading(self, shell: MovingShell, tip: float) -> str:
        """What stands above a picture of a shell whose tip deflects by so much (m)."""
        title = f"{self.title}:  " if self.title else ""
        way = " sideways" if shell.from_above else ""
        return f"{title}t = {self.time:.3f} s,  tip {signed(f'{1.0e3 * tip:+.1f}')} mm{way}"


@dataclass(frozen=True, slots=True)
class BoomView:
    """What the pictures of a boom share, so that they can be compared.

    Args:
        scale: of displacements and play.
        largest: deflection, up or down, in mm.
        camera: sees the boom at every instant.
    """

    scale: float
    largest: float
    camera: Camera

    @classmethod
    def of(
        cls,
        shell: MovingShell,
        instants: Sequence[Instant],
        pixels: tuple[int, int] = PIXELS,
        displacement: float = DISPLACEMENT_DRAWN,
    ) -> BoomView:
        """The view for pictures of these instants, of so many pixels each way.

        Displacements are drawn up to a part of the boom's length.
        """
        low, high = 0.0, 0.0
        for moved in shell.displacements([instant.time for instant in instants]):
            low, high = min(low, moved[:, 2].min()), max(high, moved[:, 2].max())
        # A scale has two ends, even at rest.
        largest = 1.0e3 * max(high, -low, SAME_PLACE)
        begin, end = reach(shell, instants)
        half = SECTION_DRAWN * shell.points[:, 2].max()
        play = sum(overlap.clearance for overlap in shell.overlaps)
        scale = round_scale(
            min(
                displacement * (end - begin) / max(high, -low, SAME_PLACE),
                PLAY_OF_SECTION * half / max(play, SAME_PLACE),
            )
        )
        for stop in shell.stops:
            low, high = min(low, stop.side * stop.clearance), max(high, stop.side * stop.clearance)
        bottom, top = scale * low - 3.0 * half, scale * high + 2.0 * half
        width = max(1.1 * (end - begin), (top - bottom) * pixels[0] / pixels[1])
        centre = np.array([0.5 * (begin + end), 0.0, 0.5 * (bottom + top)])
        camera = Camera(centre, width, pixels, elevation=10.0)
        return cls(scale, largest, camera)


def reach(shell: MovingShell, instants: Sequence[Instant]) -> tuple[float, float]:
    """The least and the largest x in m at which the boom is, drawn out as it may be."""
    x = shell.points[:, 0]
    places = [x, *(x + shell.along(instant.time) for instant in instants)]
    return float(np.min(places)), float(np.max(places))


def draw_boom(
    shell: MovingShell,
    instants: Sequence[Instant],
    view: BoomView,
    until: float,
    pace: str = "",
    part: float = 1.0,
) -> Iterator[Image.Image]:
    """The deformed boom, above the deflection of its tip in time.

    Args:
        shell: in motion.
        instants: of the pictures.
        view: scale, colours, camera.
        until: last time in s of the tip's curve.
        pace: how fast a film shows it.
        part: see :class:`shell_model.pictures.theme.Sheet`.
    """
    camera = view.camera
    time, tip = shell.motion["time"].values, shell.motion["tip"].values
    sheet = Sheet(camera.pixels, 325, part)
    sheet.mark_x(camera, *reach(shell, instants))
    bar = sheet.figure.colorbar(
        ScalarMappable(Normalize(0.0, view.largest), theme.DEFLECTION),
        cax=sheet.axes(1110, 150, 420, 40),
        orientation="horizontal",
    )
    bar.set_label(
        "amount of deflection sideways (mm)" if shell.from_above else "amount of deflection (mm)"
    )
    curve = sheet.axes(150, 85, 820, 150)
    curve.plot(time, 1.0e3 * tip, color=theme.FAINT, linewidth=2)
    (past,) = curve.plot([], [], color=theme.INK, linewidth=3)
    (now,) = curve.plot([], [], "o", color=theme.FORCE, markersize=13, clip_on=False)
    sheet.move(past, now)
    curve.set(xlim=(time[0], until), xlabel="time (s)", ylabel="tip (mm)")
    where, black = ("seen from above; ", "") if shell.from_above else ("", "; black: supports")
    still = "at rest, as at t = 0" if shell.ways.size else "at rest"
    black += " and cylinders" if shell.lugs else ""
    springs = [sign for sign in shell.signs if sign.kind == SPRING]
    grey = [*(["stops"] if shell.stops else []), *(["springs"] if springs else [])]
    black += f"; grey blocks: {' and '.join(grey)}" if grey else ""
    black += "; balls: masses" if any(sign.kind == MASS for sign in shell.signs) else ""
    black += "; arrows: loads" if any(sign.kind in (UP, DOWN) for sign in shell.signs) else ""
    with Scene(camera.pixels, part) as scene:
        # A little behind the boom, or it would shine through where that hardly moves.
        rest = shell.drawn(np.zeros_like(shell.points), view.scale, SECTION_DRAWN)
        rest[:, 1] += 0.02
        edges = sharp_edges(rest, shell.triangles)
        scene.outline("rest", rest, edges, theme.FAINT, 1.5)
        larger = np.array([1.0, SECTION_DRAWN, SECTION_DRAWN])
        for number, held in enumerate([] if shell.from_above else shell.supports()):
            scene.surface(f"support {number}", *_wedge(larger * held), color=theme.INK)
        for number, stop in enumerate(shell.stops):
            block = _wedge(_met(shell, rest, stop), stop.side, view.scale * stop.clearance)
            scene.surface(f"stop {number}", *block, color=theme.FAINT)
        for number, spring in enumerate(springs):
            block = _wedge(_met(shell, rest, spring))
            scene.surface(f"spring {number}", *block, color=theme.FAINT)
        for number, lug in enumerate(shell.lugs):
            scene.surface(f"cylinder {number}", *_rod(_met(shell, rest, lug), lug), color=theme.INK)
        all_moved = shell.displacements([instant.time for instant in instants])
        for instant, moved in zip(instants, all_moved, strict=True):
            places = shell.drawn(moved, view.scale, SECTION_DRAWN)
            places[:, 0] += shell.along(instant.time)
            scene.surface(
                "boom",
                places,
                shell.triangles,
                scalars=1.0e3 * np.abs(moved[:, 2]),
                cmap=theme.DEFLECTION,
                clim=(0.0, view.largest),
            )
            scene.outline("edges", places, edges, theme.INK, 1.2)
            sheet.show(scene.seen_by(camera))
            _draw_signs(shell, sheet, camera, places)
            last = int(np.abs(time - instant.time).argmin())
            past.set_data(time[: last + 1], 1.0e3 * tip[: last + 1])
            now.set_data(time[[last]], 1.0e3 * tip[[last]])
            sheet.write(
                instant.heading(shell, float(tip[last])),
                f"{where}drawn: displacements and play × {view.scale:g}, sections × "
                f"{SECTION_DRAWN:g}\ngrey: {still}{black}{pace}",
            )
            yield sheet.image()


def _draw_signs(shell: MovingShell, sheet: Sheet, camera: Camera, places: Array) -> None:
    """Masses that hang from the boom where it is drawn, and arrows of what pushes it."""
    sheet.clear_arrows()
    for sign in shell.signs:
        x, _, z = _met(shell, places, sign).T
        low, high = (camera.project([x.mean(), 0.0, edge]) for edge in (z.min(), z.max()))
        if sign.kind == MASS:
            sheet.hang(low, ROPE)
        elif sign.kind == DOWN:
            sheet.arrow(high + np.array([0.0, PUSH]), -PUSH, "")
        elif sign.kind == UP:
            sheet.arrow(low - np.array([0.0, PUSH]), PUSH, "")


def _met(shell: MovingShell, rest: Array, place: Stop | Lug | Sign) -> Array:
    """(num_points, 3) where the section that something meets is drawn."""
    mine = shell.members[place.segment]
    return np.asarray(rest[mine[np.abs(shell.points[mine, 0] - place.x) < SAME_PLACE]])


def _rod(section: Array, lug: Lug) -> tuple[Array, Triangles]:
    """Points and triangles of a cylinder: a bar from a flange towards the ground, cut where wedges
    end.

    ``section`` (num_points, 3) in m is the outline at the lug, where it is drawn.
    """
    low, high = section[:, 2].min(), section[:, 2].max()
    size, line = 0.35 * (high - low), -np.array([lug.along, lug.up])
    start = np.array([section[:, 0].mean(), low if lug.up > 0.0 else high])
    # A flat line would not end.
    end = start + 2.0 * size / max(abs(lug.up), 0.3) * line
    half = 0.15 * size * np.array([-line[1], line[0]])
    profile = [start + half, start - half, end - half, end + half]
    middle, across = section[:, 1].mean(), 0.25 * np.ptp(section[:, 1])
    points = np.array([[x, y, z] for y in (middle - across, middle + across) for x, z in profile])
    around = [(k, (k + 1) % 4) for k in range(4)]
    sides = [part for i, j in around for part in ((i, j, j + 4), (i, j + 4, i + 4))]
    return points, np.array([(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), *sides], dtype=np.int32)


def _wedge(held: Array, side: float = -1.0, gap: float = 0.0) -> tuple[Array, Triangles]:
    """Points and triangles of a support: a prism whose edge carries a flange, at a gap in m.

    ``held`` (num_points, 3) in m is the outline where it is drawn, ``side`` -1 at the bottom.
    """
    x, across = held[:, 0].mean(), np.ptp(held[:, 1])
    low, high = held[:, 2].min(), held[:, 2].max()
    edge = (high if side > 0.0 else low) + side * gap
    size = 0.35 * (high - low)
    base = edge + side * 2.0 * size
    profile = np.array([[x, edge], [x - size, base], [x + size, base]])
    middle = held[:, 1].mean()
    points = np.array(
        [[px, y, pz] for y in (middle - 0.5 * across, middle + 0.5 * across) for px, pz in profile]
    )
    sides = [(0, 3, 4), (0, 4, 1), (1, 4, 5), (1, 5, 2), (2, 5, 3), (2, 3, 0)]
    return points, np.array([(0, 1, 2), (3, 5, 4), *sides], dtype=np.int32)
