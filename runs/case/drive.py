# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of drives, which extend or retract an inner segment during the motion."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from dynamics.arrays import Array
from dynamics.excitation import History, MotionLaw, PiecewiseLinear, SCurve, Shaped, Spline, Stroke
from geometry.boom import BoomError
from geometry.fields import Distance, Few, In, NotNegative, Number, Positive, describe
from geometry.joint import Carrier, Drive
from runs.case.limits import MOST_TIMES, CaseTable, Text

# Shorter times in s are input errors; a shorter travel in m counts as none.
_MIN_TIME, _MIN_TRAVEL = 1.0e-6, 1.0e-9

# Minimum number of sampling times, number per period of the fastest history, and maximum number.
_TIMES, _PER_PERIOD, _MOST_TIMES = 2001, 100, 1_000_001
# Two times closer than this fraction of the duration count as one.
_SAME_TIME = 1.0e-9

# Keys that define the history of the extension; a drive has one of them.
_HISTORY_KEYS = ("time", "speed", "table")

Ratio = Annotated[float, Field(strict=True, ge=0.0, lt=1.0)]

TravelPairs = Annotated[
    tuple[tuple[Number, Number], ...], In("s", "m"), Field(min_length=2, max_length=MOST_TIMES)
]


class TravelTable(CaseTable):
    """History of the length that a drive or a winch travels."""

    travel: Annotated[Number, In("m")] | None = None
    """the length in m by which the segment extends; negative where it retracts"""
    time: Annotated[Positive, In("s")] | None = None
    """the duration of the travel in s, on a smooth S-curve"""
    speed: Annotated[Positive, In("m/s")] | None = None
    """the speed of the travel in m/s, instead of its duration"""
    ramp: Annotated[NotNegative, In("s")] = 0.0
    """the time in s in which the drive reaches this speed, and in which it stops; at once unless
    given"""
    start: Annotated[NotNegative, In("s")] = 0.0
    """the time in s at which the travel begins"""
    table: TravelPairs | None = None
    """pairs of a time in s and the extension in m since the start, linear between them and constant
    beyond, instead of a travel"""
    file: Text | None = None
    """a CSV file of such pairs; its path is relative to the case file"""
    columns: tuple[Text, Text] | None = None
    """the names of the columns of times and lengths in the heading of the file; not needed if the
    file has only two columns"""

    shaper: Annotated[tuple[tuple[Positive, Ratio], ...], In("Hz", "1"), Few] = ()
    """pairs of the frequency in Hz and the damping ratio of a mode of which no vibration shall
    remain; check offers them for slewing and luffing"""

    # Unit of the travel, and class of the history that interpolates a table.
    unit: ClassVar[str] = "m"
    interpolation: ClassVar[type[PiecewiseLinear] | type[Spline]] = PiecewiseLinear

    def history(self, where: str) -> MotionLaw:
        """Return the history of the travel in ``unit``, after input shaping.

        Arguments and errors are those of :meth:`unshaped`.
        """
        law = self.unshaped(where)
        for frequency, damping in self.shaper:
            law = Shaped(law, frequency, damping)
        return law

    def unshaped(self, where: str) -> MotionLaw:
        """Return the history of the travel in ``unit``, before input shaping.

        Args:
            where: key of the drive.

        Raises:
            BoomError: keys contradict one another, or a key is missing.
        """
        keys = [key for key in _HISTORY_KEYS if getattr(self, key) is not None]
        if not keys:
            raise BoomError(
                f"{where}.time",
                f"missing; it is {self.meaning('time')}, or give speed, table or file",
            )
        if len(keys) > 1:
            raise BoomError(f"{where}.{keys[1]}", f"{keys[0]} is given; leave one of them out")
        if self.ramp and self.speed is None:
            raise BoomError(f"{where}.ramp", f"{keys[0]} is given; only a speed has a ramp")
        for key, seconds in (("time", self.time), ("ramp", self.ramp)):
            if seconds and seconds < _MIN_TIME:
                what = f"must be at least {_MIN_TIME:g} s, got {seconds:g} s"
                raise BoomError(f"{where}.{key}", what)
        if self.table is not None:
            return self._table_history(where)
        if self.travel is None:
            raise BoomError(f"{where}.travel", f"missing; it is {self.meaning('travel')}")
        if self.time is not None:
            return SCurve(self.travel, self.time, self.start)
        assert self.speed is not None
        if not np.isfinite(abs(self.travel) / self.speed):
            raise BoomError(
                f"{where}.speed",
                f"never comes to {self.travel:g} {self.unit}; give a larger one",
            )
        try:
            return Stroke(self.travel, self.speed, self.ramp, self.start)
        except ValueError as error:
            raise BoomError(f"{where}.ramp", str(error)) from None

    def _table_history(self, where: str) -> MotionLaw:
        for key in ("travel", "start"):
            if getattr(self, key):
                raise BoomError(f"{where}.{key}", "table is given; leave one of them out")
        assert self.table is not None
        try:
            history = self.interpolation(*zip(*self.table, strict=True))
        except ValueError as error:
            raise BoomError(f"{where}.table", str(error)) from None
        start = float(history(np.zeros(())))
        if start != 0.0:
            raise BoomError(
                f"{where}.table",
                f"must be 0 {self.unit} at t = 0, where the boom is as it is given, got "
                f"{start:g} {self.unit}",
            )
        return history

    @classmethod
    def meaning(cls, key: str) -> str:
        """Return the description of a key."""
        return describe(cls.model_fields[key])


