# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stiffeners of the walls of segments: collars and diaphragms."""

from __future__ import annotations

from pydantic.dataclasses import dataclass as part

from geometry.fields import PART, Category, Length, Place


@part(frozen=True, slots=True, config=PART)
class Collar:
    """Doubler around a segment; it does not shift the walls' mid-surfaces.

    >>> head = pt.Collar(span=(7.5, 8.0), thickness=0.01)
    >>> replace(boom.segments[0], collars=(head,)).collars[0].length
    0.5
    """

    span: tuple[Place, Place]
    """the x of its two ends in m, in ascending order"""
    thickness: Length
    """the additional thickness in m of all walls"""
    detail_category: Category | None = None
    """the number of the detail category of the welds at its ends, for [[spectrum]]"""

    @property
    def length(self) -> float:
        """The length along the boom in m."""
        return self.span[1] - self.span[0]

    @property
    def middle(self) -> float:
        """The x of the middle in m."""
        return 0.5 * sum(self.span)


@part(frozen=True, slots=True, config=PART)
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
