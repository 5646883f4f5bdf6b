# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of motions in a case file: drives, slewing, luffing and hoisting."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from protractile.dynamics.excitation import History, PiecewiseLinear, resolving_times
from protractile.dynamics.motion_laws import MotionLaw, SCurve, Shaped, Spline, Stroke
from protractile.geometry.boom import BoomError
from protractile.geometry.fields import (
    Few,
    Flag,
    In,
    NotNegative,
    Number,
    Positive,
    describe,
    rising,
)
from protractile.runs.case.limits import MOST_TIMES, CaseTable, Text
from protractile.runs.case.load_tables import HistoryTable

# Shorter times in s are input errors.
_MIN_TIME = 1.0e-6

Ratio = Annotated[float, Field(strict=True, ge=0.0, lt=1.0)]

TimePairs = Annotated[
    tuple[tuple[Number, Number], ...],
    Field(min_length=2, max_length=MOST_TIMES),
    rising("times"),
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
    table: Annotated[TimePairs, In("s", "m")] | None = None
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

    # Unit of the travel, its name in messages, and class of the history that interpolates a table.
    unit: ClassVar[str] = "m"
    curve: ClassVar[str] = "length"
    interpolation: ClassVar[type[PiecewiseLinear] | type[Spline]] = PiecewiseLinear

    def history(self, where: str) -> MotionLaw:
        """Return the history of the travel in ``unit``, after input shaping.

        Raises:
            BoomError: keys contradict one another, or a key is missing.
        """
        law = self._unshaped_history(where)
        for frequency, damping in self.shaper:
            law = Shaped(law, frequency, damping)
        return law

    def _unshaped_history(self, where: str) -> MotionLaw:
        keys = [key for key in ("time", "speed", "table") if getattr(self, key) is not None]
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
        return describe(cls, key)


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


def max_speed(history: History) -> float:
    """Return the largest speed in m/s of a travel in m that varies over time."""
    times = resolving_times([history], max(history.kinks))
    return float(np.abs(np.diff(history(times)) / np.diff(times)).max())


class LuffTable(TravelTable):
    """Luffing of the boom about its foot."""

    travel: Annotated[Number, In("deg")] | None = None
    """the angle in degrees by which the boom turns, positive where the tip rises"""
    speed: Annotated[Positive, In("deg/s")] | None = None
    """the speed in deg/s, instead of the duration"""
    table: Annotated[TimePairs, In("s", "deg")] | None = None
    """pairs of a time in s and the angle in degrees since the start, on a cubic spline that is at
    rest at both ends, instead of a travel"""

    unit: ClassVar[str] = "degrees"
    interpolation: ClassVar[type[PiecewiseLinear] | type[Spline]] = Spline


class SlewTable(LuffTable):
    """Slewing of the boom about the vertical."""

    travel: Annotated[Number, In("deg")] | None = None
    """the angle in degrees by which the boom turns, positive towards +y"""
    radius: Annotated[Number, In("m")] = 0.0
    """the horizontal distance in m of the boom's foot from the axis of slewing, negative where it
    is behind the axis"""


class WindTable(HistoryTable):
    """A horizontal force, such as wind, on a load that swings."""

    direction: Literal["x", "y"] = "y"
    """the direction, which stands still: away from the crane at t = 0, or lateral"""
    force: Annotated[Number, In("N")] = 1.0
    """the force in N; a factor, 1 unless given, if the heading of its file has such a unit"""

    amount: ClassVar[str] = "force"


class HoistTable(TravelTable):
    """A load on a rope below the tip, and the winch that hoists it."""

    travel: Annotated[Number, In("m")] | None = None
    """the length in m by which the winch hoists the load; negative where it lowers it"""
    mass: Annotated[Positive, In("kg")]
    """the mass in kg of the load"""
    stiffness: Annotated[Positive, In("N/m")] | None = None
    """the stiffness in N/m of all falls of the rope together; unless given, it follows from area,
    modulus, length and falls"""
    area: Annotated[Positive, In("m^2")] | None = None
    """the metallic cross-section in m^2 of one fall"""
    modulus: Annotated[Positive, In("Pa")] | None = None
    """the modulus of elasticity in Pa of the rope"""
    length: Annotated[Positive, In("m")] | None = None
    """the length in m of the falls"""
    falls: Annotated[int, Field(strict=True, ge=1, le=100)] = 1
    """the number of falls"""
    hanging: Flag = False
    """whether the load hangs on the rope at t = 0; it lies on the ground unless given"""
    slack: Annotated[NotNegative, In("m")] = 0.0
    """the length in m that the winch takes up before the rope is straight, of a load that lies on
    the ground"""
    pendulum: Annotated[Positive, In("m")] | None = None
    """the distance in m from the tip to a hanging load, which then swings; it only moves vertically
    unless given"""
    wind: Annotated[tuple[WindTable, ...], Few] = ()
    """the forces of wind on a load that swings"""
    dropped: Flag = False
    """whether the hanging load is dropped at t = 0"""
    phi_2_min: Annotated[Positive, In("1")] | None = None
    """the least dynamic factor of the hoisting class, with beta_2: the results compare the computed
    factor with φ₂ = phi_2_min + beta_2 v of the hoisting speed v (EN 13001-2)"""
    beta_2: Annotated[NotNegative, In("s/m")] | None = None
    """the increase in s/m of the dynamic factor with the hoisting speed, by the hoisting class"""

    @property
    def has_winch(self) -> bool:
        """True if a winch hoists or lowers the load."""
        return self.travel is not None or self.table is not None

    @property
    def rope_stiffness(self) -> float:
        """The stiffness in N/m of all falls together, if the data are complete."""
        if self.stiffness is not None:
            return self.stiffness
        assert self.area
        assert self.modulus
        assert self.length
        return self.falls * self.modulus * self.area / self.length

    @property
    def factor_by_class(self) -> float | None:
        """The factor φ₂ of the hoisting class; None without its constants."""
        if self.phi_2_min is None or self.beta_2 is None:
            return None
        return self.phi_2_min + self.beta_2 * max_speed(self.history("hoist"))
