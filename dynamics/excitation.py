# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads that change with time: a modal load times a history.

Kinks, peak and highest frequency of a history determine the time step.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from protractile.dynamics.arrays import Array, are_finite, is_finite

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


class MotionLaw(History, Protocol):
    """Length or angle over time, with its time derivatives."""

    def rate(self, time: Array, order: int) -> Array:
        """Return the first or second time derivative (``order``), in the shape of ``time`` in s."""


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
        _check_positive("duration", self.duration, "s")

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
        _check_positive("frequency", self.frequency, "Hz")
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
class Spline:
    """Cubic spline between points, with zero slope at both ends and constant beyond them.

    >>> Spline(times=[0.0, 1.0, 2.0], values=[0.0, 5.0, 10.0])(np.array([0.5, 1.0, 9.0]))
    array([ 1.5625,  5.    , 10.    ])

    Args:
        times: times in s, ascending, two at least.
        values: value at each time.

    Raises:
        ValueError: the points are invalid.
    """

    times: Sequence[float]
    values: Sequence[float]

    def __post_init__(self) -> None:
        PiecewiseLinear(self.times, self.values)

    @property
    def kinks(self) -> Sequence[float]:
        """The times of the points in s."""
        return self.times

    @property
    def peak(self) -> float:
        """The largest |value|."""
        fine = np.linspace(self.times[0], self.times[-1], 16 * len(self.times))
        return float(np.abs(self(fine)).max())

    @property
    def fastest(self) -> float:
        """The reciprocal of the shortest interval between points, a bound in rad/s."""
        return 1.0 / float(np.diff(self.times).min())

    def __call__(self, time: Array) -> Array:
        return self.rate(time, 0)

    def rate(self, time: Array, order: int) -> Array:
        """Return the value for the order 0, or the derivative of the order 1 or 2."""
        from scipy.interpolate import CubicSpline

        curve = CubicSpline(self.times, self.values, bc_type="clamped")
        time = np.asarray(time)
        inside = (time > self.times[0]) & (time <= self.times[-1])
        values = curve(np.clip(time, self.times[0], self.times[-1]), order)
        return np.asarray(values * inside if order else values)


@dataclass(frozen=True, slots=True)
class SCurve:
    """Extension s = travel (τ − sin 2πτ/2π), with the time τ as a fraction of the duration.

    Speed and acceleration begin and end with 0 (cycloidal motion; Norton 2009).

    >>> pt.SCurve(travel=4.0, duration=5.0)(np.array([0.0, 2.5, 9.0]))
    array([0., 2., 4.])

    Args:
        travel: travel in m; negative for a retraction.
        duration: duration in s.
        start: start in s.
    """

    travel: float
    duration: float
    start: float = 0.0

    def __post_init__(self) -> None:
        _check_positive("duration", self.duration, "s")
        if not (is_finite(self.travel) and is_finite(self.start)):
            raise ValueError(f"travel and start must be finite, got {self.travel} and {self.start}")

    @property
    def kinks(self) -> tuple[float, float]:
        """The start and end in s."""
        return self.start, self.start + self.duration

    @property
    def peak(self) -> float:
        """The largest extension in m."""
        return abs(self.travel)

    @property
    def fastest(self) -> float:
        """The circular frequency 2π over the duration, in rad/s."""
        return 2.0 * np.pi / self.duration

    def __call__(self, time: Array) -> Array:
        part = np.clip((np.asarray(time) - self.start) / self.duration, 0.0, 1.0)
        return np.asarray(self.travel * (part - np.sin(2.0 * np.pi * part) / (2.0 * np.pi)))

    def rate(self, time: Array, order: int) -> Array:
        """Return the derivative of the order 1 or 2."""
        phase = 2.0 * np.pi * np.clip((np.asarray(time) - self.start) / self.duration, 0.0, 1.0)
        shape = 1.0 - np.cos(phase) if order == 1 else self.fastest * np.sin(phase)
        return np.asarray(self.travel / self.duration * shape)


