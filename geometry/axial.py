# SPDX-License-Identifier: LGPL-3.0-or-later
"""Axial forces: the compression of each segment along the load path to the base.

All forces act towards the base. A segment transfers the sum of its forces to the next segment at
its lock, or to the ground at its foot. Forces outboard of that point cause compression, forces
inboard of it cause tension.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import hypot
from operator import attrgetter
from typing import Annotated, Any

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.compression import NO_COMPRESSION, Compression
from protractile.geometry.fields import In, Number, part
from protractile.geometry.joint import Joint, sample_times
from protractile.geometry.place import Place, SegmentRef, resolve_segments
from protractile.geometry.section import Direction
from protractile.geometry.segment import SAME_PLACE, PointMass, Segment
from protractile.geometry.taper import mean_area

# Number of steps of uniform weight in a tapered segment. Forces are exact at the ends of steps;
# between them the error is some thousandths of the weight of a step.
_STEPS = 8

# Number of point masses that replace the mass per length of a segment, and Gauss points between two
# of them.
_LUMPS, _GAUSS = 20, np.polynomial.legendre.leggauss(3)


@part
class Thrust:
    """Axial force on a segment towards the base, for example of a hoist rope.

    >>> rope = pt.Thrust(segment="fly", x="head", force=12e3)
    >>> arm, fly = with_compression(boom.segments, boom.joints, [rope])
    >>> fly.compression.ends, arm.compression.ends
    (((12000.0, 12000.0),), ((12000.0, 12000.0), (0.0, 0.0)))
    """

    segment: SegmentRef
    """the name of the segment"""
    x: Place
    """the x in m"""
    force: Annotated[Number, In("N")]
    """the force in N"""


@part
class Lead:
    """Force of the rope from the head on the axis of the boom back to the winch.

    The rope points to the winch as the boom deflects. Second-order work of its force S over the
    distance ℓ to the winch is that of an axial force S cos β and of a spring S/ℓ across the axis,
    S cos² β/ℓ in the plane of the angle β between rope and axis (Timoshenko and Gere 1961, article
    2.6: a force through a fixed point).

    >>> lead = pt.Lead(segment=1, x=14.0, force=28e3)
    >>> lead.stiffness("z"), lead.components[0]
    (2000.0, -28000.0)
    """

    segment: SegmentRef
    """the name of the segment with the head"""
    x: Place
    """the x in m of the head"""
    force: Annotated[Number, In("N")]
    """the force in N"""
    winch: Annotated[Number, In("m")] = 0.0
    """the x in m of the winch, where nothing deflects"""
    depth: Annotated[Number, In("m")] = 0.0
    """the depth in m of the winch below the axis"""
    ahead: Annotated[Number, In("m")] = 0.0
    """the distance in m of the sheave beyond the head"""
    below: Annotated[Number, In("m")] = 0.0
    """the depth in m of the sheave below the axis"""

    @property
    def components(self) -> tuple[float, float]:
        """The components of the force along x and z in N."""
        along, up = self.winch - self.x - self.ahead, self.below - self.depth
        return self.force * along / hypot(along, up), self.force * up / hypot(along, up)

    def stiffness(self, direction: Direction) -> float:
        """Return the stiffness in N/m across the axis in a direction."""
        along, up = self.winch - self.x - self.ahead, self.below - self.depth
        part = (along / hypot(along, up)) ** 2 if direction == "z" else 1.0
        return self.force * part / hypot(along, up)


def with_compression(
    segments: Sequence[Segment],
    joints: Sequence[Joint],
    thrusts: Sequence[Thrust],
    gravity: float = 0.0,
) -> tuple[Segment, ...]:
    """Return the segments with their axial forces.

    Example: the base of an upright boom carries its weight.

    >>> arm, fly = with_compression(boom.segments, boom.joints, [], gravity=9.80665)
    >>> masses = [segment.mass_per_length * segment.length for segment in (arm, fly)]
    >>> (foot, _), _ = arm.compression.ends
    >>> round(foot / 9.80665 - sum(masses), 6)
    0.0

    Args:
        segments: segments from the base to the tip.
        joints: joints with the positions of locks.
        thrusts: axial forces on the segments.
        gravity: acceleration towards the base in m/s²; it acts on all masses, including
            collars and diaphragms.

    Raises:
        BoomError: a segment name is unknown.
    """
    thrusts = [resolve_segments(t, f"thrusts[{i}]", segments) for i, t in enumerate(thrusts)]
    transferred: list[list[tuple[float, float]]] = [[] for _ in segments]
    loaded = list(segments)
    for number in reversed(range(len(segments))):
        segment = segments[number]
        weights, spread = _weights(segment, gravity)
        points = [(t.x, t.force) for t in thrusts if t.segment == number]
        points += transferred[number] + weights
        joint = _lock(joints, number)
        anchor = segment.start if joint is not None or segment.foot is None else segment.foot.x
        if joint is not None:
            locked = segment.start if joint.locked_at is None else joint.locked_at
            total = sum(force for _, force in points)
            total += sum(each * (end - start) for start, end, each in spread)
            transferred[joint.outer].append((locked, total))
            anchor = max(anchor, locked)
        loaded[number] = replace(segment, compression=_compression(segment, anchor, points, spread))
    return tuple(loaded)


@dataclass(frozen=True, slots=True)
class MovingForce:
    """Axial force that moves along a segment as a joint telescopes.

    At an extension s > 0, P increases by the force between x and x + direction · s; at s < 0 it
    decreases.
    """

    segment: int  #: index of the segment
    x: float  #: initial position in m
    direction: int  #: 1 towards the head, −1 towards the tail
    force: float  #: force in N

    def change(self, x: Array, extension: Array) -> Array:
        """Return the change of P (..., num_places) in N at x in m, at extensions (...) in m."""
        passed = self.direction * (x - self.x)
        far = np.asarray(extension)[..., None]
        out, back = (passed > 0.0) & (passed < far), (far < passed) & (passed < 0.0)
        return np.asarray(self.force * (out.astype(float) - back))


def joint_thrust(segments: Sequence[Segment], joints: Sequence[Joint], number: int) -> float:
    """Return the axial force in N that a joint carries; 0 if another joint has the lock."""
    inner = joints[number].inner
    is_lock = _lock(joints, inner) is joints[number]
    return segments[inner].compression.transferred if is_lock else 0.0


def foot_thrust(
    segments: Sequence[Segment],
    joints: Sequence[Joint],
    number: int,
    time: Array | float = 0.0,
    changes: Sequence[AxialChange] = (),
) -> Array:
    """Return the axial force (...) in N on a segment's foot at times (...) in s.

    It is 0 if a joint carries the force. Arguments as in :func:`axial_force`.
    """
    segment, time = segments[number], np.asarray(time)
    if segment.foot is None or _lock(joints, number) is not None:
        return np.zeros(time.shape)
    total = np.full(time.shape, segment.compression.transferred)
    for change in changes:
        if change.compressions:
            total = total + change.history(time) * change.compressions[number].transferred
    return total


def moving_force(
    segments: Sequence[Segment], joints: Sequence[Joint], number: int
) -> MovingForce | None:
    """Return the axial force that moves with a telescoping joint; None if there is none.

    The lock is the place where the inner segment transfers its axial force. If it is fixed to the
    inner segment, the force moves along the outer segment. If it is fixed to the outer segment,
    the force moves along the inner segment; there is none if the lock is below its tail.
    """
    joint = joints[number]
    inner, force = segments[joint.inner], joint_thrust(segments, joints, number)
    if joint.drive is None or force == 0.0:
        return None
    locked = inner.start if joint.locked_at is None else joint.locked_at
    if joint.drive.locked == "inner":
        return MovingForce(joint.outer, locked, 1, force)
    return MovingForce(joint.inner, locked, -1, force) if locked >= inner.start else None


def moving_force_places(
    segments: Sequence[Segment], joints: Sequence[Joint], segment: int
) -> set[float]:
    """Return the places x in m on a segment where moving axial forces start and end."""
    return {
        moving.x + moving.direction * extension
        for number, joint in enumerate(joints)
        if joint.drive is not None
        and (moving := moving_force(segments, joints, number)) is not None
        and moving.segment == segment
        for extension in (0.0, *joint.drive.reach)
    }


@dataclass(frozen=True, slots=True)
class AxialChange:
    """Change of the stiffness over time, due to axial and centrifugal forces.

    The strain energy decreases by ½ g_e (∫ P w′² dx + Σ m w² − Σ k w²). Here g_e is the value of
    the history, P the axial force, m a point mass, k the stiffness of a lead and w the deflection
    of mass or head.
    """

    history: Any  #: factor g_e over time, see :mod:`.dynamics.excitation`
    #: axial force P of each segment in N at the factor 1; none unless given
    compressions: Sequence[Compression] = ()
    #: point masses m of each segment in kg; none unless given
    masses: Sequence[Sequence[PointMass]] = ()
    direction: Direction = "z"  #: direction of the deflection w of the masses
    leads: Sequence[Lead] = ()  #: ropes from the head to a winch, with indices of segments

    @property
    def times(self) -> Array:
        """The times (num_times,) in s of the samples of the history, from t = 0 on."""
        return sample_times(self.history)

    def geometric_stiffness(
        self, deflections: Sequence[Mapping[Direction, tuple[Array, Array]]]
    ) -> Array:
        """Return the reduction of the modal stiffness (num_modes, num_modes) at the factor 1.

        ``deflections`` has, for each segment and direction, ascending x (num_places,) in m and the
        deflections (num_places, num_modes) of the modes there.
        """
        from scipy.interpolate import CubicSpline

        total = np.zeros(())
        for number, lines in enumerate(deflections):
            for direction, (x, rows) in lines.items():
                total = total + np.zeros((rows.shape[1],) * 2)
                spline = CubicSpline(x, rows)
                if self.compressions and (compression := self.compressions[number]):
                    slopes, weights = _at_gauss_points(
                        spline.derivative(), {*x, *compression.places}
                    )
                    total = total + (slopes.T * (weights[1] * compression(weights[0]))) @ slopes
                if self.masses and direction == self.direction:
                    values = spline([mass.x for mass in self.masses[number]])
                    total = total + (values.T * [m.mass for m in self.masses[number]]) @ values
                for lead in self.leads:
                    if lead.segment == number:
                        head = spline(lead.x)
                        total = total - lead.stiffness(direction) * np.outer(head, head)
        return total


def largest_change(changes: Sequence[AxialChange]) -> Array:
    """Return the factors (num_changes,) of the histories when the foot's compression is largest."""
    times = np.unique(np.concatenate([np.zeros(1), *(change.times for change in changes)]))
    factors = np.array([change.history(times) for change in changes])
    compressions = [
        change.compressions[0].transferred if change.compressions else 0.0 for change in changes
    ]
    return np.asarray(factors[:, (np.array(compressions) @ factors).argmax()])


