# SPDX-License-Identifier: LGPL-3.0-or-later
"""Supports of segments on the ground."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Annotated, Literal

from pydantic import Field

from protractile.geometry.fields import BoomError, In, NotNegative, Positive, part
from protractile.geometry.place import Depth, Place
from protractile.geometry.section import Direction


@part
class Pin:
    """Pin in double or multiple shear, for the proof of strength of a foot or a cylinder.

    >>> round(1e-3 * pt.Pin(diameter=0.05, strength=6e8).resistance)
    1414
    """

    diameter: Annotated[Positive, In("m")]
    """the diameter in m"""
    strength: Annotated[Positive, In("Pa")]
    """the ultimate tensile strength f_up in Pa"""
    planes: Annotated[int, Field(strict=True, ge=1, le=100)] = 2
    """the number of shear planes, of all pins that share the force"""

    @property
    def resistance(self) -> float:
        """The characteristic shear resistance 0.6 A f_up in N (EN 1993-1-8, table 3.10)."""
        return 0.6 * self.planes * 0.25 * pi * self.diameter**2 * self.strength


@part
class Support:
    """Support of a segment on the ground, in space also against lateral motion and twist.

    >>> pt.Support(2.0).stiffness is None, pt.Support(0.0, "clamped").kind
    (True, 'clamped')
    >>> hinge = pt.Support(0.0, "hinged", depth=0.2)
    >>> hinge.holds_slope("z"), hinge.holds_slope("y")
    (False, True)
    """

    x: Place
    """the x in m"""
    kind: Literal["pinned", "hinged", "clamped"] = "pinned"
    """the kind: whether the slope is free or fixed; a hinge, with a pin across the boom, leaves it
    free in the plane of bending and fixes it laterally"""
    stiffness: Annotated[Positive, In("N/m")] | None = None
    """the stiffness of an elastic support in N/m; rigid unless given"""
    rotation_stiffness: Annotated[Positive, In("N m/rad")] | None = None
    """the rotational stiffness in N m/rad for the slopes that the kind leaves free; 0 unless
    given"""
    dashpot: Annotated[NotNegative, In("N s/m")] = 0.0
    """the linear dashpot of an elastic support in N s/m, parallel to its stiffness"""
    depth: Depth = 0.0
    """the depth in m of its pin below the segment's axis, which goes through the centroid, or from
    a surface, { bottom = 0.26 } above that of the bottom, { top = 0.4 } below that of the top; for
    the first support of a segment with a cylinder or axial forces"""
    pin: Pin | None = None
    """the table of its pin, for the proof of the foot"""

    def holds_slope(self, direction: Direction) -> bool:
        """Return whether the slope of the deflection along y or z is fixed."""
        return self.kind == "clamped" or (self.kind == "hinged" and direction == "y")

    def turned(self) -> Support:
        """Return the support for a segment with y and z exchanged."""
        return replace(self, kind="clamped") if self.kind == "hinged" else self


def check_support(where: str, support: Support) -> None:
    """Check that a support is not both rigid and elastic; ``where`` names it in messages.

    Raises:
        BoomError: the support is both rigid and elastic.
    """
    at = f"at {support.x:g} m"
    if support.stiffness is not None and support.kind != "pinned":
        hold = "clamped support" if support.kind == "clamped" else "hinge"
        raise BoomError(
            where,
            f"a {hold} is rigid, and the one {at} has a stiffness; leave it out, or make the "
            "support pinned",
        )
    if support.rotation_stiffness is not None and support.kind == "clamped":
        raise BoomError(
            where,
            f"a clamped support holds the slope, and the one {at} has a rotation_stiffness; leave "
            "it out, or make the support pinned",
        )
    if support.dashpot > 0.0 and support.stiffness is None:
        raise BoomError(
            where,
            f"the support {at} is rigid, and its dashpot would never move; leave it out, or give "
            "the support a stiffness",
        )
