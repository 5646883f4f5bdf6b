# SPDX-License-Identifier: LGPL-3.0-or-later
"""Deflections and section forces along segments of beams.

With the rotation β of the cross-section, the moment is M_y = −E J β′. The shear force is normal to
the straight axis, V = M_y′ − P w′ with the compression P. The mean of V over an element is exact:
under a uniform load q, M_y has an error of q ℓ_e²/12 at both ends of an element of length ℓ_e, but
its mean slope has none. Between point forces, V is linear between the centres of elements.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from operator import attrgetter

import numpy as np
from scipy.interpolate import interp1d

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.component import SegmentModel
from protractile.dynamics.line import Line, LineQuantity
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Direction
from protractile.geometry.contact_places import load_places

# Number of pieces of a segment without elements.
_PIECES = 40

# Relative positions in a piece of the points of a linear curvature.
_EARLY, _LATE = 0.25, 0.75

_NAMES: dict[Direction, tuple[LineQuantity, LineQuantity, LineQuantity]] = {
    "z": ("deflection", "moment", "shear"),
    "y": ("lateral", "lateral_moment", "lateral_shear"),
}


def lines(boom: Boom, models: Sequence[SegmentModel]) -> list[Line]:
    """Return the line of each segment; rigid segments have no section forces."""
    return lines_of_modes(boom, BoomModes(boom, models))


def lines_of_modes(boom: Boom, modes: BoomModes) -> list[Line]:
    """Return the line of each segment, as :func:`lines`, from the modes of the boom."""
    return [_line(boom, number, modes) for number in range(len(boom.segments))]


def _line(boom: Boom, number: int, modes: BoomModes) -> Line:
    segment, model = boom.segments[number], modes.models[number]
    # Ends of the segment, and positions of forces.
    places = {*segment.ends, *load_places(boom, number), *segment.compression.places}
    places |= {support.x for support in segment.supports} | {mass.x for mass in segment.all_masses}
    # Ends of elements, or of equal pieces between forces.
    breaks = model.components["z"].breaks
    if not breaks.size:
        even = np.linspace(segment.start, segment.end, _PIECES + 1)
        breaks = np.unique(np.concatenate([even, sorted(places)]).round(9))
    starts, lengths = breaks[:-1], np.diff(breaks)
    midpoints = 0.5 * (breaks[1:] + breaks[:-1])
    rows: dict[LineQuantity, Array] = {}
    beam = modes.beams[number]
    for direction in boom.directions:
        deflection, moment, shear = _NAMES[direction]
        rows[deflection] = _both_ends(breaks, partial(beam.at, direction))
        if model.components[direction].bends:
            plane = segment if direction == "z" else segment.turned()
            early, late = (
                # E J belongs to the section at x in this plane.
                np.array(
                    [
                        -plane.prismatic_at(x).bending_stiffness * beam.at(direction, x, 2)
                        for x in starts + part * lengths
                    ]
                )
                for part in (_EARLY, _LATE)
            )
            ends = [1.5 * early - 0.5 * late, 1.5 * late - 0.5 * early]
            rows[moment] = np.stack(ends, axis=1).reshape(2 * starts.size, -1)
            compression = segment.compression(midpoints)[:, None]
            across = _slope(breaks, rows[moment]) - compression * _slope(breaks, rows[deflection])
            rows[shear] = _to_ends(breaks, across, places)
    if boom.spatial:
        lateral = segment.lateral
        assert lateral is not None
        rows["twist"] = _both_ends(breaks, beam.torque)
        if model.components["z"].bends:
            stiffness = segment.material.shear_modulus * lateral.torsion_constant
            local = segment.property_ratio(attrgetter("lateral.torsion_constant"), midpoints)
            torque = stiffness * local[:, None] * _slope(breaks, rows["twist"])
            rows["torque"] = _to_ends(breaks, torque, places)
    return Line(np.repeat(breaks, 2)[1:-1], rows, paired=True)


def _both_ends(breaks: Array, read: Callable[[float], Array]) -> Array:
    """Return rows (2 num_pieces, num_modes) of a continuous quantity at both ends of each piece."""
    return np.asarray(np.repeat([read(x) for x in breaks], 2, axis=0)[1:-1])


def _slope(breaks: Array, rows: Array) -> Array:
    """Return the mean slopes (num_pieces, num_modes) of the pieces."""
    return np.asarray((rows[1::2] - rows[::2]) / np.diff(breaks)[:, None])


def _to_ends(breaks: Array, means: Array, places: set[float]) -> Array:
    """Return rows (2 num_pieces, num_modes) at both ends of each piece, from means over pieces."""
    jumps = [int(np.abs(breaks - x).argmin()) for x in places]
    ends = np.repeat(means, 2, axis=0)
    for first, last in pairwise(np.unique(jumps).tolist()):
        if last - first > 1:
            nodes = breaks[first : last + 1]
            midpoints = 0.5 * (nodes[1:] + nodes[:-1])
            on = interp1d(midpoints, means[first:last], axis=0, fill_value="extrapolate")
            ends[2 * first : 2 * last] = np.repeat(on(nodes), 2, axis=0)[1:-1]
    return ends
