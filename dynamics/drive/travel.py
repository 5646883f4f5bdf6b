# SPDX-License-Identifier: LGPL-3.0-or-later
"""The extension of a segment over time, and the rows that it changes.

In material coordinates nothing else changes: a segment that moves along its own axis has the
inertia m̄ ü at each of its points if slopes are small. Modes, loads and observers of one segment
stay the same. A row that reads two segments at one place reads one of them at another place as the
segment extends.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from dynamics.arrays import Array
from dynamics.drive.row_table import MovingAxialForce, RowTable
from dynamics.drive.stick_slip import ElasticDrive
from dynamics.excitation import History

# The rows of a gap system that may change with time, in the order in which loops stack them.
Kind = Literal["rows", "friction_rows", "dashpots"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True, slots=True)
class SCurve:
    """Extension from 0 to ``travel`` within ``duration``, s = travel (τ − sin 2πτ/2π).

    Speed and acceleration begin and end with 0 (cycloidal motion; Norton 2009).

    >>> pt.SCurve(travel=4.0, duration=5.0)(np.array([0.0, 2.5, 9.0]))
    array([0., 2., 4.])

    Args:
        travel: in m; negative where the segment retracts.
        duration: in s.
        start: in s.
    """

    travel: float
    duration: float
    start: float = 0.0

    def __post_init__(self) -> None:
        _check_positive("duration", self.duration, "s")

    @property
    def kinks(self) -> tuple[float, float]:
        """Start and end in s."""
        return self.start, self.start + self.duration

    @property
    def peak(self) -> float:
        """Largest extension in m."""
        return abs(self.travel)

    @property
    def fastest(self) -> float:
        """2π over the duration, in rad/s."""
        return 2.0 * np.pi / self.duration

    def __call__(self, time: Array) -> Array:
        part = np.clip((np.asarray(time) - self.start) / self.duration, 0.0, 1.0)
        return np.asarray(self.travel * (part - np.sin(2.0 * np.pi * part) / (2.0 * np.pi)))


@dataclass(frozen=True, slots=True)
class Stroke:
    """Extension from 0 to ``travel`` at a constant speed, with linear ramps of the speed.

    >>> pt.Stroke(travel=4.0, speed=1.0, ramp=1.0)(np.array([1.0, 2.0, 5.0]))
    array([0.5, 1.5, 4. ])

    Args:
        travel: in m; negative where the segment retracts.
        speed: in m/s, positive.
        ramp: duration in s of the acceleration, and of the deceleration.
        start: in s.

    Raises:
        ValueError: a number is out of range, or the travel is too short to reach the speed.
    """

    travel: float
    speed: float
    ramp: float = 0.0
    start: float = 0.0

    def __post_init__(self) -> None:
        _check_positive("speed", self.speed, "m/s")
        if not 0.0 <= self.ramp < np.inf:
            raise ValueError(f"ramp must be finite and not negative, got {self.ramp} s")
        if self.speed * self.ramp > abs(self.travel):
            raise ValueError(
                f"within a travel of {abs(self.travel):g} m a ramp of {self.ramp:g} s does not "
                f"come to {self.speed:g} m/s; the ramp must be at most "
                f"{abs(self.travel) / self.speed:g} s"
            )

    @property
    def duration(self) -> float:
        """In s."""
        return abs(self.travel) / self.speed + self.ramp

    @property
    def kinks(self) -> tuple[float, ...]:
        """Times in s at which speed or acceleration jump."""
        end = self.start + self.duration
        times = (self.start, self.start + self.ramp, end - self.ramp, end)
        return tuple(sorted(set(times)))

    @property
    def peak(self) -> float:
        """Largest extension in m."""
        return abs(self.travel)

    @property
    def fastest(self) -> float:
        """Acceleration of the ramps over the speed, in rad/s."""
        return 1.0 / self.ramp if self.ramp else 0.0

    def __call__(self, time: Array) -> Array:
        after = np.clip(np.asarray(time) - self.start, 0.0, self.duration)
        ramps = self._integrate_ramp(after), self._integrate_ramp(after - self.duration + self.ramp)
        return np.asarray(np.sign(self.travel) * self.speed * (ramps[0] - ramps[1]))

    def _integrate_ramp(self, after: Array) -> Array:
        """Return ∫ v dt in s, v being a ramp from 0 to 1 that then stays."""
        if self.ramp == 0.0:
            return np.maximum(after, 0.0)
        part = np.clip(after / self.ramp, 0.0, 1.0)
        return np.asarray(0.5 * self.ramp * part**2 + np.maximum(after - self.ramp, 0.0))


@dataclass(frozen=True, slots=True)
class HistorySum:
    """The sum of several histories: of all joints between a segment and the ground."""

    parts: tuple[History, ...]

    @property
    def kinks(self) -> tuple[float, ...]:
        return tuple(sorted({time for part in self.parts for time in part.kinks}))

    @property
    def peak(self) -> float:
        return sum(part.peak for part in self.parts)

    @property
    def fastest(self) -> float:
        return max(part.fastest for part in self.parts)

    def __call__(self, time: Array) -> Array:
        return np.asarray(sum(part(time) for part in self.parts))


@dataclass(frozen=True, slots=True)
class Travel:
    """Rows that follow the history of an extension, from 0 at t = 0.

    A row that reads less of the ball as a segment extends:

    >>> table = RowTable.of(lambda s: np.array([[1.0 - s]]), [0.0, 0.5])
    >>> lift = Travel(pt.SCurve(travel=0.5, duration=1.0), table, (("rows", 0),))
    >>> replace(ball, travels=[lift]).standing(1.0).rows
    array([[0.5]])

    Args:
        history: in m.
        table: (num_moving, num_modes) rows over the extension.
        moving: kind and position of each row in the gap system.
        suffix: of the names of its results; there are none where it is None.
        axial_forces: those that move with the extension.
        axial_load: of all moved segments in N, against which the drive works.
        elastic: the elastic drive; a rigid one where it is None.

    Raises:
        ValueError: the number of rows of the table differs, or the history does not begin with 0.
    """

    history: History
    table: RowTable
    moving: Sequence[tuple[Kind, int]]
    suffix: str | None = None
    axial_forces: Sequence[MovingAxialForce] = ()
    axial_load: float = 0.0
    elastic: ElasticDrive | None = None

    def __post_init__(self) -> None:
        rows = self.table.coefficients.shape[2]
        if rows != len(self.moving):
            raise ValueError(f"the table has {rows} rows, and {len(self.moving)} move")
        start = float(self.history(np.zeros(())))
        if abs(start) > 1.0e-9:
            raise ValueError(f"a travel must be 0 at t = 0, got {start:g} m")

    @property
    def moves(self) -> bool:
        """True if the extension changes after t = 0."""
        later = [time for time in self.history.kinks if time > 0.0]
        if self.history.peak == 0.0:
            return False
        return self.history.fastest > 0.0 or bool(self.history(np.array([0.0, *later])).any())


def _check_positive(name: str, value: float, unit: str) -> None:
    if not 0.0 < value < np.inf:
        raise ValueError(f"{name} must be finite and positive, got {value} {unit}")
