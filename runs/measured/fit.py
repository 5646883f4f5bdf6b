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
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.optimize import OptimizeResult

from protractile.dynamics.failure import NUMERICAL_ERRORS, NumericsError
from protractile.geometry.arrays import Array

Residuals = Callable[[Array], Array]
Marks = npt.NDArray[np.bool_]

# Step of the differences of the Jacobian, as a fraction of the range of each unknown.
STEP = 1.0e-3
# Relative change of χ² and of unknowns at which a search ends, also within the first windows, and
# its largest number of steps.
TOLERANCE, FIRST, MOST_STEPS = 1.0e-4, 1.0e-2, 30
# Residual of an unknown at a distance of its range from the start of the first search. It holds
# unknowns without effect where they are, and moves others by far less than their errors.
HOLD = 1.0e-2
# Number of points for each unknown among which starts are chosen, and their seed, by which all runs
# have the same.
SCAN, SEED = 32, 0
# Standard error of a combination of unknowns, over their ranges, from which the readings do not
# determine it: that of a uniform distribution over the bounds.
UNDETERMINED = 1.0 / np.sqrt(12.0)
# Component of such a combination from which an unknown is not determined either.
PART = 0.3
# Misfit above which the points evolve, since impacts make χ² rough, and number of generations.
ROUGH, GENERATIONS = 1.2, 30
# Relative difference of χ² up to which two starts have the same minimum.
SAME = 1.0e-2
# Increase of χ² over s² at the ends of an interval of 95 %.
CHI_SQUARE_95 = 3.8415
# Points of a regression for each unknown, and number of regressions, each around the last result.
POINTS, REGRESSIONS = 8, 3
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
    #: χ² of each start, then of evolved points if any; NaN for a start that failed
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


@dataclass
class _Search:
    """Residuals of unknowns over their ranges, and their least squares within growing windows."""

    residuals: Residuals
    low: Array  #: lower bounds (num_unknowns,)
    span: Array  #: ranges (num_unknowns,)
    given: Array  #: unknowns (num_unknowns,) of the first search, from 0 to 1
    step: float  #: step of the differences of the Jacobian
    windows: Sequence[Marks | slice]  #: readings of each window
    failure: str = ""  #: reason why the last point could not be computed
    _last: dict[bytes, Array] = field(default_factory=dict)

    def __call__(self, u: Array) -> Array:
        """Return the residuals at ``u``, then those that hold unknowns without effect."""
        # A search asks for the residuals of a point, then for its derivatives.
        if (point := u.tobytes()) not in self._last:
            off = np.append(self.residuals(self.low + self.span * u), HOLD * (u - self.given))
            self._last = {point: off}
        return self._last[point]

    def attempt(self, u: Array) -> Array:
        """Return the residuals; at a point that cannot be computed they are infinite."""
        try:
            return self(u)
        except NUMERICAL_ERRORS as error:
            self.failure = str(error)
            return np.full_like(next(iter(self._last.values()), self.given), np.inf)

    def score(self, u: Array) -> float:
        """Return the mean logarithm of χ² over the windows; infinite for a point that fails."""
        off = self.attempt(u)
        if not np.isfinite(off).all():
            return np.inf
        return float(np.mean([np.log(off[window] @ off[window]) for window in self.windows]))

    def descend(self, begin: Array) -> OptimizeResult:
        """Return the least squares of the last window, from those of the windows before.

        Raises:
            NumericsError: the residuals cannot be computed at ``begin`` or beside a later point.
        """
        from scipy.optimize import least_squares

        found, _ = OptimizeResult(x=begin), self(begin)
        for window in self.windows:
            limits = dict.fromkeys(
                ("ftol", "xtol", "gtol"), TOLERANCE if window is self.windows[-1] else FIRST
            )
            found = least_squares(
                lambda u, window=window: self.attempt(u)[window], found.x,
                lambda u, window=window: jacobian(self, u, self.step)[window],
                bounds=(0.0, 1.0), max_nfev=MOST_STEPS, **limits,
            )  # fmt: skip
        return found


