# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows of contacts, friction and bonded joints between the shells of a boom.

At a station, contact is possible above and below the inner segment, in 3-D also at its sides. The
sides follow from the joint, since facet normals of a mesh have arbitrary signs. With surface
contact, stations have friction only. The weights of points on each wall sum to one, so that a
uniform displacement gives the contact law exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from protractile.dynamics.gap_builder import GapBuilder, LawRow
from protractile.geometry.boom import Boom, BoomError, Direction
from protractile.geometry.contact_places import ContactLine, ContactPair, Patch, pads, stop_patches
from protractile.geometry.section import EACH_SIDE, Offset, Section, Side
from protractile.geometry.telescoping import drives_below
from protractile.shell_model.contact.surface import SurfaceOptions, SurfacePoint, surface_points
from protractile.shell_model.contact.wall_rows import CornerLines, Wall, WallPoints, gauss
from protractile.shell_model.segment.cross_section import Operator, Row, SectionNodes
from protractile.shell_model.segment.segment_shell import SegmentShell

# Numbers of Gauss points of a patch, along x and across.
_POINTS = 4


# Contact point: side, weight, and operator of the relative displacement u − w.
_Point = tuple[Side, float, Operator]


@dataclass(frozen=True, slots=True)
class _PadOperators:
    """Operators of the relative displacements u − w at a pad."""

    pad: ContactPair  #: the pad
    corners: Sequence[CornerLines]  #: corner lines of all segments
    walls: Sequence[WallPoints]  #: walls of all segments; empty if no contact is on a wall

    def contact(self, line: ContactLine) -> tuple[list[_Point], Operator]:
        """Return the contact points and the operator of the sliding displacement. Collective."""
        pad = self.pad
        if pad.joint.lateral_play is not None:
            if pad.patch is None:
                approach = self.at_corners(pad.station.direction, pad.inner, pad.outer)
            else:
                approach = self.over_patch(pad.patch, pad.side, pad.half)
            slide = self.at_corners(pad.sliding_direction, pad.inner, pad.outer)
            return [(pad.side, pad.weight, approach)], slide
        points = []
        for side in (pad.side,) if pad.side else EACH_SIDE:
            if pad.patch is not None:
                right, left = (self.over_patch(pad.patch, side, half) for half in (1, -1))
                points.append((side, pad.weight, 0.5 * right + 0.5 * left))
            elif line == "across":
                points += self.across(side)
            else:
                at = 0.0, side
                points.append((side, pad.weight, self.at_corners("z", at, at)))
        if pad.side:
            return points, points[0][2]
        # The sliding displacement is the mean of both flanges.
        first, *others = (0.5 * weight * approach for _, weight, approach in points)
        return points, sum(others, first)

    def at_corners(self, direction: Direction, inner: Offset, outer: Offset) -> Operator:
        """Return the operator of u − w on the corners at offsets (y, z) in m of both segments."""
        places = zip(self._ends, self.pad.intervals, (inner, outer), strict=True)
        rows = (self.corners[n].deflection(at, direction, *offset) for n, at, offset in places)
        return self._approach(*rows)

    def across(self, side: Side) -> Iterator[_Point]:
        """Yield contact points over the width of a face of the inner section. Collective."""
        width = self._inner_section.face("z", side).width
        across, shares = gauss(-0.5 * width, 0.5 * width, 8)
        for y, share in zip(across[across > 0.0], 2.0 * shares[across > 0.0], strict=True):
            rows = []
            for number, stretch in zip(self._ends, self.pad.intervals, strict=True):
                # Points at ±y along the interval, with weights that sum to one.
                x, weights = gauss(stretch.start, stretch.end, _POINTS)
                force = 0.5 * weights * (stretch.end - stretch.start) * stretch.line_load(x)
                places = np.column_stack([np.tile(x, 2), np.repeat([y, -y], x.size)])
                mean = self.walls[number].mean
                rows.append(mean(Wall("z", side), places, np.tile(force, 2), "z"))
            yield side, share, self._approach(*rows)

    def over_patch(self, patch: Patch, side: Side, half: int) -> Operator:
        """Return the operator of the mean of u − w over a patch. Collective."""
        x, along = gauss(patch.start, patch.end, _POINTS)
        near, far = patch.across(self._inner_section.face(self.pad.station.direction, side))
        y, over = gauss(half * near, half * far, _POINTS)
        places = np.column_stack([np.repeat(x, y.size), np.tile(y, x.size)])
        weights = np.outer(along, over).ravel()
        wall = Wall(self.pad.station.direction, side)
        rows = (
            self.walls[n].mean(wall, places + np.array([by, 0.0]), weights, wall.normal)
            for n, by in zip(self._ends, self.pad.travel, strict=True)
        )
        return self._approach(*rows)

    @property
    def _inner_section(self) -> Section:
        """The section of the inner segment at the pad."""
        inner = self.walls[self.pad.joint.inner].segment
        return inner.section_at(self.pad.station.x + self.pad.travel[0])

    @property
    def _ends(self) -> tuple[int, int]:
        return self.pad.joint.inner, self.pad.joint.outer

    def _approach(self, inner: Row, outer: Row) -> Operator:
        return Operator({self.pad.joint.inner: inner, self.pad.joint.outer: -outer})


