# SPDX-License-Identifier: LGPL-3.0-or-later
"""The modal coordinates of all segments, and rows that read displacements in them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, null_space

from beam_model.component import Component, Modes, Motion, SegmentModel, natural_modes
from beam_model.drawn_rows import moving_thrusts
from dynamics.drive.row_table import MovingThrust
from dynamics.second_order import buckling_factor, softened
from geometry.arrays import Array
from geometry.boom import Boom, Direction
from geometry.cylinder import GroundLine, ground_lines
from geometry.drawing import places, stands

# One component of one segment.
_Part = tuple[int, Motion]

# A tie that holds less than this part of what the strongest one holds, holds nothing.
ROUND_OFF = 1.0e-9


class BoomModes:
    """Modes of the boom without contact: of each component of each segment by itself.

    Segments that a tied joint connects have their modes together, as cylinders let them.

    Args:
        boom: its joints say what is tied, and whether it is in space.
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
        """(num_modes,) row that reads a displacement of a segment at x in m.

        ``offset`` is (y, z) of the point from the axis in m.
        """
        row = self._expand(segment, direction, self._component(segment, direction).at(x))
        # A small turn θ about x moves (y, z) by (−θ z, θ y).
        arm = offset[0] if direction == "z" else -offset[1]
        if arm != 0.0:
            row += arm * self.twist(segment, x)
        return row

    def twist(self, segment: int, x: float) -> Array:
        """(num_modes,) row that reads the turn of a segment's cross-section about x in rad."""
        return self._expand(segment, "twist", self._component(segment, "twist").at(x))

    def unit_load(self, segment: int, direction: Direction) -> Array:
        """(num_modes,) modal load of one N/m along a segment, in 1/(N/m) of N/√kg."""
        return self._expand(segment, direction, self._component(segment, direction).unit_load)

    def inertia(self, segment: int, direction: Direction) -> Array:
        """(num_modes,) an acceleration that a segment feels as 1 N/m on average."""
        return self._expand(segment, direction, self._component(segment, direction).inertia)

    def rotation(self, segment: int, x: float, direction: Direction) -> Array:
        """(num_modes,) row that reads the rotation of a segment's cross-section at x in m."""
        rotation = self._component(segment, direction).rotation_at(x)
        return self._expand(segment, direction, rotation)

    def curvature(self, segment: int, x: float, direction: Direction) -> Array:
        """(num_modes,) row that reads the curvature of a segment at x in m."""
        curvature = self._component(segment, direction).curvature_at(x)
        return self._expand(segment, direction, curvature)

    def turning(self, segment: int, direction: Direction) -> Array:
        """(num_modes,) modal momentum of a segment that turns about x = 0 by 1 rad/s."""
        return self._expand(segment, direction, self._component(segment, direction).turning)

    def load_between(self, segment: int, direction: Direction, start: float, end: float) -> Array:
        """(num_modes,) modal load of one N/m between two x in m of a segment."""
        load = self._component(segment, direction).uniform_load(start, end)
        return self._expand(segment, direction, load)

    def _component(self, segment: int, motion: Motion) -> Component:
        return self._models[segment].components[motion]

    def _expand(self, segment: int, motion: Motion, row: Array) -> Array:
        """A component's row or load over all modal coordinates."""
        columns, shapes = self._shapes[segment, motion]
        whole = np.zeros(self.omega2.size)
        whole[columns] = row @ shapes
        return whole


def critical_factor(boom: Boom, models: Sequence[SegmentModel]) -> float | None:
    """Of the axial forces of the play-free boom, see :mod:`dynamics.second_order`.

    Infinite without such forces; None where something moves that nothing holds. Of a boom that is
    drawn out the smallest at some places of its way, its ends among them.
    """
    tied = boom.play_free
    smallest = np.inf
    for group in _groups(tied):
        components = [models[i].components[motion] for i, motion in group]
        first = block_diag(*(component.softening for component in components))
        bodies = [_Body(group, components, number) for number in range(len(boom.segments))]
        passing = _passing(boom, models, bodies)
        if not (first.any() or any(passing.values())):
            continue
        if (_group_modes(tied, group, components).omega2 == 0.0).any():
            return None
        for ways in stands(boom):
            drawn = (one.softening(ways[n]) for n, thrusts in passing.items() for one in thrusts)
            geometric = sum(drawn, first)
            moved = {n: places(boom.joints[n], way) for n, way in ways.items()}
            ties, pulled = _holds(tied, group, components, moved)
            stiffness, free = _held_stiffness(components, pulled), _free(ties, len(geometric))
            factor = buckling_factor(free.T @ stiffness @ free, free.T @ geometric @ free)
            smallest = min(smallest, factor)
    return smallest


