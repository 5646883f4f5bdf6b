# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modal coordinates of a boom of beams, and rows of displacements in these coordinates.

In a telescoping boom, rows are functions of the extensions of joints. While a station passes an
element, the rows of the station are the shape functions of the element. Tables of cubics are exact
for prismatic elements. For tapered elements, of degree five, and for series, of any degree, they
have a tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag, null_space

from protractile.beam_model.component import (
    BeamSegment,
    Modes,
    Motion,
    Rule,
    SegmentModel,
    natural_modes,
)
from protractile.dynamics.gap_builder import GapBuilder
from protractile.dynamics.motion_laws import HistorySum
from protractile.dynamics.second_order import buckling_factor, soften_modes
from protractile.dynamics.travel import MovingAxialForce, RowTable, Travel
from protractile.geometry.arrays import Array
from protractile.geometry.axial import joint_thrust, largest_change, moving_force
from protractile.geometry.boom import SAME_PLACE, Boom, Direction, Joint
from protractile.geometry.ground import ground_lines
from protractile.geometry.telescoping import (
    TelescopingStations,
    drives_below,
    reach,
    sample_extensions,
    station_positions,
)

# Type that identifies a component: index of the segment, and motion.
_Part = tuple[int, Motion]

# Fraction of the largest singular value below which a singular value is round-off.
ROUND_OFF = 1.0e-9

# Number of places on a segment at which deflections are evaluated for changes of axial forces.
_PLACES = 41


# Function that returns all rows of the boom, from extensions in m by index of the joint.
RowsAt = Callable[[Mapping[int, float]], GapBuilder[Array]]


class BoomModes:
    """Modes of the boom without contact, for each segment and each component of its motion.

    Segments connected by bonded joints, or by cylinders, have common modes.

    Attributes:
        models: models of the segments.
        beams: rows and load vectors of each segment in all modal coordinates.
        omega2: ω² (num_modes,) in rad²/s², exactly 0 for rigid modes; negative if an axial force
            makes a segment unstable.
        load: uniform loads (num_modes,) of the segments in N/√kg.
        damping: diagonal (num_modes,) of the modal damping matrix in 1/s, exact for damping
            proportional to mass.
    """

    def __init__(self, boom: Boom, models: Sequence[SegmentModel]) -> None:
        self.models = models
        self._shapes: dict[_Part, tuple[slice, Array]] = {}
        # ω², load and damping of each group.
        of_groups: list[tuple[Array, Array, Array]] = []
        first = 0
        for group in _coupled_groups(boom, models):
            modes = group.modes()
            geometric = group.geometric_stiffness
            if geometric.any():
                softening = modes.shapes.T @ geometric @ modes.shapes
                softer, combination = soften_modes(modes.omega2, softening)
                modes = Modes(softer, modes.shapes @ combination)
            columns = slice(first, first + modes.omega2.size)
            first = columns.stop
            sizes = np.cumsum([len(component.load) for component in group.components])
            parts = np.split(modes.shapes, sizes[:-1])
            for number, part in zip(group.parts, parts, strict=True):
                self._shapes[number] = columns, part
            load = np.concatenate([c.load for c in group.components]) @ modes.shapes
            rates = block_diag(*(c.damping for c in group.components))
            damping = np.einsum("ki,kl,li->i", modes.shapes, rates, modes.shapes, optimize=True)
            of_groups.append((modes.omega2, load, damping))
        self.omega2, self.load, self.damping = map(np.concatenate, zip(*of_groups, strict=True))
        self.beams = [self._beam(number) for number in range(len(boom.segments))]

    def add_coordinates(self, omega2: Array) -> None:
        """Add coordinates with ω² (num_added,) that move no segment."""
        self.omega2 = np.append(self.omega2, omega2)
        self.load, self.damping = (np.pad(a, (0, omega2.size)) for a in (self.load, self.damping))
        self.beams = [self._beam(number) for number in range(len(self.models))]

    def displacement(
        self, segment: int, x: float, direction: Direction, offset: tuple[float, float] = (0.0, 0.0)
    ) -> Array:
        """Return the row (num_modes,) of a displacement of a segment at x in m.

        ``offset`` is (y, z) of the point from the axis in m.
        """
        row = self.beams[segment].at(direction, x)
        # A small rotation θ about x moves (y, z) by (−θ z, θ y).
        arm = offset[0] if direction == "z" else -offset[1]
        return row if arm == 0.0 else row + arm * self.beams[segment].torque(x)

    def _beam(self, segment: int) -> BeamSegment:
        def read(motion: Motion, rule: Rule) -> Array:
            columns, shapes = self._shapes[segment, motion]
            whole = np.zeros(self.omega2.size)
            whole[columns] = rule(self.models[segment].components[motion]) @ shapes
            return whole

        return BeamSegment(read)


