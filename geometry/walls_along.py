# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where the walls of a segment are at many x, whether it tapers or not."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.segment import Segment

# A part of the height: above what walls that are flat between mesh lines are off the section there,
# below any edge.
_OFF_TAPER = 1.0e-4


class WallsAlong:
    """The mid-lines at each of many places.

    Args:
        segment: whose plates are known.
        x: (num_places,) in m.

    Attributes:
        near: places closer than this (m) to a mid-line are on it.
    """

    def __init__(self, segment: Segment, x: Array) -> None:
        self.near, sections, at = segment.widest.near, [segment.widest], np.zeros(x.size, dtype=int)
        if segment.head_section is not None:
            self.near = _OFF_TAPER * min(segment.section_at(e).size("z") for e in segment.ends)
            places, at = np.unique(x, return_inverse=True)
            sections = [segment.section_at(place) for place in places.tolist()]
        self._at = at
        self._starts = np.array([[plate.start for plate in one.plates] for one in sections])

    def starts(self, plate: int) -> Array:
        """(num_places, 2) where a plate begins, in m."""
        return np.asarray(self._starts[self._at, plate])

    def distance(self, plate: int, places: Array) -> Array:
        """(num_places,) of places (num_places, 2), one at each x, from a plate's mid-line, in m."""
        start, end = self.starts(plate), self.starts((plate + 1) % self._starts.shape[1])
        length = np.linalg.norm(end - start, axis=1)
        tangent = (end - start) / length[:, None]
        arms = places - start
        along = (arms * tangent).sum(axis=1)
        beyond = np.maximum(np.maximum(-along, along - length), 0.0)
        across = arms[:, 0] * tangent[:, 1] - arms[:, 1] * tangent[:, 0]
        return np.asarray(np.hypot(beyond, across))
