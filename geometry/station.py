# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stations: the places of a boom where its segments may touch one another, or stops."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from protractile.dynamics.contact import Gap
from protractile.geometry.joint import SIDES, Joint, SlidePad, Stop
from protractile.geometry.section import Direction


@dataclass(frozen=True, slots=True)
class Station:
    """Place where a segment may touch the segment around it, or a stop, along one direction.

    >>> tail, head = boom.stations
    >>> head.name, head.x, head.direction, head.joint is boom.joints[0]
    ('8', 8.0, 'z', True)
    """

    x: float  #: position in m
    direction: Direction  #: direction of contact
    segment: int  #: index of the segment that touches, of a joint the inner one
    number: int  #: index of its joint in ``Boom.joints``, or of its stop in ``Boom.stops``
    place: int = 0  #: index of its x in ``Joint.stations``
    joint: Joint | None = None  #: its joint; None for a stop
    stop: Stop | None = None  #: its stop; None for a joint
    index: int = 0  #: index in ``Boom.stations``, in the rows of models and in trajectories
    #: name in results: the x in m, followed by ``y`` for a lateral station. The suffixes ``#2``,
    #: ``#3`` … distinguish stations with the same x and direction.
    name: str = ""

    @property
    def pads(self) -> tuple[SlidePad, ...]:
        """The pads in ``Joint.pads`` that touch in its direction."""
        pads = () if self.joint is None else self.joint.pads
        return tuple(pad for pad in pads if SIDES[pad.side][0] == self.direction)

    @property
    def law(self) -> Gap:
        """The contact law with its clearances.

        Raises:
            BoomError: the joint has no contact.
        """
        if self.joint is not None:
            return self.joint.law(self.direction)
        assert self.stop is not None
        return self.stop.law


def stations(
    joints: Sequence[Joint], stops: Sequence[Stop], directions: Sequence[Direction]
) -> tuple[Station, ...]:
    """Return the stations of joints that are not bonded, by direction, then those of stops."""
    found = [
        Station(x, direction, joint.inner, number, place, joint=joint)
        for direction in directions
        for number, joint in enumerate(joints)
        if not joint.bonded
        for place, x in enumerate(joint.stations)
    ]
    found += [Station(stop.x, "z", stop.segment, i, stop=stop) for i, stop in enumerate(stops)]
    names = [f"{station.x:g}" + ("y" if station.direction == "y" else "") for station in found]
    counts = [names[: i + 1].count(name) for i, name in enumerate(names)]
    return tuple(
        replace(station, index=i, name=name if count == 1 else f"{name}#{count}")
        for i, (station, name, count) in enumerate(zip(found, names, counts, strict=True))
    )
