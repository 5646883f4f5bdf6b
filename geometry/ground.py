# SPDX-License-Identifier: LGPL-3.0-or-later
"""Forces between a boom and the ground beside its supports: cylinders, leads and dashpots."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from protractile.geometry.arrays import Array
from protractile.geometry.assembly import Assembly
from protractile.geometry.axial import foot_thrust
from protractile.geometry.load import LoadedSegment


class GroundLine(NamedTuple):
    """Spring and dashpot between a segment and the ground, in addition to its supports."""

    segment: int  #: index in ``Boom.segments``
    push: Array  #: load vector (num_dofs,) of 1 N along the line, also row of the elongation
    stiffness: float  #: stiffness in N/m
    dashpot: float  #: dashpot in N·s/m
    #: name of the spring force in results, positive in compression; empty if it is not a result
    force: str = ""


def force_name(number: int) -> str:
    """Return the name of a cylinder's spring force in results; ``number`` counts from 1."""
    return "cylinder_force" if number == 1 else f"cylinder_force-{number}"


def difference_name(number: int) -> str:
    """Return the name of the difference of the spring forces of two cylinders side by side."""
    return force_name(number).replace("force", "force_difference")


def forces(boom: Assembly) -> dict[str, str]:
    """Return the descriptions of the cylinders' spring forces, by their names in results."""
    observations = {}
    for number, cylinder in enumerate(boom.cylinders, start=1):
        name = force_name(number)
        where = f"at x = {cylinder.x:g} m of {boom.segments[cylinder.segment].name!r}"
        observations[name] = f"spring force of the cylinder {where}, positive in compression"
        if cylinder.spread > 0.0:
            observations[difference_name(number)] = (
                f"spring force of the cylinder at positive y {where}, less the force of the other"
            )
    return observations


def ground_lines(boom: Assembly, bodies: Sequence[LoadedSegment]) -> Iterator[GroundLine]:
    """Yield springs and dashpots of cylinders, springs of leads, and dashpots of supports."""
    names = iter(forces(boom))
    for cylinder in boom.cylinders:
        for push in cylinder.load_vectors(
            bodies[cylinder.segment], boom.segments[cylinder.segment].foot
        ):
            yield GroundLine(
                cylinder.segment, push, cylinder.axial_stiffness, cylinder.dashpot, next(names)
            )
    for lead in boom.leads:
        for direction in boom.directions:
            push = bodies[lead.segment].unit_load_vector(lead.x, direction)
            yield GroundLine(lead.segment, push, lead.stiffness(direction), 0.0)
    for number, segment in enumerate(boom.segments):
        for support in segment.supports:
            if support.dashpot > 0.0:
                for direction in boom.directions:
                    push = bodies[number].unit_load_vector(support.x, direction)
                    yield GroundLine(number, push, 0.0, support.dashpot)


def pin_moments(boom: Assembly, bodies: Sequence[LoadedSegment]) -> Iterator[tuple[int, Array]]:
    """Yield (segment, load vector) of the moment of axial forces, for each pin below the axis.

    The pin, at the depth d, does not move. So a slope w′ at the pin moves the segment along x by
    −d w′ against its compression P. The work P d w′ equals that of a moment P d at the pin.
    """
    for number, segment in enumerate(boom.segments):
        foot = segment.foot
        if foot is not None and foot.depth != 0.0:
            moment = foot.depth * float(foot_thrust(boom.segments, boom.joints, number))
            yield number, moment * bodies[number].moment(foot.x, "z")
