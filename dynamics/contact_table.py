# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact law that interpolates a table of measured forces linearly."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from protractile.dynamics.arrays import Array, are_finite
from protractile.dynamics.contact import ContactLaw, Term


@dataclass(frozen=True, slots=True)
class TableContact(ContactLaw):
    """Contact law with linear interpolation in a table of forces, and extrapolation beyond it.

    The law is a sum of linear springs: one spring begins at each change of slope.

    >>> pad = pt.TableContact(depths=(0.001, 0.002), forces=(1e3, 4e3))
    >>> round(float(pad.force(np.array(0.0015))), 6)
    2500.0

    Args:
        depths: penetrations in m, positive and ascending; the force is 0 at 0.
        forces: forces in N, positive, one for each penetration.
        damping: as in :class:`ContactLaw`, in s/m.

    Raises:
        ValueError: the table is empty or its depths do not ascend, or a force is not positive in
            the table or beyond it.
    """

    depths: tuple[float, ...]
    forces: tuple[float, ...]
    damping: float = 0.0

    def __post_init__(self) -> None:
        if not (are_finite(self.depths) and are_finite(self.forces)):
            raise ValueError("depths and forces must be sequences of finite numbers")
        if not 0 < len(self.depths) == len(self.forces):
            raise ValueError("a table needs one force for each depth, and one at least")
        if not (np.isfinite(self._slopes()).all() and (np.diff([0.0, *self.depths]) > 0.0).all()):
            raise ValueError("depths must be finite and rise from above 0")
        if min(self.forces) <= 0.0 or self._slopes()[-1] < 0.0:
            raise ValueError("forces must be positive, and must not fall at the end")

    def _slopes(self) -> Array:
        """Return the stiffness (num_depths,) in N/m between successive rows of the table."""
        with np.errstate(all="ignore"):
            return np.asarray(np.diff([0.0, *self.forces]) / np.diff([0.0, *self.depths]))

    @property
    def terms(self) -> tuple[Term, ...]:
        changes = np.diff([0.0, *self._slopes()]).tolist()
        starts = [0.0, *self.depths[:-1]]
        return tuple(
            Term(side, change, start, 1.0)
            for side in (1.0, -1.0)
            for change, start in zip(changes, starts, strict=True)
            if change != 0.0
        )

    def __str__(self) -> str:
        return f"table to {1e-3 * self.forces[-1]:g} kN at {1e3 * self.depths[-1]:g} mm"