class ContactPlace(NamedTuple):
    """Place of the contacts of a station: joint, direction, and index of the station.

    ``shift`` is x in m of the resultant force, from the station.
    """

    joint: int
    direction: Direction
    station: int
    shift: float = 0.0


class StationCompliance(NamedTuple):
    """Compliance (num_places, num_places) in m/N of closed contacts at places.

    An entry is the displacement of the inner segment in the outer one at a place, by a unit force
    at another.
    """

    places: tuple[ContactPlace, ...]
    compliance: Array

    @property
    def couples_directions(self) -> bool:
        """Whether a force along z causes a displacement along y."""
        lateral = np.array([place.direction == "y" for place in self.places], dtype=bool)
        coupled = np.abs(self.compliance[np.ix_(lateral, ~lateral)]).max(initial=0.0)
        return bool(coupled > ROUND_OFF * np.abs(self.compliance).max(initial=0.0))


def critical_factor(
    boom: Boom,
    models: Sequence[SegmentModel],
    walls: StationCompliance | None = None,
) -> float | None:
    """Return the buckling factor of the axial forces for bonded or compliant joints.

    It is infinite without axial forces, and None for a mechanism. For a telescoping boom it is the
    minimum over several extensions, including the extreme ones. If axial forces change with time,
    the minimum includes the time of the largest compression of the foot.

    Args:
        walls: compliance of closed contacts; stations without one are rigid, and all are unless
            given.
    """
    # Sections that distort couple the motions along z and y.
    between: list[tuple[_Part, _Part]] = []
    if walls is not None and walls.couples_directions:
        between = [((i, "z"), (i, "y")) for i in range(len(boom.segments))]
    levels = largest_change(boom.axial_changes) if boom.axial_changes else np.zeros(0)
    drives = [number for number, joint in enumerate(boom.joints) if joint.drive is not None]
    smallest = np.inf
    for group in _coupled_groups(boom.bonded, models, between):
        initial = group.geometric_stiffness
        added = group.changes(levels) if levels.any() else []
        passing = {n: moving_axial_forces(boom, models, group.beams, n) for n in drives}
        largest = sum(added, initial)
        if not (initial.any() or largest.any() or any(passing.values())):
            continue
        if group.rigid_modes:
            return None
        for extensions, first in product(sample_extensions(boom), (initial, largest)):
            moving = (
                force.geometric_stiffness(extensions[number])
                for number, forces in passing.items()
                for force in forces
            )
            geometric = sum(moving, first)
            positions = {
                n: station_positions(joint, extensions[n])
                if n in extensions
                else [(x, x) for x in joint.stations]
                for n, joint in enumerate(boom.joints)
            }
            ties, stiffness = group.ties(positions), group.stiffness()
            if walls is not None:
                stiffness = stiffness + group.contact_stiffness(walls, positions)
            closed = {place[:3] for place in walls.places} if walls is not None else set()
            rigid = [tie for station, tie in ties.items() if station not in closed]
            free = _kernel(rigid, len(geometric))
            both = (free.T @ matrix @ free for matrix in (stiffness, geometric))
            smallest = min(smallest, buckling_factor(*both))
    return smallest


def _coupled_groups(
    boom: Boom, models: Sequence[SegmentModel], between: Sequence[tuple[_Part, _Part]] = ()
) -> list[_CoupledGroup]:
    """Return the groups of components with common modes.

    Bonded joints couple segments in each motion. Two inclined cylinders side by side couple the
    twist of a segment with its slope along y. ``between`` has further pairs of coupled parts.
    """
    motions: tuple[Motion, ...] = ("z", "y", "twist") if boom.spatial else ("z",)
    parts: list[_Part] = [(i, motion) for motion in motions for i in range(len(boom.segments))]
    connected: list[tuple[_Part, _Part]] = [
        ((joint.outer, motion), (joint.inner, motion))
        for motion in motions
        for joint in boom.joints
        if joint.bonded
    ]
    connected += [((c.segment, "y"), (c.segment, "twist")) for c in boom.cylinders if c.spread]
    connected += between
    group_of = {part: number for number, part in enumerate(parts)}
    for first, second in connected:
        kept, lost = group_of[first], group_of[second]
        group_of = {part: kept if at == lost else at for part, at in group_of.items()}
    return [
        _CoupledGroup(boom, models, [part for part in parts if group_of[part] == name])
        for name in dict.fromkeys(group_of.values())
    ]


def is_mechanism(boom: Boom, models: Sequence[SegmentModel]) -> bool:
    """Return True if a boom can move without strain of its segments and cylinders."""
    return any(group.rigid_modes for group in _coupled_groups(boom, models))


