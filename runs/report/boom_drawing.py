# SPDX-License-Identifier: LGPL-3.0-or-later
"""Drawing of the boom of a case in its initial position, with supports, loads and sections."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon, Rectangle
from matplotlib.path import Path as Sign
from matplotlib.ticker import MaxNLocator
from matplotlib.typing import HashableList

from protractile.geometry import typography
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Cylinder, Joint
from protractile.geometry.section import Plate, Section
from protractile.geometry.telescoping import farthest_travel
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.folder.files import atomic_path
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart
from protractile.runs.report.figure_context import Figure, FigureContext
from protractile.runs.report.marks import elevation
from protractile.runs.report.scene import Scene
from protractile.runs.report.static_charts import LEGEND_CHARACTERS, draw_curves
from protractile.runs.report.symbols import (
    Symbol,
    abbreviate,
    edges,
    marker_style,
)

# Height of the outermost section over the height of the panel, if heights are exaggerated.
SECTION_SHARE = 0.2
# Sizes of symbols in pt: standard, and if there are many.
SIGN, SMALL = 15.0, 9.0
# Size of the symbols of the whole boom, over its length.
WHOLE_SIGN = 0.04
# Heights in inches: panel along the boom, panel to scale (maximum, minimum), sections, line of the
# legend.
ALONG_HEIGHT, MAX_HEIGHT, MIN_HEIGHT, SECTIONS, LEGEND_LINE = 1.8, 2.6, 0.7, 1.6, 0.24
# Angle of the boom in degrees above which up to this number of sections are drawn beside it.
STEEP, BESIDE = 25.0, 3
# Number of characters that fit into a line of the legend.
LINE_CHARACTERS = 66
# Margin beside the boom, as a fraction of its length.
MARGIN = 0.06
# Maximum number of sections side by side, and their distance as a fraction of the largest width.
MOST, GAP = 8, 0.35

CAPTION = (
    "The boom in its initial position: elevation to scale, side view with its joints, sections. "
    "The legend explains the symbols; overlaps are shaded."
)


@dataclass(slots=True)
class Panel:
    """Panel with a drawing along the boom, and the meanings of its symbols."""

    axes: Axes  #: axes of the drawing
    boom: Boom  #: the boom
    height_factor: float  #: factor by which heights are exaggerated
    meanings: dict[str, Line2D] = field(default_factory=dict)  #: symbol of each legend text

    def outline(self, corners: Sequence[tuple[float, float]] | Array, **style: Any) -> None:
        """Draw a filled polygon from the x and z of its corners in m."""
        places = np.array(corners) * [1.0, self.height_factor]
        self.axes.add_patch(Polygon(places, closed=True, **style))

    def line(self, places: Sequence[Sequence[float] | Array] | Array, **style: Any) -> None:
        """Draw a line through x and z in m."""
        x, z = np.array(places).T
        self.axes.plot(x, self.height_factor * z, **style)

    def draw_symbol(self, symbol: Symbol) -> None:
        """Draw the symbol of a support or load at its places."""
        along, _, up = symbol.arm
        places = [(x + along, symbol.z(self.boom, x) + up) for x in symbol.places]
        if any(symbol.arm):
            foot = places[0][0] - along, places[0][1] - up
            self.line([foot, places[0]], clip_on=False, color=symbol.color, linewidth=1.6)
        size = SIGN if len(places) == 1 else SMALL
        self.line(places, clip_on=False, zorder=5, **marker_style(symbol.path, symbol.color, size))
        corners = np.asarray(symbol.path.vertices)
        centred = corners - 0.5 * (corners.min(axis=0) + corners.max(axis=0))
        in_legend = marker_style(Sign(centred, symbol.path.codes), symbol.color, SMALL)
        self.meanings.setdefault(symbol.meaning, Line2D([], [], **in_legend))


def boom(run: FigureContext) -> list[Figure]:
    """Return the drawing of the boom of a run."""
    drawing = partial(boom_sheet, run.case, build_boom(run.case))
    return [Figure("boom", "The boom", CAPTION, "case", drawing=drawing, main=True)]


def save_drawing(case: Case, file: str, picture: str) -> None:
    """Draw the boom of a case to scale and with exaggerated heights, and its sections, into a file.

    The file is written atomically. The name ``file`` of the case is for messages.

    Raises:
        BadInput: the path does not end with ``.png``.
    """
    if Path(picture).suffix.lower() != ".png":
        raise BadInput(file, f"--picture {picture}", "must end in .png")
    with atomic_path(Path(picture)) as part, rc_context(theme.RC):
        boom_sheet(case, build_boom(case)).savefig(part, format="png")


def boom_sheet(case: Case, boom: Boom) -> Sheet:
    """Return the sheet with the drawing of a boom."""
    angle = 0.0 if case.gravity is None else case.gravity.angle
    scene = Scene.at_rest(case, boom)
    alone = replace(scene, symbols=[one for one in scene.symbols if len(one.places) == 1])
    whole = elevation(alone, alone.points, 1.0, angle, WHOLE_SIGN)
    heights = np.concatenate([curve.values for curve in whole.curves])
    width, height = np.ptp(whole.time), np.nanmax(heights) - np.nanmin(heights)
    sections = [
        (number, segment.section)
        for number, segment in enumerate(boom.segments)
        if segment.section is not None
    ][:MOST]
    beside = abs(angle) > STEEP and 0 < len(sections) <= BESIDE
    room = (0.45 if beside else 1.0) * theme.WIDTH
    whole_height = min(max(MIN_HEIGHT, room * height / width), MAX_HEIGHT)
    rows: list[HashableList[str]] = [
        ["whole", "sections" if beside else "whole"],
        ["along", "along"],
    ]
    heights_of_rows = [whole_height, ALONG_HEIGHT]
    if sections and not beside:
        rows.append(["sections", "sections"])
        heights_of_rows.append(SECTIONS)
    sheet = Sheet(figsize=(theme.WIDTH, 1.0))
    panels: dict[str, Axes] = sheet.subplot_mosaic(rows, height_ratios=heights_of_rows)
    _draw_whole(panels["whole"], whole, boom, angle)
    detailed = Panel(panels["along"], boom, _height_factor(boom))
    _draw_along(detailed, scene.symbols)
    if sections:
        _draw_sections(panels["sections"], boom, sections)
    entries = detailed.meanings | dict.fromkeys(_remarks(case, boom), Line2D([], [], linestyle=""))
    columns = 2 if max(map(len, entries)) <= LEGEND_CHARACTERS else 1
    names = [fill(meaning, LINE_CHARACTERS) for meaning in entries]
    lines = -(-sum(name.count("\n") + 1 for name in names) // columns)
    sheet.set_size_inches(theme.WIDTH, sum(heights_of_rows) + 0.4 + LEGEND_LINE * (lines + 1))
    sheet.legend(
        [*entries.values()],
        names,
        loc="outside lower left",
        ncols=columns,
        fontsize=9.5,
        handletextpad=0.5,
        columnspacing=1.0,
        labelspacing=0.6,
    )
    return sheet


def _draw_whole(axes: Axes, whole: Chart, boom: Boom, angle: float) -> None:
    """Draw the boom to scale at its angle, with its supports and loads."""
    draw_curves([axes], whole)
    axes.set_aspect("equal")
    axes.margins(MARGIN)
    axes.set_axis_off()
    degrees = typography.with_minus_signs(f"{angle:g}°")
    axes.set_title(f"at {degrees}, to scale" if angle else "to scale", fontsize=10.0)
    if angle:
        radius = 0.18 * boom.length
        arc = np.radians(np.linspace(0.0, angle, 30))
        grey: dict[str, Any] = {"color": theme.PLAY_FREE, "linewidth": 0.9}
        axes.plot(radius * np.cos(arc), radius * np.sin(arc), **grey)
        axes.plot([0.0, 1.25 * radius], [0.0, 0.0], **grey)
        x, z = 1.15 * radius * np.cos(arc[15]), 1.15 * radius * np.sin(arc[15])
        axes.text(x, z, degrees, color=theme.PLAY_FREE, va="center", fontsize=10.0)


def _draw_along(panel: Panel, symbols: Sequence[Symbol]) -> None:
    """Draw the boom horizontally, with exaggerated heights, names and x."""
    _draw(panel, symbols)
    boom, axes, factor = panel.boom, panel.axes, panel.height_factor
    for number, segment in enumerate(boom.segments):
        # Each name stands above the visible part; many names alternate between two lines.
        hidden = boom.segments[number - 1].end if number else segment.start
        middle = 0.5 * (max(hidden, segment.start) + segment.end)
        axes.annotate(
            segment.name,
            (middle, factor * edges(boom, segment, middle)[1]),
            (0, 18 + 12 * (number % 2 if len(boom.segments) > 4 else 0)),
            textcoords="offset points",
            ha="center",
            color=theme.segment_color(number),
            fontweight="bold",
            annotation_clip=False,
        )
    margin = MARGIN * boom.length
    travel = max(0.0, farthest_travel(boom, len(boom.segments) - 1))
    ahead = max((symbol.arm[0] for symbol in symbols), default=0.0)
    reach = boom.segments[0].start - margin, boom.tip + max(travel, ahead) + margin
    tallest = factor * max(abs(z) for s in boom.segments for x in s.ends for z in edges(boom, s, x))
    axes.set(xlim=reach, ylim=(-2.9 * tallest, 2.6 * tallest), yticks=[])
    axes.grid(False)
    axes.spines["left"].set_visible(False)
    axes.xaxis.set_major_locator(MaxNLocator(9, steps=[1, 2, 5, 10]))
    axes.set_xlabel("x along the boom (m)", fontsize=10.0)
    exaggeration = f", heights × {factor:g}" if factor > 1.0 else ""
    axes.set_title(f"along the boom{exaggeration}", fontsize=10.0)


def _draw(panel: Panel, symbols: Sequence[Symbol]) -> None:
    """Draw the boom with its supports and loads."""
    for number in reversed(range(len(panel.boom.segments))):
        _draw_segment(panel, number)
    for joint in panel.boom.joints:
        _draw_stations(panel, joint)
    for symbol in (symbol for symbol in symbols if symbol.grounded):
        panel.draw_symbol(symbol)
    for cylinder in panel.boom.cylinders:
        _draw_cylinder(panel, cylinder)
    for symbol in (symbol for symbol in symbols if not symbol.grounded):
        panel.draw_symbol(symbol)


def _draw_segment(panel: Panel, number: int) -> None:
    boom, color = panel.boom, theme.segment_color(number)
    segment = boom.segments[number]
    (bottom, top), (last_bottom, last_top) = (edges(boom, segment, x) for x in segment.ends)
    tail, head = segment.ends
    box = [(tail, bottom), (head, last_bottom), (head, last_top), (tail, top)]
    panel.outline(box, facecolor=f"{theme.tint(color, 0.25)}bf", edgecolor=color, linewidth=1.0)
    if travel := farthest_travel(boom, number):
        dashed: dict[str, Any] = {"linewidth": 0.9, "linestyle": "--"}
        panel.outline(np.add(box, [travel, 0.0]), facecolor="none", edgecolor=color, **dashed)
        panel.meanings["extended position"] = Line2D([], [], color=theme.PLAY_FREE, **dashed)
    for collar in segment.collars:
        ends = collar.span
        walls = {strip.wall for strip in collar.strips(segment.widest)}
        both = zip(*(edges(boom, segment, x) for x in ends), strict=True)
        for side, edge in zip((-1, 1), both, strict=True):
            if segment.widest.face("z", side).plate in walls:
                panel.line([*zip(ends, edge, strict=True)], color=color, linewidth=2.6)
    for plate in segment.diaphragms:
        upright = [(plate.x, z) for z in edges(boom, segment, plate.x)]
        panel.line(upright, color=color, linewidth=1.6)


def _draw_stations(panel: Panel, joint: Joint) -> None:
    """Draw each station as bars across the clearance, above and below."""
    outer, inner = (panel.boom.segments[number] for number in (joint.outer, joint.inner))
    color = theme.PLAY_FREE if joint.bonded else theme.INK
    bar: dict[str, Any] = {"color": color, "linewidth": 4.0, "solid_capstyle": "butt"}
    for x in joint.stations:
        for ends in zip(edges(panel.boom, inner, x), edges(panel.boom, outer, x), strict=True):
            panel.line([(x, z) for z in ends], **bar)
    touching = "slide pads" if joint.padded else "contact stations"
    panel.meanings["bonded joint" if joint.bonded else touching] = Line2D([], [], **bar)


def _draw_cylinder(panel: Panel, cylinder: Cylinder) -> None:
    """Draw a cylinder from its lug, without its lower part."""
    lug, ground = np.array([cylinder.x, -cylinder.depth]), np.array(cylinder.ground)
    ground = lug + (ground - lug) * min(1.0, 0.6 / panel.height_factor)
    panel.line([lug * [1.0, 0.0], lug], color=theme.INK, linewidth=1.0)
    panel.line([lug, ground], color=theme.INK, linewidth=1.6)
    panel.line([0.5 * (lug + ground), ground], color=theme.INK, linewidth=4.0)
    thick = Line2D([], [], color=theme.INK, linewidth=4.0)
    panel.meanings[f"cylinder, {abbreviate(cylinder.axial_stiffness, 'N/m')}"] = thick


def _height_factor(boom: Boom) -> float:
    """Return the factor by which heights are exaggerated."""
    tallest = max(np.ptp(edges(boom, s, x)) for s in boom.segments for x in s.ends)
    wanted = (
        SECTION_SHARE * ALONG_HEIGHT * (1.0 + 2.0 * MARGIN) * boom.length / theme.WIDTH / tallest
    )
    return max(1.0, float(f"{wanted:.1g}"))


def _remarks(case: Case, boom: Boom) -> Iterator[str]:
    """Yield remarks on loads and supports without a symbol."""
    loose = [joint for joint in boom.joints if not joint.bonded]
    if loose:
        yield f"play {_join_values(1e3 * joint.play for joint in loose)} mm"
    if boom.spatial:
        lateral = (1e3 * (joint.lateral_play or 0.0) for joint in loose)
        yield f"lateral play {_join_values(lateral)} mm"
    if any(joint.friction for joint in loose):
        yield f"friction {_join_values(joint.friction for joint in loose)}"
    for base in case.base:
        yield f"the ground shakes along {base.direction}"
    if case.gravity is not None:
        yield f"self-weight, g = {typography.number(case.gravity.acceleration, 4)} m/s²"


def _join_values(values: Iterable[float]) -> str:
    return ", ".join(f"{value:g}" for value in sorted(set(values)))


def _draw_sections(axes: Axes, boom: Boom, sections: Sequence[tuple[int, Section]]) -> None:
    """Draw sections of segments side by side at the same scale, with pads and dimensions in mm."""
    widest = max(section.size("y") for _, section in sections)
    lowest = min(section.reach("z")[0] for _, section in sections)
    highest = max(section.reach("z")[1] for _, section in sections)
    pitch = (1.0 + GAP) * widest
    for number, (segment, section) in enumerate(sections):
        color = theme.segment_color(segment)
        for y, z, width, height in _pads(boom, segment, section):
            axes.add_patch(Rectangle((y + number * pitch, z), width, height, color=theme.INK, lw=0))
        for plate in section.plates:
            corners = _plate_outline(plate) + np.array([number * pitch, 0.0])
            axes.add_patch(Polygon(corners, closed=True, facecolor=color, edgecolor=color, lw=0.3))
        size = f"{1e3 * section.size('z'):.0f} × {1e3 * section.size('y'):.0f}"
        axes.annotate(
            f"{size}\n{_walls(section)}",
            (number * pitch, 1.03 * lowest),
            (0, -3),
            textcoords="offset points",
            ha="center",
            va="top",
            fontsize=9.0 if len(sections) < 4 else 8.0,
        )
    reach = -0.6 * pitch, (len(sections) - 0.4) * pitch
    axes.set(xlim=reach, ylim=(1.6 * lowest, 1.05 * highest), aspect="equal")
    axes.set_axis_off()
    axes.set_title("sections to scale; mid-lines\nand walls in mm", fontsize=10.0)


def _pads(boom: Boom, number: int, section: Section) -> Iterator[tuple[float, ...]]:
    """Yield the lowest (y, z), the width and the height in m of the pads on a section of a segment.

    A pad of unknown thickness fills the gap to the outer segment.
    """
    for joint in (joint for joint in boom.joints if joint.inner == number and joint.padded):
        outer = boom.segments[joint.outer]
        if outer.section is None:
            continue
        around = outer.section_at(joint.stations[0])
        for face in (face for face in section.faces if face.direction in boom.directions):
            gap = abs(around.face(face.direction, face.side).inside - face.outside)
            for size, *_ in joint.pads_of(face.direction, face.side):
                assert size is not None
                thickness = size.thickness or gap
                base = min(face.outside, face.outside + face.side * thickness)
                for near in (face.low + size.offset, face.high - size.offset - size.width):
                    flat = near, base, size.width, thickness
                    yield flat if face.direction == "z" else (base, near, thickness, size.width)


def _plate_outline(plate: Plate) -> Array:
    """Return the corners (4, 2) of a plate that extends half its thickness beyond both ends."""
    half = 0.5 * plate.thickness * plate.tangent
    start, end, across = plate.start - half, plate.end + half, np.array([-half[1], half[0]])
    return np.array([start - across, end - across, end + across, start + across])


def _walls(section: Section) -> str:
    """Return the thicknesses of webs and flanges in mm as text."""
    webs = {number for number, _ in section.shear_plates("z")}
    thick = [round(1e3 * plate.thickness, 1) for plate in section.plates]
    web, flange = (
        ", ".join(
            f"{t:g}" for t in sorted({t for i, t in enumerate(thick) if (i in webs) == is_web})
        )
        for is_web in (True, False)
    )
    if not flange or web == flange:
        return f"walls {web}" if web else ""
    both = "flanges\n" if "," in flange else "flange "
    return f"web {web}\n{both}{flange}"
