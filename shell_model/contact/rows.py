# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where the boom's shells touch, rub and are tied: rows over the segments they concern.

At a station the inner segment's top flange may press up against the outer one's, its bottom
flange down, and in space its webs to the sides. Which side is which comes from the joint, never
from a facet's normal, whose direction a mesh does not promise. Contact over the whole overlap
leaves the stations to friction.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from dynamics.contact import ContactLaw
from dynamics.gap_builder import Contact, GapBuilder
from geometry.boom import Boom, BoomError, Direction
from geometry.contact_places import ContactLine, Pad, pads
from geometry.drawing import drives_below
from geometry.rests import rests
from shell_model.contact.corner_lines import CornerLines
from shell_model.contact.stations import (
    Touch,
    across,
    corner,
    corner_patch,
    flange_patches,
    flanges,
    near_webs,
)
from shell_model.contact.surface import SurfaceOptions, SurfacePoint, surface_points
from shell_model.contact.wall_points import WallPoints
from shell_model.segment.cross_section import Outline, Reading, Row
from shell_model.segment.segment_shell import SegmentShell


@dataclass(frozen=True, slots=True)
class Touching:
    """What may touch, rub and drag of a boom's shells.

    Args:
        boom: its joints and stops.
        laws: along each direction, one for each joint.
        line: where walls touch.
        corners, walls: of the segments; no walls where nothing reads them.
        points: of a surface; none unless walls touch there.
    """

    boom: Boom
    laws: Mapping[Direction, Sequence[ContactLaw]]
    line: ContactLine
    corners: Sequence[CornerLines]
    walls: Sequence[WallPoints]
    points: Sequence[SurfacePoint]

    @classmethod
    def of(
        cls,
        boom: Boom,
        shells: Sequence[SegmentShell],
        laws: Mapping[Direction, Sequence[ContactLaw]],
        line: ContactLine,
        surface: SurfaceOptions,
    ) -> Touching:
        """Of shells. Collective.

        Args:
            boom, laws, line: see above.
            shells: of its segments.
            surface: how, where it is the whole overlap.

        Raises:
            BoomError: the contact line does not suit the boom.
        """
        _check_line(boom, line)
        points = surface_points(boom, shells, laws, surface) if line == "surface" else []
        by_points = line == "across" or any(joint.padded for joint in boom.joints)
        walls = [WallPoints(shell) for shell in shells] if by_points else []
        return cls(boom, laws, line, [CornerLines(shell) for shell in shells], walls, points)

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
                law = self.laws[pad.direction][pad.number]
                pressing = rows.press(pad.station, law, touch.points, pad.raised)
            rows.drag(pad.station, pad.joint.dashpot, touch.points)
            rows.rub(pad.station, pad.joint.friction, touch.slide, pad.normal_force, pressing)
        for rest in rests(boom):
            segment = rest.stop.segment
            way = sum(ways.get(number, 0.0) for number in drives_below(boom.joints, segment))
            rows.stop(
                rest.station, rest.stop, flanges(rest.drawn(boom, way), self.corners[segment])
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
    if pad.joint.lateral_clearance is not None:
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
