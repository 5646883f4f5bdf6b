# SPDX-License-Identifier: LGPL-3.0-or-later
"""Section forces of a segment, including the normal force.

The normal force N follows from given axial forces, and from the forces of luffing cylinders between
their lugs and the foot of the boom.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line, LineQuantity
from protractile.geometry.arrays import Array
from protractile.geometry.axial import axial_force
from protractile.geometry.boom import Boom
from protractile.geometry.ground import force_name

# Distance by which both positions at a jump are moved away from it, as a fraction of the length.
_SHIFT = 1.0e-9

_ACROSS: tuple[tuple[LineQuantity, LineQuantity], ...] = (
    ("deflection", "shear"),
    ("lateral", "lateral_shear"),
)


@dataclass(frozen=True)
class AnalysisModel:
    """A model under all constant loads, with lines along its segments."""

    boom: Boom  #: boom with the play of the model
    system: GapSystem  #: gap system of the boom, whose ``load`` includes all constant loads
    lines: Sequence[Line]  #: lines along the segments, with normal forces by the cylinders
    smooth: bool = False  #: True if section forces do not jump at point forces, as in a series

    @classmethod
    def of(cls, boom: Boom, system: GapSystem, lines: Sequence[Line], smooth: bool = False) -> Self:
        """Return the model under all constant loads, with normal forces by cylinders in lines."""
        extended = list(lines)
        for number, cylinder in enumerate(boom.cylinders, start=1):
            line, foot = extended[cylinder.segment], boom.segments[cylinder.segment].foot
            x = np.repeat(0.5 * (line.x[::2] + line.x[1::2]), 2) if line.paired else line.x
            row = system.observers[force_name(number)].row
            pull = np.outer(cylinder.normal_force(x, foot), row)
            normal = line.rows.get("normal", 0.0) + pull
            extended[cylinder.segment] = replace(line, rows={**line.rows, "normal": normal})
        return cls(boom, system.gather_loads(), extended, smooth)

    def deflection(self, number: int, x: float, state: Array) -> float:
        """Return the deflection in m of a segment along z at x in m, by a cubic near x.

        ``state`` (num_modes,) are modal coordinates.
        """
        places, rows = dict(self.lines[number].deflections)["z"]
        count = min(4, places.size)
        first = np.clip(np.searchsorted(places, x) - 2, 0, places.size - count)
        near = places[first : first + count]
        # Lagrange's polynomials: 1 at one of the places, 0 at the others.
        factors = (x - near) / (near[:, None] - near + np.eye(count))
        np.fill_diagonal(factors, 1.0)
        row = factors.prod(axis=1) @ rows[first : first + count]
        return float(row @ state[: row.size])

    def section_forces(self, number: int, states: Array, time: Array) -> dict[LineQuantity, Array]:
        """Return deflections and section forces of a segment as :func:`section_forces`."""
        return section_forces(self.boom, number, self.lines[number], states, time)


def section_forces(
    boom: Boom, number: int, line: Line, states: Array, time: Array
) -> dict[LineQuantity, Array]:
    """Return deflections and section forces (..., num_places) of a segment.

    Args:
        boom: the boom, which may telescope.
        number: index of the segment.
        line: line along the segment.
        states: modal coordinates (..., num_modes) of the model.
        time: times (...) of the states in s.
    """
    read = line.read(states)
    # Both positions at a jump are moved slightly apart.
    jump = np.diff(line.x) == 0.0
    shift = _SHIFT * max(1.0, float(np.ptp(line.x)))
    x = line.x + shift * (np.append(False, jump).astype(float) - np.append(jump, False))
    thrust = axial_force(boom.segments, boom.joints, number, x, time, boom.axial_changes)
    if boom.telescopes or boom.axial_changes:
        # Lines already include the shear force at the start due to axial forces.
        extra = thrust - boom.segments[number].compression(x)
        for deflection, shear in _ACROSS:
            if shear in read:
                read[shear] -= extra * _slopes(line, read[deflection])
    return {**read, "normal": -thrust + read.get("normal", np.zeros((*states.shape[:-1], 1)))}


def _slopes(line: Line, deflection: Array) -> Array:
    """Return the derivative along x of a deflection (..., num_places), in its shape."""
    x, index = np.unique(line.x, return_index=True)
    slopes = np.gradient(deflection[..., index], x, axis=-1)
    return np.asarray(slopes[..., np.searchsorted(x, line.x)])
