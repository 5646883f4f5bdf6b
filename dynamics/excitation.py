# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads that change with time: a modal load times a history.

Every history is a function of the time in s, vectorised, without unit. For the choice of a step it
tells its largest absolute value, ``peak``, and the ``fastest`` frequency in it in rad/s.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Step:
    """1 from t = 0 on."""

    peak = 1.0
    fastest = 0.0

    def __call__(self, time: Array) -> Array:
        return np.where(np.asarray(time) >= 0.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class Ramp:
    """From 0 to 1 within ``duration`` in s, then 1."""

    duration: float

    peak = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.duration < np.inf:
            raise ValueError(f"duration must be finite and positive, got {self.duration} s")

    @property
    def fastest(self) -> float:
        """1 / duration."""
        return 1.0 / self.duration

    def __call__(self, time: Array) -> Array:
        return np.clip(np.asarray(time) / self.duration, 0.0, 1.0)


@dataclass(frozen=True, slots=True)
class Sine:
    """sin(2π f t + φ).

    Args:
        frequency: f in Hz, positive.
        phase: φ in rad.
    """

    frequency: float
    phase: float = 0.0

    peak = 1.0

    def __post_init__(self) -> None:
        if not 0.0 < self.frequency < np.inf:
            raise ValueError(f"frequency must be finite and positive, got {self.frequency} Hz")
        if not np.isfinite(self.phase):
            raise ValueError(f"phase must be finite, got {self.phase} rad")

    @property
    def fastest(self) -> float:
        """2π f."""
        return 2.0 * np.pi * self.frequency

    def __call__(self, time: Array) -> Array:
        return np.asarray(np.sin(self.fastest * np.asarray(time) + self.phase))


@dataclass(frozen=True, slots=True)
class Table:
    """Straight lines between points, held constant outside them.

    Args:
        times: in s, rising.
        values: one for each time.
    """

    times: Sequence[float]
    values: Sequence[float]

    def __post_init__(self) -> None:
        if len(self.times) != len(self.values) or len(self.times) == 0:
            raise ValueError(
                f"a table needs one value for each time, got {len(self.values)} for "
                f"{len(self.times)}"
            )
        if not np.isfinite([*self.times, *self.values]).all():
            raise ValueError("times and values must be finite")
        if (np.diff(self.times) <= 0.0).any():
            raise ValueError("times must rise")

    @property
    def peak(self) -> float:
        """Largest |value|."""
        return float(np.abs(self.values).max())

    @property
    def fastest(self) -> float:
        """1 / the shortest time between two points."""
        return float(1.0 / np.diff(self.times).min()) if len(self.times) > 1 else 0.0

    def __call__(self, time: Array) -> Array:
        return np.asarray(np.interp(time, self.times, self.values))


@dataclass(frozen=True, slots=True)
class Excitation:
    """A modal load that follows a history; over one time step as a straight line.

    Args:
        load: (num_modes,) in N/√kg.
        history: time in s, any shape → factor, the same shape.
    """

    load: Array
    history: Callable[[Array], Array]

    @property
    def peak(self) -> float:
        """Largest |history|; 1 if it does not tell."""
        return float(getattr(self.history, "peak", 1.0))

    @property
    def fastest(self) -> float:
        """Highest frequency of the history in rad/s; 0 if it does not tell."""
        return float(getattr(self.history, "fastest", 0.0))
