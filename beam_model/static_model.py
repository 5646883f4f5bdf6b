# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beam elements of a boom, kept while its shape does not change, for states under many loads.

Loads, axial forces and the luffing angle change neither the elements nor the contacts. In the modes
of the boom without them, the stiffness is

    K = diag(ω²) − ∫ P w′ w′ᵀ dx + Σ_c (k_c p_c p_cᵀ − k̄_c p̄_c p̄_cᵀ)

with the axial force P, and cylinders of the stiffness k. The row p of a cylinder's elongation and
its stiffness depend on the luffing angle; the modes include a cylinder at right angles to its lever
arm, with p̄ and k̄. The spring of a rope's lead is part of the reduction by P.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from dataclasses import fields, replace
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import null_space

from protractile.beam_model.boom_modes import BoomModes, critical_factor, is_mechanism
from protractile.beam_model.component import Motion, Rule, products
from protractile.beam_model.lines import force_places, line_without_compression, with_compression
from protractile.beam_model.segment_model import contact_rows, system_of_rows
from protractile.beam_model.statics import Completion, Elements, loaded_system
from protractile.beam_model.wall_compliance import (
    contact_compliance,
    station_compliance,
    with_compliance,
)
from protractile.dynamics.damping import closed_stiffness
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.gap_builder import GapBuilder
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line
from protractile.dynamics.second_order import buckling_factor
from protractile.dynamics.stability import closing_loads
from protractile.geometry.arrays import Array, Indices
from protractile.geometry.boom import Boom
from protractile.geometry.compression import NO_COMPRESSION, Compression
from protractile.geometry.cylinder import Cylinder
from protractile.geometry.ground import ground_lines, pin_moments
from protractile.geometry.load import Load
from protractile.geometry.section import EACH_SIDE
from protractile.geometry.segment import PointMass, Segment

# Elements of the longest segment. The error of stresses under a uniform load is below 0.1 %.
_ELEMENTS = 20

# Number of models that a process keeps.
_KEPT = 16


class _Slopes(NamedTuple):
    """Slopes of a component of bending in the modes that move it."""

    segment: int  #: index of the segment
    points: Array  #: x and weights (2, num_points) in m of Gauss points
    own: tuple[Indices, ...]  #: these modes, as rows and columns of a matrix
    slopes: Array  #: slopes w′ (num_points, num_own) at the points


