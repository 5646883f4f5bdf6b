# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modal coordinates of all segments, and rows that read displacements in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from scipy.linalg import block_diag, null_space

from beam_model.component import (
    BeamMember,
    Component,
    Modes,
    Motion,
    Rule,
    SegmentModel,
    natural_modes,
)
from beam_model.telescoping import moving_axial_forces
from dynamics.second_order import buckling_factor, softened
from geometry.arrays import Array
from geometry.boom import Boom, Direction
from geometry.cylinder import GroundLine, ground_lines
from geometry.telescoping import places, stands

# One component of one segment.
_Part = tuple[int, Motion]

# A tie whose stiffness is below this fraction of the strongest one's has no effect.
ROUND_OFF = 1.0e-9


class BoomModes:
    """Modes of the boom without contact, of each component of each segment separately.

    Segments connected by a bonded joint have common modes, under the influence of cylinders.

    Args:
        boom: with its joints, bonded or with play, flat or in space.
        models: one for each segment.

    Attributes:
        omega2: (num_modes,) ω² in rad²/s², rigid modes exactly 0; negative where an axial force
            tips a segment over.
        load: (num_modes,) the segments' own uniform loads in N/√kg.
        damping: (num_modes,) diagonal of the modal damping matrix in 1/s, exact where the
            damping is proportional to the mass.
    """

    def __init__(self, boom: Boom, models: Sequence[SegmentModel]) -> None:
        self._models = models
        self._shapes: dict[_Part, tuple[slice, Array]] = {}
        omega2: list[Array] = []
        load: list[Array] = []
        damping: list[Array] = []
        first = 0
        for group in _groups(boom):
            components = [models[i].components[motion] for i, motion in group]
            modes = _group_modes(boom, group, components)
            geometric = block_diag(*(component.softening for component in components))
            if geometric.any():
                taken = modes.shapes.T @ geometric @ modes.shapes
                softer, combination = softened(modes.omega2, taken)
                modes = Modes(softer, modes.shapes @ combination)
            columns = slice(first, first + modes.omega2.size)
            first = columns.stop
            sizes = np.cumsum([len(component.load) for component in components])
            parts = np.split(modes.shapes, sizes[:-1])
            for one, part in zip(group, parts, strict=True):
                self._shapes[one] = columns, part
            omega2.append(modes.omega2)
            load.append(np.concatenate([c.load for c in components]) @ modes.shapes)
            rates = block_diag(*(c.damping for c in components))
            damping.append(
                np.einsum("ki,kl,li->i", modes.shapes, rates, modes.shapes, optimize=True)
            )
        self.omega2 = np.concatenate(omega2)
        self.load = np.concatenate(load)
        self.damping = np.concatenate(damping)

    def displacement(
        self, segment: int, x: float, direction: Direction, offset: tuple[float, float] = (0.0, 0.0)
    ) -> Array:
        """Return the row (num_modes,) that reads a displacement of a segment at x in m.

        ``offset`` is (y, z) of the point from the axis in m.
        """
        row = self.member(segment).at(direction, x)
        # A small turn θ about x moves (y, z) by (−θ z, θ y).
        arm = offset[0] if direction == "z" else -offset[1]
        if arm != 0.0:
            row += arm * self.twist(segment, x)
        return row

    def twist(self, segment: int, x: float) -> Array:
        """Return the row (num_modes,) that reads the rotation of a cross-section about x in rad."""
        return self.member(segment).torque(x)

    def rotation(self, segment: int, x: float, direction: Direction) -> Array:
        """Return the row (num_modes,) that reads the rotation of a cross-section at x in m."""
        return self.member(segment).moment(x, direction)

    def curvature(self, segment: int, x: float, direction: Direction) -> Array:
        """Return the row (num_modes,) that reads the curvature of a segment at x in m."""
        return self.member(segment).read(direction, lambda component: component.curvature_at(x))

    def member(self, segment: int) -> BeamMember:
        """Return a segment under loads, over all modal coordinates."""

        def read(motion: Motion, rule: Rule) -> Array:
            columns, shapes = self._shapes[segment, motion]
            whole = np.zeros(self.omega2.size)
            whole[columns] = rule(self._models[segment].components[motion]) @ shapes
            return whole

        return BeamMember(read)


def critical_factor(boom: Boom, models: Sequence[SegmentModel]) -> float | None:
    """Return the critical factor of the axial forces, see :mod:`dynamics.second_order`.

    The boom is without play. The factor is infinite without such forces, and None for a mechanism.
    Of a telescoping boom it is the smallest at several extensions, the stroke's ends among them.
    """
    tied = boom.play_free
    drives = [number for number, joint in enumerate(boom.joints) if joint.drive is not None]
    smallest = np.inf
    for group in _groups(tied):
        components = [models[i].components[motion] for i, motion in group]
        first = block_diag(*(component.softening for component in components))
        members = _members(boom, group, components)
        passing = {number: moving_axial_forces(boom, models, members, number) for number in drives}
        if not (first.any() or any(passing.values())):
            continue
        if (_group_modes(tied, group, components).omega2 == 0.0).any():
            return None
        for extensions in stands(boom):
            moving = (
                force.softening(extensions[number])
                for number, forces in passing.items()
                for force in forces
            )
            geometric = sum(moving, first)
            moved = {n: places(boom.joints[n], extension) for n, extension in extensions.items()}
            ties, pulled = _holds(tied, group, components, moved)
            stiffness, free = _held_stiffness(components, pulled), _free(ties, len(geometric))
            factor = buckling_factor(free.T @ stiffness @ free, free.T @ geometric @ free)
            smallest = min(smallest, factor)
    return smallest


