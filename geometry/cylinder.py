# SPDX-License-Identifier: LGPL-3.0-or-later
"""Luffing cylinders, which support a hinged boom."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import field, replace
from math import cos, hypot, isfinite, pi, sin
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError

from protractile.geometry.arrays import Array
from protractile.geometry.fields import (
    BoomError,
    In,
    NotNegative,
    Number,
    Positive,
    is_number,
    part,
)
from protractile.geometry.load import LoadedSegment
from protractile.geometry.place import Depth, Place, SegmentRef
from protractile.geometry.support import Pin, Support

# Young's modulus in Pa of the rod, of steel, and fraction of a length that is rounded in drawings.
_ROD_MODULUS, _REACH = 2.1e11, 1.0e-6


@part
class EarthPoint:
    """Point in earth axes, from the pin of the foot, about which the boom luffs, or of the head."""

    front: Annotated[Number, In("m")]
    """the horizontal distance in m in front of the pin"""
    below: Annotated[Number, In("m")]
    """the vertical distance in m below the pin"""

    def turned(self, angle: float) -> tuple[float, float]:
        """Return its distances in m along and above the axis of a boom at a luffing angle in rad.

        >>> [round(distance, 12) for distance in pt.EarthPoint(3.0, 1.0).turned(0.5 * np.pi)]
        [-1.0, -3.0]
        """
        return (
            self.front * cos(angle) - self.below * sin(angle),
            -self.front * sin(angle) - self.below * cos(angle),
        )


def _ground(value: Any) -> Any:
    """Validate a pair or a point in earth axes. Errors of a union type would be unreadable."""
    if isinstance(value, EarthPoint):
        return value
    earth = isinstance(value, Mapping)
    if earth or isinstance(value, list | tuple):
        numbers = list(value.values() if earth else value)
        finite = all(is_number(number) and isfinite(number) for number in numbers)
        if finite and (value.keys() == {"front", "below"} if earth else len(numbers) == 2):
            return EarthPoint(**value) if earth else tuple(map(float, numbers))
    raise PydanticCustomError("ground", "a point of the ground")


if TYPE_CHECKING:
    # In the axes of the boom. In a case it may be an EarthPoint.
    Ground = tuple[float, float]
else:
    _Points = tuple[Number, Number] | EarthPoint
    Ground = Annotated[_Points, BeforeValidator(_ground, json_schema_input_type=_Points), In("m")]


@part
class Cylinder:
    """A luffing cylinder: a spring between a lug of a segment and a point of the ground.

    The lug is fixed to the cross-section at its x. The segment is rigid along x, and supported
    along x at its foot, the support nearest to the base.

    >>> jack = pt.Cylinder(segment=0, x=4.0, depth=0.3, ground=(1.0, -4.3), stiffness=5e7)
    >>> jack.length, jack.direction
    (5.0, (0.6, 0.8))
    >>> hinge = pt.Support(0.0)
    >>> arm = replace(boom.segments[0], supports=(hinge,))
    >>> luffed = replace(boom, segments=(arm, boom.segments[1]), cylinders=(jack,))
    >>> bool((pt.BeamElements(luffed).system().omega2[:2] > 0.0).all())
    True
    """

    segment: SegmentRef
    """the name of the segment"""
    x: Place
    """the x of the lug in m"""
    depth: Depth = 0.0
    """the depth in m of the lug below the segment's axis, which goes through the centroid, or from
    a surface, { bottom = -0.1 } below that of the bottom, { top = 0.4 } below that of the top"""
    ground: Ground = field(kw_only=True)
    """the other end in m, which does not luff: { front, below }, its distances in front of and
    below the foot pin in earth axes; or [x, height above the axis] in the axes of the boom at the
    luffing angle gravity.angle of the case"""
    stiffness: Annotated[Positive, In("N/m")] | None = field(default=None, kw_only=True)
    """the axial stiffness in N/m, of two cylinders side by side their sum; unless given, that of
    oil column and rod by bore, rod, closed and open or stroke: the column on the piston if it
    pushes, on the ring around the rod if the loads at t = 0 make it pull"""
    dashpot: Annotated[NotNegative, In("N s/m")] = 0.0
    """the linear axial dashpot in N s/m; of two cylinders their sum"""
    spread: Annotated[NotNegative, In("m")] = 0.0
    """the lateral distance in m of two cylinders side by side, for a boom in space; unless given,
    one cylinder is in the middle"""
    capacity: Annotated[Positive, In("N")] | None = None
    """the characteristic resistance in N to its force, for proofs; of two cylinders their sum;
    unless given, if it pushes the smaller one of pressure times area of the bore and of the
    buckling force, and if it pulls the pressure times the area of the bore without the rod"""
    closed: Annotated[Positive, In("m")] | None = None
    """the length in m from pin to pin of the retracted cylinder"""
    open: Annotated[Positive, In("m")] | None = None
    """the length in m from pin to pin of the extended cylinder, of one stage, below twice closed"""
    stroke: Annotated[Positive, In("m")] | None = field(default=None, kw_only=True)
    """the stroke in m of the cylinder, in place of open, which then is closed plus it"""
    bore: Annotated[Positive, In("m")] | None = None
    """the diameter in m of the piston"""
    rod: Annotated[Positive, In("m")] | None = None
    """the diameter in m of the rod, below the bore"""
    pressure: Annotated[Positive, In("Pa")] | None = None
    """the largest permitted oil pressure in Pa"""
    oil_modulus: Annotated[Positive, In("Pa")] = 1.4e9
    """the bulk modulus in Pa of the oil with its hoses; 1.4e9 unless given, for oil without air"""
    pin: Pin | None = None
    """the table of the pin of its lug, for proofs; of two cylinders that of each"""

    @property
    def length(self) -> float:
        """The length from the ground to the lug in m."""
        return hypot(self.x - self.ground[0], -self.depth - self.ground[1])

    @property
    def direction(self) -> tuple[float, float]:
        """The x and z components of the unit vector from the ground to the lug."""
        return (
            (self.x - self.ground[0]) / self.length,
            (-self.depth - self.ground[1]) / self.length,
        )

    @property
    def count(self) -> int:
        """The number of cylinders side by side."""
        return 2 if self.spread > 0.0 else 1

    @property
    def longest(self) -> float | None:
        """The length in m of the extended cylinder by ``open`` or ``stroke``; None without them."""
        return self.closed + self.stroke if self.closed and self.stroke else self.open

    @property
    def extension(self) -> float | None:
        """The length in m by which the cylinder is extended; None without ``closed``."""
        return None if self.closed is None else self.length - self.closed

    def oil_area(self, pulls: bool = False) -> float | None:
        """Return the area in m² under oil of all cylinders that push, or that pull.

        It is that of the pistons, less that of the rods if they pull; None without their diameters.
        """
        if self.bore is None or (pulls and self.rod is None):
            return None
        rod = self.rod if pulls and self.rod else 0.0
        return 0.25 * pi * (self.bore**2 - rod**2) * self.count

    @property
    def axial_stiffness(self) -> float:
        """The axial stiffness in N/m: ``stiffness``, or that of oil and rod if it pushes."""
        return self.oil_stiffness() if self.stiffness is None else self.stiffness

    def oil_stiffness(self, pulls: bool = False) -> float:
        """Return the stiffness in N/m of oil column and rod in series, if it pushes or pulls.

        It needs ``bore``, ``rod`` and ``closed``. The column is on the pistons, as long as the
        extension; of a cylinder that pulls it is on the rings around the rods, as long as the rest
        of the stroke, without ``open`` and ``stroke`` up to twice ``closed``. The rod is as long as
        the closed cylinder. Barrel and hoses are rigid.
        """
        area = self.oil_area(pulls)
        assert area is not None
        assert self.rod is not None
        assert self.closed is not None
        rods = 0.25 * pi * self.rod**2 * self.count
        most = self.longest or 2.0 * self.closed
        column = most - self.length if pulls else self.length - self.closed
        compliance = max(column, 0.0) / (self.oil_modulus * area)
        return 1.0 / (compliance + self.closed / (_ROD_MODULUS * rods))

    @property
    def buckling_force(self) -> float | None:
        """Euler's force in N of the rod, hinged at both pins; None without ``rod``.

        It is the simplest case of ISO/TS 13725 on the safe side: the rod over the whole length,
        without the stiffer barrel, and without eccentricities, to be covered by
        ``resistance.cylinder``.
        """
        if self.rod is None:
            return None
        second_moment = pi * self.rod**4 / 64.0
        return self.count * pi**2 * _ROD_MODULUS * second_moment / self.length**2

    def resistance(self, pulls: bool = False) -> float | None:
        """Return the characteristic resistance in N of cylinders that push, or that pull.

        It is ``capacity``, or that by pressure, and by buckling if they push: a rod in tension does
        not buckle. None without the data.
        """
        if self.capacity is not None:
            return self.capacity
        area = self.oil_area(pulls)
        by_pressure = self.pressure and area and self.pressure * area
        if pulls:
            return by_pressure
        known = [force for force in (by_pressure, self.buckling_force) if force is not None]
        return min(known, default=None)

    def arm(self, foot: Support) -> float:
        """Return the lever arm in m of the cylinder force about the pin of a foot."""
        along, up = self.direction
        return (self.x - foot.x) * up + (self.depth - foot.depth) * along

    def luffed(self, turn: float, foot: Support) -> Cylinder:
        """Return the cylinder in the axes of a boom turned about ``foot`` by ``turn`` in rad."""
        return self.on_earth(0.0, foot).in_boom_axes(turn, foot)

    def on_earth(self, angle: float, foot: Support) -> Cylinder:
        """Return the cylinder with its ground in earth axes.

        Args:
            angle: luffing angle in rad at which the ground in the axes of the boom is given.
            foot: support whose pin the boom luffs about.
        """
        if isinstance(self.ground, EarthPoint):
            return self
        along, up = self.ground[0] - foot.x, self.ground[1] + foot.depth
        front, height = along * cos(angle) - up * sin(angle), along * sin(angle) + up * cos(angle)
        point: Any = EarthPoint(front, -height)
        return replace(self, ground=point)

    def in_boom_axes(self, angle: float, foot: Support) -> Cylinder:
        """Return the cylinder with its ground in the axes of a boom at a luffing angle in rad."""
        point = self.ground
        if not isinstance(point, EarthPoint):
            return self
        along, up = point.turned(angle)
        return replace(self, ground=(foot.x + along, up - foot.depth))

    def normal_force(self, x: Array, foot: Support | None) -> Array:
        """Return the segment's axial force (num_places,) in N at x in m per N of cylinder force.

        The cylinder force is positive in compression, the axial force in tension. It acts between
        lug and foot; without a foot it is 0.
        """
        if foot is None:
            return np.zeros(x.shape)
        between = (min(foot.x, self.x) < x) & (x < max(foot.x, self.x))
        return np.where(between, np.sign(self.x - foot.x) * self.direction[0], 0.0)

    def check(self, where: str, spatial: bool) -> None:
        """Check the data of the cylinder.

        Args:
            where: attribute of the boom, for example ``cylinders[0]``.
            spatial: whether the boom is three-dimensional.

        Raises:
            BoomError: the cylinder has no length or stiffness, its ground is in earth axes, its rod
                does not fit into it, it does not reach, or a flat boom has two side by side.
        """
        if isinstance(self.ground, EarthPoint):
            raise BoomError(
                f"{where}.ground", "a boom has no earth axes; give x and z in m of its own axes"
            )
        if not 0.0 < self.length < float("inf"):
            raise BoomError(
                f"{where}.ground", "must be another point than the lug; give x and z in m"
            )
        if self.stiffness is None:
            for key in ("bore", "rod", "closed"):
                if getattr(self, key) is None:
                    what = "missing; give bore, rod and closed, or the stiffness"
                    raise BoomError(f"{where}.{key}", what)
        if self.bore is not None and self.rod is not None and self.rod >= self.bore:
            what = f"must be below the bore of {self.bore:g} m, got {self.rod:g} m"
            raise BoomError(f"{where}.rod", what)
        if self.open and self.stroke:
            raise BoomError(f"{where}.stroke", "open is given; leave one of them out")
        if self.stroke and not self.closed:
            raise BoomError(f"{where}.closed", "missing; the stroke begins at this length")
        end_key = "stroke" if self.stroke else "open"
        if self.closed and self.longest and self.longest >= 2.0 * self.closed:
            most, name = (1.0, "closed") if self.stroke else (2.0, "twice closed")
            what = f"must be below {most * self.closed:g} m, {name}, as the rod goes into the"
            got = f"closed cylinder, got {getattr(self, end_key):g} m"
            raise BoomError(f"{where}.{end_key}", f"{what} {got}")
        for key, end, sign in (("closed", self.closed, 1.0), (end_key, self.longest, -1.0)):
            if end is not None and sign * (self.length - end) < -_REACH * end:
                raise BoomError(
                    f"{where}.{key}",
                    f"{end:g} m, and from ground to lug it is {self.length:.4g} m: the cylinder "
                    "does not reach; change it, the ground or the luffing angle",
                )
        if self.spread > 0.0 and not spatial:
            raise BoomError(
                f"{where}.spread",
                "the boom is flat, and nothing turns about its axis; leave it out, or give the "
                "joints lateral_play",
            )

    def load_vectors(self, body: LoadedSegment, foot: Support | None) -> Iterator[Array]:
        """Yield the load vectors (num_dofs,) of one cylinder, or of two side by side.

        The first vector is for a cylinder force of 1 N. For two cylinders a second one follows,
        for ½ N in one cylinder and −½ N in the other. Times the degrees of freedom, the first gives
        the mean elongation, the second half the difference of both elongations.

        The deflections are v along y and w along z, and θ is the twist. A point (y, z) of a section
        moves by −w′ z − v′ y along x, and by w + θ y along z. The segment also moves along x as a
        rigid body, so that the pin of the foot stays in place.

        Args:
            body: segment with the lug.
            foot: support of the segment along x.
        """
        along, up = self.direction
        in_plane = up * body.unit_load_vector(self.x, "z") + along * self.depth * body.moment(
            self.x, "z"
        )
        if foot is not None and foot.depth != 0.0:
            in_plane = in_plane - along * foot.depth * body.moment(foot.x, "z")
        yield in_plane
        if self.spread > 0.0:
            half = 0.5 * self.spread
            yield half * (up * body.torque(self.x) - along * body.moment(self.x, "y"))
