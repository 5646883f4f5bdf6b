# SPDX-License-Identifier: LGPL-3.0-or-later
"""Axial forces that go along as shells are drawn out.

What a force softens that has come farther is K_G of the sections as they move as a whole: of the
slope of their mean deflection, which is a spline between the lines of the mesh that go all around.
Walls that bend in themselves keep what they have at the start.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dynamics.drive.moving_thrust import MovingThrust
from dynamics.drive.row_table import RowTable
from geometry.arrays import Array
from geometry.axial import Entry, entry
from geometry.boom import SAME_PLACE, Boom
from geometry.drawing import Course
from geometry.drive import Drive
from shell_model.boom_shell import BoomShell
from shell_model.reduction.coordinates import BoomCoordinates
from shell_model.segment.cross_section import Reading
from shell_model.stress.stresses import lines_around


def moving_thrusts(
    boom: Boom, full: BoomShell, coordinates: BoomCoordinates, course: Course, behind: int
) -> Iterator[MovingThrust]:
    """The axial force, if there is one, that goes along with a course. Collective.

    Behind the coordinates come so many that sections do not move.
    """
    found = entry(boom.segments, boom.joints, course.joints[0])
    if found is None or len(course.joints) > 1:
        return
    ways = _ways(full, found, course.drives[0], SAME_PLACE * boom.length)
    rows = np.array([_rows(boom, full, coordinates, found, way) for way in ways.tolist()])
    beside = np.zeros((*rows.shape[:2], behind))
    yield MovingThrust(found.force, RowTable.through(ways, np.concatenate([rows, beside], axis=2)))


def _ways(full: BoomShell, found: Entry, drive: Drive, near: float) -> Array:
    """(num_ways,) in m, rising, at which the force passes lines of the mesh."""
    mesh, lines = full.shells[found.segment].mesh, np.zeros(0)
    if mesh is not None:
        along = mesh.points[mesh.triangles, 0]
        around = lines_around(np.stack([along.min(axis=1), along.max(axis=1)], axis=1))
        # Nodes are on these but for the digits to which they are rounded.
        x = np.unique(along)
        lines = x[np.searchsorted(0.5 * (x[1:] + x[:-1]), around)]
    ways = np.sort(found.direction * (full.comm.bcast(lines) - found.x))
    low, high = drive.reach
    return np.asarray(ways[(ways > low - near) & (ways < high + near)])


def _rows(
    boom: Boom, full: BoomShell, coordinates: BoomCoordinates, found: Entry, way: float
) -> list[Array]:
    """(num_planes, num_modes) that read where the force has come to."""
    outline = full.shells[found.segment].outline(found.x + found.direction * way)
    return [
        coordinates.row(Reading({found.segment: outline.mean_deflection(direction)}))
        for direction in boom.directions
    ]