def _passing(
    boom: Boom, models: Sequence[SegmentModel], bodies: Sequence[_Body]
) -> dict[int, list[MovingThrust]]:
    """The axial forces that go along as joints are drawn out, on the components of a group."""

    def reads(segment: int, x: float, direction: Direction) -> Array:
        return bodies[segment].at(direction, x)

    drives = [number for number, joint in enumerate(boom.joints) if joint.drive is not None]
    return {number: moving_thrusts(boom, models, reads, number) for number in drives}


def _groups(boom: Boom) -> list[list[_Part]]:
    """What has its modes together: segments that tied joints connect, in each motion.

    Two inclined cylinders side by side hold the twist of a segment by its slope along y.
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


@dataclass(frozen=True, slots=True)
class _Body:
    """A segment as single forces push it, on the components of a group."""

    group: Sequence[_Part]
    components: Sequence[Component]
    segment: int

    def force(self, x: float, direction: Direction) -> Array:
        return self.at(direction, x)

    def moment(self, x: float, direction: Direction) -> Array:
        return self._spread(direction, [component.rotation_at for component in self.components], x)

    def torque(self, x: float) -> Array:
        return self.at("twist", x)

    def at(self, motion: Motion, x: float) -> Array:
        """(num_dofs,) row that reads a deflection or the twist."""
        return self._spread(motion, [component.at for component in self.components], x)

    def _spread(self, motion: Motion, rows: Sequence[Callable[[float], Array]], x: float) -> Array:
        """The row of one component, 0 in the others; all 0 where the group has none of it."""
        parts = zip(self.group, self.components, rows, strict=True)
        own = (self.segment, motion)
        return np.concatenate(
            [row(x) if part == own else np.zeros(len(c.load)) for part, c, row in parts]
        )


def _holds(
    boom: Boom,
    group: Sequence[_Part],
    components: Sequence[Component],
    moved: Mapping[int, Sequence[tuple[float, float]]],
) -> tuple[list[Array], list[GroundLine]]:
    """Of a group: rows (num_dofs,) that ties keep at zero, and the cylinders that pull at it.

    Joints that are drawn out are tied where they have ``moved`` to, x in m on both segments.
    """
    bodies = [_Body(group, components, number) for number in range(len(boom.segments))]
    ties = [
        bodies[joint.inner].at(motion, on_inner) - bodies[joint.outer].at(motion, on_outer)
        for number, joint in enumerate(boom.joints)
        if joint.tied
        for motion in dict.fromkeys(motion for _, motion in group)
        if (joint.outer, motion) in group
        for on_outer, on_inner in moved.get(number, [(x, x) for x in joint.stations])
    ]
    lines = ground_lines(boom, bodies)
    return ties, [line for line in lines if line.stiffness > 0.0 and line.push.any()]


def _held_stiffness(components: Sequence[Component], pulled: Sequence[GroundLine]) -> Array:
    """(num_dofs, num_dofs) with the springs of cylinders."""
    stiffness = block_diag(*(c.stiffness for c in components))
    for line in pulled:
        stiffness += line.stiffness * np.outer(line.push, line.push)
    return np.asarray(stiffness)


def _free(ties: Sequence[Array], num_dofs: int) -> Array:
    """(num_dofs, num_free) motions that keep the ties at zero."""
    return null_space(np.array(ties)) if ties else np.eye(num_dofs)


def _group_modes(boom: Boom, group: Sequence[_Part], components: Sequence[Component]) -> Modes:
    """Modes of components side by side that keep ties at zero and pull at cylinders."""
    apart = [natural_modes(c.stiffness, c.mass, c.rigid_modes) for c in components]
    ties, pulled = _holds(boom, group, components, {})
    if not ties and not pulled and len(apart) == 1:
        return apart[0]
    rigid = block_diag(
        *(m.shapes[:, : c.rigid_modes] for m, c in zip(apart, components, strict=True))
    )
    # What these leave of the segments' rigid motions is rigid still.
    held = np.array([*ties, *(line.push for line in pulled)]).reshape(-1, len(rigid)) @ rigid
    bound = np.linalg.svd(held, compute_uv=False) if held.size else np.zeros(0)
    rigid_modes = rigid.shape[1] - int((bound > ROUND_OFF * bound.max(initial=0.0)).sum())
    stiffness = _held_stiffness(components, pulled)
    mass = block_diag(*(c.mass for c in components))
    free = _free(ties, len(mass))
    modes = natural_modes(free.T @ stiffness @ free, free.T @ mass @ free, rigid_modes)
    return Modes(modes.omega2, free @ modes.shapes)