class _CoupledGroup:
    """Components of segments that bonded joints and cylinders couple.

    Attributes:
        parts: (segment, motion) of each component.
        components: components of the group.
        beams: rows and load vectors of each segment in the coordinates of the group.
        springs: cylinders that act on the components.
        geometric_stiffness: geometric stiffness K_G (num_dofs, num_dofs).
    """

    def __init__(self, boom: Boom, models: Sequence[SegmentModel], parts: Sequence[_Part]) -> None:
        self._boom, self.parts = boom, parts
        self.components = [models[i].components[motion] for i, motion in parts]
        self.beams = [self._beam(number) for number in range(len(boom.segments))]
        lines = [line for line in ground_lines(boom, self.beams) if line.push.any()]
        self.springs = [line for line in lines if line.force]
        # The springs of leads grow with the axial forces.
        self.geometric_stiffness = block_diag(
            *(component.geometric_stiffness for component in self.components)
        ) - sum(line.stiffness * np.outer(line.push, line.push) for line in lines if not line.force)

    def _beam(self, segment: int) -> BeamSegment:
        def read(motion: Motion, rule: Rule) -> Array:
            parts = zip(self.parts, self.components, strict=True)
            own = (segment, motion)
            return np.concatenate(
                [rule(c) if part == own else np.zeros(len(c.load)) for part, c in parts]
            )

        return BeamSegment(read)

    def changes(self, levels: Array) -> list[Array]:
        """Return the contribution of each axial force that changes with time to K_G.

        ``levels`` (num_changes,) are the values of the histories.
        """
        boom = self._boom
        lines: list[dict[Direction, tuple[Array, Array]]] = [
            {
                direction: (x, np.array([beam.at(direction, place) for place in x]))
                for direction in boom.directions
            }
            for beam, x in zip(
                self.beams,
                [np.linspace(*segment.ends, _PLACES) for segment in boom.segments],
                strict=True,
            )
        ]
        return [
            level * change.geometric_stiffness(lines)
            for level, change in zip(levels, boom.axial_changes, strict=True)
        ]

    def ties(
        self, positions: Mapping[int, Sequence[tuple[float, float]]]
    ) -> dict[tuple[int, Motion, int], Array]:
        """Return the constraints of bonded joints: rows (num_dofs,) of displacements that are zero.

        Keys are the index of the joint, the motion and the index of the station. ``positions`` has
        (x on the outer segment, x on the inner segment) in m of each station of a telescoping
        joint.
        """
        return {
            (number, motion, k): self.tie(joint, motion, on_outer, on_inner)
            for number, joint in enumerate(self._boom.joints)
            if joint.bonded
            for motion in dict.fromkeys(motion for _, motion in self.parts)
            if (joint.outer, motion) in self.parts
            for k, (on_outer, on_inner) in enumerate(
                positions.get(number, [(x, x) for x in joint.stations])
            )
        }

    def tie(self, joint: Joint, motion: Motion, on_outer: float, on_inner: float) -> Array:
        """Return the row (num_dofs,) of the motion of the inner segment in the outer one."""
        inner, outer = self.beams[joint.inner], self.beams[joint.outer]
        return inner.at(motion, on_inner) - outer.at(motion, on_outer)

    def contact_stiffness(
        self, walls: StationCompliance, positions: Mapping[int, Sequence[tuple[float, float]]]
    ) -> Array:
        """Return the stiffness (num_dofs, num_dofs) of closed contacts; ``positions`` as above."""
        directions = {motion for _, motion in self.parts}
        own = [i for i, place in enumerate(walls.places) if place.direction in directions]
        rows = np.zeros((len(own), len(self.geometric_stiffness)))
        for row, i in zip(rows, own, strict=True):
            place = walls.places[i]
            ends = (x + place.shift for x in positions[place.joint][place.station])
            row[:] = self.tie(self._boom.joints[place.joint], place.direction, *ends)
        return np.asarray(rows.T @ np.linalg.solve(walls.compliance[np.ix_(own, own)], rows))

    def stiffness(self) -> Array:
        """Return the stiffness (num_dofs, num_dofs) with the springs of cylinders."""
        stiffness = block_diag(*(c.stiffness for c in self.components))
        for line in self.springs:
            stiffness += line.stiffness * np.outer(line.push, line.push)
        return np.asarray(stiffness)

    @cached_property
    def _separate(self) -> list[Modes]:
        """The modes of each component by itself."""
        return [natural_modes(c.stiffness, c.mass, c.rigid_modes) for c in self.components]

    @property
    def rigid_modes(self) -> int:
        """The number of rigid modes with the constraints of :meth:`modes`."""
        rigid = block_diag(
            *(
                m.shapes[:, : c.rigid_modes]
                for m, c in zip(self._separate, self.components, strict=True)
            )
        )
        # Rigid motions that satisfy all constraints and do not strain cylinders are rigid modes.
        rows = [*self.ties({}).values(), *(line.push for line in self.springs)]
        restraints = np.array(rows).reshape(-1, len(rigid)) @ rigid
        values = np.linalg.svd(restraints, compute_uv=False) if restraints.size else np.zeros(0)
        return len(rigid.T) - int((values > ROUND_OFF * values.max(initial=0.0)).sum())

    def modes(self) -> Modes:
        """Return the modes with the constraints of bonded joints and the springs of cylinders."""
        ties = [*self.ties({}).values()]
        if not ties and not self.springs and len(self.components) == 1:
            return self._separate[0]
        stiffness, mass = self.stiffness(), block_diag(*(c.mass for c in self.components))
        free = _kernel(ties, len(mass))
        modes = natural_modes(free.T @ stiffness @ free, free.T @ mass @ free, self.rigid_modes)
        return Modes(modes.omega2, free @ modes.shapes)


