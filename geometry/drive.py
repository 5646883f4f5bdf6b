# SPDX-License-Identifier: LGPL-3.0-or-later
"""What draws a segment out of another one, or in, while the boom moves."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np

from geometry.arrays import Array

# On which segment of its joint a station sits, and goes with it.
Carrier = Literal["outer", "inner"]

# Places in time at which the reach of a history is looked for beside its kinks.
_TIMES = 1000


@dataclass(frozen=True)
class Drive:
    """How far the inner segment of a joint is drawn out over time.

    >>> out = pt.Drive(pt.SCurve(travel=1.5, duration=3.0), carriers=("inner", "outer"))
    >>> drawn = replace(boom, joints=(replace(boom.joints[0], drive=out),))
    >>> drawn.joints[0].drive.reach
    (0.0, 1.5)

    Args:
        history: in m since the start, 0 at t = 0; a history of the dynamics.
        carriers: the segment on which each station of the joint sits.
        least_overlap: in m, below which the overlap must not come.
        locked: the segment on which the place sits where the inner one's axial force passes.
    """

    history: Any
    carriers: tuple[Carrier, ...]
    least_overlap: float = 0.0
    locked: Carrier = "inner"

    @cached_property
    def times(self) -> Array:
        """(num_times,) from t = 0 on, in s, with its kinks."""
        kinks = np.array([0.0, *self.history.kinks])
        times = np.union1d(kinks, np.linspace(kinks.min(), kinks.max(), _TIMES))
        return np.asarray(times[times >= 0.0])

    @cached_property
    def reach(self) -> tuple[float, float]:
        """How far in, not above 0, and how far out, not below it, it comes in m."""
        ways = self.history(self.times)
        return min(0.0, float(ways.min())), max(0.0, float(ways.max()))
