# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact laws, which are sums of one-sided powers of a penetration, and dry friction.

Python and the compiled loops share the formulas of these terms. The potential serves the energy
balance, which checks every trajectory.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from protractile.dynamics.arrays import Array, is_finite

# A negligible force in N, and logarithms of penetrations in m between which forces are
# interpolated.
_LEAST, _LOGARITHMS = 1.0e-300, np.linspace(-300.0, 300.0, 6001)

# Types of arrays: (num_terms,) of TERM, (num_rows,) of LIMITS.
Terms = npt.NDArray[np.void]
Limits = npt.NDArray[np.void]

# Types: a relative displacement y, or an array of them; a function of a term and y, or of the
# arrays of several terms with one exponent and y.
Displacement = Any
OfTerm = Callable[[Any, Displacement], Displacement]

# Record of the y in m between which a contact is open, and of its damping χ in s/m.
LIMITS = np.dtype([("low", np.float64), ("high", np.float64), ("damping", np.float64)])


class Term(NamedTuple):
    """One-sided power law F = side · k max(side · y − onset, 0)ⁿ.

    >>> pt.PowerContact(1e6, 1.0).lower().with_clearance(0.01).terms
    (Term(side=-1.0, stiffness=1000000.0, onset=0.01, exponent=1.0),)
    """

    side: float  #: 1 for contact at positive y, −1 at negative y
    stiffness: float  #: k in N/mⁿ; negative where a law becomes softer
    onset: float  #: distance in m from y = 0 at which contact begins
    exponent: float  #: n, at least 1


# Record of a term in the law of a row.
TERM = np.dtype([("row", np.int64), *((name, np.float64) for name in Term._fields)])


def force_of(term: np.void, y: Displacement) -> Displacement:
    """Return the force in N of a term at relative displacements y in m."""
    penetration, n = np.maximum(term["side"] * y - term["onset"], 0.0), term["exponent"]
    power = penetration if n == 1.0 else penetration * penetration if n == 2.0 else penetration**n
    return term["side"] * term["stiffness"] * power


def energy_of(term: np.void, y: Displacement) -> Displacement:
    """Return the potential in J of a term at relative displacements y in m."""
    penetration, n = np.maximum(term["side"] * y - term["onset"], 0.0), term["exponent"]
    return term["stiffness"] * penetration ** (n + 1.0) / (n + 1.0)


def slope_of(term: np.void, y: Displacement) -> Displacement:
    """Return dF/dy in N/m of a term at relative displacements y in m."""
    penetration, n = np.maximum(term["side"] * y - term["onset"], 0.0), term["exponent"]
    return np.sign(penetration) * n * term["stiffness"] * penetration ** (n - 1.0)


class ContactLaw(ABC):
    """Contact force between two bodies by their relative displacement y = u − w.

    A user-defined law is a frozen dataclass that derives from this class. It defines

    - ``terms``; their sum is the elastic force F, which is never attractive and is zero at y = 0;
    - ``damping``, χ in s/m of Hunt and Crossley (1975): the force is F (1 + χ δ̇) at the rate δ̇ of
      the penetration, but never attractive;
    - ``str(law)``, a short description for tables.

    Contact begins at y = 0 unless :meth:`with_clearance` adds a clearance.
    """

    __slots__ = ()

    damping: float

    @property
    @abstractmethod
    def terms(self) -> tuple[Term, ...]:
        """The one-sided powers whose sum is the force, in ascending order of onset on each side."""

    def one_sided(self, side: int) -> Gap | None:
        """Return the law on one side, 1 or −1, only; None without contact on this side."""
        part = self.with_clearance(0.0)
        part = replace(part, sides=tuple(kept for kept in part.sides if kept == side))
        return part if part.terms else None

    def with_weight(self, weight: float) -> Gap:
        """Return the law times ``weight``, for one of several points of a contact."""
        part = self.with_clearance(0.0)
        return replace(part, weight=weight * part.weight)

    def with_clearance(self, above: float, below: float | None = None) -> Gap:
        """Return the law with clearances in m for y > 0 and for y < 0, by default the same."""
        return Gap(self, above, above if below is None else below)

    def scale_clearances(self, factor: float) -> ContactLaw:
        """Return the law with its clearances multiplied by a factor."""
        return self

    def onset(self, side: float) -> float:
        """Return the |y| in m at which contact begins on side 1 or −1; infinite without contact."""
        return min((term.onset for term in self.terms if term.side == side), default=np.inf)

    def force(self, y: Array) -> Array:
        """Return the elastic force F (…) in N on the outer segment; −F acts on the inner one.

        Args:
            y: relative displacement u − w (…) in m.
        """
        return self._sum(force_of, y)

    def energy(self, y: Array) -> Array:
        """Return the potential of :meth:`force` in J, in the shape of ``y``."""
        return self._sum(energy_of, y)

    def slope(self, y: Array) -> Array:
        """Return dF/dy in N/m, in the shape of ``y``."""
        return self._sum(slope_of, y)

    def penetration(self, y: Array) -> Array:
        """Return the penetration in m, 0 without contact, in the shape of ``y`` in m."""
        beyond = [term.side * y - term.onset for term in self.terms]
        return np.asarray(np.max(beyond, axis=0, initial=0.0))

    def slope_at(self, force: float) -> float:
        """Return dF/dy in N/m at a contact force in N, on the stiffer side of the law."""
        # Interpolation in logarithms, in which a power law is linear.
        penetrations, slopes = np.exp(_LOGARITHMS), []
        # Overflow occurs only at penetrations far beyond the given force.
        with np.errstate(over="ignore"):
            for side in {term.side for term in self.terms}:
                forces = np.log(np.maximum(np.abs(self.force(side * penetrations)), _LEAST))
                penetration = np.exp(np.interp(np.log(max(force, _LEAST)), forces, _LOGARITHMS))
                slopes.append(float(self.slope(side * penetration)))
        return max(slopes)

    def _sum(self, of_term: OfTerm, y: Array) -> Array:
        gaps = np.asarray(y, dtype=np.float64)
        return np.asarray(sum(of_term(term, gaps) for term in contact_terms([self])))