class StaticModel:
    """Beam elements of a boom at its initial extension, with elastic plates under pads.

    Masses, friction and dashpots do not act. The theory is Timoshenko's if all segments have
    sections.
    """

    def __init__(self, shape: Boom) -> None:
        """Build the elements of a boom of :func:`_of_shape`."""
        self._shape = shape
        self._segments = Elements(shape, _ELEMENTS).segments
        self._modes = BoomModes(shape, self._segments)
        self._walls = contact_compliance(shape)
        rows, count = contact_rows(shape, self._modes, EACH_SIDE, {}), self._modes.omega2.size
        system = with_compliance(
            system_of_rows(rows, shape, self._modes, self._modes.load), self._walls
        )
        # Springs of plates have coordinates of their own.
        self._modes.add_coordinates(system.omega2[count:])
        contacts = zip(rows.contacts, system.rows, strict=True)
        self._rows: GapBuilder[Array] = GapBuilder(
            [contact._replace(operator=row) for contact, row in contacts], grounded=rows.grounded
        )
        numbers = range(len(shape.segments))
        self._lines = [line_without_compression(shape, n, self._modes) for n in numbers]
        self._places = [force_places(shape, number) for number in numbers]
        lines = ground_lines(shape, self._modes.beams)
        self._cylinders = [line for line in lines if line.force]
        self._slopes = [*self._all_slopes()]
        # Motions (num_modes, num_free) that stations without closed contacts allow, by the others;
        # None if all are closed.
        self._motions: dict[frozenset[tuple[int, Motion, int]], Array | None] = {}

    def _all_slopes(self) -> Iterator[_Slopes]:
        for number, (segment, beam) in enumerate(
            zip(self._segments, self._modes.beams, strict=True)
        ):
            for motion in self._shape.directions:
                component = segment.components[motion]
                rows = np.array([beam.read(motion, _constant(row)) for row in component.slopes])
                own = np.flatnonzero(rows.any(axis=0))
                yield _Slopes(number, component.points, np.ix_(own, own), rows[:, own])

    @classmethod
    def of(cls, boom: Boom) -> StaticModel:
        """Return the model of a boom without drives; booms of one shape share it."""
        return _kept(_Shape(boom))

    def loaded(
        self, boom: Boom, complete: Completion | None = None
    ) -> tuple[GapSystem, list[Line]]:
        """Return the gap system of a boom of this shape with all its loads, and its lines.

        ``complete`` adds what the boom lacks, such as a load on a rope.
        """
        system = self._system(boom, self._softening(boom))
        lines = [
            with_compression(*one)
            for one in zip(boom.segments, self._lines, self._places, strict=True)
        ]
        if complete is not None:
            system = complete(system, lines)
        return system.gather_loads(), lines

    def critical_factor(self, boom: Boom) -> float | None:
        """Return the buckling factor of a boom, as :func:`estimate_critical_factor`.

        Raises:
            NumericsError: there is no equilibrium without axial forces.
        """
        softening = self._softening(boom)
        if not softening.any():
            return float("inf")
        if self._is_mechanism:
            return None
        system, factors = self._system(boom, np.zeros_like(softening)), list[float]()
        pins = sum(push for _, push in pin_moments(boom, self._modes.beams))
        system = replace(system, load=system.load - pins).gather_loads()
        stiffness = system.stiffness
        for pushing in closing_loads(system, system.load_at(0.0)):
            closed = closed_stiffness(system, equilibrium(system, pushing))
            walls = station_compliance(boom, closed, self._walls)
            rows = np.array(
                [
                    self._tie(place.joint, place.direction, place.station, place.shift)
                    for place in walls.places
                ]
            ).reshape(-1, len(stiffness))
            matrices = stiffness + rows.T @ np.linalg.solve(walls.compliance, rows), softening
            pressed = frozenset[tuple[int, Motion, int]](place[:3] for place in walls.places)
            if pressed not in self._motions:
                ties = [*self._open_ties(pressed)]
                self._motions[pressed] = null_space(np.array(ties)) if ties else None
            if (free := self._motions[pressed]) is not None:
                matrices = free.T @ matrices[0] @ free, free.T @ softening @ free
            factors.append(buckling_factor(*matrices))
        return min(factors)

    def _system(self, boom: Boom, softening: Array) -> GapSystem:
        """Return the gap system under the loads of a boom, with K_G of axial forces."""
        modes, load = self._modes, np.zeros(self._modes.omega2.size)
        for segment, beam in zip(boom.segments, modes.beams, strict=True):
            load += segment.load * beam.uniform("z", None)
            if boom.spatial and segment.lateral is not None:
                load += segment.lateral.load * beam.uniform("y", None)
        change = softening - self._stiffening(boom)
        return replace(
            system_of_rows(self._rows, boom, modes, load),
            geometric_stiffness=change if change.any() else np.zeros((0, 0)),
        )

    def _softening(self, boom: Boom) -> Array:
        """Return K_G (num_modes, num_modes) of the axial forces and leads of a boom."""
        total = np.zeros((self._modes.omega2.size,) * 2)
        for number, (x, weights), own, slopes in self._slopes:
            compression = boom.segments[number].compression
            if compression:
                total[own] += products(slopes.T, weights * compression(x))
        for line in ground_lines(boom, self._modes.beams) if boom.leads else ():
            if not line.force:
                total -= line.stiffness * np.outer(line.push, line.push)
        return total

    def _stiffening(self, boom: Boom) -> Array:
        """Return the change of the stiffness by cylinders that have turned with the boom."""
        total = np.zeros((self._modes.omega2.size,) * 2)
        lines = [line for line in ground_lines(boom, self._modes.beams) if line.force]
        for line, before in zip(lines, self._cylinders, strict=True):
            now, then = (np.outer(one.push, one.push) for one in (line, before))
            total += line.stiffness * (now - then) + (line.stiffness - before.stiffness) * then
        return total

    @cached_property
    def _is_mechanism(self) -> bool:
        """Whether the boom moves without strain although its joints are bonded."""
        return is_mechanism(self._shape.bonded, self._segments)

    def _open_ties(self, closed: frozenset[tuple[int, Motion, int]]) -> Iterator[Array]:
        """Yield the displacements (num_modes,) between segments at stations not in ``closed``."""
        motions: tuple[Motion, ...] = ("z", "y", "twist") if self._shape.spatial else ("z",)
        for number, joint in enumerate(self._shape.joints):
            for motion in motions:
                for station in range(len(joint.stations)):
                    if (number, motion, station) not in closed:
                        yield self._tie(number, motion, station)

    def _tie(self, number: int, motion: Motion, station: int, shift: float = 0.0) -> Array:
        """Return the row (num_modes,) of the motion of the inner segment in the outer one."""
        joint, beams = self._shape.joints[number], self._modes.beams
        x = joint.stations[station] + shift
        return beams[joint.inner].at(motion, x) - beams[joint.outer].at(motion, x)


