# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a beam leaves besides its trajectory: how its segments move, at a few instants."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from dynamics.line import Line, Quantity
from dynamics.trajectory import Trajectory
from geometry.arrays import Array

# Enough for a film.
FRAMES = 61


class MovedSegment(NamedTuple):
    """Along one segment, x (num_places,) in m, rising, the quantities (num_frames, num_places)."""

    x: Array
    read: Mapping[Quantity, Array]


class BeamOutput(NamedTuple):
    """Of all segments at so many times (num_frames,) in s."""

    time: Array
    segments: list[MovedSegment]

    @classmethod
    def of(cls, lines: Sequence[Line], trajectory: Trajectory) -> BeamOutput:
        """From a beam that has moved; where something jumps what is beyond is kept."""
        steps = frames(trajectory.time.size)
        moved = []
        for line in lines:
            last = np.append(np.diff(line.x) > 0.0, True)
            read = line.read(trajectory.states[steps])
            moved.append(
                MovedSegment(line.x[last], {name: along[:, last] for name, along in read.items()})
            )
        return cls(trajectory.time[steps], moved)


def frames(num_times: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Positions of the output times that a film shows, spread evenly, the ends included."""
    return np.unique(np.linspace(0, num_times - 1, FRAMES).round().astype(np.intp))