@dataclass(frozen=True, slots=True)
class Gap(ContactLaw):
    """Contact law with clearances and a factor, on one side or on both.

    >>> law = pt.PowerContact(1e6, exponent=1.0).with_clearance(0.004, 0.010)
    >>> law.force(np.array([0.005, -0.005]))
    array([1000.,    0.])

    Args:
        law: contact law beyond the clearances.
        above, below: clearances Δ in m for positive and negative y; a negative clearance is an
            interference, and requires a linear law.
        sides: signs of y with contact.
        weight: factor of the law's force.

    Raises:
        ValueError: a clearance is not finite, or is negative although the law is not linear.
    """

    law: ContactLaw
    above: float
    below: float
    sides: tuple[int, ...] = (1, -1)
    weight: float = 1.0
    damping: float = field(init=False)

    def __post_init__(self) -> None:
        if not np.isfinite([self.above, self.below]).all():
            raise ValueError(
                f"clearance must be a finite number of m, got {self.above} and {self.below}"
            )
        linear = all(term.exponent == 1.0 and term.onset == 0.0 for term in self.law.terms)
        if not linear and any(term.onset < 0.0 for term in self.terms):
            raise ValueError(f"a law must be linear behind a negative clearance, got {self.law}")
        object.__setattr__(self, "damping", self.law.damping)

    @property
    def terms(self) -> tuple[Term, ...]:
        clearance = {1.0: self.above, -1.0: self.below}
        return tuple(
            Term(side, self.weight * k, clearance[side] + onset, exponent)
            for side, k, onset, exponent in self.law.terms
            if side in self.sides
        )

    def with_clearance(self, above: float, below: float | None = None) -> Gap:
        """Return the law with clearances that are larger by these lengths in m."""
        more = above if below is None else below
        return replace(self, above=self.above + above, below=self.below + more)

    def scale_clearances(self, factor: float) -> Gap:
        return replace(self, above=factor * self.above, below=factor * self.below)

    def slope_at(self, force: float) -> float:
        # Beside clearances, a small penetration would be lost to round-off.
        return ContactLaw.slope_at(replace(self, above=0.0, below=0.0), force)

    def __str__(self) -> str:
        return str(self.law)


@dataclass(frozen=True, slots=True)
class PowerContact(ContactLaw):
    """Power law F = k₂ yⁿ for y > 0 and F = −k₁ (−y)ⁿ for y < 0.

    Equation (4) of Rusiński and Wyciślok (1997), in the only sign convention that gives a restoring
    force; n = 3/2 is Hertz contact, n = 1 a linear stop. A side with stiffness zero has no contact.

    >>> law = pt.PowerContact(stiffness=1e6, exponent=1.5).with_clearance(0.01)
    >>> law.force(np.array([0.0, 0.01, 0.02]))
    array([   0.,    0., 1000.])

    Args:
        stiffness: k₂ in N/mⁿ.
        exponent: n, at least 1, so that the slope is finite at the beginning of contact.
        stiffness_below: k₁ in N/mⁿ; the same as ``stiffness`` unless given.
        damping: χ in s/m of Hunt and Crossley (1975), not negative: F = k δⁿ (1 + χ δ̇) at the
            penetration δ, but never attractive.

    Raises:
        ValueError: an argument is out of its range or not finite.
    """

    stiffness: float
    exponent: float = 2.0
    _: KW_ONLY
    stiffness_below: float | None = None
    damping: float = 0.0

    def __post_init__(self) -> None:
        for name, k in (("stiffness", self.stiffness), ("stiffness_below", self.below)):
            if not (is_finite(k) and k >= 0.0):
                raise ValueError(f"{name} must be a number of N/m^n, not negative, got {k}")
        if self.stiffness == 0.0 and self.below == 0.0:
            raise ValueError("stiffness must be positive on one side at least, got 0.0 on both")
        if not (is_finite(self.exponent) and self.exponent >= 1.0):
            raise ValueError(f"exponent must be at least 1, got {self.exponent}")
        if not (is_finite(self.damping) and self.damping >= 0.0):
            raise ValueError(f"damping must be finite and not negative, got {self.damping} s/m")

    @property
    def below(self) -> float:
        """The stiffness k₁ in N/mⁿ at negative displacement."""
        return self.stiffness if self.stiffness_below is None else self.stiffness_below

    @property
    def terms(self) -> tuple[Term, ...]:
        sides = (1.0, self.stiffness), (-1.0, self.below)
        return tuple(Term(side, k, 0.0, self.exponent) for side, k in sides if k > 0.0)

    def upper(self) -> PowerContact:
        """Return the law on the side y > 0 only."""
        return replace(self, stiffness_below=0.0)

    def lower(self) -> PowerContact:
        """Return the law on the side y < 0 only."""
        return replace(self, stiffness=0.0, stiffness_below=self.below)

    def __str__(self) -> str:
        below = "" if self.below == self.stiffness else f", {self.below:g} below"
        return f"k {self.stiffness:g}{below}, n {self.exponent:g}"