def _groups(boom: Boom) -> list[list[_Part]]:
    """Return the groups with common modes: segments that bonded joints connect, in each motion.

    Two inclined cylinders side by side couple the twist of a segment to its slope along y.
    """
    motions: tuple[Motion, ...] = ("z", "y", "twist") if boom.spatial else ("z",)
    parts: list[_Part] = [(i, motion) for motion in motions for i in range(len(boom.segments))]
    connected: list[tuple[_Part, _Part]] = [
        ((joint.outer, motion), (joint.inner, motion))
        for motion in motions
        for joint in boom.joints
        if joint.tied
    ]
    connected += [((c.segment, "y"), (c.segment, "twist")) for c in boom.cylinders if c.spread]
    group_of = {part: number for number, part in enumerate(parts)}
    for one, other in connected:
        kept, lost = group_of[one], group_of[other]
        group_of = {part: kept if at == lost else at for part, at in group_of.items()}
    return [
        [part for part in parts if group_of[part] == name]
        for name in dict.fromkeys(group_of.values())
    ]


def _members(
    boom: Boom, group: Sequence[_Part], components: Sequence[Component]
) -> list[BeamMember]:
    """Return each segment under loads on a group's components; a row is 0 where it has none."""

    def member(segment: int) -> BeamMember:
        def read(motion: Motion, rule: Rule) -> Array:
            parts = zip(group, components, strict=True)
            own = (segment, motion)
            return np.concatenate(
                [rule(c) if part == own else np.zeros(len(c.load)) for part, c in parts]
            )

        return BeamMember(read)

    return [member(number) for number in range(len(boom.segments))]


def _holds(
    boom: Boom,
    group: Sequence[_Part],
    components: Sequence[Component],
    moved: Mapping[int, Sequence[tuple[float, float]]],
) -> tuple[list[Array], list[GroundLine]]:
    """Return rows (num_dofs,) that ties keep at zero, and those of the cylinders, of a group.

    Telescoping joints are bonded where they have ``moved`` to, x in m on both segments.
    """
    members = _members(boom, group, components)
    ties = [
        members[joint.inner].at(motion, on_inner) - members[joint.outer].at(motion, on_outer)
        for number, joint in enumerate(boom.joints)
        if joint.tied
        for motion in dict.fromkeys(motion for _, motion in group)
        if (joint.outer, motion) in group
        for on_outer, on_inner in moved.get(number, [(x, x) for x in joint.stations])
    ]
    lines = ground_lines(boom, members)
    return ties, [line for line in lines if line.stiffness > 0.0 and line.push.any()]


def _held_stiffness(components: Sequence[Component], pulled: Sequence[GroundLine]) -> Array:
    """Return the stiffness (num_dofs, num_dofs) with the springs of cylinders."""
    stiffness = block_diag(*(c.stiffness for c in components))
    for line in pulled:
        stiffness += line.stiffness * np.outer(line.push, line.push)
    return np.asarray(stiffness)


def _free(ties: Sequence[Array], num_dofs: int) -> Array:
    """Return (num_dofs, num_free) the motions that keep the ties at zero."""
    return null_space(np.array(ties)) if ties else np.eye(num_dofs)


def _group_modes(boom: Boom, group: Sequence[_Part], components: Sequence[Component]) -> Modes:
    """Return the modes of components side by side under the constraints of ties and cylinders."""
    apart = [natural_modes(c.stiffness, c.mass, c.rigid_modes) for c in components]
    ties, pulled = _holds(boom, group, components, {})
    if not ties and not pulled and len(apart) == 1:
        return apart[0]
    rigid = block_diag(
        *(m.shapes[:, : c.rigid_modes] for m, c in zip(apart, components, strict=True))
    )
    # Rigid motions of the segments that satisfy these constraints stay rigid.
    held = np.array([*ties, *(line.push for line in pulled)]).reshape(-1, len(rigid)) @ rigid
    bound = np.linalg.svd(held, compute_uv=False) if held.size else np.zeros(0)
    rigid_modes = rigid.shape[1] - int((bound > ROUND_OFF * bound.max(initial=0.0)).sum())
    stiffness = _held_stiffness(components, pulled)
    mass = block_diag(*(c.mass for c in components))
    free = _free(ties, len(mass))
    modes = natural_modes(free.T @ stiffness @ free, free.T @ mass @ free, rigid_modes)
    return Modes(modes.omega2, free @ modes.shapes)
