# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stiffeners of the walls of segments: collars and diaphragms."""

from __future__ import annotations

from functools import lru_cache
from typing import Annotated, NamedTuple

import numpy as np
from pydantic import Field

from protractile.geometry.fields import Category, In, Length, Name, NotNegative, Positive, part
from protractile.geometry.place import Place
from protractile.geometry.section import COMPONENT, Direction, Section


class Strip(NamedTuple):
    """Part of a wall between two distances from its midpoint, on both sides of it.

    Args:
        wall: index in the plates of the section.
        low, high: smallest and largest distance in m.
    """

    wall: int
    low: float
    high: float


# Load cases and combinations have the same sections and collars.
@lru_cache(maxsize=256)
def _strips(section: Section, walls: tuple[str, ...], low: float, high: float) -> tuple[Strip, ...]:
    return tuple(
        Strip(k, low, min(high, 0.5 * plate.length))
        for k, plate in enumerate(section.plates)
        if (not walls or plate.name in walls) and low < 0.5 * plate.length
    )


@part
class Collar:
    """Doubler around a segment; it does not shift the walls' mid-surfaces.

    >>> head = pt.Collar(span=(7.5, 8.0), thickness=0.01)
    >>> replace(boom.segments[0], collars=(head,)).collars[0].length
    0.5
    """

    span: tuple[Place, Place]
    """the x of its two ends in m, in ascending order"""
    thickness: Length
    """the additional thickness in m of the walls"""
    walls: Annotated[tuple[Name, ...], Field(max_length=20)] = ()
    """the names of its walls, such as "top" and "bottom"; all walls unless given"""
    across: Annotated[tuple[NotNegative, Positive], In("m")] | None = None
    """the smallest and largest distance in m from the middle of each wall, on both sides of it;
    the whole width unless given"""
    detail_category: Category | None = None
    """the number of the detail category of the welds at its ends, for [[spectrum]]"""

    @property
    def length(self) -> float:
        """The length along the boom in m."""
        return self.span[1] - self.span[0]

    @property
    def midpoint(self) -> float:
        """The x of the midpoint in m."""
        return 0.5 * sum(self.span)

    def strips(self, section: Section) -> tuple[Strip, ...]:
        """Return the parts of the walls of a section that the collar covers."""
        return _strips(section, self.walls, *(self.across or (0.0, np.inf)))

    def width(self, section: Section) -> float:
        """Return the total width of the collar's strips around a section in m."""
        return sum(2.0 * (strip.high - strip.low) for strip in self.strips(section))

    def is_symmetric(self, section: Section, axis: Direction) -> bool:
        """Return whether the plane normal to ``axis`` mirrors the collar onto itself."""
        midpoints = np.array(
            [section.plates[strip.wall].midpoint for strip in self.strips(section)]
        )
        images = midpoints.copy()
        images[:, COMPONENT[axis] - 1] *= -1.0
        distances = np.abs(images[:, None] - midpoints).max(axis=2).min(axis=1)
        return bool((distances < section.near).all())


@part
class Diaphragm:
    """Plate across a segment's box, welded to its walls.

    >>> plate = pt.Diaphragm(x=0.5, thickness=0.01)
    >>> len(replace(boom.segments[0], diaphragms=(plate,)).diaphragms)
    1
    """

    x: Place
    """the x in m"""
    thickness: Length
    """the thickness in m"""
    detail_category: Category | None = None
    """the number of the detail category of its welds to the walls, for [[spectrum]]"""