@dataclass(frozen=True, slots=True)
class DryFriction:
    """Coulomb's law of one friction row: |R_l| ≤ μ N_l, and R_l = −μ N_l sign(ḋ_l) in sliding.

    Equation (28) of Rusiński and Wyciślok (1997) with a prescribed normal force, and (11) with
    contact forces as normal force.

    >>> rubbed = replace(
    ...     ball, load=np.zeros(1), friction_rows=np.ones((1, 1)),
    ...     frictions=[DryFriction(coefficient=0.2, station=0, normal_force=10.0)],
    ... )
    >>> slid = simulate(rubbed, 1.0, position=[1.0], velocity=[-1.0])
    >>> print(f"{float(slid.data['height'][-1]):.3f} m")
    0.750 m

    Args:
        coefficient: μ, not negative.
        station: index in the stations of the system.
        normal_force: prescribed part of N_l in N, not negative.
        normal_rows: contact rows whose forces |F_j| are the other part of N_l.

    Raises:
        ValueError: an argument is negative or not finite.
    """

    coefficient: float
    station: int
    normal_force: float = 0.0
    normal_rows: tuple[int, ...] = ()

    def __post_init__(self) -> None:
        if not 0.0 <= self.coefficient < np.inf:
            raise ValueError(f"coefficient must be finite, not negative, got {self.coefficient}")
        if not 0.0 <= self.normal_force < np.inf:
            raise ValueError(
                f"normal_force must be finite, not negative, got {self.normal_force} N"
            )


def contact_terms(laws: Sequence[ContactLaw]) -> Terms:
    """Return the terms of all contact laws, in the order of rows, for compiled loops."""
    return np.array([(row, *term) for row, law in enumerate(laws) for term in law.terms], TERM)


def contact_limits(laws: Sequence[ContactLaw]) -> Limits:
    """Return the open range of y and the damping of each contact law, for compiled loops."""
    return np.array([(-law.onset(-1.0), law.onset(1.0), law.damping) for law in laws], LIMITS)


def restitution_damping(restitution: float, speed: float) -> float:
    """Return the damping χ in s/m for which a mass rebounds with a given restitution.

    For a mass m with F = k δⁿ (1 + χ δ̇), δ̇ dδ̇/(1 + χ δ̇) = −(k/m) δⁿ dδ. The right side integrates
    to zero over the whole impact for all k, n and m, hence v₀ + v₁ = ln[(1 + χ v₀)/(1 − χ v₁)]/χ.

    >>> print(f"{pt.restitution_damping(restitution=0.5, speed=2.0):.4f} s/m")
    0.7164 s/m

    Args:
        restitution: ratio v₁/v₀ of the speeds after and before the impact, above 0 and at most 1.
        speed: v₀ before the impact in m/s, positive.

    Raises:
        ValueError: an argument is out of its range.
    """
    from scipy.optimize import brentq

    e = restitution
    if not (is_finite(e) and 0.0 < e <= 1.0):
        raise ValueError(f"restitution must be above 0 and at most 1, got {e}")
    if not (is_finite(speed) and speed > 0.0):
        raise ValueError(f"speed must be finite and positive, got {speed} m/s")
    # The root of the third-order series in χ v₀, whose relative error is of the order of (χ v₀)².
    first = 1.5 * (1.0 - e**2) / (1.0 + e**3)
    if first < 1.0e-4:
        return first / speed
    # The unknown is u = −ln(1 − χ v₁), which is finite for all χ v₁ below 1.
    u = brentq(
        lambda u: np.log1p(-np.expm1(-u) / e) + u + (1.0 + e) * np.expm1(-u) / e,
        -np.log1p(-0.5 * e * first),
        (1.0 + e) / e,
        rtol=1.0e-14,
    )
    return float(-np.expm1(-u) / (e * speed))
