# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where the boom's shells touch, rub and are tied: rows over the segments they concern.

At a station the inner segment's top flange may press up against the outer one's, its bottom
flange down, and in space its webs to the sides. Which side is which comes from the joint, never
from a facet's normal, whose direction a mesh does not promise. Contact over the whole overlap
leaves the stations to friction.

The points of each wall have weights that sum to one, so that a uniform approach gives the paper's
law (4) exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from dynamics.gap_builder import Contact, GapBuilder
from geometry.arrays import Array
from geometry.boom import Boom, BoomError, Direction
from geometry.contact_places import ContactLine, Pad, Patch, Rest, Stretch, pads, rests
from geometry.drawing import drives_below
from geometry.section import Section, Side
from shell_model.contact.surface import SurfaceOptions, SurfacePoint, surface_points
from shell_model.contact.wall_rows import CornerLines, Wall, WallPoints, gauss
from shell_model.segment.cross_section import Outline, Reading, Row
from shell_model.segment.segment_shell import SegmentShell

_SIDES: tuple[Side, Side] = (1, -1)

# Gauss's rule over a patch, along x and across.
_POINTS = 4


class Touch(NamedTuple):
    """Side, weight and approach of each pair of points of a pad, and how the pad slides."""

    points: Sequence[tuple[Side, float, Reading]]
    slide: Reading


def near_webs(pad: Pad, inner: CornerLines, outer: CornerLines) -> Touch:
    """A station of a flat boom, from web to web; both flanges together slide as their mean does."""

    def along(side: Side) -> Reading:
        rows = (
            lines.deflection(stretch, "z", 0.0, side)
            for lines, stretch in zip((inner, outer), pad.pressed, strict=True)
        )
        return _approach(pad, *rows)

    return _sliding_as_its_mean([(side, 1.0, along(side)) for side in _SIDES])


def across(pad: Pad, inner: WallPoints, outer: WallPoints) -> Touch:
    """A station of a flat boom over the width of the inner section's faces. Collective."""
    points = []
    for side in _SIDES:
        for y, weight in zip(
            *_half_gauss(_touching(pad, inner).face("z", side).width), strict=True
        ):
            rows = (
                walls.mean(Wall("z", side), *_line(stretch, y), "z")
                for walls, stretch in zip((inner, outer), pad.pressed, strict=True)
            )
            points.append((side, weight, _approach(pad, *rows)))
    return _sliding_as_its_mean(points)


def corner(pad: Pad, inner: CornerLines, outer: CornerLines) -> Touch:
    """A pad of a boom in space."""

    def along(direction: Direction) -> Reading:
        rows = (
            lines.deflection(stretch, direction, *offset)
            for lines, stretch, offset in zip(
                (inner, outer), pad.pressed, (pad.inner, pad.outer), strict=True
            )
        )
        return _approach(pad, *rows)

    return Touch([(pad.side, pad.weight, along(pad.direction))], along(pad.rubs))


def flange_patches(pad: Pad, patch: Patch, inner: WallPoints, outer: WallPoints) -> Touch:
    """A station of a flat boom with pads of a size; it slides as :func:`near_webs`. Collective."""
    points = []
    for side in (pad.side,) if pad.side else _SIDES:
        right, left = (_mean_approach(pad, patch, side, half, inner, outer) for half in (1, -1))
        points.append((side, pad.weight, 0.5 * right + 0.5 * left))
    if pad.side:
        return Touch(points, points[0][2])
    return _sliding_as_its_mean(points)


def corner_patch(
    pad: Pad, patch: Patch, at_corner: Touch, inner: WallPoints, outer: WallPoints
) -> Touch:
    """A pad of a size in space; it slides as its corner does. Collective."""
    reading = _mean_approach(pad, patch, pad.side, pad.half, inner, outer)
    return Touch([(pad.side, pad.weight, reading)], at_corner.slide)


def flanges(rest: Rest, corners: CornerLines) -> list[tuple[Side, float, Reading]]:
    """Side, weight and approach of a stop, which meets a flange above its webs, both at once."""
    return [
        (
            side,
            1.0,
            Reading({rest.stop.segment: corners.deflection(rest.pressed, "z", 0.0, side)}),
        )
        for side in _SIDES
    ]


def _mean_approach(
    pad: Pad, patch: Patch, side: Side, half: int, inner: WallPoints, outer: WallPoints
) -> Reading:
    """Mean of u − w over a patch: read the other way round, a uniform pressure on both walls."""
    x, along = gauss(patch.start, patch.end, _POINTS)
    near, far = patch.across(_touching(pad, inner).face(pad.direction, side))
    y, over = gauss(half * near, half * far, _POINTS)
    places = np.column_stack([np.repeat(x, y.size), np.tile(y, x.size)])
    weights = np.outer(along, over).ravel()
    wall = Wall(pad.direction, side)
    rows = (
        walls.mean(wall, places + np.array([by, 0.0]), weights, pad.direction)
        for walls, by in zip((inner, outer), pad.moved, strict=True)
    )
    return _approach(pad, *rows)


def _touching(pad: Pad, inner: WallPoints) -> Section:
    """The section of the inner segment where a pad presses it."""
    return inner.segment.section_at(pad.x + pad.moved[0])


def _sliding_as_its_mean(points: Sequence[tuple[Side, float, Reading]]) -> Touch:
    first, *others = (0.5 * weight * approach for _, weight, approach in points)
    return Touch(points, sum(others, first))


def _half_gauss(width: float) -> tuple[Array, Array]:
    """Places at positive y of Gauss's rule with eight points over a width; weights sum to one."""
    y, weights = gauss(-0.5 * width, 0.5 * width, 8)
    return y[y > 0.0], 2.0 * weights[y > 0.0]


