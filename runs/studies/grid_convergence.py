# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far a value is from where refinement would take it (Roache 1994)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

# Of three or more grids (Roache 1998).
SAFETY = 1.25


@dataclass(frozen=True, slots=True)
class GridConvergence:
    """The three finest values of a quantity, whose meshes are finer by one ratio each.

    Args:
        coarse, medium, fine: values.
        ratio: of one mesh size to the next finer one, above 1.
    """

    coarse: float
    medium: float
    fine: float
    ratio: float

    @classmethod
    def of(cls, values: Sequence[float], ratio: float) -> GridConvergence:
        """From values in the order of refinement, three at least."""
        coarse, medium, fine = values[-3:]
        return cls(coarse, medium, fine, ratio)

    @property
    def order(self) -> float:
        """Observed order p; NaN where the values do not go one way with ever smaller steps."""
        earlier, later = self.medium - self.coarse, self.fine - self.medium
        if later == 0.0 or earlier / later <= 1.0:
            return math.nan
        return math.log(earlier / later) / math.log(self.ratio)

    @property
    def limit(self) -> float:
        """Richardson's value at mesh size zero."""
        return self.fine + (self.fine - self.medium) / self._shrinking

    @property
    def index(self) -> float:
        """Grid convergence index of the fine mesh, relative to its value."""
        return self._index(self.fine, self.medium)

    @property
    def coarser_index(self) -> float:
        """The same of the medium mesh."""
        return self._index(self.medium, self.coarse)

    @property
    def _shrinking(self) -> float:
        return math.pow(self.ratio, self.order) - 1.0

    def _index(self, finer: float, coarser: float) -> float:
        return SAFETY * abs((finer - coarser) / finer) / self._shrinking
