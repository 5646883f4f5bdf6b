# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows of a telescoping boom of beams as functions of the extensions of its joints.

While a station passes an element, the rows of the station are the shape functions of the element.
Tables of cubics are exact for prismatic elements. For tapered elements, of degree five, and for
series, of any degree, they have a tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from beam_model.component import BeamSegment, SegmentModel
from dynamics.excitation import HistorySum
from dynamics.gap_builder import GapBuilder
from dynamics.travel import MovingAxialForce, RowTable, Travel
from geometry.arrays import Array
from geometry.axial import joint_thrust, moving_force
from geometry.boom import SAME_PLACE, Boom
from geometry.telescoping import TelescopingStations, drives_below, telescoping_stations

# Function that returns all rows of the boom, from extensions in m by index of the joint.
RowsAt = Callable[[Mapping[int, float]], GapBuilder[Array]]


def travels(
    boom: Boom,
    models: Sequence[SegmentModel],
    rows_at: RowsAt,
    beams: Sequence[BeamSegment],
) -> list[Travel]:
    """Return the travels of each joint with a drive, and of stops that drives move."""
    return [_travel(boom, models, rows_at, beams, group) for group in telescoping_stations(boom)]


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


def _travel(
    boom: Boom,
    models: Sequence[SegmentModel],
    rows_at: RowsAt,
    beams: Sequence[BeamSegment],
    group: TelescopingStations,
) -> Travel:
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
    return _extensions_between(boom, group.reach, crossings)


def _extensions_between(
    boom: Boom, reach: tuple[float, float], passed: Sequence[Array]
) -> list[float]:
    """Return the ends of the range ``reach`` in m, and the extensions ``passed`` within it."""
    low, high = reach
    extensions = np.unique(np.clip(np.concatenate([reach, *passed]), low, high))
    near = SAME_PLACE * boom.length
    inside = (one for one in extensions[1:-1] if low + near < one < high - near)
    kept = [low, *inside, high]
    apart = np.diff(kept, prepend=low - 1.0) > near
    return [extension for extension, keep in zip(kept, apart, strict=True) if keep]