def _line(stretch: Stretch, y: float) -> tuple[Array, Array]:
    """Places (num_places, 2) at ±y along a stretch, and their weights, which sum to one."""
    x, weights = gauss(stretch.start, stretch.end, _POINTS)
    forces = 0.5 * weights * (stretch.end - stretch.start) * stretch.density(x)
    places = np.column_stack([np.tile(x, 2), np.repeat([y, -y], x.size)])
    return places, np.tile(forces, 2)


def _approach(pad: Pad, inner: Row, outer: Row) -> Reading:
    """u − w of the two points."""
    return Reading({pad.joint.inner: inner, pad.joint.outer: -outer})


@dataclass(frozen=True, slots=True)
class Touching:
    """What may touch, rub and drag of a boom's shells.

    Args:
        boom: its joints and stops.
        line: where walls touch.
        corners, walls: of the segments; no walls where nothing reads them.
        points: of a surface; none unless walls touch there.
    """

    boom: Boom
    line: ContactLine
    corners: Sequence[CornerLines]
    walls: Sequence[WallPoints]
    points: Sequence[SurfacePoint]

    @classmethod
    def of(
        cls,
        boom: Boom,
        shells: Sequence[SegmentShell],
        line: ContactLine,
        surface: SurfaceOptions,
    ) -> Touching:
        """Of shells. Collective.

        Args:
            boom, line: see above.
            shells: of its segments.
            surface: how, where it is the whole overlap.

        Raises:
            BoomError: the contact line does not suit the boom.
        """
        _check_line(boom, line)
        points = surface_points(boom, shells, surface) if line == "surface" else []
        by_points = line == "across" or any(joint.padded for joint in boom.joints)
        walls = [WallPoints(shell) for shell in shells] if by_points else []
        return cls(boom, line, [CornerLines(shell) for shell in shells], walls, points)

    def rows(self, ways: Mapping[int, float]) -> GapBuilder[Reading]:
        """Rows of every pad, surface, stop and dashpot where joints are drawn out by ``ways`` in m.

        Collective.
        """
        boom, points = self.boom, self.points
        rows = GapBuilder([Contact(point.reading, point.law, point.station) for point in points])
        for pad in pads(boom):
            touch = _touch(
                pad.drawn(boom, ways.get(pad.number, 0.0)), self.corners, self.walls, self.line
            )
            if self.line == "surface":
                pressing = tuple(i for i, point in enumerate(points) if point.presses(pad))
            else:
                law = pad.joint.law(pad.direction)
                pressing = rows.press(pad.station, law, touch.points, pad.raised)
            rows.drag(pad.station, pad.joint.dashpot, touch.points)
            rows.rub(pad.station, pad.joint.friction, touch.slide, pad.normal_force, pressing)
        for rest in rests(boom):
            segment = rest.stop.segment
            way = sum(ways.get(number, 0.0) for number in drives_below(boom.joints, segment))
            rows.stop(
                rest.station, rest.stop.law, flanges(rest.drawn(boom, way), self.corners[segment])
            )
        return rows


def ties(boom: Boom, shells: Sequence[SegmentShell]) -> list[Reading]:
    """What the tied joints keep at zero: relative deflections, and in space the twist. Collective.

    Each is read in the walls that carry its force in their own plane.
    """
    found: list[Reading] = []
    for joint in boom.joints:
        if not joint.tied:
            continue
        for x in joint.stations:
            ends = joint.inner, joint.outer
            outlines = [shells[number].outline(x) for number in ends]
            for read in _TIED_IN_SPACE if boom.spatial else _TIED_IN_PLANE:
                inner, outer = (read(outline) for outline in outlines)
                found.append(Reading({joint.inner: inner, joint.outer: -outer}))
    return found


_TIED_IN_PLANE: Sequence[Callable[[Outline], Row]] = (
    partial(Outline.wall_deflection, direction="z"),
)
_TIED_IN_SPACE: Sequence[Callable[[Outline], Row]] = (
    *_TIED_IN_PLANE,
    partial(Outline.wall_deflection, direction="y"),
    Outline.twist,
)


def _touch(
    pad: Pad, corners: Sequence[CornerLines], walls: Sequence[WallPoints], line: ContactLine
) -> Touch:
    """What a pad reads."""
    ends = pad.joint.inner, pad.joint.outer
    lines = [corners[number] for number in ends]
    if pad.joint.lateral_play is not None:
        touch = corner(pad, *lines)
        if pad.patch is None:
            return touch
        return corner_patch(pad, pad.patch, touch, *(walls[number] for number in ends))
    if pad.patch is not None:
        return flange_patches(pad, pad.patch, *(walls[number] for number in ends))
    if line == "across":
        return across(pad, *(walls[number] for number in ends))
    return near_webs(pad, *lines)


def _check_line(boom: Boom, line: ContactLine) -> None:
    for segment in boom.segments:
        if line == "surface" and segment.head_section is not None:
            raise BoomError(
                "contact_line",
                f"'surface' lets parallel walls touch, and {segment.name!r} tapers; give 'near "
                "webs', or 'across'",
            )
    if boom.spatial and line == "across":
        raise BoomError(
            "contact_line",
            "'across' spreads the force over the flanges of a flat boom; in space the pads sit in "
            "the corners: give 'near webs' or 'surface'",
        )
    if line != "near webs" and any(joint.padded for joint in boom.joints):
        raise BoomError(
            "contact_line",
            f"{line!r} leaves no place to the joints' pads; give 'near webs', or leave pad out",
        )
