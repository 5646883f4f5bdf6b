# SPDX-License-Identifier: LGPL-3.0-or-later
"""The axial force along a segment."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from protractile.geometry.arrays import Array


@dataclass(frozen=True, slots=True)
class Compression:
    """Piecewise linear axial force P(x) in N along a segment, positive in compression.

    >>> column = Compression(places=(0.0, 4.0, 10.0), ends=((9e3, 7e3), (2e3, 2e3)))
    >>> column(np.array([1.0, 5.0]))
    array([8500., 2000.])
    """

    #: ascending x in m of the ends of the pieces; empty if P is 0 everywhere
    places: tuple[float, ...] = ()
    ends: tuple[tuple[float, float], ...] = ()  #: P in N at both ends of each piece
    #: total axial force in N, which acts at the lock or foot of the segment
    transferred: float = 0.0

    def __bool__(self) -> bool:
        """Return whether there is any axial force."""
        return bool(self.ends)

    def __call__(self, x: Array) -> Array:
        """Return P (num_places,) in N at x (num_places,) in m.

        At a jump the value is that on the side of larger x.
        """
        if not self:
            return np.zeros(x.shape)
        places, ends = np.array(self.places), np.array(self.ends)
        piece = np.clip(np.searchsorted(places, x, side="right") - 1, 0, len(ends) - 1)
        first, last = ends[piece].T
        part = (x - places[piece]) / (places[piece + 1] - places[piece])
        return np.asarray(first + part * (last - first))


NO_COMPRESSION = Compression()