class DriveTable(TravelTable):
    """A drive that telescopes an inner segment during the motion of the boom."""

    least_overlap: Annotated[NotNegative, In("m")] = 0.0
    """the least overlap in m that must remain; any positive overlap unless given"""
    stiffness: Annotated[Positive, In("N/m")] | None = None
    """the stiffness in N/m of the rope, chain or cylinder that moves the segment, which may then
    stick and slip; rigid unless given"""
    dashpot: Annotated[NotNegative, In("N s/m")] = 0.0
    """the viscous damping in N s/m parallel to this stiffness"""
    static_friction: Annotated[Positive, In("1")] | None = None
    """the coefficient of friction while the segment sticks; the joint's unless given"""

    def drive(
        self,
        where: str,
        stations: tuple[float | Distance, ...],
        locked_at: float | Distance | None,
        inner: tuple[str, float],
    ) -> Drive | None:
        """Return the drive of a joint; None if the extension is constant.

        Args:
            where: key of the joint, for messages.
            stations: stations of the joint.
            locked_at: locked station of the joint.
            inner: name of the inner segment, and the x in m of the segment's tail.

        Raises:
            BoomError: see :meth:`history`; or a station is on no segment.
        """
        history = self.history(f"{where}.drive")
        name, tail = inner
        context = f"{where}.stations", "the station", name
        carriers = tuple(_carrier(place, *context) for place in stations)
        locked: Carrier = "inner"
        if isinstance(locked_at, float) and locked_at < tail:
            # A cylinder, fixed at locked_at on the outer segment, pushes the tail.
            locked = "outer"
        elif locked_at is not None:
            locked = _carrier(locked_at, f"{where}.locked_at", "the place", name)
        drive = Drive(history, carriers, self.least_overlap, locked)
        low, high = drive.reach
        return drive if high - low > _MIN_TRAVEL else None


def max_speed(history: History) -> float:
    """Return the largest speed in m/s of a travel in m that varies over time."""
    times = resolving_times([history], max(history.kinks))
    return float(np.abs(np.diff(history(times)) / np.diff(times)).max())


def resolving_times(histories: Sequence[History], duration: float) -> Array:
    """Return ascending times (num_times,) in s, up to ``duration``, that resolve all histories.

    >>> from runs.case.drive import resolving_times
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


def _carrier(place: float | Distance, where: str, what: str, inner: str) -> Carrier:
    if not isinstance(place, Distance):
        raise BoomError(
            where,
            f"{place:g} m does not tell on which segment {what} moves as {inner!r} telescopes; "
            "give 'tail' or 'head', or a distance from one",
        )
    return "inner" if place.head is None else "outer"
