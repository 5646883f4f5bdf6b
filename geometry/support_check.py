# SPDX-License-Identifier: LGPL-3.0-or-later
"""Check of support: supports, cylinders, joints and stops must prevent all rigid motions.

Rigid motions of a segment are translation along z and rotation in the plane x-z; in 3-D also
translation along y, rotation in the plane x-y, and rotation about the axis. Each restraint is a row
with one column for each rigid motion of each segment. The boom is supported if rows · motion = 0
has only the solution zero. If the boom needs a one-sided stop, the loads at t = 0 must press the
segment against it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.assembly import Assembly
from protractile.geometry.axial import foot_thrust
from protractile.geometry.fields import BoomError
from protractile.geometry.ground import ground_lines, pin_moments
from protractile.geometry.load import LoadedSegment
from protractile.geometry.section import Direction
from protractile.geometry.segment import Segment

# Fraction of the largest row or force below which a remainder is round-off.
_ROUND_OFF = 1.0e-9

# Number of rigid motions of a segment in planar and in three-dimensional booms.
_FLAT, _SPATIAL = 2, 5


def check_supported(boom: Assembly) -> None:
    """Check that supports, cylinders, joints and stops prevent all rigid motions.

    Raises:
        BoomError: a segment can move as a rigid body.
    """
    _check_depths(boom)
    bodies = _bodies(boom)
    free = _free_motions(
        [*_two_way_restraints(boom, bodies), *_one_way_restraints(boom, bodies)], bodies
    )
    for body in _segments_in_motion(bodies, free):
        if np.abs(free[body.motions][:_FLAT]).max() > _ROUND_OFF:
            raise BoomError(
                body.key,
                f"nothing holds {body.segment.name!r}: give it two supports, a hinge and a "
                "cylinder whose line passes beside it, or a joint with two stations to a segment "
                "that is held",
            )
        raise BoomError(
            body.key,
            f"nothing holds {body.segment.name!r} sideways: give it two supports, one that is "
            "hinged or clamped, or a joint with two stations to a segment that is held",
        )


def check_contacts_at_rest(boom: Assembly) -> None:
    """Check that the loads at t = 0 press segments against the one-sided stops that the boom needs.

    Raises:
        BoomError: the loads lift a segment off its stops.
    """
    bodies = _bodies(boom)
    free = _free_motions(_two_way_restraints(boom, bodies), bodies)
    if not free.size:
        return
    from scipy.optimize import nnls

    pushes = [body.load for body in bodies]
    pushes += [push for _, push in pin_moments(boom, bodies)]
    load = sum(pushes, np.zeros(len(free))) @ free
    _, unbalanced = nnls((np.array(_one_way_restraints(boom, bodies)) @ free).T, -load)
    if unbalanced > _ROUND_OFF * np.linalg.norm(load):
        body = next(_segments_in_motion(bodies, free))
        raise BoomError(
            body.key,
            f"the loads at t = 0 lift {body.segment.name!r} off its one-way supports, and nothing "
            "else holds it: give it two supports, or a stop that holds both ways",
        )


@dataclass(frozen=True, slots=True)
class _RigidBody(LoadedSegment):
    """Rigid segment; degrees of freedom are the rigid motions of all segments.

    Rotations are scaled by the length of the boom.
    """

    boom: Assembly
    number: int

    @property
    def segment(self) -> Segment:
        return self.boom.segments[self.number]

    @property
    def key(self) -> str:
        """The name of the segment in messages, as an attribute of the boom."""
        return f"segments[{self.number}]"

    @property
    def motions(self) -> slice:
        """The degrees of freedom of the segment: for z, in 3-D booms also for y and twist."""
        count = _SPATIAL if self.boom.spatial else _FLAT
        return slice(count * self.number, count * (self.number + 1))

    @property
    def load(self) -> Array:
        """The load vector (num_dofs,) of the segment at t = 0."""
        whole = self.segment.load * self.uniform("z", None)
        if self.boom.spatial and self.segment.lateral is not None:
            whole += self.segment.lateral.load * self.uniform("y", None)
        for load in self.boom.loads:
            # The history of a load that ends before t = 0 is not callable.
            if load.segment == self.number and callable(load.history):
                whole += float(load.history(np.zeros(()))) * load.push(self)
        return whole

    def unit_load_vector(self, x: float, direction: Direction) -> Array:
        middle = 0.5 * (self.segment.start + self.segment.end)
        return self._row(0 if direction == "z" else 2, 1.0, (x - middle) / self.boom.length)

    def moment(self, x: float, direction: Direction) -> Array:
        return self._row(1 if direction == "z" else 3, 1.0 / self.boom.length)

    def torque(self, x: float) -> Array:
        return self._row(4, 1.0 / self.boom.length)

    def uniform(self, direction: Direction, span: tuple[float, float] | None) -> Array:
        start, end = span or (self.segment.start, self.segment.end)
        return (end - start) * self.unit_load_vector(0.5 * (start + end), direction)

    def inertia(self, direction: Direction, force: float) -> Array:
        segment, acceleration = self.segment, force / self.segment.mass_per_length
        plain = force * segment.length * self.unit_load_vector(segment.mass_centre, direction)
        added = (
            acceleration * mass.mass * self.unit_load_vector(mass.x, direction)
            for mass in segment.stiffener_masses
        )
        return sum(added, plain)

    def rotation_load(self, direction: Direction) -> Array:
        segment = self.segment if direction == "z" else self.segment.turned()
        mass, middle = segment.mass_per_length * segment.length, segment.mass_centre
        inertia = mass * segment.length**2 / 12.0 + segment.rotary_inertia * segment.length
        plates = mass * middle * self.unit_load_vector(middle, direction) + inertia * self.moment(
            middle, direction
        )
        added = (
            mass.mass * mass.x * self.unit_load_vector(mass.x, direction)
            for mass in segment.stiffener_masses
        )
        return sum(added, plates)

    def _row(self, first: int, *values: float) -> Array:
        row = np.zeros(len(self.boom.segments) * (self.motions.stop - self.motions.start))
        first += self.motions.start
        row[first : first + len(values)] = values
        return row


def _check_depths(boom: Assembly) -> None:
    luffed = {cylinder.segment for cylinder in boom.cylinders}
    for number, segment in enumerate(boom.segments):
        has_thrust = number in luffed or foot_thrust(boom.segments, boom.joints, number) != 0.0
        for k, support in enumerate(segment.supports):
            if support.depth != 0.0 and not (has_thrust and support is segment.foot):
                raise BoomError(
                    f"segments[{number}].supports[{k}].depth",
                    "of no use: only the first support of a segment has a depth, under a cylinder "
                    "or axial forces; leave it out",
                )


def _bodies(boom: Assembly) -> list[_RigidBody]:
    return [_RigidBody(boom, number) for number in range(len(boom.segments))]


def _one_way_restraints(boom: Assembly, bodies: list[_RigidBody]) -> list[Array]:
    """Return the load vectors (num_dofs,) of 1 N from each one-sided stop."""
    return [
        -stop.sides[0] * bodies[stop.segment].unit_load_vector(stop.x, "z")
        for stop in boom.stops
        if len(stop.sides) == 1
    ]


def _two_way_restraints(boom: Assembly, bodies: list[_RigidBody]) -> Iterator[Array]:
    """Yield the rows (num_dofs,) of restraints that act in both directions."""
    for body in bodies:
        for support in body.segment.supports:
            for direction in boom.directions:
                yield body.unit_load_vector(support.x, direction)
                if support.holds_slope(direction) or support.rotation_stiffness is not None:
                    yield body.moment(support.x, direction)
            if boom.spatial:
                yield body.torque(support.x)
    # A lead is none: its spring is a part of the work of an axial force.
    yield from (line.push for line in ground_lines(boom, bodies) if line.force)
    for joint in boom.joints:
        inner, outer = bodies[joint.inner], bodies[joint.outer]
        for x in joint.stations:
            for direction in boom.directions:
                yield inner.unit_load_vector(x, direction) - outer.unit_load_vector(x, direction)
            if boom.spatial:
                yield inner.torque(x) - outer.torque(x)
    for stop in boom.stops:
        if len(stop.sides) == 2:
            yield bodies[stop.segment].unit_load_vector(stop.x, "z")


def _free_motions(rows: Iterable[Array], bodies: list[_RigidBody]) -> Array:
    """Return a basis (num_dofs, num_free) of the motions that the rows leave free."""
    sizes = [(row, float(np.linalg.norm(row))) for row in rows]
    scaled = np.array([row / size for row, size in sizes if size > 0.0])
    motions = np.eye(bodies[-1].motions.stop)
    if not scaled.size:
        return motions
    _, values, vectors = np.linalg.svd(scaled)
    return np.asarray(vectors[int(np.count_nonzero(values > _ROUND_OFF * values[0])) :].T)


def _segments_in_motion(bodies: list[_RigidBody], free: Array) -> Iterator[_RigidBody]:
    """Yield the segments that move in ``free`` (num_dofs, num_free)."""
    return (body for body in bodies if np.abs(free[body.motions]).max(initial=0.0) > _ROUND_OFF)
