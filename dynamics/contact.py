# SPDX-License-Identifier: LGPL-3.0-or-later
"""The force between two segments that touch across a play.

The law is the paper's equation (4): nothing inside the clearance, a power of the
penetration beyond it. Its potential is kept beside it, because the energy ledger of
every trajectory is the first check of a contact simulation.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PowerContact:
    """Gap contact: F(y) = k₂ (y − Δ)ⁿ above Δ, −k₁ (−y − Δ)ⁿ below −Δ, zero between.

    Equation (4) of Rusiński and Wyciślok (1997), in the one sign convention that restores;
    n = 3/2 is Hertz, n = 1 a linear stop. A side with stiffness zero never touches.

    Args:
        stiffness: k₂ in N/mⁿ.
        exponent: n, at least 1. Below 1 the force has an infinite slope at touch.
        clearance: Δ in m on each side (half the play), not negative.
        stiffness_below: k₁ in N/mⁿ; the same as ``stiffness`` unless given.
        damping: d in s/m of Hunt and Crossley (1975), F = k pⁿ (1 + d ṗ) at the penetration p, but
            never adhesive; not negative.

    Raises:
        ValueError: an argument is out of its range or not finite.
    """

    stiffness: float
    exponent: float
    clearance: float
    stiffness_below: float | None = None
    damping: float = 0.0

    def __post_init__(self) -> None:
        for name, k in (("stiffness", self.stiffness), ("stiffness_below", self.below)):
            if not (np.isfinite(k) and k >= 0.0):
                raise ValueError(f"{name} must be a number of N/m^n, not negative, got {k}")
        if self.stiffness == 0.0 and self.below == 0.0:
            raise ValueError("stiffness must be positive on one side at least, got 0.0 on both")
        if not 1.0 <= self.exponent < np.inf:
            raise ValueError(f"exponent must be at least 1, got {self.exponent}")
        if not 0.0 <= self.clearance < np.inf:
            raise ValueError(f"clearance must be finite and not negative, got {self.clearance} m")
        if not 0.0 <= self.damping < np.inf:
            raise ValueError(f"damping must be finite and not negative, got {self.damping} s/m")

    @property
    def below(self) -> float:
        """k₁ in N/mⁿ."""
        return self.stiffness if self.stiffness_below is None else self.stiffness_below

    def upper(self) -> PowerContact:
        """The same law on the side y > 0 alone."""
        return replace(self, stiffness_below=0.0)

    def lower(self) -> PowerContact:
        """The same law on the side y < 0 alone."""
        return replace(self, stiffness=0.0, stiffness_below=self.below)

    def one_sided(self, side: int) -> PowerContact | None:
        """The law on the side of this sign alone; None where it never touches."""
        if (self.stiffness if side > 0 else self.below) == 0.0:
            return None
        return self.upper() if side > 0 else self.lower()

    def shared(self, weight: float) -> PowerContact:
        """The part ``weight`` of the law, for one of several points that carry it together."""
        return replace(self, stiffness=weight * self.stiffness, stiffness_below=weight * self.below)

    def penetration(self, y: Array) -> Array:
        """Depth beyond the clearance in m, zero while apart. Shape of ``y``."""
        return np.maximum(np.abs(y) - self.clearance, 0.0)

    def force(self, y: Array) -> Array:
        """Elastic force in N that the outer segment feels; the inner one feels its opposite.

        Args:
            y: relative displacement u − w in m, any shape.
        """
        return np.sign(y) * self._side(y) * self.penetration(y) ** self.exponent

    def energy(self, y: Array) -> Array:
        """Potential of :meth:`force` in J. Shape of ``y``."""
        n = self.exponent
        return self._side(y) * self.penetration(y) ** (n + 1.0) / (n + 1.0)

    def slope(self, y: Array) -> Array:
        """Derivative of :meth:`force` in N/m, zero while apart. Shape of ``y``."""
        depth, n = self.penetration(y), self.exponent
        return np.where(depth > 0.0, n * self._side(y) * depth ** (n - 1.0), 0.0)

    def _side(self, y: Array) -> Array:
        return np.where(y > 0.0, self.stiffness, self.below)


def restitution_damping(restitution: float, speed: float) -> float:
    """Damping d in s/m with which a mass that hits a contact rebounds with a part of its speed.

    With F = k pⁿ (1 + d ṗ), ṗ dṗ/(1 + d ṗ) = −(k/m) pⁿ dp. Over the whole impact the right side
    adds up to nothing, whatever k, n and m, hence (e + 1) v = ln[(1 + d v)/(1 − d e v)]/d.

    Args:
        restitution: e, speed after over speed before the impact, above 0 and at most 1.
        speed: v before the impact in m/s, positive.

    Raises:
        ValueError: an argument is out of its range.
    """
    e = restitution
    if not 0.0 < e <= 1.0:
        raise ValueError(f"restitution must be above 0 and at most 1, got {e}")
    if not 0.0 < speed < np.inf:
        raise ValueError(f"speed must be finite and positive, got {speed} m/s")
    # The root of the series in d v up to third order: right up to a part of its square.
    first = 1.5 * (1.0 - e**2) / (1.0 + e**3)
    if first < 1.0e-4:
        return first / speed
    # In u = −ln(1 − d e v), which stays a number however near d e v is to 1.
    u = brentq(
        lambda u: np.log1p(-np.expm1(-u) / e) + u + (1.0 + e) * np.expm1(-u) / e,
        -np.log1p(-0.5 * e * first),
        (1.0 + e) / e,
        rtol=1.0e-14,
    )
    return float(-np.expm1(-u) / (e * speed))