@dataclass(frozen=True, slots=True)
class ShellContacts:
    """Possible contacts, friction and dashpots between the shells of a boom."""

    boom: Boom  #: boom with joints and stops
    line: ContactLine  #: contact line on the walls
    corners: Sequence[CornerLines]  #: corner lines of all segments
    walls: Sequence[WallPoints]  #: walls of all segments; empty if no contact is on a wall
    points: Sequence[SurfacePoint]  #: points of surface contact; none otherwise

    @classmethod
    def from_shells(
        cls,
        boom: Boom,
        shells: Sequence[SegmentShell],
        line: ContactLine,
        surface: SurfaceOptions,
    ) -> ShellContacts:
        """Return the contacts between shells. Collective.

        Args:
            boom, line: as in the class.
            shells: shell of each segment.
            surface: options of surface contact, if it is used.

        Raises:
            BoomError: the contact line does not suit the boom.
        """
        _check_line(boom, line)
        points = surface_points(boom, shells, surface) if line == "surface" else []
        by_points = line == "across" or any(joint.padded for joint in boom.joints)
        walls = [WallPoints(shell) for shell in shells] if by_points else []
        return cls(boom, line, [CornerLines(shell) for shell in shells], walls, points)

    def rows(self, extensions: Mapping[int, float]) -> GapBuilder[Operator]:
        """Return the rows of pads, surfaces, stops and dashpots. Collective.

        ``extensions`` are the extensions of joints in m.
        """
        boom, points = self.boom, self.points
        rows = GapBuilder([LawRow(point.operator, point.law, point.station) for point in points])
        for pad in pads(boom):
            station, joint = pad.station, pad.joint
            extended = pad.at_extension(boom, extensions.get(station.number, 0.0))
            touching, slide = _PadOperators(extended, self.corners, self.walls).contact(self.line)
            if self.line == "surface":
                pressing = tuple(i for i, point in enumerate(points) if point.presses(pad))
            else:
                pressing = rows.add_contact(station.index, station.law, touching, pad.shim)
            rows.add_dashpot(station.index, joint.dashpot, touching)
            rows.add_friction(station.index, joint.friction, slide, pad.normal_force, pressing)
        for rest in stop_patches(boom):
            segment, drives = rest.stop.segment, drives_below(boom.joints, rest.stop.segment)
            extension = sum(extensions.get(number, 0.0) for number in drives)
            interval, lines = rest.at_extension(boom, extension).interval, self.corners[segment]
            # A stop touches a flange at both webs.
            flanges = [
                (side, 1.0, Operator({segment: lines.deflection(interval, "z", 0.0, side)}))
                for side in EACH_SIDE
            ]
            rows.add_stop(rest.station.index, rest.station.law, flanges)
        return rows


def ties(boom: Boom, shells: Sequence[SegmentShell]) -> list[Operator]:
    """Return operators that bonded joints constrain to zero. Collective.

    They are relative deflections, in 3-D booms also twist. Constraint forces act in the planes of
    walls.
    """
    reads: list[Callable[[SectionNodes], Row]] = [
        partial(SectionNodes.wall_deflection, direction=direction) for direction in boom.directions
    ]
    if boom.spatial:
        reads.append(SectionNodes.twist)
    constraints: list[Operator] = []
    for joint in boom.joints:
        for x in joint.stations if joint.bonded else ():
            outlines = [shells[number].outline(x) for number in (joint.inner, joint.outer)]
            for read in reads:
                inner, outer = (read(outline) for outline in outlines)
                constraints.append(Operator({joint.inner: inner, joint.outer: -outer}))
    return constraints


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
