# SPDX-License-Identifier: LGPL-3.0-or-later
"""The rows of a boom of beams over all of the way that its joints are drawn out.

Between the nodes that pass a station rows are the shape functions of an element: of a plain one
cubics, which tables hold exactly; of a tapered one they are of the fifth degree, and of a series
polynomials of any, which tables hold within a tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from beam_model.component import SegmentModel
from dynamics.drive.row_table import MovingThrust, RowTable
from dynamics.drive.travel import Travel
from dynamics.gap_builder import GapBuilder
from geometry.arrays import Array
from geometry.axial import borne, entry
from geometry.boom import SAME_PLACE, Boom, Direction
from geometry.drawing import Course, courses, drives_below

# Rows of the boom where each joint is drawn out by its way in m.
RowsAt = Callable[[Mapping[int, float]], GapBuilder[Array]]


# (num_modes,) what reads the deflection of a segment at x in m along a direction.
Reads = Callable[[int, float, Direction], Array]


def travels(
    boom: Boom, models: Sequence[SegmentModel], rows_at: RowsAt, reads: Reads
) -> list[Travel]:
    """What moves the rows of a boom: the drive of each joint, several together for stops.

    ``rows_at`` takes positions of joints and their m.
    """
    return [_travel(boom, models, rows_at, reads, course) for course in courses(boom)]


def moving_thrusts(
    boom: Boom, models: Sequence[SegmentModel], reads: Reads, joint: int
) -> list[MovingThrust]:
    """The axial force, if there is one, that goes along as a joint is drawn out.

    ``reads`` may be in any coordinates.
    """
    found = entry(boom.segments, boom.joints, joint)
    drive = boom.joints[joint].drive
    if found is None or drive is None:
        return []
    segment, start, direction = found.segment, found.x, found.direction

    def rows(way: float) -> Array:
        at = start + direction * way
        return np.array([reads(segment, at, plane) for plane in boom.directions])

    nodes = np.concatenate([models[segment].components[plane].breaks for plane in boom.directions])
    breaks = _between(boom, drive.reach, [direction * (nodes - start)])
    return [MovingThrust(found.force, RowTable.of(rows, breaks))]


def _travel(
    boom: Boom, models: Sequence[SegmentModel], rows_at: RowsAt, reads: Reads, course: Course
) -> Travel:
    moving = rows_at({}).moving(course.stations)

    def rows(way: float) -> Array:
        return rows_at(course.ways(way)).some_rows(moving, lambda row: row)

    table = RowTable.of(rows, _breaks(boom, models, course))
    alone = len(course.joints) == 1
    pressing = moving_thrusts(boom, models, reads, course.joints[0]) if alone else []
    histories = [drive.history for drive in course.drives]
    against = borne(boom.segments, boom.joints, course.joints[0]) if alone else 0.0
    return Travel.of(histories, table, moving, course.suffix, pressing, against)


def _breaks(boom: Boom, models: Sequence[SegmentModel], course: Course) -> list[float]:
    """Ways in m at which a node passes a station, between the ends of the reach."""
    joint = boom.joints[course.joints[-1]]
    outer, inner = (
        np.concatenate([c.breaks for c in models[segment].components.values()])
        for segment in (joint.outer, joint.inner)
    )
    passed = []
    if len(course.joints) == 1:
        passed += [x - inner for x in joint.stations] + [outer - x for x in joint.stations]
    for stop in boom.stops:
        if drives_below(boom.joints, stop.segment) == course.joints:
            passed += [stop.x - c.breaks for c in models[stop.segment].components.values()]
    return _between(boom, course.reach, passed)


def _between(boom: Boom, reach: tuple[float, float], passed: Sequence[Array]) -> list[float]:
    """Ways in m between the ends of a reach, and these."""
    low, high = reach
    ways = np.unique(np.clip(np.concatenate([reach, *passed]), low, high))
    near = SAME_PLACE * boom.length
    kept = [low, *(way for way in ways[1:-1] if low + near < way < high - near), high]
    apart = np.diff(kept, prepend=low - 1.0) > near
    return [way for way, keep in zip(kept, apart, strict=True) if keep]
