# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sheet with a rendered boom and annotations.

VTK renders the surfaces, matplotlib draws the annotations. Both use the same camera projection, so
that labels and axes have the correct positions.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import MaxNLocator
from PIL import Image

from protractile.geometry.arrays import Array
from protractile.runs.report import theme

Pixels = npt.NDArray[np.uint8]

# Lights under which faces differ in brightness.
MATTE = {
    "ambient": 0.35,
    "diffuse": 0.75,
    "specular": 0.0,
    "show_scalar_bar": False,
    "render": False,
}
MESHED = {"show_edges": True, "edge_color": theme.INK, "line_width": 1.5}
UNLIT = {"lighting": False, "render": False}

# Width and height of a sheet in pixels, pixels per inch, and oversampling in both directions for
# smooth edges.
SHEET = (1600, 900)
DPI = 100
OVERSAMPLING = 2

# Angle in degrees between two walls above which their edge is drawn.
SHARP = 30.0

# Vertical angle of view in degrees, for a little perspective.
VIEW_ANGLE = 12.0


@dataclass(frozen=True, slots=True)
class Camera:
    """Camera along y, from negative y and slightly from above, so that x runs to the right."""

    centre: Array  #: (3,) centre of the picture in m
    width: float  #: width of the view at the centre in m
    pixels: tuple[int, int]  #: width and height of the picture
    elevation: float  #: angle from above in degrees

    @property
    def axes(self) -> Array:
        """The unit vectors (3, 3) to the right, up and into the picture."""
        tilt = np.radians(self.elevation)
        right = np.array([1.0, 0.0, 0.0])
        into = np.array([0.0, np.cos(tilt), -np.sin(tilt)])
        return np.array([right, np.cross(right, into), into])

    @property
    def position(self) -> Array:
        """The position (3,) in m."""
        half_height = 0.5 * self.width * self.pixels[1] / self.pixels[0]
        distance = half_height / np.tan(np.radians(0.5 * VIEW_ANGLE))
        return np.asarray(self.centre - distance * self.axes[2])

    def project(self, points: npt.ArrayLike) -> Array:
        """Return the pixel coordinates (..., 2), from lower left, of points (..., 3) in m."""
        right, up, depth = np.moveaxis((np.asarray(points) - self.position) @ self.axes.T, -1, 0)
        magnification = 0.5 * self.pixels[1] / np.tan(np.radians(0.5 * VIEW_ANGLE)) / depth
        middle = 0.5 * np.array(self.pixels)
        return np.asarray(np.stack([right, up], axis=-1) * magnification[..., None] + middle)

    def render(self, plotter: Any) -> Pixels:
        """Return the picture (height, width, 3) of a plotter's scene from this camera."""
        plotter.camera_position = [self.position, self.centre, self.axes[1]]
        plotter.camera.view_angle = VIEW_ANGLE
        plotter.reset_camera_clipping_range()
        plotter.render()
        fine = Image.fromarray(np.asarray(plotter.screenshot(return_img=True)))
        return np.asarray(fine.reduce(OVERSAMPLING))


@contextmanager
def stage(pixels: tuple[int, int], part: float = 1.0) -> Iterator[Any]:
    """Yield an off-screen pyvista plotter; ``part`` is the size factor of the sheet."""
    # Imported here, since a machine that draws no pictures may lack VTK.
    import pyvista
    from vtkmodules.vtkCommonCore import vtkLogger

    # Without a display VTK warns, and then renders by EGL.
    verbosity = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    size = [OVERSAMPLING * round(part * n) for n in pixels]
    look = pyvista.themes.DocumentTheme()
    look.multi_samples = 1
    plotter = pyvista.Plotter(off_screen=True, window_size=size, theme=look)
    try:
        yield plotter
    finally:
        plotter.close()
        vtkLogger.SetStderrVerbosity(verbosity)


def surface(points: Array, triangles: npt.NDArray[np.int32]) -> Any:
    """Return a pyvista surface of points (num_points, 3) in m and triangles (num_triangles, 3)."""
    import pyvista

    kinds: Any = pyvista.PolyData
    return kinds.from_regular_faces(points, triangles)


def sharp_edges(mesh: Any) -> Any:
    """Return free and sharp edges of a surface, with the point numbers of the surface."""
    mesh["number"] = np.arange(mesh.n_points)
    return mesh.extract_feature_edges(feature_angle=SHARP)


