# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads on the segments of a boom: each kind gives its place and its load vector."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from geometry.arrays import Array
from geometry.fields import SegmentRef
from geometry.section import Direction


class Body(Protocol):
    """A segment of a model under single forces; each method gives (num_dofs,) on its coordinates.

    The load vector of a unit force is also the row that reads the displacement of its point.
    """

    def force(self, x: float, direction: Direction) -> Array:
        """Return the load vector of 1 N at x in m."""

    def moment(self, x: float, direction: Direction) -> Array:
        """Return that of 1 N·m at x in m, in the plane of the direction, towards a larger slope."""

    def torque(self, x: float) -> Array:
        """Return the load vector of 1 N·m at x in m about the axis, of a segment in space."""


class Member(Body, Protocol):
    """A segment of a model under all kinds of loads."""

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        """Return that of 1 N/m between two x in m; along the whole segment where none are given."""

    def inertia(self, direction: Direction, force: float) -> Array:
        """Return that of an acceleration of all masses: ``force`` N/m on the plain segment."""

    def turning(self, direction: Direction) -> Array:
        """Return that of 1 rad/s² about x = 0 on all but point masses, towards a larger slope
        in the direction's plane.
        """


@dataclass(frozen=True, slots=True)
class Load:
    """A force on a segment's axis that follows a history.

    >>> gust = pt.Load(segment=1, direction="z", magnitude=-1e3, x=14.0, history=pt.Sine(0.5))
    >>> len(pt.BeamElements(replace(boom, loads=(gust,))).system().excitations)
    1

    Args:
        segment: its name; in a boom its position.
        direction: along which it acts.
        magnitude: magnitude in N/m along the whole segment, or in N at one place.
        x: the place in m; None for the whole segment.
        history: factor of the magnitude over time, a history of the dynamics, or its substitute
            for loads that are over at t = 0.
        inertial: whether it is an acceleration of the mass per length along the whole segment,
            which collars and diaphragms feel beyond that.
    """

    segment: SegmentRef
    direction: Direction
    magnitude: float
    x: float | None
    history: Any
    inertial: bool = False

    @property
    def places(self) -> Mapping[str, float]:
        """x in m of the mesh lines that it needs, by the keys that give them."""
        return {} if self.x is None else {"x": self.x}

    def resultant(self, length: float) -> float:
        """Return its resultant in N at the value 1 of its history, for a segment's length in m."""
        return self.magnitude * (length if self.x is None else 1.0)

    def push(self, member: Member) -> Array:
        """Return its load vector (num_dofs,) at the value 1 of its history."""
        if self.x is not None:
            return self.magnitude * member.force(self.x, self.direction)
        if self.inertial:
            return member.inertia(self.direction, self.magnitude)
        return self.magnitude * member.uniform(self.direction, None)


@dataclass(frozen=True, slots=True)
class PartialLoad(Load):
    """A uniform load in N/m between two x in m."""

    span: tuple[float, float] = (0.0, 0.0)

    @property
    def places(self) -> Mapping[str, float]:
        return dict(zip(("from", "to"), self.span, strict=True))

    def resultant(self, length: float) -> float:
        start, end = self.span
        return self.magnitude * (end - start)

    def push(self, member: Member) -> Array:
        return self.magnitude * member.uniform(self.direction, self.span)


@dataclass(frozen=True, slots=True)
class Moment(Load):
    """A moment in N·m at one place, which bends the segment towards a larger slope."""

    def resultant(self, length: float) -> float:
        return 0.0

    def push(self, member: Member) -> Array:
        assert self.x is not None
        return self.magnitude * member.moment(self.x, self.direction)


@dataclass(frozen=True, slots=True)
class Turn(Load):
    """Inertia load of mass per length and rotary inertia turning about x = 0; magnitude in rad/s².

    With a history that gives its impulse, it makes them turn at so many rad/s.
    """

    def push(self, member: Member) -> Array:
        return self.magnitude * member.turning(self.direction)
