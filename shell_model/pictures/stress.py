# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of von Mises stresses: the whole boom, and below it an overlap that is cut open."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.ticker import MaxNLocator
from PIL import Image

from geometry.arrays import Array
from geometry.typography import digits
from shell_model.pictures import theme as theme
from shell_model.pictures.boom import SECTION_DRAWN, BoomView, Instant
from shell_model.pictures.deformation import MovingShell, Overlap
from shell_model.pictures.overlap import Look, OverlapView
from shell_model.pictures.theme import Scene, Sheet, Triangles, sharp_edges

# Of the overlap and of the whole boom, whose displacements are drawn up to this part of its length.
OVERLAP_PIXELS, BOOM_PIXELS = (theme.SHEET[0], 475), (1160, 195)
BOOM_DISPLACEMENT = 0.1

# The scale of stresses ends where this part of the walls' area is below: the few triangles at a
# line of contact would leave nothing but the light end for the rest.
SHOWN_AREA = 0.995

# Stresses below it are none, in Pa.
LEAST = 1.0

# Elements across a web from which on its stresses can be read.
ENOUGH = 4

# Between this part of the scale and its end there is no room for another number.
LAST_TICK = 0.65


@dataclass(frozen=True, slots=True)
class StressScale:
    """The colours of von Mises stresses, the same in all pictures that are to be compared.

    Args:
        end: what the darkest colour is for, in Pa, of three digits.
        largest: of all triangles and instants, in Pa.
    """

    end: float
    largest: float

    @classmethod
    def of(cls, shell: MovingShell, instants: Iterable[Instant]) -> StressScale:
        """From all triangles at these instants."""
        end, largest = 0.0, 0.0
        for stress in shell.stress.instants([instant.time for instant in instants]):
            values = stress.largest()
            rising = values.argsort()
            covered = np.cumsum(shell.stress.areas[rising])
            place = int(np.searchsorted(covered, SHOWN_AREA * covered[-1]))
            end = max(end, float(values[rising[place]]))
            largest = max(largest, float(values.max()))
        return cls(_rounded_down(max(end, LEAST)), largest)

    def look(self, values: Array) -> dict[str, Any]:
        """How corners of triangles with these stresses (num_triangles, 3) in Pa are drawn."""
        return {
            "scalars": values.ravel() / 1.0e6,
            "preference": "point",
            "cmap": theme.STRESS,
            "clim": (0.0, self.end / 1.0e6),
            **theme.COLOUR_READ,
        }

    def add_bar(self, sheet: Sheet) -> None:
        """Draw the scale beside the boom."""
        end, goes_on = self.end / 1.0e6, self.largest > self.end
        bar = sheet.figure.colorbar(
            ScalarMappable(Normalize(0.0, end), theme.STRESS),
            cax=sheet.axes(1215, 655, 330, 34),
            orientation="horizontal",
            extend="max" if goes_on else "neither",
        )
        ticks = [t for t in MaxNLocator(3).tick_values(0.0, end) if t <= LAST_TICK * end]
        last = f"≥ {end:.3g}" if goes_on else f"{end:.3g}"
        labels = {**{t: f"{t:g}" for t in ticks}, end: last}
        if self.largest < self.end:
            # Nothing is stressed, and the scale has no end.
            labels = {0.0: "0"}
        bar.set_ticks(list(labels), labels=list(labels.values()))
        bar.set_label("von Mises stress (MPa),\nthe larger of both faces", fontsize=18)


def _rounded_down(number: float) -> float:
    """To three digits, so that what is written is not above what there is."""
    unit = 10.0 ** (np.floor(np.log10(number)) - 2.0)
    return float(f"{np.floor(number / unit + 1.0e-9) * unit:.3g}")


