# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of an overlap in a sectional view: contact forces and von Mises stresses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt
import xarray as xr
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from PIL import Image

from protractile.geometry.arrays import Array, Mask
from protractile.geometry.typography import TO_MEGA, digits
from protractile.runs.report import theme
from protractile.runs.report.boom_pictures import BoomView
from protractile.runs.report.scene import (
    SAME_PLACE,
    SECTION_DRAWN,
    Instant,
    Numbers,
    Overlap,
    Scene,
    means_around,
    round_scale,
)
from protractile.runs.report.sheet import (
    COLOUR_READ,
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
from protractile.shell_model.stress.stresses import ShellStress

# Limits of the magnified clearance and of magnified wall displacements relative to the outer
# segment, both as fractions of the height of the outer section; margin beside the stations in m.
CLEARANCE_DRAWN, DISPLACEMENT_DRAWN, MARGIN = 0.08, 0.25, 0.6

PIXELS = (SHEET[0], 625)

# Sizes in pixels of the stress pictures of the overlap and of the whole boom; limit of magnified
# displacements of the boom over its length.
STRESS_PIXELS, BOOM_PIXELS = (SHEET[0], 475), (1160, 195)
BOOM_DISPLACEMENT = 0.1

# Colours of the cut walls of the outer and the inner segment in stress pictures.
CUT_COLORS = "#ffffff", "#c8c8c8"

# A peak force is shown beside the mean if it exceeds the mean by this factor.
PEAK = 1.02

# Lengths in pixels of the shortest and the longest arrow; room for arrows above and below.
SHORTEST, LONGEST, ARROW_ROOM = 60.0, 110.0, 120.0

# Share of the area of the walls within the stress scale. A few triangles at a line contact would
# otherwise stretch the scale.
SHOWN_AREA = 0.995

# Smaller stresses in Pa count as zero.
LEAST = 1.0

# Minimum number of elements across a web that resolve its stresses.
ENOUGH = 4

# A round number above this fraction of the scale would overlap the number at its end.
LAST_TICK = 0.65


@dataclass(frozen=True)
class OverlapView:
    """View of an overlap that all its pictures share."""

    scene: Scene  #: scene of the boom in motion
    overlap: Overlap  #: an overlap of the scene
    times: Sequence[float]  #: times of the pictures in s
    pixels: tuple[int, int] = PIXELS  #: width and height of the picture

    @property
    def stress(self) -> ShellStress:
        """The stresses of the shell; only shells have sectional views."""
        assert self.scene.stress is not None
        return self.scene.stress

    @cached_property
    def motion(self) -> xr.Dataset:
        """The trajectories at the stations of the overlap."""
        return self.scene.motion.isel(station=[one.index for one in self.overlap.stations])

    @property
    def midpoint(self) -> float:
        """The x in m of the centre between the stations."""
        return 0.5 * (min(self.overlap.centres) + max(self.overlap.centres))

    @cached_property
    def scale(self) -> float:
        """The largest round magnification within the limits for drawn displacements and play."""
        height = 2.0 * self.scene.half_height(self.overlap.outer)
        half = 0.5 * np.ptp(self.overlap.centres) + MARGIN
        near = np.abs(self.scene.points[:, 0] - self.midpoint) <= half
        near &= np.isin(self.scene.owner, self.numbers)
        largest = max(
            float(np.abs(self._relative_displacements(time)[near]).max()) for time in self.times
        )
        return round_scale(
            height
            * min(
                CLEARANCE_DRAWN / max(self.overlap.clearance, SAME_PLACE),
                DISPLACEMENT_DRAWN / max(largest, SAME_PLACE),
            )
        )

    @cached_property
    def width(self) -> float:
        """The width of the view in m."""
        ends = [self.ends(self.places(time)) for time in self.times]
        tallest = float(np.ptp(ends, axis=1).max()) + self.scene.wall(self.overlap)
        room = tallest * self.pixels[0] / (self.pixels[1] - 2.0 * ARROW_ROOM)
        return max(float(np.ptp(self.overlap.centres)) + 2.0 * MARGIN, room)

    @cached_property
    def behind(self) -> Mask:
        """The mask (num_triangles,) of the triangles behind the cut."""
        corners = self.scene.points[self.scene.triangles]
        near = (np.abs(corners[..., 0] - self.midpoint) < self.width).all(axis=1)
        return np.asarray(near & (corners[..., 1].mean(axis=1) > 0.0))

    @property
    def numbers(self) -> tuple[int, int]:
        """The numbers of the outer and the inner segment."""
        return self.overlap.outer, self.overlap.inner

    def places(self, time: float) -> Array:
        """Return the displayed points (num_points, 3) in m at a time in s."""
        return self.scene.magnify(self._relative_displacements(time), self.scale, 1.0)

    def _relative_displacements(self, time: float) -> Array:
        """Return the displacements (num_points, 3) in m relative to the outer segment."""
        between = min(self.overlap.centres), max(self.overlap.centres)
        return self.scene.relative_displacements(time, self.overlap.outer, between)

    def ends(self, places: Array) -> tuple[float, float]:
        """Return the lowest and highest z in m of the outer segment's flanges at the stations."""
        flanges = [places[self.scene.flange_in_plane(self.overlap.outer, side)] for side in (-1, 1)]
        heights = [_point_at(line, x)[2] for line in flanges for x in self.overlap.centres]
        return min(heights), max(heights)

    def camera(self, places: Array) -> Camera:
        """Return a camera whose view contains the stations."""
        centre = np.array([self.midpoint, 0.0, np.mean(self.ends(places))])
        return Camera(centre, self.width, self.pixels, elevation=8.0)

    def sheet(self, floor: int) -> Sheet:
        """Return a sheet with the x axis of the view; ``floor`` is its height in pixels."""
        sheet, half = Sheet(self.pixels, floor), 0.475 * self.width
        sheet.mark_x(self.camera(self.scene.points), self.midpoint - half, self.midpoint + half)
        return sheet

    def draw(
        self,
        plotter: Any,
        sheet: Sheet,
        time: float,
        places: Array,
        cuts: Iterable[str],
        stress: tuple[Array, StressScale] | None = None,
    ) -> str:
        """Draw both segments and the forces between them, and return a sentence on the forces.

        The plotter has the size of the view, and ``places`` are the displayed points at a time in
        s. The colours ``cuts`` are those of the cut walls of the outer and the inner segment, and
        of the other walls unless these show stresses (num_triangles, 3) at corners in Pa on a
        scale.
        """
        camera, wall = self.camera(places), self.scene.wall(self.overlap)
        plotter.clear_actors()
        for number, color in zip(self.numbers, cuts, strict=False):
            mine = self.behind & (self.scene.segment == number)
            half, look = surface(places, self.scene.triangles[mine]), {"color": color}
            if stress is not None:
                values, scale = stress
                half = _surface_with_values(places, self.scene.triangles[mine], values[mine])
                look = scale.look
            plotter.add_mesh(half, **(MATTE | MESHED | look))
            for side in (-1, 1):
                cut = _band(places[self.scene.flange_in_plane(number, side)], wall)
                plotter.add_mesh(cut, color=color, **UNLIT)
                plotter.add_mesh(sharp_edges(cut), color=theme.INK, line_width=4.0, **UNLIT)
        sheet.show(camera.render(plotter))
        strongest = np.abs(self.motion["contact_force"].values).max()
        now = self.motion.sel(time=time, method="nearest")
        forces = np.nan_to_num(now["contact_force"].values)
        if not forces.any():
            return "no contact here"
        interval = float(np.diff(self.motion["time"].values[:2])[0])
        meaning = f"forces: mean of the last {1.0e3 * interval:.3g} ms"
        impact, peaks = "", now["contact_force_peak"].values
        for x, force, peak in zip(self.overlap.centres, forces, peaks, strict=True):
            if force == 0.0:
                continue
            side = int(np.sign(force))
            outside = _point_at(places[self.scene.flange_in_plane(self.overlap.outer, side)], x)
            outside[2] += 0.5 * side * wall
            length = SHORTEST + (LONGEST - SHORTEST) * abs(force) / strongest
            text = f"{digits(1e-3 * abs(force))} kN"
            if abs(peak) >= PEAK * abs(force):
                text += f"\n(peak {digits(1e-3 * abs(peak))} kN)"
                impact = "; peak: maximum of a short impact"
            sheet.arrow(camera.project(outside), side * length, text)
        return f"{meaning}{impact}"


def draw_overlap(
    scene: Scene, instants: Sequence[Instant], overlap: Overlap
) -> Iterator[Image.Image]:
    """Yield sectional views of an overlap, with the forces at its stations."""
    view = OverlapView(scene, overlap, [instant.time for instant in instants])
    outer, inner = (scene.boom.segments[number].name for number in view.numbers)
    labels = {theme.OUTER: outer, theme.INNER: inner, theme.FORCE: f"force of {inner} on {outer}"}
    aside = "seen from above, " if scene.from_above else ""
    sheet = view.sheet(floor=90)
    sheet.figure.legend(
        handles=[Patch(color=color, label=label) for color, label in labels.items()],
        loc="upper center",
        bbox_to_anchor=(0.5, 0.86),
        ncols=3,
        frameon=False,
    )
    with stage(PIXELS) as plotter:
        for instant in instants:
            forces = view.draw(plotter, sheet, instant.time, view.places(instant.time), labels)
            sheet.write(
                instant.heading(scene),
                f"{aside}cut open; play and displacements relative to {outer} × {view.scale:g}, "
                f"walls not to scale\n{forces}",
            )
            yield sheet.image()


@dataclass(frozen=True, slots=True)
class StressScale:
    """Colour scale of von Mises stresses, the same in all pictures of a shell."""

    end: float  #: stress at the end of the scale in Pa, with three digits
    largest: float  #: largest stress of all triangles and times in Pa

    @classmethod
    def of(cls, shell: ShellStress, times: Iterable[float]) -> StressScale:
        """Return the scale for the stresses of all triangles at ``times`` in s."""
        end, largest = LEAST, 0.0
        for stress in shell.instants([*times]):
            values = stress.largest()
            rising = values.argsort()
            covered = np.cumsum(shell.areas[rising])
            place = int(np.searchsorted(covered, SHOWN_AREA * covered[-1]))
            end = max(end, float(values[rising[place]]))
            largest = max(largest, float(values.max()))
        # The end is rounded down, so that the displayed number does not exceed a stress.
        unit = 10.0 ** (np.floor(np.log10(end)) - 2.0)
        return cls(float(f"{np.floor(end / unit + 1.0e-9) * unit:.3g}"), largest)

    @property
    def look(self) -> dict[str, Any]:
        """The style of surfaces with a ``stress`` in MPa."""
        ends = (0.0, TO_MEGA * self.end)
        return {"scalars": "stress", "cmap": theme.STRESS, "clim": ends, **COLOUR_READ}

    def add_bar(self, sheet: Sheet) -> None:
        """Draw the colour scale on a sheet, beside the boom."""
        end, goes_on = self.end / 1.0e6, self.largest > self.end
        extend = "max" if goes_on else "neither"
        bar = sheet.colour_bar((1215, 655, 330, 34), end, theme.STRESS, extend)
        ticks = [t for t in MaxNLocator(3).tick_values(0.0, end) if t <= LAST_TICK * end]
        last = f"≥ {end:.3g}" if goes_on else f"{end:.3g}"
        labels = {**{t: f"{t:g}" for t in ticks}, end: last}
        if self.largest < self.end:
            # Without stresses the scale has only its zero.
            labels = {0.0: "0"}
        bar.set_ticks(list(labels), labels=list(labels.values()))
        bar.set_label("von Mises stress (MPa),\nlarger of both faces", fontsize=18)


def draw_stress(
    scene: Scene, instants: Sequence[Instant], scale: StressScale, overlaps: Iterable[Overlap]
) -> Iterator[list[Image.Image]]:
    """Yield the stress pictures of each overlap: the whole boom above, a sectional view below."""
    assert scene.stress is not None
    times = [instant.time for instant in instants]
    corners = [
        smooth_corners(scene.stress, scene.triangles, stress.largest())
        for stress in scene.stress.instants(times)
    ]
    whole = BoomView.of(scene, instants, BOOM_PIXELS, BOOM_DISPLACEMENT)
    booms = []
    with stage(BOOM_PIXELS) as plotter:
        for time, values in zip(times, corners, strict=True):
            places = whole.places(scene.displacement(time), time)
            plotter.clear_actors()
            plotter.add_mesh(_surface_with_values(places, scene.triangles, values), **scale.look)
            plotter.add_mesh(whole.edges_at(places), color=theme.INK, line_width=2.4, **UNLIT)
            booms.append(whole.camera.render(plotter))
    aside = "from above; " if scene.from_above else ""
    for overlap in overlaps:
        view = OverlapView(scene, overlap, times, STRESS_PIXELS)
        sheet, images = view.sheet(floor=85), []
        scale.add_bar(sheet)
        with stage(STRESS_PIXELS) as plotter:
            for instant, values, boom in zip(instants, corners, booms, strict=True):
                sheet.show(boom, 20, 550)
                places = view.places(instant.time)
                stress = values, scale
                forces = view.draw(plotter, sheet, instant.time, places, CUT_COLORS, stress)
                sheet.write(
                    instant.heading(scene),
                    f"{aside}boom: displacements × {whole.scale:g}, sections × {SECTION_DRAWN:g}; "
                    f"overlap: cut open, × {view.scale:g}, cuts white (outer), grey (inner)\n"
                    f"{_ring_largest(sheet, view, places, values)}; "
                    f"{_largest(view, instant.time)}\n"
                    f"{forces}{_coarse_mesh_caution(view)}",
                )
                images.append(sheet.image())
        yield images


def _surface_with_values(points: Array, triangles: Numbers, values: Array) -> Any:
    """Return a surface of separate triangles with stresses, so that colours may jump at edges.

    Points (num_points, 3) are in m. Stresses (num_triangles, 3) in Pa are those at the corners of
    the triangles.
    """
    corner_numbers = np.arange(triangles.size, dtype=np.int32).reshape(triangles.shape)
    mesh = surface(points[triangles].reshape(-1, 3), corner_numbers)
    mesh["stress"] = TO_MEGA * values.ravel()
    return mesh


def smooth_corners(shell: ShellStress, triangles: Numbers, values: npt.ArrayLike) -> Array:
    """Return values (num_triangles, 3) at corners: means over triangles of the same wall there."""
    walls = int(shell.wall.max()) + 1
    of = (triangles.astype(np.int64) * walls + shell.wall[:, None]).ravel()
    _, number = np.unique(of, return_inverse=True)
    corner = number.reshape(triangles.shape)
    return np.asarray(means_around(corner, shell.areas, values)[corner])


def _largest(view: OverlapView, time: float) -> str:
    """Return a text on the largest triangle stress of both segments, hidden walls included."""
    stress, segment = view.stress.at(time).largest(), view.scene.segment
    triangle = int(np.where(np.isin(segment, view.numbers), stress, 0.0).argmax())
    x, _, _ = view.stress.centroids[triangle]
    return (
        f"single element: {digits(TO_MEGA * float(stress[triangle]))} MPa, "
        f"x = {x:.2f} m ({view.scene.boom.segments[int(segment[triangle])].name}, "
        f"{view.stress.wall_name(triangle)} wall)"
    )


def _ring_largest(sheet: Sheet, view: OverlapView, places: Array, values: Array) -> str:
    """Mark the largest smoothed stress of visible walls with a circle, and return its legend."""
    scene = view.scene
    visible = view.behind & np.isin(scene.segment, view.numbers)
    triangle = int(np.where(visible, values.max(axis=1), 0.0).argmax())
    corner = int(values[triangle].argmax())
    x, y = view.camera(places).project(places[scene.triangles[triangle, corner]])
    largest = f"{digits(TO_MEGA * float(values[triangle, corner]))} MPa"
    sheet.ring(float(x), float(y), largest)
    segment = scene.boom.segments[int(scene.segment[triangle])]
    place = f"x = {view.stress.centroids[triangle][0]:.2f} m ({segment.name})"
    return f"circle: nodal average {largest}, {place}"


def _coarse_mesh_caution(view: OverlapView) -> str:
    """Return a caution if webs have too few elements to resolve their stresses."""
    across_webs = []
    for number in view.numbers:
        x, _, z = view.scene.points[view.scene.owner == number].T
        inside = np.abs(z - 0.5 * (z.min() + z.max())) < 0.999 * 0.5 * np.ptp(z)
        counts = np.unique(x[inside].round(6), return_counts=True)[1]
        # Count the points of two webs, without those at their ends.
        across_webs.append(int(np.median(counts)) // 2 + 1)
    fewest = min(across_webs)
    return "" if fewest >= ENOUGH else f";  webs of {fewest} elements are coarse for stresses"


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