def _constant(row: Array) -> Rule:
    return lambda component: row


class _Shape:
    """A boom that equals other booms of the same shape."""

    def __init__(self, boom: Boom) -> None:
        self.boom = boom
        # Elements have nodes at the places of forces.
        places = {(load.segment, x) for load in boom.loads for x in load.places.values()}
        of_segments = [
            _key(one, "load", "masses", "lateral", "compression") for one in boom.segments
        ]
        lateral = [one.lateral and replace(one.lateral, load=0.0) for one in boom.segments]
        points = [
            (tuple(mass.x for mass in one.masses), one.compression.places) for one in boom.segments
        ]
        cylinders = [_key(one, "ground", "capacity", "pin") for one in boom.cylinders]
        others = boom.joints, boom.stops, boom.observations
        parts = (*of_segments, *lateral, *points, *cylinders, *others, frozenset(places))
        self._key: Hashable = parts

    def __hash__(self) -> int:
        return hash(self._key)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Shape) and self._key == other._key


def _key(part: Segment | Cylinder, *without: str) -> Hashable:
    return tuple(getattr(part, one.name) for one in fields(part) if one.name not in without)


@lru_cache(maxsize=_KEPT)
def _kept(shape: _Shape) -> StaticModel:
    return StaticModel(_of_shape(shape.boom))


def _of_shape(boom: Boom) -> Boom:
    """Return the boom without loads, with unit masses and with axial forces 0 at their places."""
    segments = [
        replace(
            segment,
            load=0.0,
            lateral=segment.lateral and replace(segment.lateral, load=0.0),
            masses=tuple(PointMass(mass.x, 1.0) for mass in segment.masses),
            compression=Compression(
                segment.compression.places, tuple((0.0, 0.0) for _ in segment.compression.ends)
            ),
        )
        for segment in boom.segments
    ]
    places = {(load.segment, x) for load in boom.loads for x in load.places.values()}
    loads = [Load(segment, "z", 0.0, x, Step()) for segment, x in sorted(places)]
    cylinders = [_square(one, segments[one.segment]) for one in boom.cylinders]
    return replace(
        boom, segments=segments, loads=loads, cylinders=cylinders, leads=(), axial_changes=()
    )


def _square(cylinder: Cylinder, segment: Segment) -> Cylinder:
    """Return a cylinder at right angles to its lever arm about the foot of its segment."""
    foot, along, up = segment.foot, 1.0, 0.0
    if foot is not None and (foot.x, foot.depth) != (cylinder.x, cylinder.depth):
        along, up = cylinder.x - foot.x, foot.depth - cylinder.depth
    # Its length is not that of the cylinder, whose data may give the stiffness.
    data: dict[str, Any] = dict.fromkeys(("closed", "open", "stroke", "bore", "rod", "pressure"))
    ground = cylinder.x + up, -cylinder.depth - along
    return replace(cylinder, ground=ground, stiffness=cylinder.axial_stiffness, **data)


def estimate_critical_factor(boom: Boom) -> float | None:
    """Return the buckling factor of the boom by beam elements, with walls that bend under pads.

    Contacts that are closed at t = 0 have their stiffness at rest, in an equilibrium without axial
    forces, which exists for booms that buckle, too. The factor is infinite without axial forces,
    and None for a mechanism or if numbers overflow.
    """
    if not boom.compressed:
        return float("inf")
    try:
        with np.errstate(all="ignore"):
            if not (boom.telescopes or boom.axial_changes):
                return StaticModel.of(boom).critical_factor(boom)
            segments = Elements(boom).segments
            factors = [
                critical_factor(boom, segments, station_compliance(boom, stiffness))
                for stiffness in _closed_stiffness(boom)
            ]
            return min((factor for factor in factors if factor is not None), default=None)
    except NUMERICAL_ERRORS:
        return None


def _closed_stiffness(boom: Boom) -> Iterator[Array]:
    """Yield the stiffness (num_rows,) in N/m of contacts at rest, 0 where they are open.

    In space, contacts that no load presses are closed in one direction at a time.
    """
    segments = [replace(segment, compression=NO_COMPRESSION) for segment in boom.segments]
    unloaded = replace(boom, segments=segments, axial_changes=())
    modes = BoomModes(unloaded, Elements(unloaded).segments)
    system = loaded_system(unloaded, modes).at_time(0.0)
    for load in closing_loads(system, system.load_at(0.0)):
        yield closed_stiffness(system, equilibrium(system, load))
