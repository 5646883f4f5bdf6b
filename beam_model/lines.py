# SPDX-License-Identifier: LGPL-3.0-or-later
"""Deflections and section forces along segments of beams.

The moment is that of the curvature, M = −E J θ′; the shear force of a piece between two places the
mean slope of M there, which is exact for elements: under a load that is even on each, their moment
is off by q h²/12 at the ends and by nothing in the mean slope.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from operator import attrgetter

import numpy as np

from beam_model.boom_modes import BoomModes
from beam_model.component import SegmentModel
from dynamics.line import Line, Quantity
from geometry.arrays import Array
from geometry.boom import Boom, Direction, Segment

# Pieces of a segment between places where something acts, at least.
_PIECES = 40

# Where in a piece a curvature is read, which is straight there: none of the neighbours'.
_EARLY, _LATE = 0.25, 0.75

_NAMES: dict[Direction, tuple[Quantity, Quantity, Quantity]] = {
    "z": ("deflection", "moment", "shear"),
    "y": ("lateral", "lateral_moment", "lateral_shear"),
}


def lines(boom: Boom, models: Sequence[SegmentModel]) -> list[Line]:
    """One for each segment; those that do not bend have no section forces."""
    modes = BoomModes(boom, models)
    return [_line(boom, number, modes, model) for number, model in enumerate(models)]


def _line(boom: Boom, number: int, modes: BoomModes, model: SegmentModel) -> Line:
    segment = boom.segments[number]
    breaks = _breaks(boom, number, model.components["z"].breaks)
    rows: dict[Quantity, Array] = {}
    for direction in boom.directions:
        deflection, moment, shear = _NAMES[direction]
        rows[deflection] = _both_ends(
            breaks, partial(modes.displacement, number, direction=direction)
        )
        if model.components[direction].curvature is not None:
            plane = segment if direction == "z" else segment.turned()
            rows[moment] = _at_ends(breaks, partial(_moment, modes, number, plane, direction))
            rows[shear] = _slope(breaks, rows[moment])
    if boom.spatial:
        lateral = segment.lateral
        assert lateral is not None
        rows["twist"] = _both_ends(breaks, partial(modes.twist, number))
        if model.components["z"].curvature is not None:
            stiffness = segment.material.shear_modulus * lateral.torsion_constant
            middles = 0.5 * (breaks[1:] + breaks[:-1])
            local = np.repeat(segment.relative(attrgetter("lateral.torsion_constant"), middles), 2)
            rows["torque"] = stiffness * local[:, None] * _slope(breaks, rows["twist"])
    return Line(np.repeat(breaks, 2)[1:-1], rows, paired=True)


def _moment(modes: BoomModes, number: int, plane: Segment, direction: Direction, x: float) -> Array:
    """(num_modes,) at x, by the local E J of the segment as it bends in its plane."""
    return -plane.local(x).bending_stiffness * modes.curvature(number, x, direction)


def _breaks(boom: Boom, number: int, nodes: Array) -> Array:
    """x in m of the ends of all pieces: those of the elements, or even ones between stations."""
    if nodes.size:
        return nodes
    segment = boom.segments[number]
    places = {segment.start, segment.end, *boom.stations_of(number)}
    places |= {support.x for support in segment.supports}
    even = np.linspace(segment.start, segment.end, _PIECES + 1)
    return np.asarray(np.unique(np.concatenate([even, sorted(places)]).round(9)))


def _both_ends(breaks: Array, read: Callable[[float], Array]) -> Array:
    """(2 num_pieces, num_modes) of what is continuous, at both ends of each piece."""
    return np.asarray(np.repeat([read(x) for x in breaks], 2, axis=0)[1:-1])


def _at_ends(breaks: Array, read: Callable[[float], Array]) -> Array:
    """(2 num_pieces, num_modes) of what is straight in each piece."""
    found = []
    for a, b in pairwise(breaks):
        early, late = (read(a + part * (b - a)) for part in (_EARLY, _LATE))
        found += [1.5 * early - 0.5 * late, 1.5 * late - 0.5 * early]
    return np.array(found)


def _slope(breaks: Array, rows: Array) -> Array:
    """(2 num_pieces, num_modes) the mean slope of each piece, at both its ends."""
    slopes = (rows[1::2] - rows[::2]) / np.diff(breaks)[:, None]
    return np.asarray(np.repeat(slopes, 2, axis=0))
