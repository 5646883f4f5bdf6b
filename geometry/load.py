# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads on the segments of a boom: their positions and load vectors."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Protocol

from protractile.geometry.arrays import Array
from protractile.geometry.fields import Flag, HistoryRef, Number, part
from protractile.geometry.place import Place, SegmentRef
from protractile.geometry.section import Direction


class LoadedSegment(Protocol):
    """Segment of a model. The methods return load vectors (num_dofs,).

    The load vector of a unit force is also the row of the displacement at the point of the force.
    """

    def unit_load_vector(self, x: float, direction: Direction) -> Array:
        """Return the load vector of 1 N at x in m."""

    def moment(self, x: float, direction: Direction) -> Array:
        """Return the load vector of 1 N·m at x in m, positive towards a larger slope."""

    def torque(self, x: float) -> Array:
        """Return the load vector of a torque of 1 N·m at x in m."""

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        """Return the load vector of 1 N/m between the x in m of ``span``, by default everywhere."""

    def inertia(self, direction: Direction, force: float) -> Array:
        """Return the load vector of a uniform acceleration of the whole segment.

        ``force`` in N/m is the inertia force per length without stiffeners.
        """

    def rotation_load(self, direction: Direction) -> Array:
        """Return the load vector of an angular acceleration of 1 rad/s² about x = 0.

        It is positive towards a larger slope, and excludes point masses.
        """


@part
class Load:
    """Force on the axis of a segment, with a history.

    >>> gust = pt.Load(segment=1, direction="z", magnitude=-1e3, x=14.0, history=pt.Sine(0.5))
    >>> len(pt.BeamElements(replace(boom, loads=(gust,))).system().excitations)
    1
    """

    segment: SegmentRef
    """the name of the segment"""
    direction: Direction
    """the direction of the force"""
    magnitude: Number
    """the magnitude in N/m along the whole segment, or in N at one place"""
    x: Place | None
    """the x in m; None for the whole segment"""
    history: HistoryRef
    """the factor of the magnitude over time, see :mod:`.dynamics.excitation`"""
    inertial: Flag = False
    """whether it is the inertia load of an acceleration of the whole segment, which also acts on
    collars and diaphragms"""

    @property
    def places(self) -> Mapping[str, float]:
        """The x in m at which the load needs mesh lines, by their keys in a case."""
        return {} if self.x is None else {"x": self.x}

    def resultant(self, length: float) -> float:
        """Return the resultant in N at the value 1 of the history, for a segment's length in m."""
        return self.magnitude * (length if self.x is None else 1.0)

    def turn(self, ends: tuple[float, float], about: float) -> float:
        """Return the moment in N·m about an x in m at the value 1, for a segment between ends."""
        places = [*self.places.values()] or ends
        return self.resultant(ends[1] - ends[0]) * (sum(places) / len(places) - about)

    def push(self, segment: LoadedSegment) -> Array:
        """Return the load vector (num_dofs,) at the value 1 of the history."""
        if self.x is not None:
            return self.magnitude * segment.unit_load_vector(self.x, self.direction)
        if self.inertial:
            return segment.inertia(self.direction, self.magnitude)
        return self.magnitude * segment.uniform(self.direction, None)


@part
class PartialLoad(Load):
    """Uniform load in N/m between two x in m."""

    span: tuple[Place, Place] = (0.0, 0.0)
    """both x in m"""

    @property
    def places(self) -> Mapping[str, float]:
        return dict(zip(("from", "to"), self.span, strict=True))

    def resultant(self, length: float) -> float:
        start, end = self.span
        return self.magnitude * (end - start)

    def push(self, segment: LoadedSegment) -> Array:
        return self.magnitude * segment.uniform(self.direction, self.span)


@part
class Moment(Load):
    """Moment in N·m at a point, positive towards a larger slope of the segment."""

    def resultant(self, length: float) -> float:
        return 0.0

    def turn(self, ends: tuple[float, float], about: float) -> float:
        return self.magnitude

    def push(self, segment: LoadedSegment) -> Array:
        assert self.x is not None
        return self.magnitude * segment.moment(self.x, self.direction)


@part
class Torque(Moment):
    """Torque in N·m about the axis at a point; the direction has no meaning."""

    def turn(self, ends: tuple[float, float], about: float) -> float:
        return 0.0

    def push(self, segment: LoadedSegment) -> Array:
        assert self.x is not None
        return self.magnitude * segment.torque(self.x)


@part
class AngularAcceleration(Load):
    """Inertia load of an angular acceleration about x = 0; the magnitude is in rad/s².

    With an impulse as history, it causes an angular velocity of its magnitude in rad/s.
    """

    def push(self, segment: LoadedSegment) -> Array:
        return self.magnitude * segment.rotation_load(self.direction)
