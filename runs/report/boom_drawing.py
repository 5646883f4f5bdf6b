# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom of a case as it is before anything moves: a drawing with all that holds and loads it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon
from matplotlib.path import Path as Shape
from matplotlib.ticker import MaxNLocator
from matplotlib.transforms import Affine2D, Transform
from matplotlib.typing import HashableList

from geometry.arrays import Array
from geometry.boom import Boom, Cylinder, Joint, Segment, Stop, Support
from geometry.drawing import farthest
from geometry.typography import signed
from runs.case.build import build_boom
from runs.case.messages import BadInput
from runs.case.schema import Case
from runs.folder.files import whole
from runs.report import numerals, symbols, theme
from runs.report.acting import Acting, acting, amount
from runs.report.figure_context import Figure, Pen
from runs.report.sections_drawing import draw_sections, shown_sections

# Of the panels' height the outermost section takes this part, in the one that draws heights larger.
SECTION_SHARE = 0.2
# A segment whose plates are unknown is drawn as high as this part of the boom's length.
UNKNOWN = 0.015
# Size of the signs in pt, and of those of which there are many.
SIGN, SMALL = 15.0, 9.0
# Heights in inches: of the panel along the boom, of the one to scale at most and at least, of the
# sections, of a line of the legend.
LYING, HIGHEST, LEAST, SECTIONS, LEGEND_LINE = 1.8, 2.6, 0.7, 1.6, 0.24
# Letters that fit in one of two columns of the legend.
LETTERS = 30
# A boom that stands steeper than so many degrees leaves room for so many sections beside it.
STEEP, BESIDE = 25.0, 3
# What is left free beside the boom, as a part of its length.
MARGIN = 0.06

CAPTION = (
    "The boom before anything moves: as it stands, along itself with its joints, and its sections. "
    "Signs are explained below the drawing; a segment is tinted where another one is inside it."
)


@dataclass(slots=True)
class Drawing:
    """A panel, and what its signs mean.

    Args:
        axes: of the panel.
        turn: from places along the boom to the panel's.
        larger: by how much heights are drawn larger.
        whole: whether it shows all of the boom and no details.
        meanings: text of the legend → its sign.
    """

    axes: Axes
    turn: Transform
    larger: float
    whole: bool
    meanings: dict[str, Line2D] = field(default_factory=dict)

    def outline(self, corners: Sequence[tuple[float, float]] | Array, **look: Any) -> None:
        """A filled polygon, x and z of its corners in m."""
        places = np.asarray(corners) * [1.0, self.larger]
        self.axes.add_patch(Polygon(self.turn.transform(places), closed=True, **look))

    def line(self, places: Sequence[Sequence[float] | Array] | Array, **look: Any) -> None:
        """Through x and z in m."""
        x, z = self.turn.transform(np.asarray(places) * [1.0, self.larger]).T
        self.axes.plot(x, z, **look)

    def sign(self, shape: Shape, places: Array, meaning: str, color: str = theme.INK) -> None:
        """One of :mod:`runs.report.symbols` at x and z in m, (num_places, 2)."""
        x, z = self.turn.transform(places * [1.0, self.larger]).T
        mark = _mark(shape, color, SIGN if len(places) == 1 else SMALL)
        self.axes.plot(x, z, clip_on=False, zorder=5, **mark)
        if meaning:
            self.meanings.setdefault(
                meaning, Line2D([], [], **_mark(_centred(shape), color, SMALL))
            )


def boom(pen: Pen) -> list[Figure]:
    """What the run is of."""
    path = pen.folder / "boom.png"
    if not path.exists():
        draw_boom_of(pen.case, path)
    return [Figure(path, "The boom", CAPTION, part="case")]


def draw_boom_of(case: Case, path: Path) -> None:
    """Draw a case's boom: to scale as it stands, along itself with heights larger, its sections.

    Args:
        case: whose boom it is.
        path: of the PNG file.
    """
    boom = build_boom(case)
    with rc_context(theme.RC):
        boom_sheet(case, boom).savefig(path, format="png")


def save_drawing(case: Case, file: str, picture: str) -> None:
    """Draw a case's boom into a file, whole or not at all.

    Args:
        case: whose boom it is.
        file: how messages call the case.
        picture: where it goes, as the user gave it.

    Raises:
        BadInput: that is no PNG file's name.
    """
    if Path(picture).suffix.lower() != ".png":
        raise BadInput(file, f"--picture {picture}", "must end in .png")
    with whole(Path(picture)) as part:
        draw_boom_of(case, part)


