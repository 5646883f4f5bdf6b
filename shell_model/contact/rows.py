# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where the boom's shells touch, rub and are tied: rows over the segments they concern.

At a station the inner segment's top flange may press up against the outer one's, its bottom
flange down, and in space its webs to the sides. Which side is which comes from the joint, never
from a facet's normal, whose direction a mesh does not promise. Contact over the whole overlap
leaves the stations to friction.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dynamics.contact import ContactLaw, PowerContact
from dynamics.gap_builder import Contact, GapBuilder
from geometry.boom import Boom, BoomError, Direction, Stop
from geometry.contact_places import ContactLine, Pad, Stretch, pads, patch
from geometry.section import Side
from shell_model.contact.corner_lines import CornerLines
from shell_model.contact.stations import (
    Touch,
    across,
    corner,
    corner_patch,
    flange_patches,
    half_of,
    near_webs,
)
from shell_model.contact.surface import SurfaceOptions, SurfacePoint, surface_points
from shell_model.contact.wall_points import WallPoints
from shell_model.cross_section import Reading, relative
from shell_model.segment_shell import SegmentShell


def gap_rows(
    boom: Boom,
    shells: Sequence[SegmentShell],
    laws: Mapping[Direction, Sequence[ContactLaw]],
    line: ContactLine,
    surface: SurfaceOptions,
) -> GapBuilder[Reading]:
    """Rows of every pad, surface and stop. Collective.

    Args:
        boom: its joints and stops.
        shells: of its segments.
        laws: along each direction, one for each joint.
        line: where walls touch.
        surface: how, where it is the whole overlap.

    Raises:
        BoomError: the contact line does not suit the boom.
    """
    _check_line(boom, line)
    points = surface_points(boom, shells, laws, surface) if line == "surface" else []
    rows = GapBuilder([Contact(point.reading, point.law, point.station) for point in points])
    corners = [CornerLines(shell) for shell in shells]
    by_points = line == "across" or any(joint.pad for joint in boom.joints)
    walls = [WallPoints(shell) for shell in shells] if by_points else []
    for pad in pads(boom):
        touch = _touch(boom, pad, corners, walls, line)
        if line == "surface":
            pressing = tuple(i for i, point in enumerate(points) if _presses(point, pad))
        else:
            law = laws[pad.direction][pad.number]
            pressing = rows.press(pad.station, law, touch.points)
        rows.rub(pad.station, pad.joint.friction, touch.slide, pad.normal_force, pressing)
    for station, stop in boom.numbered_stops:
        law = PowerContact(stop.stiffness, stop.exponent, stop.clearance, stop.stiffness_below)
        rows.stop(station, law, _flanges(boom, stop, corners[stop.segment]))
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
            numbers = joint.inner, joint.outer
            ends = [(number, shells[number].outline(x)) for number in numbers]
            inner, outer = ((number, end.wall_deflection("z")) for number, end in ends)
            found.append(relative(inner, outer))
            if boom.spatial:
                inner, outer = ((number, end.wall_deflection("y")) for number, end in ends)
                found.append(relative(inner, outer))
                inner, outer = ((number, end.twist()) for number, end in ends)
                found.append(relative(inner, outer))
    return found


def _flanges(boom: Boom, stop: Stop, corners: CornerLines) -> list[tuple[Side, float, Reading]]:
    """A stop meets a flange above its webs, both at once."""
    stretch = Stretch.on(boom.segments[stop.segment], stop.x, boom.contact_length(stop))
    sides: tuple[Side, Side] = (1, -1)
    return [
        (side, 1.0, {stop.segment: corners.deflection(stretch, "z", 0.0, side)}) for side in sides
    ]


def _touch(
    boom: Boom,
    pad: Pad,
    corners: Sequence[CornerLines],
    walls: Sequence[WallPoints],
    line: ContactLine,
) -> Touch:
    """What a pad reads."""
    inner, outer = pad.joint.inner, pad.joint.outer
    covered = patch(boom, pad)
    if not boom.spatial and covered is not None:
        return flange_patches(pad, covered, walls[inner], walls[outer])
    length = boom.contact_length(pad.joint)
    pressed = (
        Stretch.on(boom.segments[inner], pad.x, length),
        Stretch.on(boom.segments[outer], pad.x, length),
    )
    if boom.spatial:
        touch = corner(pad, corners[inner], corners[outer], pressed)
        if covered is None:
            return touch
        return corner_patch(pad, covered, touch, walls[inner], walls[outer])
    section = boom.segments[inner].section
    assert section is not None
    if line == "across":
        return across(pad, walls[inner], walls[outer], pressed, section)
    return near_webs(pad, corners[inner], corners[outer], pressed)


def _presses(point: SurfacePoint, pad: Pad) -> bool:
    """Whether a surface point belongs to a pad: that of its station, in space of its corner."""
    if point.station != pad.station:
        return False
    return pad.side == 0 or (point.side == pad.side and point.half == half_of(pad))


def _check_line(boom: Boom, line: ContactLine) -> None:
    if boom.spatial and line == "across":
        raise BoomError(
            "contact_line",
            "'across' spreads the force over the flanges of a flat boom; in space the pads sit in "
            "the corners: give 'near webs' or 'surface'",
        )
    if line != "near webs" and any(joint.pad for joint in boom.joints):
        raise BoomError(
            "contact_line",
            f"{line!r} leaves no place to the joints' pads; give 'near webs', or leave pad out",
        )
