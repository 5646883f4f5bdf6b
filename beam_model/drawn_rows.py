# SPDX-License-Identifier: LGPL-3.0-or-later
"""The rows of a boom of beams over all of the way that its joints are drawn out.

Between the nodes that pass a station rows are the shape functions of an element: cubics, which
tables hold exactly, or polynomials of a series, within a tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from beam_model.component import SegmentModel
from dynamics.gap_builder import GapBuilder
from dynamics.row_table import RowTable
from dynamics.travel import Travel
from geometry.arrays import Array
from geometry.boom import SAME_PLACE, Boom
from geometry.drawing import Course, courses, drives_below

# Rows of the boom where each joint is drawn out by its way in m.
RowsAt = Callable[[Mapping[int, float]], GapBuilder[Array]]


def travels(boom: Boom, models: Sequence[SegmentModel], rows_at: RowsAt) -> list[Travel]:
    """What moves the rows of a boom: the drive of each joint, several together for stops.

    Args:
        boom: its joints may have drives.
        models: one for each segment.
        rows_at: positions of joints and their m → what touches, rubs and drags.
    """
    return [_travel(boom, models, rows_at, course) for course in courses(boom)]


def _travel(boom: Boom, models: Sequence[SegmentModel], rows_at: RowsAt, course: Course) -> Travel:
    moving = rows_at({}).moving(course.stations)

    def rows(way: float) -> Array:
        return rows_at(course.ways(way)).some_rows(moving, lambda row: row)

    table = RowTable.of(rows, _breaks(boom, models, course))
    return Travel.of([drive.history for drive in course.drives], table, moving, course.suffix)


def _breaks(boom: Boom, models: Sequence[SegmentModel], course: Course) -> list[float]:
    """Ways in m at which a node passes a station, between the ends of the reach."""
    low, high = course.reach
    joint = boom.joints[course.joints[-1]]
    outer, inner = (
        np.concatenate([c.breaks for c in models[segment].components.values()])
        for segment in (joint.outer, joint.inner)
    )
    passed = [np.array([low, high])]
    if len(course.joints) == 1:
        passed += [x - inner for x in joint.stations] + [outer - x for x in joint.stations]
    for stop in boom.stops:
        if drives_below(boom.joints, stop.segment) == course.joints:
            passed += [stop.x - c.breaks for c in models[stop.segment].components.values()]
    ways = np.unique(np.clip(np.concatenate(passed), low, high))
    near = SAME_PLACE * boom.length
    kept = [low, *(way for way in ways[1:-1] if low + near < way < high - near), high]
    apart = np.diff(kept, prepend=low - 1.0) > near
    return [way for way, keep in zip(kept, apart, strict=True) if keep]