def _at_gauss_points(function: Any, places: set[float]) -> tuple[Array, Array]:
    """Return values (num_points, num_modes) at Gauss points; x and weights (2, num_points) in m."""
    ends = np.array(sorted(places))
    half = 0.5 * np.diff(ends)[:, None]
    x = ends[:-1, None] + half * (1.0 + _GAUSS[0])
    return function(x.ravel()), np.array([x.ravel(), (half * _GAUSS[1]).ravel()])


def lumped_masses(segment: Segment) -> tuple[PointMass, ...]:
    """Return the masses of a segment as point masses."""
    ends = np.linspace(segment.start, segment.end, _LUMPS + 1)
    x, length = 0.5 * (ends[1:] + ends[:-1]), segment.length / _LUMPS
    ratio = segment.property_ratio(attrgetter("mass_per_length"), x)
    masses = segment.mass_per_length * length * ratio
    lumps = (PointMass(*lump) for lump in zip(x.tolist(), masses.tolist(), strict=True))
    return (*lumps, *segment.all_masses)


def axial_force(
    segments: Sequence[Segment],
    joints: Sequence[Joint],
    number: int,
    x: Array,
    time: Array,
    changes: Sequence[AxialChange] = (),
) -> Array:
    """Return the axial force (..., num_places) of a segment in N; at a jump, the value on one side.

    Args:
        segments: segments with their initial axial forces.
        number: index of the segment.
        x: positions (num_places,) in m.
        time: times (...) in s.
        changes: changes of the axial forces.
    """
    total = np.broadcast_to(segments[number].compression(x), (*time.shape, x.size))
    for position, joint in enumerate(joints):
        moving = moving_force(segments, joints, position)
        if joint.drive is not None and moving is not None and moving.segment == number:
            total = total + moving.change(x, joint.drive.history(time))
    for change in changes:
        if change.compressions:
            total = total + change.history(time)[..., None] * change.compressions[number](x)
    return total


