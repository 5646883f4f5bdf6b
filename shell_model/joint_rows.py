# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where the boom's shells touch, rub and are tied: rows over the segments they concern.

At a station the inner segment's top flange may press up against the outer one's, its bottom
flange down, and in space its webs to the sides. Which side is which comes from the joint, never
from a facet's normal, whose direction a mesh does not promise. The points of each wall have
weights that sum to one, so that a uniform approach gives the paper's law (4) exactly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from dynamics.contact import PowerContact
from dynamics.friction import DryFriction
from geometry.boom import Boom, BoomError, Direction, Joint
from geometry.pads import Pad, pads
from geometry.section import BoxSection
from shell_model.outline import Outline, Row, combine
from shell_model.segment_shell import SegmentShell

ContactLine = Literal["near webs", "across"]

# Number of a segment → what is read of it, with its sign.
Reading = Mapping[int, Row]


class Contact(NamedTuple):
    """One contact row: the approach it reads, the law it follows, its station."""

    reading: Reading
    law: PowerContact
    station: int


class Friction(NamedTuple):
    """One friction row: the slide it reads, and what rubs."""

    reading: Reading
    law: DryFriction


class _Touch(NamedTuple):
    """Side, weight and approach of each pair of points of a pad, and how the pad slides."""

    points: Sequence[tuple[int, float, Reading]]
    slide: Reading


class ContactPoint(NamedTuple):
    """A mirrored pair of points on facing flanges, with the part of the force it carries.

    ``inner`` and ``outer`` are the distances in m from the middle of each flange.
    """

    inner: float
    outer: float
    weight: float


def contact_points(line: ContactLine, inner: BoxSection, outer: BoxSection) -> list[ContactPoint]:
    """Where facing flanges of a flat boom touch; the weights sum to one.

    Args:
        line: ``near webs`` passes the force from web to web; ``across`` takes Gauss's rule with
            eight points over the inner flange.
        inner, outer: the sections of the joint's segments.
    """
    if line == "near webs":
        return [ContactPoint(0.5 * inner.width, 0.5 * outer.width, 1.0)]
    nodes, weights = np.polynomial.legendre.leggauss(8)
    places = 0.5 * inner.width * nodes[nodes > 0.0]
    return [
        ContactPoint(float(y), float(y), float(w))
        for y, w in zip(places, weights[nodes > 0.0], strict=True)
    ]


def contacts_and_frictions(
    boom: Boom,
    shells: Sequence[SegmentShell],
    laws: Mapping[Direction, Sequence[PowerContact]],
    line: ContactLine,
) -> tuple[list[Contact], list[Friction]]:
    """Rows of every pad and stop. Collective.

    Args:
        boom: its joints and stops.
        shells: of its segments.
        laws: along each direction, one for each joint.
        line: where a flat boom's flanges touch.

    Raises:
        BoomError: a boom in space whose contact is to spread across the flanges.
    """
    if boom.spatial and line == "across":
        raise BoomError(
            "contact_line",
            "'across' spreads the force over the flanges of a flat boom; in space the pads sit in "
            "the corners: give 'near webs'",
        )
    contacts: list[Contact] = []
    frictions: list[Friction] = []
    for pad in pads(boom):
        inner, outer = (shells[i].outline(pad.x) for i in (pad.joint.inner, pad.joint.outer))
        touch = _corner(pad, inner, outer) if pad.side else _flanges(pad, inner, outer, line)
        law = laws[pad.direction][pad.number]
        first = len(contacts)
        for side, weight, reading in touch.points:
            one_sided = _on_side(law, side)
            if one_sided is not None:
                contacts.append(Contact(reading, one_sided.shared(weight), pad.station))
        pressing = tuple(range(first, len(contacts)))
        if pad.joint.friction > 0.0 and pressing:
            pressed_by = () if pad.joint.normal_forces else pressing
            friction = DryFriction(pad.joint.friction, pad.station, pad.prescribed, pressed_by)
            frictions.append(Friction(touch.slide, friction))
    return contacts + _stop_contacts(boom, shells), frictions


def ties(boom: Boom, shells: Sequence[SegmentShell]) -> list[Reading]:
    """What the tied joints keep at zero: relative deflections, and in space the twist. Collective.

    Each is read in the walls that carry its force in their own plane.
    """
    found: list[Reading] = []
    for joint in boom.joints:
        if not joint.tied:
            continue
        for x in joint.stations:
            inner, outer = (shells[number].outline(x) for number in (joint.inner, joint.outer))
            found.append(_relative(joint, inner.wall_deflection("z"), outer.wall_deflection("z")))
            if boom.spatial:
                found.append(
                    _relative(joint, inner.wall_deflection("y"), outer.wall_deflection("y"))
                )
                found.append(_relative(joint, inner.twist(), outer.twist()))
    return found


def _stop_contacts(boom: Boom, shells: Sequence[SegmentShell]) -> list[Contact]:
    """A stop meets a flange above its webs, both at once."""
    contacts = []
    for station, stop in enumerate(boom.stops, start=len(boom.stations) - len(boom.stops)):
        law = PowerContact(stop.stiffness, stop.exponent, stop.clearance, stop.stiffness_below)
        outline = shells[stop.segment].outline(stop.x)
        for side in (1, -1):
            one_sided = _on_side(law, side)
            if one_sided is not None:
                row = outline.flange_deflection(side, 0.5 * outline.section.width)
                contacts.append(Contact({stop.segment: row}, one_sided, station))
    return contacts


def _on_side(law: PowerContact, side: int) -> PowerContact | None:
    """The law on one side alone; None where it never touches."""
    if (law.stiffness if side > 0 else law.below) == 0.0:
        return None
    return law.upper() if side > 0 else law.lower()


def _flanges(pad: Pad, inner: Outline, outer: Outline, line: ContactLine) -> _Touch:
    """A station of a flat boom; both flanges together slide as their mean does."""
    points = [
        (
            side,
            point.weight,
            _relative(
                pad.joint,
                inner.flange_deflection(side, point.inner),
                outer.flange_deflection(side, point.outer),
            ),
        )
        for side in (1, -1)
        for point in contact_points(line, inner.section, outer.section)
    ]
    return _Touch(points, _sum([(0.5 * weight, reading) for _, weight, reading in points]))


def _corner(pad: Pad, inner: Outline, outer: Outline) -> _Touch:
    """A pad of a boom in space."""

    def along(direction: Direction) -> Reading:
        rows = inner.point(direction, *pad.inner), outer.point(direction, *pad.outer)
        return _relative(pad.joint, *rows)

    return _Touch([(pad.side, pad.weight, along(pad.direction))], along(pad.rubs))


def _relative(joint: Joint, inner: Row, outer: Row) -> Reading:
    return {joint.inner: inner, joint.outer: combine((-1.0, outer))}


def _sum(terms: Sequence[tuple[float, Reading]]) -> Reading:
    """Readings of the same segments, each with its factor."""
    numbers = terms[0][1]
    return {
        number: combine(*((factor, reading[number]) for factor, reading in terms))
        for number in numbers
    }
