# SPDX-License-Identifier: LGPL-3.0-or-later
"""The modal coordinates of all segments, and rows that read displacements in them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.linalg import block_diag, null_space

from beam_model.component import Component, Modes, Motion, SegmentModel, natural_modes
from geometry.arrays import Array
from geometry.boom import Boom, Direction

# A tie that holds less than this part of what the strongest one holds, holds nothing.
ROUND_OFF = 1.0e-9


class BoomModes:
    """Modes of the boom without contact: of each component of each segment by itself.

    Segments that a tied joint connects have their modes together.

    Args:
        boom: its joints say what is tied, and whether it is in space.
        models: one for each segment.

    Attributes:
        omega2: (num_modes,) ω² in rad²/s², rigid modes exactly 0.
        load: (num_modes,) the segments' own uniform loads in N/√kg.
        damping: (num_modes,) diagonal of the modal damping matrix in 1/s, exact where the
            damping is proportional to the mass.
    """

    def __init__(self, boom: Boom, models: Sequence[SegmentModel]) -> None:
        self._models = models
        self._shapes: dict[tuple[int, Motion], tuple[slice, Array]] = {}
        omega2: list[Array] = []
        load: list[Array] = []
        damping: list[Array] = []
        first = 0
        motions: tuple[Motion, ...] = ("z", "y", "twist") if boom.spatial else ("z",)
        for motion in motions:
            for group in _tied_groups(boom):
                components = [models[i].components[motion] for i in group]
                modes = _group_modes(components, _ties(boom, group, components))
                columns = slice(first, first + modes.omega2.size)
                first = columns.stop
                sizes = np.cumsum([len(component.load) for component in components])
                parts = np.split(modes.shapes, sizes[:-1])
                for i, part in zip(group, parts, strict=True):
                    self._shapes[i, motion] = columns, part
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
        """(num_modes,) row that reads a displacement of a segment.

        Args:
            segment: its position.
            x: m.
            direction: of the displacement.
            offset: (y, z) of the point from the axis in m.
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

    def rotation(self, segment: int, x: float, direction: Direction) -> Array:
        """(num_modes,) row that reads the rotation of a segment's cross-section at x in m."""
        rotation = self._component(segment, direction).rotation
        assert rotation is not None
        return self._expand(segment, direction, rotation(x))

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


def _tied_groups(boom: Boom) -> list[list[int]]:
    """Segments by what tied joints connect, in order; most are by themselves."""
    group_of = list(range(len(boom.segments)))
    for joint in boom.joints:
        if joint.tied:
            kept, lost = group_of[joint.outer], group_of[joint.inner]
            group_of = [kept if group == lost else group for group in group_of]
    return [
        [i for i, group in enumerate(group_of) if group == name] for name in dict.fromkeys(group_of)
    ]


def _ties(boom: Boom, group: Sequence[int], components: Sequence[Component]) -> Array:
    """(num_ties, num_dofs) rows over a group that are zero where its joints hold."""
    rows = []
    for joint in boom.joints:
        if joint.tied and joint.outer in group:
            for x in joint.stations:
                parts = [np.zeros(len(component.load)) for component in components]
                for segment, sign in ((joint.inner, 1.0), (joint.outer, -1.0)):
                    k = group.index(segment)
                    parts[k] = sign * components[k].at(x)
                rows.append(np.concatenate(parts))
    return np.array(rows).reshape(len(rows), sum(len(c.load) for c in components))


def _group_modes(components: Sequence[Component], ties: Array) -> Modes:
    """Modes of components side by side that keep the ties at zero."""
    apart = [natural_modes(c.stiffness, c.mass, c.rigid_modes) for c in components]
    if not ties.size:
        (alone,) = apart
        return alone
    rigid = block_diag(
        *(m.shapes[:, : c.rigid_modes] for m, c in zip(apart, components, strict=True))
    )
    # What ties leave of the segments' rigid motions is rigid still.
    bound = np.linalg.svd(ties @ rigid, compute_uv=False) if rigid.size else np.zeros(0)
    rigid_modes = rigid.shape[1] - int((bound > ROUND_OFF * bound.max(initial=0.0)).sum())
    free = null_space(ties)
    stiffness = block_diag(*(c.stiffness for c in components))
    mass = block_diag(*(c.mass for c in components))
    modes = natural_modes(free.T @ stiffness @ free, free.T @ mass @ free, rigid_modes)
    return Modes(modes.omega2, free @ modes.shapes)
