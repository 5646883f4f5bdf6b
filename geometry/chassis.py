# SPDX-License-Identifier: LGPL-3.0-or-later
"""The undercarriage of a slewing crane: tipping moments and outrigger forces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from math import hypot
from typing import Annotated, NamedTuple

from protractile.geometry.fields import In, NotNegative, Number, Positive, part


class CraneForce(NamedTuple):
    """A force in the vertical plane of the boom."""

    down: float  #: downward component in N
    ahead: float = 0.0  #: distance in m from the slewing axis towards the tip
    forward: float = 0.0  #: horizontal component in N towards the tip
    above: float = 0.0  #: height in m above the ground
    moment: float = 0.0  #: moment in N·m in addition, positive towards the tip

    def overturning(self, distance: float) -> float:
        """Return the moment in N·m about a line on the ground at ``distance`` in m ahead."""
        return self.down * (self.ahead - distance) + self.forward * self.above + self.moment


@part
class Chassis:
    """The undercarriage on outriggers. The boom slews about a vertical axis.

    The outriggers are at the corners of a rectangle, and its sides are the tipping lines.
    """

    mass: Annotated[Positive, In("kg")]
    """the mass in kg that does not slew"""
    front: Annotated[Positive, In("m")]
    """the distance in m of the front outriggers from the slewing axis, along the vehicle"""
    rear: Annotated[Positive, In("m")]
    """the distance in m of the rear outriggers from the slewing axis, along the vehicle"""
    side: Annotated[Positive, In("m")]
    """the distance in m of the outriggers from the slewing axis, across the vehicle"""
    centre: Annotated[Number, In("m")] = 0.0
    """the distance in m of its centre of gravity in front of the slewing axis"""
    counterweight: Annotated[NotNegative, In("kg")] = 0.0
    """the mass in kg that slews with the boom: counterweight and superstructure"""
    behind: Annotated[Number, In("m")] = 0.0
    """the distance in m of its centre of gravity behind the slewing axis"""
    foot_ahead: Annotated[Number, In("m")] = 0.0
    """the distance in m of the boom's foot pin in front of the slewing axis; negative behind it"""
    foot_above: Annotated[NotNegative, In("m")] = 0.0
    """the height in m of the boom's foot pin above the ground"""

    def tipping(
        self, forces: Sequence[CraneForce], gravity: float
    ) -> Iterator[tuple[str, float, float]]:
        """Yield the side of each tipping line, and the overturning and stabilising moments in N·m.

        The boom points across the line. Overturning is the sum of the moments that are positive,
        stabilising of those that are negative. ``forces`` act on the boom, ``gravity`` in m/s² on
        the masses of the chassis.
        """
        lines = {
            "front": (self.front, self.centre),
            "rear": (self.rear, -self.centre),
            "side": (self.side, 0.0),
        }
        for name, (distance, centre) in lines.items():
            own = self.mass * gravity, self.counterweight * gravity
            weights = CraneForce(own[0], centre), CraneForce(own[1], -self.behind)
            moments = [one.overturning(distance) for one in (*forces, *weights)]
            stabilising = -sum(moment for moment in moments if moment < 0.0)
            yield name, sum(moment for moment in moments if moment > 0.0), stabilising

    def outrigger_forces(
        self, forces: Sequence[CraneForce], gravity: float
    ) -> Iterator[tuple[str, float]]:
        """Yield the place of the outriggers, and the largest force in N of one in a full turn.

        The chassis is rigid, on four equal springs, of which one may lift. Arguments as in
        :meth:`tipping`.
        """
        slewing = [*forces, CraneForce(self.counterweight * gravity, -self.behind)]
        down, weight = sum(force.down for force in slewing), self.mass * gravity
        turning = sum(force.overturning(0.0) for force in slewing)
        middle, half = 0.5 * (self.front - self.rear), 0.5 * (self.front + self.rear)
        mean = 0.25 * (down + weight)
        shift = 0.25 * (weight * (self.centre - middle) - down * middle) / half
        swing = 0.25 * abs(turning) * hypot(1.0 / half, 1.0 / self.side)
        for name, largest, opposite in (
            ("front", mean + shift, mean - shift),
            ("rear", mean - shift, mean + shift),
        ):
            # An outrigger that would pull lifts, and the opposite one takes its force.
            yield name, largest + swing + max(0.0, swing - opposite)
