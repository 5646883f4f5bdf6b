# SPDX-License-Identifier: LGPL-3.0-or-later
"""Bounded least squares with several starts, and what its Jacobian tells of the unknowns.

Unknowns are scaled by their bounds. The covariance is s² (JᵀJ)⁻¹ with the residuals over their
uncertainties, and s² = max(1, χ²/(m − n)), so that a model that misses the readings by more than
their uncertainty has larger errors (Seber and Wild 1989, *Nonlinear Regression*, 2.1 and 5.8).
Directions that the readings determine no better than the bounds are left out, and their unknowns
marked.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import count

import numpy as np
import numpy.typing as npt

from protractile.dynamics.failure import NUMERICAL_ERRORS, NumericsError
from protractile.geometry.arrays import Array

Residuals = Callable[[Array], Array]
Marks = npt.NDArray[np.bool_]

# Step of the differences of the Jacobian, as a fraction of the range of each unknown.
STEP = 1.0e-3
# Relative change of χ² and of unknowns at which a search ends, and its largest number of steps.
TOLERANCE, MOST_STEPS = 1.0e-4, 30
# Residual of an unknown at a distance of its range from the start of the first search. It holds
# unknowns without effect where they are, and moves others by far less than their errors.
HOLD = 1.0e-2
# Seed of the starts, by which all runs have the same.
SEED = 0
# Standard error of a combination of unknowns, over their ranges, from which the readings do not
# determine it: that of a uniform distribution over the bounds.
UNDETERMINED = 1.0 / np.sqrt(12.0)
# Component of such a combination from which an unknown is not determined either.
PART = 0.3
# Relative difference of χ² up to which two starts have the same minimum.
SAME = 1.0e-2
# Increase of χ² over s² at the ends of an interval of 95 %.
CHI_SQUARE_95 = 3.8415
# Number of values of a profile, and their farthest distance in standard errors.
PROFILE, FARTHEST = 9, 3.0


@dataclass(frozen=True)
class Fit:
    """Unknowns that fit readings best, and how well the readings determine them."""

    low: Array  #: lower bounds (num_unknowns,)
    high: Array  #: upper bounds (num_unknowns,)
    values: Array  #: values (num_unknowns,) of the unknowns
    residuals: Array  #: (model − reading)/uncertainty (num_readings,)
    jacobian: Array  #: derivatives (num_readings, num_unknowns) by unknowns over their ranges
    #: χ² of each start, NaN for one that failed
    starts: Array

    @cached_property
    def misfit(self) -> float:
        """The root of χ² over the degrees of freedom: 1 if the model is right."""
        freedom = max(1, self.residuals.size - self.values.size)
        return float(np.sqrt(self.residuals @ self.residuals / freedom))

    @cached_property
    def _directions(self) -> tuple[Array, Array]:
        """Standard errors (num_unknowns,) of the principal combinations of unknowns, and these."""
        _, sizes, turn = np.linalg.svd(self.jacobian, full_matrices=True)
        sizes = np.pad(sizes, (0, self.values.size - sizes.size))
        with np.errstate(divide="ignore"):
            return max(1.0, self.misfit) / sizes, turn.T

    @cached_property
    def determined(self) -> Marks:
        """True (num_unknowns,) for each unknown that the readings determine."""
        errors, turn = self._directions
        loose = turn[:, errors > UNDETERMINED]
        return np.asarray((np.abs(loose) < PART).all(axis=1), dtype=np.bool_)

    @cached_property
    def at_bound(self) -> Marks:
        """True (num_unknowns,) for each unknown at one of its bounds."""
        span = self.high - self.low
        return np.minimum(self.values - self.low, self.high - self.values) < STEP * span

    @cached_property
    def covariance(self) -> Array:
        """The covariance (num_unknowns, num_unknowns), without undetermined directions."""
        errors, turn = self._directions
        known = errors <= UNDETERMINED
        root = (self.high - self.low)[:, None] * turn[:, known] * errors[known]
        return np.asarray(root @ root.T)

    @cached_property
    def errors(self) -> Array:
        """The standard errors (num_unknowns,); infinite if the readings do not determine them."""
        return np.where(self.determined, np.sqrt(np.diag(self.covariance)), np.inf)

    @cached_property
    def correlation(self) -> Array:
        """The correlation (num_unknowns, num_unknowns); NaN for undetermined unknowns."""
        errors = np.where(self.determined, self.errors, np.nan)
        return np.asarray(self.covariance / np.outer(errors, errors))

    @property
    def agreeing(self) -> int:
        """The number of starts that reach the smallest χ²."""
        least = float(np.nanmin(self.starts))
        return int(np.sum(self.starts <= (1.0 + SAME) * least + SAME))

    def covariance_with(self, more: Array | None = None) -> Array:
        """Return the covariance (num_unknowns, num_unknowns) with the bounds as knowledge.

        Args:
            more: derivatives of (model − reading)/uncertainty of more readings, as in ``jacobian``.
        """
        scale, span = max(1.0, self.misfit), self.high - self.low
        known = np.eye(self.values.size) * scale / UNDETERMINED
        rows = np.vstack([self.jacobian, known, *([] if more is None else [more])])
        return np.asarray(scale**2 * np.outer(span, span) * np.linalg.inv(rows.T @ rows))


def fit(
    residuals: Residuals,
    low: Sequence[float] | Array,
    high: Sequence[float] | Array,
    start: Sequence[float] | Array,
    starts: int = 1,
    report: Callable[[float], None] = lambda part: None,
    step: float = STEP,
) -> Fit:
    """Return the unknowns within bounds that have the smallest sum of squared residuals.

    >>> x = np.linspace(0.0, 1.0, 50)
    >>> line = fit(lambda p: (p[0] + p[1] * x - (2.0 + 3.0 * x)) / 0.1, [0, 0], [9, 9], [1, 1])
    >>> line.values.round(6), line.errors.round(3)
    (array([2., 3.]), array([0.028, 0.048]))

    Args:
        residuals: function that returns (model − reading)/uncertainty (num_readings,) for unknowns
            (num_unknowns,).
        low, high: bounds (num_unknowns,).
        start: values (num_unknowns,) from which the first search starts.
        starts: number of searches; all but the first start from quasi-random points.
        report: callback that receives the completed fraction, 0 to 1.
        step: step of the differences of the Jacobian, as a fraction of the range of each unknown.

    Raises:
        NumericsError: the residuals cannot be computed at any start.
    """
    from scipy.optimize import least_squares
    from scipy.stats import qmc

    lower, upper = np.asarray(low, dtype=float), np.asarray(high, dtype=float)
    span = upper - lower

    begins = [np.clip((np.asarray(start, dtype=float) - lower) / span, 1e-3, 1.0 - 1e-3)]

    last: dict[bytes, Array] = {}

    def scaled(u: Array) -> Array:
        # The search asks for the residuals of a point, then for its derivatives.
        if (point := u.tobytes()) not in last:
            last.clear()
            last[point] = np.append(residuals(lower + span * u), HOLD * (u - begins[0]))
        return last[point]

    def attempt(u: Array) -> Array:
        # A trial point that cannot be computed is rejected by its infinite residuals.
        try:
            return scaled(u)
        except NUMERICAL_ERRORS:
            return np.full_like(first, np.inf)

    if starts > 1:
        points = qmc.Sobol(span.size, seed=SEED).random_base2(max(1, (starts - 2).bit_length()))
        begins += [*points[: starts - 1]]
    best, costs, failure = None, np.full(starts, np.nan), ""
    for number, begin in zip(count(), begins):
        try:
            first = scaled(begin)
            found = least_squares(
                attempt, begin, lambda u: jacobian(scaled, u, step), bounds=(0.0, 1.0),
                ftol=TOLERANCE, xtol=TOLERANCE, gtol=TOLERANCE, max_nfev=MOST_STEPS,
            )  # fmt: skip
            costs[number] = 2.0 * found.cost
            if best is None or found.cost < best.cost:
                best = found
        except NUMERICAL_ERRORS as error:
            failure = str(error)
        report((number + 1) / starts)
    if best is None:
        raise NumericsError(f"the model cannot be computed between the bounds: {failure}")
    own = slice(-span.size)
    return Fit(lower, upper, lower + span * best.x, best.fun[own], best.jac[own], costs)


def jacobian(residuals: Residuals, u: Array, step: float = STEP) -> Array:
    """Return the derivatives (num_readings, num_unknowns) at ``u``, from 0 to 1, by differences.

    They point to the middle of the range.
    """
    here, steps = residuals(u), np.where(u > 0.5, -step, step)
    moved = (residuals(u + change) for change in np.diag(steps))
    return np.asarray(np.array([there - here for there in moved]).T / steps)


def profile(residuals: Residuals, found: Fit, number: int) -> tuple[Array, Array]:
    """Return values of one unknown, and the increase of χ²/s² with all others fitted to it.

    An increase of :data:`CHI_SQUARE_95` bounds the interval of 95 % (profile likelihood; Venzon and
    Moolgavkar 1988).
    """
    reach = FARTHEST * found.errors[number] * np.linspace(-1.0, 1.0, PROFILE)
    within = found.low[number], found.high[number]
    values = np.unique(np.clip(found.values[number] + reach, *within))
    others = np.arange(found.values.size) != number
    increases = []
    for value in values:
        whole = np.where(others, found.values, value)

        def rest(part: Array, whole: Array = whole) -> Array:
            whole = whole.copy()
            whole[others] = part
            return residuals(whole)

        if others.any():
            refit = fit(rest, found.low[others], found.high[others], found.values[others])
            left = refit.residuals
        else:
            left = residuals(whole)
        increases.append(left @ left - found.residuals @ found.residuals)
    return values, np.array(increases) / max(1.0, found.misfit) ** 2