def draw_stress(
    shell: MovingShell, instants: Sequence[Instant], scale: StressScale, overlap: Overlap
) -> Iterator[Image.Image]:
    """Von Mises stresses of the whole boom, and below it of an overlap cut open."""
    overlap_view = OverlapView.of(shell, instants, overlap, OVERLAP_PIXELS)
    view = BoomView.of(shell, instants, BOOM_PIXELS, BOOM_DISPLACEMENT)
    sheet = Sheet(OVERLAP_PIXELS, floor=85)
    scale.add_bar(sheet)
    where = "from above; " if shell.from_above else ""
    with Scene(OVERLAP_PIXELS) as scene, Scene(BOOM_PIXELS) as small:
        rest = shell.drawn(np.zeros_like(shell.points), view.scale, SECTION_DRAWN)
        edges = sharp_edges(rest, shell.triangles)
        for instant in instants:
            values = smoothed(shell, shell.stress.at(instant.time).largest())
            places = shell.drawn(shell.displacement(instant.time), view.scale, SECTION_DRAWN)
            places[:, 0] += shell.along(instant.time)
            small.surface("boom", *apart(places, shell.triangles), **scale.look(values))
            small.outline("edges", places, edges, theme.INK, 1.2)
            sheet.inset(small.seen_by(view.camera), 20, 550)
            looks = {
                number: Look(
                    scale.look(values[overlap_view.behind & (shell.segment == number)]), color
                )
                for number, color in (
                    (overlap.outer, theme.CUT_OUTER),
                    (overlap.inner, theme.CUT_INNER),
                )
            }
            overlap_view.draw(scene, sheet, instant.time, looks, apart)
            ringed = _mark_largest(sheet, overlap_view, values, instant.time)
            sheet.write(
                overlap_view.heading(instant),
                f"{where}boom: displacements × {view.scale:g}, sections × {SECTION_DRAWN:g}; "
                f"overlap: cut open, × {overlap_view.scale:g}, cuts white (outer), grey (inner)\n"
                f"{ringed}; {_largest(overlap_view, instant.time)}\n"
                f"{overlap_view.forces_explained(instant.time)}{_coarse(shell, overlap)}",
            )
            yield sheet.image()


def apart(points: Array, triangles: Triangles) -> tuple[Array, Triangles]:
    """The same triangles with points of their own, which may differ in colour."""
    own = np.arange(triangles.size, dtype=np.int32).reshape(triangles.shape)
    return points[triangles].reshape(-1, 3), own


def smoothed(shell: MovingShell, values: npt.ArrayLike) -> Array:
    """(num_triangles, 3) at the corners: means of the triangles of the same wall around a point."""
    walls = int(shell.stress.wall.max()) + 1
    of = (shell.triangles.astype(np.int64) * walls + shell.stress.wall[:, None]).ravel()
    _, corner = np.unique(of, return_inverse=True)
    weights = np.repeat(shell.stress.areas, 3)
    total = np.bincount(corner, weights * np.repeat(np.asarray(values, dtype=float), 3))
    return np.asarray((total / np.bincount(corner, weights))[corner].reshape(-1, 3))


def _largest(view: OverlapView, time: float) -> str:
    """Which stress of a triangle is the largest of both segments, seen or not, and where."""
    shell = view.shell
    stress = shell.stress.at(time)
    shown = np.isin(shell.segment, (view.overlap.outer, view.overlap.inner))
    triangle = int(np.where(shown, stress.largest(), 0.0).argmax())
    x, _, _ = shell.stress.centroids[triangle]
    wall = shell.stress.wall_name(triangle)
    value = float(stress.largest()[triangle]) / 1.0e6
    return (
        f"single triangles: {digits(value)} MPa at x = {x:.2f} m "
        f"({shell.names[int(shell.segment[triangle])]}, {wall} wall)"
    )


def _mark_largest(sheet: Sheet, view: OverlapView, values: Array, time: float) -> str:
    """A ring where the smoothed stress of the half that is seen is largest; what it is."""
    shell = view.shell
    seen = np.where(
        view.behind & np.isin(shell.segment, _both(view.overlap)), values.max(axis=1), 0.0
    )
    triangle = int(seen.argmax())
    places = view.places(time)
    corner = places[shell.triangles[triangle, int(values[triangle].argmax())]]
    x, y = view.camera(places).project(corner)
    largest = f"{digits(1e-6 * float(seen[triangle]))} MPa"
    sheet.ring(float(x), float(y), largest)
    at, segment = shell.stress.centroids[triangle][0], int(shell.segment[triangle])
    return f"ring: {largest} at x = {at:.2f} m ({shell.names[segment]})"


def _both(overlap: Overlap) -> tuple[int, int]:
    return overlap.outer, overlap.inner


def _coarse(shell: MovingShell, overlap: Overlap) -> str:
    """A caution where webs have too few elements for how stress changes across them."""
    fewest = min(_across_web(shell, number) for number in _both(overlap))
    return "" if fewest >= ENOUGH else f";  webs of {fewest} elements are coarse for stresses"


def _across_web(shell: MovingShell, segment: int) -> int:
    """How many edges of elements are across a web, at most places."""
    mine = shell.members[segment]
    half = shell.half_height(segment)
    x, _, z = shell.points[mine].T
    inside = np.abs(z - shell.middle(segment)) < 0.999 * half
    counts = np.unique(x[inside].round(6), return_counts=True)[1]
    # Two webs, the points of whose ends are not inside.
    return int(np.median(counts)) // 2 + 1
