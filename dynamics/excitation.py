# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads that change with time: a modal load times a history.

Kinks, peak and highest frequency of a history determine the time step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from protractile.dynamics.arrays import Array, are_finite, check_positive, is_finite

# Minimum number of sampling times, number per period of the fastest history, and maximum number.
_TIMES, _PER_PERIOD, _MOST_TIMES = 2001, 100, 1_000_001
# Two times closer than this fraction of the duration count as one.
_SAME_TIME = 1.0e-9


@runtime_checkable
class History(Protocol):
    """Function of time, continuous from t = 0 on, such as the factor of a load."""

    @property
    def kinks(self) -> Sequence[float]:
        """The ascending times in s at which the slope changes."""

    @property
    def peak(self) -> float:
        """The largest |value|."""

    @property
    def fastest(self) -> float:
        """The highest frequency between kinks in rad/s; 0 for a piecewise linear history."""

    def __call__(self, time: Array) -> Array:
        """Return the value at each time in s, any shape."""


@dataclass(frozen=True, slots=True)
class Step:
    """Constant 1 from t = 0 on.

    >>> pt.Step()(np.array([0.0, 1.0]))
    array([1., 1.])
    """

    kinks = (0.0,)
    peak = 1.0
    fastest = 0.0

    def __call__(self, time: Array) -> Array:
        return np.where(np.asarray(time) >= 0.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class Ramp:
    """Linear rise from 0 to 1 within ``duration`` in s, then 1.

    >>> pt.Ramp(0.5)(np.array([0.0, 0.25, 1.0]))
    array([0. , 0.5, 1. ])
    """

    duration: float

    peak = 1.0
    fastest = 0.0

    def __post_init__(self) -> None:
        check_positive("duration", self.duration, "s")

    @property
    def kinks(self) -> tuple[float, float]:
        """The start and end of the rise in s."""
        return 0.0, self.duration

    def __call__(self, time: Array) -> Array:
        return np.clip(np.asarray(time) / self.duration, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Sine:
    """Harmonic history sin(2π f t + φ).

    >>> pt.Sine(frequency=2.0)(np.array([0.0, 0.125])).round(6)
    array([0., 1.])

    Args:
        frequency: f in Hz, positive.
        phase: φ in rad.
        end: time in s of a zero of the sine, from which on the value is 0; a half-sine pulse ends
            at 1 / (2 f).
    """

    frequency: float
    phase: float = 0.0
    end: float = np.inf

    peak = 1.0

    def __post_init__(self) -> None:
        check_positive("frequency", self.frequency, "Hz")
        if not is_finite(self.phase):
            raise ValueError(f"phase must be finite, got {self.phase} rad")

    @property
    def kinks(self) -> tuple[float, ...]:
        """The end in s, if there is one."""
        return (self.end,) if np.isfinite(self.end) else ()

    @property
    def fastest(self) -> float:
        """The circular frequency 2π f in rad/s."""
        return 2.0 * np.pi * self.frequency

    def __call__(self, time: Array) -> Array:
        wave = np.sin(self.fastest * np.asarray(time) + self.phase)
        return np.where(np.asarray(time) < self.end, wave, 0.0)


@dataclass(frozen=True, slots=True)
class PiecewiseLinear:
    """Linear interpolation between points, constant outside them.

    >>> gust = pt.PiecewiseLinear(times=[0.0, 1.0, 3.0], values=[0.0, 2.0, 0.0])
    >>> gust(np.array([0.5, 2.0, 9.0])), gust.peak
    (array([1., 1., 0.]), 2.0)

    Args:
        times: times in s, ascending.
        values: value at each time.
    """

    times: Sequence[float]
    values: Sequence[float]

    fastest = 0.0

    def __post_init__(self) -> None:
        if not (are_finite(self.times) and are_finite(self.values)):
            raise ValueError("times and values must be finite numbers in two sequences")
        if len(self.times) != len(self.values) or len(self.times) == 0:
            raise ValueError(
                f"a history needs one value for each time, got {len(self.values)} for "
                f"{len(self.times)}"
            )
        if (np.diff(self.times) <= 0.0).any():
            raise ValueError("times must rise")

    @property
    def peak(self) -> float:
        """The largest |value|."""
        return float(np.abs(self.values).max())

    @property
    def kinks(self) -> Sequence[float]:
        """The times of the table in s."""
        return self.times

    def __call__(self, time: Array) -> Array:
        return np.asarray(np.interp(time, self.times, self.values))

    def rate(self, time: Array, order: int) -> Array:
        """Return the first or second time derivative; the second one is 0, also at kinks."""
        slopes = np.concatenate([[0.0], np.diff(self.values) / np.diff(self.times), [0.0]])
        return np.asarray((2 - order) * slopes[np.searchsorted(self.times, time)])


@dataclass(frozen=True, slots=True)
class ReleasedLoad:
    """Marker in place of a history, for a load that acts before t = 0 and is then removed."""


@dataclass(frozen=True, slots=True)
class InitialImpulse:
    """Marker in place of a history: an impulse at t = 0 that equals the load times 1 s."""


@dataclass(frozen=True, slots=True)
class Excitation:
    """Modal load with a history.

    Within a time step, a straight line with the same mean and first moment replaces the history.

    >>> lifted = replace(ball, excitations=[Excitation(np.array([12.0]), pt.Ramp(0.1))])
    >>> height = simulate(lifted, 1.0).data["height"]
    >>> print(f"{float(height[-1]):.1f} m")
    0.9 m

    Args:
        load: modal load (num_modes,) in N/√kg.
        history: factor of the load over time.

    Raises:
        ValueError: the history lacks a method, or its data are invalid.
    """

    load: Array
    history: History

    def __post_init__(self) -> None:
        history = self.history
        if not isinstance(history, History):
            raise ValueError(
                "a history needs kinks, peak and fastest beside its values; give a Step, Ramp, "
                f"Sine, PiecewiseLinear or other History, got {type(history).__name__}"
            )
        kinks = np.asarray(history.kinks, dtype=np.float64)
        if not np.isfinite(kinks).all() or (np.diff(kinks) <= 0.0).any():
            raise ValueError("the kinks of a history must be finite and rise")
        for name, value in (("peak", history.peak), ("fastest", history.fastest)):
            if not 0.0 <= value < np.inf:
                raise ValueError(f"{name} of a history must be finite, not negative, got {value}")


def is_constant(history: History) -> bool:
    """Return whether a history stays constant from t = 0 on."""
    ahead = [time for time in history.kinks if time > 0.0]
    times = np.array([0.0, *ahead, 1.0 + max(ahead, default=0.0)])
    changes = history.fastest > 0.0 or bool(np.ptp(history(times)))
    return history.peak == 0.0 or not changes


def resolving_times(histories: Sequence[History], duration: float) -> Array:
    """Return ascending times (num_times,) in s, up to ``duration``, that resolve all histories.

    >>> from protractile.dynamics.excitation import resolving_times
    >>> 0.01 in resolving_times([pt.Ramp(0.01)], 1000.0)
    True
    """
    times = [kink for history in histories for kink in history.kinks if 0.0 < kink <= duration]
    kinks = np.unique(np.array(times))
    cycles = max((history.fastest for history in histories), default=0.0) * duration / (2.0 * np.pi)
    number = int(np.clip(np.ceil(_PER_PERIOD * cycles) + 1.0, _TIMES, _MOST_TIMES))
    uniform_times = np.linspace(0.0, duration, number)
    nearest = np.clip(np.rint(kinks / uniform_times[1]), 1, number - 2).astype(np.int64)
    same = np.abs(uniform_times[nearest] - kinks) <= _SAME_TIME * duration
    return np.union1d(np.delete(uniform_times, nearest[same]), kinks)
