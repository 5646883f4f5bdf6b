# SPDX-License-Identifier: LGPL-3.0-or-later
"""User-defined contact law, a rubber stop F = k p + c p³, and a mass that hits it."""

from dataclasses import dataclass

import numpy as np

import protractile as pt
from protractile.dynamics.contact import Term
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import simulate


@dataclass(frozen=True, slots=True)
class RubberStop(pt.ContactLaw):
    """Stop that is linear at first, then progressively stiffer; on the upper side alone."""

    linear: float
    cubic: float
    damping: float = 0.0

    @property
    def terms(self) -> tuple[Term, ...]:
        powers = (self.linear, 1.0), (self.cubic, 3.0)
        return tuple(Term(1.0, k, 0.0, n) for k, n in powers)


def strike(law: pt.ContactLaw, speed: float) -> pt.Trajectory:
    """Return the motion of a free mass of 1 kg with an initial speed in m/s."""
    one, place = np.ones(1), np.array([0])
    mass = GapSystem(0.0 * one, 0.0 * one, one[None], [law], place, [0.0], {})
    return simulate(mass, 0.1, velocity=[speed])
