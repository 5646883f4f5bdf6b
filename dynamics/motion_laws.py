# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion laws: histories of extensions and angles, with their time derivatives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from protractile.dynamics.arrays import Array, check_positive, is_finite
from protractile.dynamics.excitation import History, PiecewiseLinear


class MotionLaw(History, Protocol):
    """Length or angle over time, with its time derivatives."""

    def rate(self, time: Array, order: int) -> Array:
        """Return the first or second time derivative (``order``), in the shape of ``time`` in s."""


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
        check_positive("duration", self.duration, "s")
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
        check_positive("speed", self.speed, "m/s")
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
        check_positive("frequency", self.frequency, "Hz")
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