@dataclass(frozen=True, slots=True)
class Stroke:
    """Extension from 0 to ``travel`` at a constant speed, with linear ramps of the speed.

    >>> pt.Stroke(travel=4.0, speed=1.0, ramp=1.0)(np.array([1.0, 2.0, 5.0]))
    array([0.5, 1.5, 4. ])

    Args:
        travel: travel in m; negative for a retraction.
        speed: speed in m/s, positive.
        ramp: duration in s of the acceleration, and of the deceleration.
        start: start in s.

    Raises:
        ValueError: a number is out of range, or the travel is too short to reach the speed.
    """

    travel: float
    speed: float
    ramp: float = 0.0
    start: float = 0.0

    def __post_init__(self) -> None:
        _check_positive("speed", self.speed, "m/s")
        if not is_finite(self.travel):
            raise ValueError(f"travel must be finite, got {self.travel}")
        if not (is_finite(self.ramp) and self.ramp >= 0.0):
            raise ValueError(f"ramp must be finite and not negative, got {self.ramp} s")
        if self.speed * self.ramp > abs(self.travel):
            raise ValueError(
                f"within a travel of {abs(self.travel):g} a ramp of {self.ramp:g} s does not "
                f"come to a speed of {self.speed:g}; the ramp must be at most "
                f"{abs(self.travel) / self.speed:g} s"
            )

    @property
    def duration(self) -> float:
        """The duration of the travel in s."""
        return abs(self.travel) / self.speed + self.ramp

    @property
    def kinks(self) -> tuple[float, ...]:
        """The times in s at which speed or acceleration jumps."""
        end = self.start + self.duration
        times = (self.start, self.start + self.ramp, end - self.ramp, end)
        return tuple(sorted(set(times)))

    @property
    def peak(self) -> float:
        """The largest extension in m."""
        return abs(self.travel)

    @property
    def fastest(self) -> float:
        """The acceleration of the ramps divided by the speed, in rad/s."""
        return 1.0 / self.ramp if self.ramp else 0.0

    def __call__(self, time: Array) -> Array:
        after = np.clip(np.asarray(time) - self.start, 0.0, self.duration)
        ramps = self._integrate_ramp(after), self._integrate_ramp(after - self.duration + self.ramp)
        return np.asarray(np.sign(self.travel) * self.speed * (ramps[0] - ramps[1]))

    def rate(self, time: Array, order: int) -> Array:
        """Return the derivative of the order 1, with a ramp also 2; at jumps the value before."""
        after = np.asarray(time) - self.start
        since = np.array([after, after - self.duration + self.ramp])
        active, full = since > 0.0, since > self.ramp
        if order == 1:
            rise = np.where(full, 1.0, since / self.ramp * active) if self.ramp else 1.0 * active
        else:
            rise = (active & ~full) / self.ramp
        return np.asarray(np.sign(self.travel) * self.speed * (rise[0] - rise[1]))

    def _integrate_ramp(self, after: Array) -> Array:
        """Return the integral in s over ``after`` in s of a ramp that rises from 0 to 1."""
        if self.ramp == 0.0:
            return np.maximum(after, 0.0)
        part = np.clip(after / self.ramp, 0.0, 1.0)
        return np.asarray(0.5 * self.ramp * part**2 + np.maximum(after - self.ramp, 0.0))


@dataclass(frozen=True, slots=True)
class HistorySum:
    """Sum of histories, for example of the extensions of all joints below a segment."""

    parts: tuple[MotionLaw, ...]

    @property
    def kinks(self) -> tuple[float, ...]:
        return tuple(sorted({time for part in self.parts for time in part.kinks}))

    @property
    def peak(self) -> float:
        return sum(part.peak for part in self.parts)

    @property
    def fastest(self) -> float:
        return max((part.fastest for part in self.parts), default=0.0)

    def __call__(self, time: Array) -> Array:
        return sum((part(time) for part in self.parts), np.zeros(np.shape(time)))

    def rate(self, time: Array, order: int) -> Array:
        """Return the derivative of the order 1 or 2, if the parts have one."""
        return sum((part.rate(time, order) for part in self.parts), np.zeros(np.shape(time)))


@dataclass(frozen=True, slots=True)
class Shaped:
    """Motion law without residual vibration of one mode (zero-vibration shaper).

    The law is divided into two parts. The second part begins half a period of the mode after the
    first one, so that the vibrations of both parts cancel (Singer and Seering 1990).

    >>> swing = pt.Shaped(pt.SCurve(travel=4.0, duration=5.0), frequency=0.25)
    >>> swing(np.array([0.0, 2.0, 7.0])), swing.delay
    (array([0.        , 0.61290214, 4.        ]), 2.0)

    Args:
        law: law without the shaper.
        frequency: natural frequency of the mode in Hz.
        damping: damping ratio of the mode.
    """

    law: MotionLaw
    frequency: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        _check_positive("frequency", self.frequency, "Hz")
        if not (is_finite(self.damping) and 0.0 <= self.damping < 1.0):
            raise ValueError(f"damping must be at least 0 and below 1, got {self.damping}")

    @property
    def delay(self) -> float:
        """Half a period of the damped vibration in s."""
        return 0.5 / (self.frequency * float(np.sqrt(1.0 - self.damping**2)))

    @property
    def kinks(self) -> tuple[float, ...]:
        """The times in s of the kinks of both parts."""
        return tuple(sorted({t + late for t in self.law.kinks for late in (0.0, self.delay)}))

    @property
    def peak(self) -> float:
        """The largest |value| of the law."""
        return self.law.peak

    @property
    def fastest(self) -> float:
        """The highest frequency of the law in rad/s."""
        return self.law.fastest

    def __call__(self, time: Array) -> Array:
        return self.rate(time, 0)

    def rate(self, time: Array, order: int) -> Array:
        """Return the value for the order 0, or the derivative of the order 1 or 2."""
        # The vibration of the first part has decayed for half a period when the second part begins.
        decay = np.exp(-2.0 * np.pi * self.frequency * self.damping * self.delay)
        time = np.asarray(time)
        early, late = (
            self.law.rate(at, order) if order else self.law(at) for at in (time, time - self.delay)
        )
        return np.asarray((early + decay * late) / (1.0 + decay))


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


def _check_positive(name: str, value: float, unit: str) -> None:
    if not (is_finite(value) and value > 0.0):
        raise ValueError(f"{name} must be finite and positive, got {value} {unit}")
