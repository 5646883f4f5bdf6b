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

from shell_model.pictures import theme as theme
from shell_model.pictures.boom import SECTION_DRAWN, BoomView, Instant
from shell_model.pictures.deformation import MovingShell, Overlap
from shell_model.pictures.overlap import Look, OverlapView
from shell_model.pictures.theme import Scene, Sheet
from shell_model.stress.stresses import Face

# Of the overlap and of the whole boom, whose displacements are drawn up to this part of its length.
OVERLAP_PIXELS, BOOM_PIXELS = (theme.SHEET[0], 475), (1160, 195)
BOOM_DISPLACEMENT = 0.1

# The scale of stresses ends where this part of the walls' area is below: the few triangles at a
# line of contact would leave nothing but the light end for the rest.
SHOWN_AREA = 0.995

# Stresses below it are none, in Pa.
LEAST = 1.0

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
        for instant in instants:
            values = shell.stress.at(instant.time).largest()
            rising = values.argsort()
            covered = np.cumsum(shell.stress.areas[rising])
            place = int(np.searchsorted(covered, SHOWN_AREA * covered[-1]))
            end = max(end, float(values[rising[place]]))
            largest = max(largest, float(values.max()))
        return cls(_rounded_down(max(end, LEAST)), largest)

    def look(self, values: npt.NDArray[np.float32]) -> dict[str, Any]:
        """How triangles with these stresses (num_triangles,) in Pa are drawn."""
        return {
            "scalars": values / 1.0e6,
            "preference": "cell",
            "cmap": theme.STRESS,
            "clim": (0.0, self.end / 1.0e6),
            **theme.COLOUR_READ,
        }

    def add_bar(self, sheet: Sheet) -> None:
        """Draw the scale beside the boom."""
        end, goes_on = self.end / 1.0e6, self.largest > self.end
        bar = sheet.figure.colorbar(
            ScalarMappable(Normalize(0.0, end), theme.STRESS),
            cax=sheet.axes(1215, 665, 330, 34),
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
    """Von Mises stresses of the whole boom, and below it of an overlap cut open.

    Args:
        shell: in motion.
        instants: of the pictures.
        scale: of the stresses.
        overlap: one of the shell's.
    """
    overlap_view = OverlapView.of(shell, instants, overlap, OVERLAP_PIXELS)
    view = BoomView.of(shell, instants, BOOM_PIXELS, BOOM_DISPLACEMENT)
    sheet = Sheet(OVERLAP_PIXELS, floor=85)
    scale.add_bar(sheet)
    where = "from above; " if shell.from_above else ""
    with Scene(OVERLAP_PIXELS) as scene, Scene(BOOM_PIXELS) as small:
        for instant in instants:
            values = shell.stress.at(instant.time).largest()
            places = shell.drawn(shell.displacement(instant.time), view.scale, SECTION_DRAWN)
            small.surface("boom", places, shell.triangles, **scale.look(values))
            small.outline("edges", places, shell.triangles, theme.INK, 1.2)
            sheet.inset(small.seen_by(view.camera), 20, 570)
            looks = {
                number: Look(
                    scale.look(values[overlap_view.behind & (shell.segment == number)]), color
                )
                for number, color in (
                    (overlap.outer, theme.CUT_OUTER),
                    (overlap.inner, theme.CUT_INNER),
                )
            }
            overlap_view.draw(scene, sheet, instant.time, looks)
            sheet.write(
                overlap_view.heading(instant),
                f"{where}boom: displacements × {view.scale:g}, sections × {SECTION_DRAWN:g}; "
                f"overlap: cut open, × {overlap_view.scale:g}, cuts white (outer), grey (inner)\n"
                f"{_largest(shell, overlap, instant.time)};  "
                f"{overlap_view.forces_explained(instant.time)}",
            )
            yield sheet.image()


def _largest(shell: MovingShell, overlap: Overlap, time: float) -> str:
    """Which stress is the largest of all, and where."""
    stress = shell.stress.at(time)
    triangle = int(stress.largest().argmax())
    x, _, _ = shell.stress.centroids[triangle]
    faces: tuple[Face, ...] = ("outer", "inner")
    face = max(faces, key=lambda name: float(stress.von_mises(name)[triangle]))
    wall = shell.stress.wall_name(triangle)
    number = int(shell.segment[triangle])
    names = {overlap.outer: "outer segment", overlap.inner: "inner segment"}
    segment = names.get(number, f"segment {number + 1}")
    value = float(stress.largest()[triangle]) / 1.0e6
    return f"largest: {value:.3g} MPa at x = {x:.2f} m ({segment}, {wall} wall, {face} face)"