class Snapshot(NamedTuple):
    """Picture of a shell in the folder of a run."""

    path: Path  #: path of the PNG or GIF file
    title: str  #: title of one line
    caption: str  #: caption in sentences

    @property
    def name(self) -> str:
        """The file name without suffix."""
        return self.path.stem

    @property
    def anchor(self) -> str:
        """The target of links in the report."""
        return f"figure-{self.name}"


class Sheet:
    """Sheet with heading, picture, x axis at the lower edge of the picture, and space below.

    The coordinates of ``picture`` are the pixels of :meth:`Camera.project`. Temporary artists
    appear in one image, all others in all images. The size of the picture and the height ``floor``
    of its lower edge are in pixels; ``part`` is the size factor of the sheet.
    """

    def __init__(self, pixels: tuple[int, int], floor: int, part: float = 1.0) -> None:
        self.figure = Figure(figsize=(SHEET[0] / DPI, SHEET[1] / DPI), dpi=part * DPI)
        self._canvas: Any = FigureCanvasAgg(self.figure)
        self._floor = round(part * floor)
        self._rendered: Pixels | None = None
        self._temporary_artists: list[Artist] = []
        self._background: Any = None
        self.picture = self.axes(0, floor, *pixels)
        self.picture.spines["left"].set_visible(False)
        self.picture.set(xlim=(0, pixels[0]), ylim=(0, pixels[1]), yticks=[])

    def axes(self, left: int, bottom: int, width: int, height: int) -> Axes:
        """Return axes at a position on the sheet in pixels."""
        return self.figure.add_axes(
            (left / SHEET[0], bottom / SHEET[1], width / SHEET[0], height / SHEET[1])
        )

    def mark_x(self, camera: Camera, first: float, last: float) -> None:
        """Draw the x axis with ticks at round values, in the plane through the camera's centre."""
        _, y, z = camera.centre
        ticks = np.asarray(MaxNLocator(20, steps=[1, 2, 5, 10]).tick_values(first, last))
        ticks = ticks[(ticks > first - 1.0e-9) & (ticks < last + 1.0e-9)]
        seen = camera.project([[x, y, z] for x in ticks])
        self.picture.set_xticks(list(seen[:, 0]), [f"{x:g}" for x in ticks])
        self.picture.set_xlabel("x along the boom (m)")

    def show(self, pixels: Pixels) -> None:
        """Show rendered pixels in the next image."""
        self._rendered = pixels

    def show_once(self, *artists: Artist) -> None:
        """Show artists in the next image only."""
        for artist in artists:
            artist.set_animated(True)
        self._temporary_artists += artists

    def entitle(self, heading: str) -> None:
        """Write the heading of the next image above the picture."""
        self.show_once(self._text(0.98, heading, size=26, weight="bold"))

    def explain(self, explanation: str) -> None:
        """Write the explanation of all images, which have not begun, below the heading."""
        self._text(0.925, explanation, size=19)

    def _text(self, height: float, text: str, **look: Any) -> Text:
        return self.figure.text(0.5, height, text, ha="center", va="top", **look)

    def arrow(self, foot: Array, length: float, text: str) -> None:
        """Draw a vertical arrow with a label from a pixel (2,); negative lengths point down."""
        x, y = (float(pixel) for pixel in foot)
        shaft = {"width": 8, "headwidth": 24, "headlength": 22, "color": theme.FORCE}
        letters: dict[str, Any] = {
            "color": theme.FORCE,
            "path_effects": theme.OUTLINED,
            "va": "center",
        }
        mark = self.picture.annotate
        self.show_once(
            # By default matplotlib omits an arrow whose tip is outside the picture.
            mark("", (x, y + length), (x, y), arrowprops=shaft, annotation_clip=False),
            mark(text, (x + 22.0, y + 0.6 * length), **letters),
        )

    def image(self) -> Image.Image:
        """Return the current image of the sheet, and remove temporary artists."""
        if self._background is None:
            self._canvas.draw()
            self._background = self._canvas.copy_from_bbox(self.figure.bbox)
        self._canvas.restore_region(self._background)
        page = np.asarray(self._canvas.buffer_rgba())
        if self._rendered is not None:
            top, (height, width, _) = len(page) - self._floor, self._rendered.shape
            place = page[top - height : top, :width, :3]
            # Characters that reach down into the picture are kept.
            np.minimum(place, self._rendered, out=place)
        for artist in sorted(self._temporary_artists, key=Artist.get_zorder):
            self.figure.draw_artist(artist)
            artist.remove()
        self._temporary_artists.clear()
        self._rendered = None
        return Image.fromarray(page[..., :3].copy())
