# SPDX-License-Identifier: LGPL-3.0-or-later
"""Section forces of a segment: those of its line, and the normal force.

The normal force N has contributions of given axial forces, and of luffing cylinders between their
lugs and the foot of the boom.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from dynamics.gap_system import GapSystem
from dynamics.line import Line, Quantity
from geometry.arrays import Array
from geometry.axial import carried
from geometry.boom import Boom
from geometry.cylinder import force_name

# Distance on both sides of a jump, as a fraction of the distance from the start.
_ASIDE = 1.0e-9

_ACROSS: tuple[tuple[Quantity, Quantity], ...] = (
    ("deflection", "shear"),
    ("lateral", "lateral_shear"),
)


# Number of digits of stored curves.
_DIGITS = 5


def rounded(values: Array | Iterable[float]) -> list[float]:
    """Return values rounded to the number of digits in files."""
    return [float(f"{value:.{_DIGITS}g}") for value in values]


def with_cylinders(boom: Boom, system: GapSystem, lines: Sequence[Line]) -> list[Line]:
    """Return lines with the axial forces of cylinders as normal forces.

    Args:
        boom: boom of the system.
        system: the system, whose observers give the cylinders' forces.
        lines: lines along the segments.
    """
    found = list(lines)
    for number, cylinder in enumerate(boom.cylinders, start=1):
        line, foot = found[cylinder.segment], boom.segments[cylinder.segment].foot
        x = np.repeat(0.5 * (line.x[::2] + line.x[1::2]), 2) if line.paired else line.x
        pull = np.outer(cylinder.pull(x, foot), system.observers[force_name(number)].row)
        normal = line.rows.get("normal", 0.0) + pull
        found[cylinder.segment] = replace(line, rows={**line.rows, "normal": normal})
    return found


def section_forces(
    boom: Boom, number: int, line: Line, states: Array, time: Array
) -> dict[Quantity, Array]:
    """Return the values (..., num_places) of a line at states (..., num_modes), with N in N.

    Args:
        boom: the boom, which may extend.
        number: index of the segment.
        line: line along the segment.
        states: modal coordinates of the model.
        time: times (...) of the states in s.
    """
    read = line.read(states)
    # Double places are moved slightly to both sides.
    jump = np.diff(line.x) == 0.0
    aside = _ASIDE * max(1.0, float(np.ptp(line.x)))
    x = line.x + aside * (np.append(False, jump).astype(float) - np.append(jump, False))
    pressed = carried(boom.segments, boom.joints, number, x, time)
    if boom.driven:
        # Lines include the shear force at the start that axial forces cause.
        more = pressed - boom.segments[number].compression(x)
        for deflection, shear in _ACROSS:
            if shear in read:
                read[shear] -= more * _slopes(line, read[deflection])
    return {**read, "normal": -pressed + read.get("normal", np.zeros((*states.shape[:-1], 1)))}


def _slopes(line: Line, deflection: Array) -> Array:
    """Return the slopes (..., num_places) of a deflection (..., num_places) along a line."""
    x, index = np.unique(line.x, return_index=True)
    slopes = np.gradient(deflection[..., index], x, axis=-1)
    return np.asarray(slopes[..., np.searchsorted(x, line.x)])
