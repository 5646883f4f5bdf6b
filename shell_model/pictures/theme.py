# SPDX-License-Identifier: LGPL-3.0-or-later
"""How the pictures of shells look: one camera, one page, one set of colours and letters.

VTK draws the surfaces, matplotlib everything that is written on them: the camera's projection
is known, so that labels and axes stand where they belong.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import TracebackType
from typing import Any, Self

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from PIL import Image

from geometry.arrays import Array

Pixels = npt.NDArray[np.uint8]
Triangles = npt.NDArray[np.int32]
Edges = npt.NDArray[np.int64]

# Told apart by the colour-blind too (Okabe and Ito 2008).
OUTER, INNER, FORCE = "#56b4e9", "#e69f00", "#b03000"
INK, FAINT = "#202020", "#a8a8a8"
DEFLECTION = "viridis_r"

# Stresses, light where there are none; and the cut walls of the segments beside them.
STRESS = "cividis_r"
CUT_OUTER, CUT_INNER = "#ffffff", "#c8c8c8"

# Light enough for the colour of a face to be that of the bar, dark enough to tell faces apart.
MATTE = {"ambient": 0.35, "diffuse": 0.75, "specular": 0.0}
COLOUR_READ = {"ambient": 0.75, "diffuse": 0.3}
MESHED = {"show_edges": True, "edge_color": INK, "line_width": 1.5}

LETTERS: dict[Any, Any] = {
    "font.size": 20.0,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
}

# Width and height of a sheet in pixels, and pixels per inch. VTK draws each pixel as a square of
# four, for smooth edges.
SHEET = (1600, 900)
DPI = 100
FINER = 2

# Walls that meet at a larger angle, in degrees, have an edge between them.
SHARP = 30.0

# Degrees over which the picture's height is seen: perspective enough for a box to look like one.
VIEW_ANGLE = 12.0


@dataclass(frozen=True, slots=True)
class Camera:
    """Looks along y, from negative y and a little from above, so that x runs to the right.

    Args:
        centre: (3,) the middle of the picture in m.
        width: what the picture's width shows at the centre in m.
        pixels: width and height of the picture.
        elevation: how far from above in degrees.
    """

    centre: Array
    width: float
    pixels: tuple[int, int]
    elevation: float

    @property
    def axes(self) -> Array:
        """(3, 3) unit vectors to the right, up and into the picture."""
        tilt = np.radians(self.elevation)
        right = np.array([1.0, 0.0, 0.0])
        into = np.array([0.0, np.cos(tilt), -np.sin(tilt)])
        return np.array([right, np.cross(right, into), into])

    @property
    def position(self) -> Array:
        """(3,) in m."""
        half_height = 0.5 * self.width * self.pixels[1] / self.pixels[0]
        distance = half_height / np.tan(np.radians(0.5 * VIEW_ANGLE))
        return np.asarray(self.centre - distance * self.axes[2])

    def project(self, points: npt.ArrayLike) -> Array:
        """(..., 2) pixels right of and above the lower left corner, of points (..., 3) in m."""
        right, up, depth = np.moveaxis((np.asarray(points) - self.position) @ self.axes.T, -1, 0)
        magnification = 0.5 * self.pixels[1] / np.tan(np.radians(0.5 * VIEW_ANGLE)) / depth
        middle = 0.5 * np.array(self.pixels)
        return np.asarray(np.stack([right, up], axis=-1) * magnification[..., None] + middle)


class Scene:
    """Surfaces before a camera, drawn off-screen on white. A thing drawn again replaces itself.

    Args:
        pixels: width and height on a whole sheet.
        part: of a whole sheet's size, each way.
    """

    def __init__(self, pixels: tuple[int, int], part: float = 1.0) -> None:
        # VTK's libraries may be missing on a machine that is asked for no picture.
        import pyvista
        from vtkmodules.vtkCommonCore import vtkLogger

        # VTK warns that it found no display before it takes EGL, which needs none.
        self._logger, self._verbosity = vtkLogger, vtkLogger.GetCurrentVerbosityCutoff()
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
        self._kinds: Any = pyvista.PolyData
        self._finer = FINER * part
        look = pyvista.themes.DocumentTheme()
        look.multi_samples = 1
        self._plotter = pyvista.Plotter(
            off_screen=True, window_size=[FINER * round(part * n) for n in pixels], theme=look
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._plotter.close()
        self._logger.SetStderrVerbosity(self._verbosity)

    def surface(self, name: str, points: Array, triangles: Triangles, **look: Any) -> None:
        """Draw (num_points, 3) places in m and (num_triangles, 3), by a look of pyvista."""
        surface = self._kinds.from_regular_faces(points, triangles)
        self._plotter.add_mesh(
            surface, name=name, show_scalar_bar=False, render=False, **(MATTE | look)
        )

    def outline(self, name: str, points: Array, edges: Edges, color: str, width: float) -> None:
        """Draw edges (num_edges, 2) of a surface; the lines' width is in pixels."""
        ends = np.insert(edges, 0, 2, axis=1)
        self._plotter.add_mesh(
            self._kinds(points, lines=ends.ravel()),
            name=name,
            color=color,
            line_width=self._finer * width,
            lighting=False,
            render=False,
        )

    def seen_by(self, camera: Camera) -> Pixels:
        """(height, width, 3) what the camera sees."""
        eye = self._plotter.camera
        eye.position, eye.focal_point = tuple(camera.position), tuple(camera.centre)
        eye.up, eye.view_angle = tuple(camera.axes[1]), VIEW_ANGLE
        self._plotter.renderer.ResetCameraClippingRange()
        self._plotter.render()
        fine = Image.fromarray(np.asarray(self._plotter.screenshot(return_img=True)))
        return np.asarray(fine.reduce(FINER))