def _kernel(ties: Sequence[Array], num_dofs: int) -> Array:
    """Return a basis (num_dofs, num_free) of the motions that satisfy the constraints ``ties``."""
    return null_space(np.array(ties)) if ties else np.eye(num_dofs)


def moving_axial_forces(
    boom: Boom, models: Sequence[SegmentModel], beams: Sequence[BeamSegment], joint: int
) -> list[MovingAxialForce]:
    """Return the axial force that moves with a telescoping joint; empty if there is none.

    ``beams`` has the load vectors and rows of each segment.
    """
    axial = moving_force(boom.segments, boom.joints, joint)
    drive = boom.joints[joint].drive
    if axial is None or drive is None:
        return []
    segment, start, direction = axial.segment, axial.x, axial.direction

    def rows(extension: float) -> Array:
        x = start + direction * extension
        return np.array([beams[segment].at(plane, x) for plane in boom.directions])

    nodes = np.concatenate([models[segment].components[plane].breaks for plane in boom.directions])
    breaks = _extensions_between(boom, drive.reach, [direction * (nodes - start)])
    return [MovingAxialForce(axial.force, RowTable.interpolate(rows, breaks))]


def travel(
    boom: Boom,
    models: Sequence[SegmentModel],
    rows_at: RowsAt,
    beams: Sequence[BeamSegment],
    group: TelescopingStations,
) -> Travel:
    """Return the travel of stations that move with the same drives."""
    moving = rows_at({}).rows_at(group.stations)

    def rows(extension: float) -> Array:
        return rows_at(group.extensions(extension)).evaluate_rows(moving, lambda row: row)

    table = RowTable.interpolate(rows, _breaks(boom, models, group))
    is_single = len(group.joints) == 1
    axial_forces = moving_axial_forces(boom, models, beams, group.joints[0]) if is_single else []
    history = HistorySum(tuple(drive.history for drive in group.drives))
    axial_load = joint_thrust(boom.segments, boom.joints, group.joints[0]) if is_single else 0.0
    return Travel(history, table, moving, group.suffix, axial_forces, axial_load)


def _breaks(boom: Boom, models: Sequence[SegmentModel], group: TelescopingStations) -> list[float]:
    """Return the extreme extensions in m, and the extensions at which a station meets a node."""
    joint = boom.joints[group.joints[-1]]
    outer, inner = (
        np.concatenate([c.breaks for c in models[segment].components.values()])
        for segment in (joint.outer, joint.inner)
    )
    crossings = []
    if len(group.joints) == 1:
        crossings += [x - inner for x in joint.stations] + [outer - x for x in joint.stations]
    for stop in boom.stops:
        if drives_below(boom.joints, stop.segment) == group.joints:
            crossings += [stop.x - c.breaks for c in models[stop.segment].components.values()]
    return _extensions_between(boom, reach(group.drives), crossings)


def _extensions_between(
    boom: Boom, ends: tuple[float, float], passed: Sequence[Array]
) -> list[float]:
    """Return the ``ends`` of a range in m, and the extensions ``passed`` within it."""
    low, high = ends
    extensions = np.unique(np.clip(np.concatenate([ends, *passed]), low, high))
    near = SAME_PLACE * boom.length
    inside = (extension for extension in extensions[1:-1] if low + near < extension < high - near)
    kept = [low, *inside, high]
    apart = np.diff(kept, prepend=low - 1.0) > near
    return [extension for extension, keep in zip(kept, apart, strict=True) if keep]