def _weights(
    segment: Segment, gravity: float
) -> tuple[list[tuple[float, float]], list[tuple[float, float, float]]]:
    """Return (x in m, weight in N) of point masses; (start, end in m, weight in N/m) of others."""
    points = [(point.x, point.mass * gravity) for point in segment.masses]
    spread = [(segment.start, segment.end, segment.mass_per_length * gravity)]
    if segment.head_section is not None:
        steps = pairwise(np.linspace(segment.start, segment.end, _STEPS + 1).tolist())
        ends = [(a, b, segment.section_at(a), segment.section_at(b)) for a, b in steps]
        weight = segment.material.density * gravity
        added = segment.added_mass_per_length * gravity
        spread = [(a, b, weight * mean_area(tail, head) + added) for a, b, tail, head in ends]
    for (start, end), mass in segment.stiffeners:
        if start == end:
            points.append((start, mass * gravity))
        else:
            spread.append((start, end, mass * gravity / (end - start)))
    return points, spread


def _lock(joints: Sequence[Joint], number: int) -> Joint | None:
    """Return the joint that carries a segment's axial force.

    It is the joint with ``locked_at``; if no joint has this key, it is the last of the segment.
    """
    around = [joint for joint in joints if joint.inner == number]
    return max(around, key=lambda joint: (joint.locked_at is not None, joint.outer), default=None)


def _compression(
    segment: Segment,
    anchor: float,
    points: Sequence[tuple[float, float]],
    spread: Sequence[tuple[float, float, float]],
) -> Compression:
    near = SAME_PLACE * segment.length
    places = [segment.start]
    ends = [x for start, end, _ in spread for x in (start, end)]
    for x in sorted([segment.end, anchor, *(x for x, _ in points), *ends]):
        if places[-1] + near < x <= segment.end + near:
            places.append(x)

    def sum_beyond(x: float) -> float:
        """Return the sum of the forces in N at and beyond x in m."""
        at_places = sum(force for place, force in points if place >= x - near)
        return at_places + sum(q * max(0.0, end - max(start, x)) for start, end, q in spread)

    everything = sum_beyond(segment.start)
    pieces = []
    for a, b in pairwise(places):
        at_a = sum(force for place, force in points if abs(place - a) <= near)
        first, last = sum_beyond(a) - at_a, sum_beyond(b)
        reaction = everything if b <= anchor + near else 0.0
        pieces.append((first - reaction, last - reaction))
    if not any(force for piece in pieces for force in piece):
        return replace(NO_COMPRESSION, transferred=everything)
    return Compression(tuple(places), tuple(pieces), everything)