def sharp_edges(points: Array, triangles: Triangles) -> Edges:
    """(num_edges, 2) point numbers of the free and the sharp edges of a surface.

    Of points (num_points, 3) in m and triangles (num_triangles, 3).
    """
    import pyvista

    kinds: Any = pyvista.PolyData
    surface = kinds.from_regular_faces(points, triangles)
    surface["number"] = np.arange(len(points))
    found = surface.extract_feature_edges(feature_angle=SHARP)
    return np.asarray(found["number"][found.lines.reshape(-1, 3)[:, 1:]], dtype=np.int64)


class Sheet:
    """A page: heading, picture, x along the picture's lower edge, and room below it.

    The first image draws all of it, further ones what changes.

    The coordinates of ``picture`` are the pixels of :meth:`Camera.project`.

    Args:
        pixels: width and height of the picture.
        floor: height of the picture's lower edge in pixels.
        part: of the size that these pixels are of; the page is so much smaller, each way.
    """

    def __init__(self, pixels: tuple[int, int], floor: int, part: float = 1.0) -> None:
        self.figure = Figure(figsize=(SHEET[0] / DPI, SHEET[1] / DPI), dpi=part * DPI)
        self._part = part
        self._canvas: Any = FigureCanvasAgg(self.figure)
        self.picture = self.axes(0, floor, *pixels)
        self.picture.spines["left"].set_visible(False)
        self.picture.set(xlim=(0, pixels[0]), ylim=(0, pixels[1]), yticks=[])
        self._floor = floor
        self._seen: dict[tuple[int, int], Pixels] = {}
        self._arrows: list[Artist] = []
        centred: dict[str, Any] = {"ha": "center", "va": "top"}
        self._heading = self.figure.text(0.5, 0.98, "", size=26, weight="bold", **centred)
        self._explanation = self.figure.text(0.5, 0.925, "", size=19, **centred)
        self._still: Any = None
        self._moving: list[Artist] = []
        # The line below the picture is drawn upon it.
        self.move(self.picture.spines["bottom"], self._heading, self._explanation)

    def move(self, *artists: Artist) -> None:
        """What changes from picture to picture, while all else is drawn once."""
        for artist in artists:
            artist.set_animated(True)
        self._moving += artists

    def axes(self, left: int, bottom: int, width: int, height: int) -> Axes:
        """Axes at a place on the sheet, in pixels."""
        return self.figure.add_axes(
            (left / SHEET[0], bottom / SHEET[1], width / SHEET[0], height / SHEET[1])
        )

    def mark_x(self, camera: Camera, first: float, last: float) -> None:
        """Put ticks where the camera sees round x in m at the depth of its centre."""
        _, y, z = camera.centre
        ticks = np.asarray(MaxNLocator(20, steps=[1, 2, 5, 10]).tick_values(first, last))
        ticks = ticks[(ticks > first - 1.0e-9) & (ticks < last + 1.0e-9)]
        seen = camera.project([[x, y, z] for x in ticks])
        self.picture.set_xticks(list(seen[:, 0]), [f"{x:g}" for x in ticks])
        self.picture.set_xlabel("x along the boom (m)")

    def write(self, heading: str, explanation: str) -> None:
        """Set the lines above the picture."""
        self._heading.set_text(heading)
        self._explanation.set_text(explanation)

    def show(self, pixels: Pixels) -> None:
        """Put what a camera saw into the picture."""
        self.inset(pixels, 0, self._floor)

    def inset(self, pixels: Pixels, left: int, bottom: int) -> None:
        """Put what a camera saw at a place on the sheet, in pixels."""
        self._seen[round(self._part * left), round(self._part * bottom)] = pixels

    def arrow(self, foot: Array, length: float, text: str) -> None:
        """Draw an upright arrow from (2,) pixels, down by negative lengths, and write beside it."""
        x, y = (float(pixel) for pixel in foot)
        shaft = {"width": 8, "headwidth": 24, "headlength": 22, "color": FORCE}
        self._arrows += [
            # Matplotlib would leave out an arrow whose tip is beyond the picture.
            self.picture.annotate(
                "", (x, y + length), (x, y), arrowprops=shaft, annotation_clip=False
            ),
            self.picture.annotate(
                text,
                (x + 22.0, y + 0.6 * length),
                va="center",
                color=FORCE,
                path_effects=[withStroke(linewidth=5, foreground="white")],
            ),
        ]

    def ring(self, x: float, y: float, text: str) -> None:
        """Ring a place, in pixels, and write beside it; goes with the arrows."""
        outlined = [withStroke(linewidth=5, foreground="white")]
        (mark,) = self.picture.plot(
            [x], [y], "o", ms=26, mfc="none", mec=INK, mew=3, path_effects=outlined
        )
        beside: dict[str, Any] = {"color": INK, "size": 18, "path_effects": outlined}
        self._arrows += [mark, self.picture.annotate(text, (x + 24.0, y - 30.0), **beside)]

    def hang(self, hook: Array, length: float) -> None:
        """Hang a mass from a place, (2,) pixels, by so many pixels; goes with the arrows."""
        x, y = (float(pixel) for pixel in hook)
        look: dict[str, Any] = {"color": INK, "lw": 3, "clip_on": False}
        (rope,) = self.picture.plot([x, x], [y, y - length], **look)
        (mass,) = self.picture.plot([x], [y - length], "o", ms=20, **look)
        self._arrows += [rope, mass]

    def clear_arrows(self) -> None:
        """Remove all arrows."""
        for arrow in self._arrows:
            arrow.remove()
        self._arrows.clear()

    def image(self) -> Image.Image:
        """The sheet as it is now."""
        if self._still is None:
            for artist in self._arrows:
                artist.set_animated(True)
            self._canvas.draw()
            self._still = self._canvas.copy_from_bbox(self.figure.bbox)
        self._canvas.restore_region(self._still)
        page = np.asarray(self._canvas.buffer_rgba())
        for (left, bottom), pixels in self._seen.items():
            height, width = pixels.shape[:2]
            top = len(page) - bottom - height
            place = page[top : top + height, left : left + width, :3]
            # Letters that come down into the picture stay.
            np.minimum(place, pixels, out=place)
        for artist in sorted((*self._moving, *self._arrows), key=Artist.get_zorder):
            self.figure.draw_artist(artist)
        return Image.fromarray(page[..., :3].copy())


def round_scale(largest: float) -> float:
    """The largest of …, 1, 2, 5, 10, 20, … that is not above ``largest``."""
    decade = 10.0 ** np.floor(np.log10(largest))
    return float(decade * max(step for step in (1.0, 2.0, 5.0) if step * decade <= largest))
