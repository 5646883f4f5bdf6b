# SPDX-License-Identifier: LGPL-3.0-or-later
"""The head of a boom, with the place where the load hangs."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from math import hypot
from typing import Annotated

from protractile.geometry.arrays import Array
from protractile.geometry.cylinder import EarthPoint
from protractile.geometry.fields import HistoryRef, In, NotNegative, Number, part
from protractile.geometry.load import Load, Moment, Torque
from protractile.geometry.place import Depth, resolve_level
from protractile.geometry.segment import SAME_PLACE, Segment


@part
class Sheave:
    """Sheave of the head, over which the rope leads from the winch to the hook."""

    ahead: Annotated[Number, In("m")] = 0.0
    """the distance in m beyond the end of the last segment, along the axis"""
    below: Depth = 0.0
    """the distance in m below the axis, which goes through the centroid of the last segment,
    negative above it, or from a surface, as the depth of a lug"""


@part
class Head(Sheave):
    """Head or fork beyond the end of the last segment, with the place of the load.

    >>> fork = pt.Head(ahead=0.8, below=0.5)
    >>> [load.magnitude for load in fork.moments(1, 14.0, [0.0, 0.0, -1000.0], pt.Step())]
    [-800.0]
    """

    beside: Annotated[Number, In("m")] = 0.0
    """the distance in m of the load beside the axis, towards +y; only in space"""
    mass: Annotated[NotNegative, In("kg")] = 0.0
    """the mass in kg of the head itself, halfway between the segment's end and the load; its weight
    is of the group dead"""
    level: EarthPoint | None = None
    """the load's place { front, below } in earth axes from the pin at ahead and below, for a cage
    that stays level at each luffing angle; at the pin unless given"""

    @property
    def placed(self) -> bool:
        """True if it gives a place of the load other than the end of the axis."""
        return bool(self.ahead or self.below or self.beside or self.level)

    def in_boom_axes(self, segment: Segment, angle: float) -> Head:
        """Return the head on the last segment with its load in the axes of the boom.

        >>> cage = pt.Head(ahead=0.2, level=pt.EarthPoint(front=0.8, below=0.5))
        >>> cage.in_boom_axes(boom.segments[1], 0.0).ahead
        1.0

        Args:
            segment: the last segment.
            angle: luffing angle in rad.

        Raises:
            BoomError: the depth is from a surface, and the segment has no section.
        """
        head = resolve_level(self, "head", partial(segment.surfaces, segment.end))
        along, up = (0.0, 0.0) if self.level is None else self.level.turned(angle)
        return replace(head, ahead=head.ahead + along, below=head.below - up, level=None)

    def moments(
        self, segment: int, x: float, force: Array, history: HistoryRef, part: float = 1.0
    ) -> Iterator[Load]:
        """Yield the moments and the torque about the segment's end of a force at the load's place.

        The force F acts at (x, y, z) = (ahead, beside, −below) from the end. By the work on the
        slopes w′ and v′ and on the twist, the moments are x F_z − z F_x and x F_y − y F_x, and the
        torque is y F_z − z F_y. Round-off is left out.

        Args:
            segment: index of the last segment.
            x: x of its end in m.
            force: force (3,) in N along x, y and z.
            history: factor of the force over time.
            part: fraction of the distances at which the force acts.
        """
        along, aside, up = (float(component) for component in force)
        ahead, beside, above = part * self.ahead, part * self.beside, -part * self.below
        round_off = SAME_PLACE * hypot(*force) * hypot(ahead, beside, above)
        for load in (
            Moment(segment, "z", ahead * up - above * along, x, history),
            Moment(segment, "y", ahead * aside - beside * along, x, history),
            Torque(segment, "z", beside * up - above * aside, x, history),
        ):
            if abs(load.magnitude) > round_off:
                yield load