def boom_sheet(case: Case, boom: Boom) -> Sheet:
    """The drawing, before it is on the disk."""
    angle = 0.0 if case.gravity is None else case.gravity.angle
    low, high = _extent(boom, angle)
    sections = shown_sections(boom)
    beside = abs(angle) > STEEP and 0 < len(sections) <= BESIDE
    room = (0.45 if beside else 1.0) * theme.WIDTH
    standing = min(max(LEAST, room * (high - low)[1] / (high - low)[0]), HIGHEST)
    rows: list[HashableList[str]] = [
        ["whole", "sections" if beside else "whole"],
        ["along", "along"],
    ]
    heights = [standing, LYING]
    if sections and not beside:
        rows.append(["sections", "sections"])
        heights.append(SECTIONS)
    sheet = Sheet(figsize=(theme.WIDTH, 1.0))
    theme.Canvas(sheet)
    panels: dict[str, Axes] = sheet.subplot_mosaic(rows, height_ratios=heights)
    acts = list(acting(case, boom))
    _draw_whole(
        Drawing(panels["whole"], Affine2D().rotate_deg(angle), 1.0, True), boom, acts, angle
    )
    lying = Drawing(panels["along"], Affine2D(), _larger(boom), False)
    _draw_along(lying, boom, acts)
    if sections:
        draw_sections(panels["sections"], sections)
    handles = [*lying.meanings.values()]
    said = list(_said(case, boom))
    handles += [Line2D([], [], linestyle="") for _ in said]
    labels = [*lying.meanings, *said]
    columns = 2 if max(map(len, labels)) <= LETTERS else 1
    lines = -(-len(handles) // columns)
    sheet.set_size_inches(theme.WIDTH, sum(heights) + 0.4 + LEGEND_LINE * (lines + 1))
    sheet.legend(
        handles,
        labels,
        loc="outside lower left",
        ncols=columns,
        fontsize=9.5,
        handletextpad=0.5,
        columnspacing=1.0,
        labelspacing=0.6,
    )
    return sheet


def _draw_whole(drawing: Drawing, boom: Boom, acts: Sequence[Acting], angle: float) -> None:
    """To scale, at its angle, between what it stands on and what it carries."""
    _draw(drawing, boom, [act for act in acts if len(act.places) == 1], angle)
    low, high = _extent(boom, angle)
    axes, margin = drawing.axes, MARGIN * boom.length
    axes.set_xlim(low[0] - margin, high[0] + margin)
    axes.set_ylim(low[1] - margin, high[1] + margin)
    axes.set_aspect("equal")
    axes.set_axis_off()
    degrees = signed(f"{angle:g}°")
    axes.set_title(f"at {degrees}, to scale" if angle else "to scale", fontsize=10.0)
    if angle:
        reach = 0.18 * boom.length
        turns = np.radians(np.linspace(0.0, angle, 30))
        grey: dict[str, Any] = {"color": theme.PLAY_FREE, "linewidth": 0.9}
        axes.plot(reach * np.cos(turns), reach * np.sin(turns), **grey)
        axes.plot([0.0, 1.25 * reach], [0.0, 0.0], **grey)
        x, z = 1.15 * reach * np.cos(turns[15]), 1.15 * reach * np.sin(turns[15])
        axes.text(x, z, degrees, color=theme.PLAY_FREE, va="center", fontsize=10.0)


def _draw_along(drawing: Drawing, boom: Boom, acts: Sequence[Acting]) -> None:
    """Lying, with heights larger, names and x."""
    _draw(drawing, boom, acts, 0.0)
    _name_segments(drawing, boom)
    axes, larger = drawing.axes, drawing.larger
    margin = MARGIN * boom.length
    axes.set_xlim(boom.segments[0].start - margin, boom.tip + _farthest(boom) + margin)
    tallest = larger * max(
        abs(z) for s in boom.segments for x in s.ends for z in _reach(s, boom, x)
    )
    axes.set_ylim(-2.9 * tallest, 2.6 * tallest)
    axes.grid(False)
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    axes.xaxis.set_major_locator(MaxNLocator(9, steps=[1, 2, 5, 10]))
    axes.set_xlabel("x along the boom (m)", fontsize=10.0)
    drawn = f", heights × {larger:g}" if larger > 1.0 else ""
    axes.set_title(f"along the boom{drawn}", fontsize=10.0)


def _draw(drawing: Drawing, boom: Boom, acts: Sequence[Acting], angle: float) -> None:
    """The boom with everything that holds and loads it."""
    for number in reversed(range(len(boom.segments))):
        _segment(drawing, boom, number)
    if not drawing.whole:
        for joint in boom.joints:
            _stations(drawing, boom, joint)
    for segment in boom.segments:
        for support in segment.supports:
            _support(drawing, boom, segment, support)
    for cylinder in boom.cylinders:
        _cylinder(drawing, cylinder)
    for stop in boom.stops:
        _stop(drawing, boom, stop)
    for act in acts:
        places = np.array(
            [(x, _edge(act.edge, boom.segments[act.segment], boom, x)) for x in act.places]
        )
        drawing.sign(act.turned(angle), places, act.meaning, act.color)


def _segment(drawing: Drawing, boom: Boom, number: int) -> None:
    segment = boom.segments[number]
    color = _color(number)
    (bottom, top), (last_bottom, last_top) = (_reach(segment, boom, x) for x in segment.ends)
    tail, head = segment.ends
    box = [(tail, bottom), (head, last_bottom), (head, last_top), (tail, top)]
    drawing.outline(box, facecolor=(*theme.tint(color, 0.25), 0.75), edgecolor=color, linewidth=1.0)
    if way := farthest(boom, number):
        look: dict[str, Any] = {"linewidth": 0.9, "linestyle": "--"}
        drawing.outline(
            np.array(box) + np.array([way, 0.0]), facecolor="none", edgecolor=color, **look
        )
        drawing.meanings["drawn to"] = Line2D([], [], color=theme.PLAY_FREE, **look)
    if drawing.whole:
        return
    for collar in segment.collars:
        places = collar.start, collar.end
        for edge in zip(*(_reach(segment, boom, x) for x in places), strict=True):
            drawing.line([*zip(places, edge, strict=True)], color=color, linewidth=2.6)
    for plate in segment.diaphragms:
        upright = [(plate.x, z) for z in _reach(segment, boom, plate.x)]
        drawing.line(upright, color=color, linewidth=1.6)


def _stations(drawing: Drawing, boom: Boom, joint: Joint) -> None:
    """Bars across what the two segments leave between them, above and below."""
    outer, inner = (boom.segments[number] for number in (joint.outer, joint.inner))
    color = theme.PLAY_FREE if joint.tied else theme.INK
    look: dict[str, Any] = {"color": color, "linewidth": 4.0, "solid_capstyle": "butt"}
    for x in joint.stations:
        for ends in zip(_reach(inner, boom, x), _reach(outer, boom, x), strict=True):
            drawing.line([(x, z) for z in ends], **look)
    what = "slide pads" if joint.padded else "where segments touch"
    drawing.meanings["tied" if joint.tied else what] = Line2D([], [], **look)


def _support(drawing: Drawing, boom: Boom, segment: Segment, support: Support) -> None:
    bottom, _ = _reach(segment, boom, support.x)
    place = np.array([(support.x, -support.depth or bottom)])
    if support.kind == "clamped":
        drawing.sign(symbols.CLAMPED, place * [1.0, 0.0], "clamped")
    elif support.stiffness is None:
        drawing.sign(symbols.PINNED, place, "support")
    else:
        drawing.sign(symbols.ELASTIC, place, f"elastic support, {amount(support.stiffness, 'N/m')}")


def _cylinder(drawing: Drawing, cylinder: Cylinder) -> None:
    """From lug to ground; without its lower part where not all is shown."""
    lug, ground = np.array([cylinder.x, -cylinder.depth]), np.array(cylinder.ground)
    if not drawing.whole:
        ground = lug + (ground - lug) * min(1.0, 0.6 / drawing.larger)
    middle = 0.5 * (lug + ground)
    drawing.line([lug * [1.0, 0.0], lug], color=theme.INK, linewidth=1.0)
    drawing.line([lug, ground], color=theme.INK, linewidth=1.6)
    drawing.line([middle, ground], color=theme.INK, linewidth=4.0)
    if drawing.whole:
        drawing.sign(symbols.PINNED, ground[None], "")
    thick = Line2D([], [], color=theme.INK, linewidth=4.0)
    drawing.meanings[f"cylinder, {amount(cylinder.stiffness, 'N/m')}"] = thick


def _stop(drawing: Drawing, boom: Boom, stop: Stop) -> None:
    play = f"rest, {2e3 * stop.clearance:g} mm of play"
    reached = _reach(boom.segments[stop.segment], boom, stop.x)
    sides = ((-1.0, stop.stiffness_below), (1.0, stop.stiffness))
    for (side, stiffness), z in zip(sides, reached, strict=True):
        if stiffness > 0.0:
            drawing.sign(symbols.rest(side), np.array([(stop.x, z)]), play, theme.PLAY_FREE)


def _color(number: int) -> str:
    """Of a segment."""
    return theme.PALETTE[number % len(theme.PALETTE)]


def _reach(segment: Segment, boom: Boom, x: float) -> tuple[float, float]:
    """z in m of the lower and the upper edge at x."""
    half = 0.5 * UNKNOWN * boom.length
    return (-half, half) if segment.section is None else segment.section_at(x).reach("z")


def _edge(name: str, segment: Segment, boom: Boom, x: float) -> float:
    """z in m of the edge at x on which a sign stands."""
    bottom, top = _reach(segment, boom, x)
    return {"top": top, "bottom": bottom, "axis": 0.0}[name]


def _extent(boom: Boom, angle: float) -> tuple[Array, Array]:
    """(2,) the lowest and the highest place of a boom at an angle in degrees, in m."""
    ends = [(x, z) for s in boom.segments for x in s.ends for z in _reach(s, boom, x)]
    ends.append((boom.tip + _farthest(boom), 0.0))
    places = np.array([*ends, *(one.ground for one in boom.cylinders)])
    turned = Affine2D().rotate_deg(angle).transform(places)
    return turned.min(axis=0), turned.max(axis=0)


def _farthest(boom: Boom) -> float:
    """How far in m the tip comes beyond where it is."""
    return max(0.0, farthest(boom, len(boom.segments) - 1))


def _larger(boom: Boom) -> float:
    """By how much heights are drawn larger."""
    tallest = max(np.ptp(_reach(s, boom, x)) for s in boom.segments for x in s.ends)
    wanted = SECTION_SHARE * LYING * (1.0 + 2.0 * MARGIN) * boom.length / theme.WIDTH / tallest
    return max(1.0, float(f"{wanted:.1g}"))


def _name_segments(drawing: Drawing, boom: Boom) -> None:
    """Above the part of each that is seen, the names of many on two lines."""
    for number, segment in enumerate(boom.segments):
        hidden = boom.segments[number - 1].end if number else segment.start
        middle = 0.5 * (max(hidden, segment.start) + segment.end)
        drawing.axes.annotate(
            segment.name,
            (middle, drawing.larger * _reach(segment, boom, middle)[1]),
            (0, 18 + 12 * (number % 2 if len(boom.segments) > 4 else 0)),
            textcoords="offset points",
            ha="center",
            color=_color(number),
            fontweight="bold",
            annotation_clip=False,
        )


def _mark(shape: Shape, color: str, size: float) -> dict[str, Any]:
    """How a sign is drawn; matplotlib scales a path by its farthest point."""
    return {
        "marker": shape,
        "markersize": 2.0 * size * float(np.abs(shape.vertices).max()),
        "linestyle": "",
        "markeredgecolor": color,
        "markerfacecolor": "none",
        "markeredgewidth": 1.1,
    }


def _centred(shape: Shape) -> Shape:
    """As a legend has it."""
    corners = np.asarray(shape.vertices)
    return Shape(corners - 0.5 * (corners.min(axis=0) + corners.max(axis=0)), shape.codes)


def _said(case: Case, boom: Boom) -> Iterator[str]:
    """What has no sign."""
    loose = [joint for joint in boom.joints if not joint.tied]
    if loose:
        yield f"play {_several(2e3 * joint.clearance for joint in loose)} mm"
    if boom.spatial:
        sideways = (2e3 * (joint.lateral_clearance or 0.0) for joint in loose)
        yield f"sideways {_several(sideways)} mm"
    if any(joint.friction for joint in loose):
        yield f"friction {_several(joint.friction for joint in loose)}"
    for base in case.base:
        yield f"the ground shakes along {base.direction}"
    if case.gravity is not None:
        yield f"weights by {numerals.number(case.gravity.acceleration, 4)} m/s²"


def _several(values: Iterable[float]) -> str:
    return ", ".join(f"{value:g}" for value in sorted(set(values)))
