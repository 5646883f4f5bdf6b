# SPDX-License-Identifier: LGPL-3.0-or-later
"""Deflections and section forces along segments of beams.

With the rotation β of the cross-section, the moment is M_y = −E J β′. The shear force is normal to
the straight axis, V = M_y′ − P w′ with the compression P. The mean of V over an element is exact:
under a uniform load q, M_y has an error of q ℓ_e²/12 at both ends of an element of length ℓ_e, but
its mean slope has none. Between point forces, V is linear between the centres of elements.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from itertools import pairwise
from operator import attrgetter

import numpy as np

from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.component import SegmentModel
from protractile.dynamics.line import Line, LineQuantity
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Direction, Segment
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
    return [
        with_compression(
            segment, line_without_compression(boom, number, modes), force_places(boom, number)
        )
        for number, segment in enumerate(boom.segments)
    ]


def line_without_compression(boom: Boom, number: int, modes: BoomModes) -> Line:
    """Return the line of a segment as without its axial force."""
    segment, model = boom.segments[number], modes.models[number]
    places = force_places(boom, number)
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
            rows[shear] = _to_ends(breaks, _slope(breaks, rows[moment]), places)
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


def with_compression(segment: Segment, line: Line, places: set[float]) -> Line:
    """Return the line of a segment with its axial force, which changes the shear force.

    ``places`` are those of :func:`force_places`.
    """
    breaks = np.append(line.x[::2], line.x[-1])
    compression = segment.compression(0.5 * (breaks[1:] + breaks[:-1]))[:, None]
    rows = dict(line.rows)
    for deflection, _, shear in _NAMES.values():
        if shear in rows:
            across = compression * _slope(breaks, rows[deflection])
            rows[shear] = rows[shear] - _to_ends(breaks, across, places)
    return replace(line, rows=rows)


def force_places(boom: Boom, number: int) -> set[float]:
    """Return the x in m of the ends of a segment and of the forces on it."""
    segment = boom.segments[number]
    places = {*segment.ends, *load_places(boom, number), *segment.compression.places}
    places |= {one.x for one in segment.supports} | {one.x for one in segment.all_masses}
    return places


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
            # Linear between midpoints, and beyond the outer ones.
            k = np.clip(np.arange(-1, midpoints.size), 0, midpoints.size - 2)
            part = ((nodes - midpoints[k]) / (midpoints[k + 1] - midpoints[k]))[:, None]
            on = means[first + k] + part * (means[first + k + 1] - means[first + k])
            ends[2 * first : 2 * last] = np.repeat(on, 2, axis=0)[1:-1]
    return ends