def fit(
    residuals: Residuals,
    low: Sequence[float] | Array,
    high: Sequence[float] | Array,
    start: Sequence[float] | Array,
    starts: int = 1,
    report: Callable[[float], None] = lambda part: None,
    step: float = STEP,
    windows: Sequence[Marks] = (),
) -> Fit:
    """Return the unknowns within bounds that have the smallest sum of squared residuals.

    Residuals of a vibration have many minima, one for each period by which it is late, but those of
    its first part have few. So each search fits growing windows of the readings. All but the first
    start from the quasi-random points with the smallest product of χ² over all windows. If the
    misfit remains large, the best points evolve (differential evolution, Storn and Price 1997).

    >>> x = np.linspace(0.0, 1.0, 50)
    >>> line = fit(lambda p: (p[0] + p[1] * x - (2.0 + 3.0 * x)) / 0.1, [0, 0], [9, 9], [1, 1])
    >>> line.values.round(6), line.errors.round(3)
    (array([2., 3.]), array([0.028, 0.048]))

    Args:
        residuals: function that returns (model − reading)/uncertainty (num_readings,) for unknowns
            (num_unknowns,).
        low, high: bounds (num_unknowns,).
        start: values (num_unknowns,) from which the first search starts.
        starts: number of searches.
        report: callback that receives the completed fraction, 0 to 1.
        step: step of the differences of the Jacobian, as a fraction of the range of each unknown.
        windows: True (num_readings,) for the readings of each window, of which the last one has
            all that are fitted; all readings at once unless given.

    Raises:
        NumericsError: the residuals cannot be computed at any start.
    """
    from scipy.optimize import differential_evolution
    from scipy.stats import qmc

    lower, span = np.asarray(low, dtype=float), np.subtract(high, low)
    given = np.clip((np.asarray(start, dtype=float) - lower) / span, 1e-3, 1.0 - 1e-3)
    held = np.full(span.size, True)
    parts: list[Marks | slice] = [np.append(window, held) for window in windows]
    parts = parts or [slice(None)]
    search = _Search(residuals, lower, span, given, step, parts)
    points = qmc.Sobol(span.size, seed=SEED).random_base2((SCAN * span.size - 1).bit_length())
    scores = list[float]()
    for number, point in enumerate(points if starts > 1 else (), start=1):
        scores.append(search.score(point))
        report(0.5 * number / len(points))
    ends, costs = [], np.full(starts, np.nan)
    for number, begin in enumerate([given, *points[np.argsort(scores)[: starts - 1]]]):
        try:
            ends.append(search.descend(begin))
            costs[number] = 2.0 * ends[-1].cost
        except NUMERICAL_ERRORS as error:
            search.failure = str(error)
        report(0.5 + 0.5 * (number + 1) / starts)
    if not ends:
        what = f"the model cannot be computed between the bounds: {search.failure}"
        raise NumericsError(what)
    best = min(ends, key=lambda end: float(end.cost))
    if starts > 1 and 2.0 * best.cost > ROUGH**2 * best.fun.size:
        bred = points[np.argsort(scores)[: len(points) // 4]]
        evolved = differential_evolution(
            search.score, [(0.0, 1.0)] * span.size, init=bred, x0=best.x, maxiter=GENERATIONS,
            polish=False, seed=SEED,
        )  # fmt: skip
        search.windows = parts[-1:]
        with suppress(*NUMERICAL_ERRORS):
            ends.append(search.descend(evolved.x))
            costs = np.append(costs, 2.0 * ends[-1].cost)
        best = min(ends, key=lambda end: float(end.cost))
    own = slice(-span.size)
    return Fit(lower, lower + span, lower + span * best.x, best.fun[own], best.jac[own], costs)


def regress(residuals: Residuals, low: Array, high: Array, start: Array, reach: float) -> Fit:
    """Return the least squares of rough residuals near ``start``, by linear regression.

    Features of chaotic motions scatter between neighbouring unknowns. A search ends in one of many
    minima, and differences have the scatter in them. A regression over points around the start
    averages both (response surface; Box and Wilson 1951).

    >>> scatter = np.random.default_rng(0).normal
    >>> rough = lambda p: 9.0 * (p - 2.0) + scatter(0.0, 0.4, 40)
    >>> found = regress(rough, np.zeros(1), np.full(1, 9.0), np.ones(1), 0.1)
    >>> found.values.round(1), found.errors.round(3)
    (array([2.]), array([0.018]))

    Args:
        residuals: see :func:`fit`.
        low, high, start: bounds and first values (num_unknowns,).
        reach: distance of the farthest points, as a fraction of the range of each unknown.

    Raises:
        NumericsError: the residuals cannot be computed at a point.
    """
    from scipy.optimize import lsq_linear
    from scipy.stats import qmc

    span, held = high - low, HOLD * np.eye(start.size)
    cloud = qmc.Sobol(start.size, seed=SEED).random_base2((POINTS * start.size - 1).bit_length())
    u = (start - low) / span
    # Smaller regions have less curvature in them.
    for far in reach * 0.5 ** np.arange(REGRESSIONS):
        away, middle = far * (2.0 * cloud - 1.0), np.clip(u, far, 1.0 - far)
        design = np.column_stack([np.ones(len(away)), away])
        off = np.array([residuals(low + span * (middle + point)) for point in away])
        at, *slopes = np.linalg.lstsq(design, off, rcond=None)[0]
        slope = np.transpose(slopes)
        rows, ends = np.vstack([slope, held]), np.append(at, np.zeros(start.size))
        u = middle + lsq_linear(rows, -ends, (-far, far)).x
    left = at + slope @ (u - middle)
    return Fit(low, high, low + span * u, left, slope, np.array([left @ left]))


def jacobian(residuals: Residuals, u: Array, step: float = STEP) -> Array:
    """Return the derivatives (num_readings, num_unknowns) at ``u``, from 0 to 1, by differences.

    They point to the middle of the range.
    """
    from scipy.optimize import approx_fprime

    slopes = approx_fprime(u, residuals, np.where(u > 0.5, -step, step))
    return np.asarray(slopes).reshape(-1, u.size)


def profile(residuals: Residuals, found: Fit, number: int) -> tuple[Array, Array]:
    """Return values of one unknown, and the increase of χ²/s² with all others fitted to it.

    An increase of :data:`CHI_SQUARE_95` bounds the interval of 95 % (profile likelihood; Venzon and
    Moolgavkar 1988).
    """
    reach = FARTHEST * found.errors[number] * np.linspace(-1.0, 1.0, PROFILE)
    within = found.low[number], found.high[number]
    values = np.unique(np.clip(found.values[number] + reach, *within))
    low, high, others = (np.delete(x, number) for x in (found.low, found.high, found.values))
    increases = []
    for value in values:

        def rest(part: Array, value: float = value) -> Array:
            return residuals(np.insert(part, number, value))

        left = fit(rest, low, high, others).residuals if others.size else rest(others)
        increases.append(left @ left - found.residuals @ found.residuals)
    return values, np.array(increases) / max(1.0, found.misfit) ** 2
