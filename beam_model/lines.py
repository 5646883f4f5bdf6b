# SPDX-License-Identifier: LGPL-3.0-or-later
"""Deflections and section forces along segments of beams.

The moment follows from the curvature, M = −E J θ′. The shear force is normal to the straight axis.
With an axial force P it is M′ − P w′, whose mean over a piece is exact for elements. Under a
uniform load q, the moment of an element has an error of q h²/12 at the ends, and none in the mean
slope. Between middles of pieces without point forces, the shear force is linear.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from operator import attrgetter

import numpy as np
from scipy.interpolate import interp1d

from beam_model.boom_modes import BoomModes
from beam_model.component import SegmentModel
from dynamics.line import Line, Quantity
from geometry.arrays import Array
from geometry.boom import Boom, Direction
from geometry.contact_places import load_places

# Minimum number of pieces of a segment between two forces.
_PIECES = 40

# Points in a piece at which curvatures are read; a curvature is linear in its piece.
_EARLY, _LATE = 0.25, 0.75

_NAMES: dict[Direction, tuple[Quantity, Quantity, Quantity]] = {
    "z": ("deflection", "moment", "shear"),
    "y": ("lateral", "lateral_moment", "lateral_shear"),
}


def lines(boom: Boom, models: Sequence[SegmentModel]) -> list[Line]:
    """Return the line of each segment; rigid segments have no section forces."""
    modes = BoomModes(boom, models)
    return [_line(boom, number, modes, model) for number, model in enumerate(models)]


def _line(boom: Boom, number: int, modes: BoomModes, model: SegmentModel) -> Line:
    segment = boom.segments[number]
    # The ends of the segment, and the places of forces on it.
    acting = {*segment.ends, *load_places(boom, number), *segment.compression.places}
    acting |= {held.x for held in segment.supports} | {mass.x for mass in segment.all_masses}
    # The ends of all pieces: those of the elements, or equal pieces between places.
    breaks = model.components["z"].breaks
    if not breaks.size:
        even = np.linspace(segment.start, segment.end, _PIECES + 1)
        breaks = np.unique(np.concatenate([even, sorted(acting)]).round(9))
    starts, lengths = breaks[:-1], np.diff(breaks)
    middles = 0.5 * (breaks[1:] + breaks[:-1])
    rows: dict[Quantity, Array] = {}
    for direction in boom.directions:
        deflection, moment, shear = _NAMES[direction]
        rows[deflection] = _both_ends(
            breaks, partial(modes.displacement, number, direction=direction)
        )
        if model.components[direction].curvature is not None:
            plane = segment if direction == "z" else segment.turned()
            early, late = (
                # The moment follows from the local E J of the segment in this plane.
                np.array(
                    [
                        -plane.prismatic_at(x).bending_stiffness
                        * modes.curvature(number, x, direction)
                        for x in starts + part * lengths
                    ]
                )
                for part in (_EARLY, _LATE)
            )
            ends = [1.5 * early - 0.5 * late, 1.5 * late - 0.5 * early]
            rows[moment] = np.stack(ends, axis=1).reshape(2 * starts.size, -1)
            pressed = segment.compression(middles)[:, None]
            across = _slope(breaks, rows[moment]) - pressed * _slope(breaks, rows[deflection])
            rows[shear] = _to_ends(breaks, across, acting)
    if boom.spatial:
        lateral = segment.lateral
        assert lateral is not None
        rows["twist"] = _both_ends(breaks, partial(modes.twist, number))
        if model.components["z"].curvature is not None:
            stiffness = segment.material.shear_modulus * lateral.torsion_constant
            local = segment.property_ratio(attrgetter("lateral.torsion_constant"), middles)
            twisted = stiffness * local[:, None] * _slope(breaks, rows["twist"])
            rows["torque"] = _to_ends(breaks, twisted, acting)
    return Line(np.repeat(breaks, 2)[1:-1], rows, paired=True)


def _both_ends(breaks: Array, read: Callable[[float], Array]) -> Array:
    """Return the rows (2 num_pieces, num_modes) of a continuous quantity at pieces' ends."""
    return np.asarray(np.repeat([read(x) for x in breaks], 2, axis=0)[1:-1])


def _slope(breaks: Array, rows: Array) -> Array:
    """Return the mean slopes (num_pieces, num_modes) of the pieces."""
    return np.asarray((rows[1::2] - rows[::2]) / np.diff(breaks)[:, None])


def _to_ends(breaks: Array, means: Array, acting: set[float]) -> Array:
    """Return rows (2 num_pieces, num_modes) at pieces' ends, extrapolated from means."""
    jumps = [int(np.abs(breaks - x).argmin()) for x in acting]
    ends = np.repeat(means, 2, axis=0)
    for first, last in pairwise(np.unique(jumps).tolist()):
        if last - first > 1:
            nodes = breaks[first : last + 1]
            middles = 0.5 * (nodes[1:] + nodes[:-1])
            on = interp1d(middles, means[first:last], axis=0, fill_value="extrapolate")
            ends[2 * first : 2 * last] = np.repeat(on(nodes), 2, axis=0)[1:-1]
    return ends
