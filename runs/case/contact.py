# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact between segments in a case file: joints, and the contact law of one model."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Self

from pydantic import AfterValidator, Field, model_validator
from pydantic.dataclasses import dataclass

from protractile.dynamics.contact import ContactLaw, PowerContact, restitution_damping
from protractile.dynamics.contact_table import TableContact
from protractile.geometry.boom import Direction
from protractile.geometry.fields import PART, BoomError, In, NotNegative, Number, Positive, rising
from protractile.geometry.joint import BareJoint, Carrier, Drive
from protractile.geometry.place import Distance
from protractile.runs.case.limits import (
    CaseTable,
    Exponent,
    Text,
    error_at,
    superfluous_error,
    unsuitable,
)
from protractile.runs.case.motion_tables import DriveTable

# Maximum number of points of a law. The time loop evaluates all of them at every contact.
MOST_POINTS = 1000

# A shorter travel in m counts as none.
_MIN_TRAVEL = 1.0e-9

NO_STIFFNESS = "missing; give pad, with the thickness from which it follows, or stiffness in N/m^n"

_POWER_LAW_KEYS = ("stiffness", "stiffness_below", "exponent")


def table_law(points: Sequence[tuple[float, float]], damping: float = 0.0) -> TableContact:
    """Return the contact law of a table of penetrations in m and forces in N.

    Raises:
        ValueError: the law is invalid.
    """
    depths, forces = zip(*points, strict=True)
    return TableContact(depths, forces, damping)


def _check_points(points: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
    try:
        table_law(points)
    except ValueError as error:
        raise unsuitable(str(error)) from None
    return points


def _check_law(table: ContactTable, power_keys: Sequence[str]) -> None:
    """Check that a power law has a stiffness, and a table or an elastic pad no ``power_keys``."""
    tables = [key for key in ("force_table", "force_file") if getattr(table, key)]
    pad = table.elastic_pads_key if isinstance(table, JointTable) else None
    superfluous_key = pad or next(iter(tables), None)
    if superfluous_key is None:
        if table.stiffness is None:
            fault = unsuitable(NO_STIFFNESS) if isinstance(table, JointTable) else "missing"
            raise error_at(table, fault, "stiffness")
        return
    others = tables if pad else tables[1:]
    keys = others + [key for key in power_keys if getattr(table, key) is not None]
    if keys:
        raise superfluous_error(table, superfluous_key, *keys)


Forces = Annotated[
    tuple[tuple[Number, Number], ...],
    In("m", "N"),
    Field(min_length=1, max_length=MOST_POINTS),
    rising("depths"),
    AfterValidator(_check_points),
]


class RestitutionTable(CaseTable):
    """Coefficient of restitution of an impact."""

    coefficient: Annotated[float, Field(strict=True, gt=0.0, le=1.0), In("1")]
    """the coefficient of restitution"""
    speed: Annotated[Positive, In("m/s")]
    """the impact speed in m/s at which the coefficient holds"""


@dataclass(frozen=True, config=PART, kw_only=True)
class ContactTable:
    """Contact law of one model, in place of the laws of all joints."""

    force_table: Forces | None = None
    """pairs of a penetration in m and a force in N, linear between them and from 0 on, instead of
    stiffness and exponent"""
    force_file: Text | None = None
    """a CSV file of such pairs; its path is relative to the case file"""
    force_columns: tuple[Text, Text] | None = None
    """the names of the columns of penetrations and forces in the heading of the file; not needed if
    the file has only two columns"""
    stiffness: Annotated[Positive, In("N/m^n")] | None = None
    """the contact stiffness in N/m^n where the inner segment presses up"""
    stiffness_below: Annotated[NotNegative, In("N/m^n")] | None = None
    """the contact stiffness in N/m^n where the inner segment presses down; the same as above unless
    given"""
    exponent: Exponent | None = None
    """the exponent n of the contact law; 2 unless given"""
    restitution: RestitutionTable | None = None
    """the table of the contact's own damping; none unless given"""

    @model_validator(mode="after")
    def _one_law(self) -> Self:
        _check_law(self, _POWER_LAW_KEYS)
        return self

    def exponent_of(self, key: str) -> float | None:
        """Return the exponent of the power law of a stiffness key; None if the case has none."""
        return self.exponent or 2.0

    def law(self, direction: Direction) -> ContactLaw | None:
        """Return the contact law of each station in a direction; None if no pad acts in it."""
        if self.force_table is not None:
            return table_law(self.force_table, self.damping)
        if self.stiffness is None:
            return None
        below = self.stiffness_below if direction == "z" else None
        return PowerContact(
            self.stiffness, self.exponent or 2.0, stiffness_below=below, damping=self.damping
        )

    @property
    def damping(self) -> float:
        """The damping of the contact in s/m."""
        impact = self.restitution
        return 0.0 if impact is None else restitution_damping(impact.coefficient, impact.speed)


@dataclass(frozen=True, config=PART, kw_only=True)
class JointTable(ContactTable, BareJoint):
    """A joint: an inner segment that slides in an outer one, with play."""

    extension: Annotated[NotNegative, In("m")] | None = None
    """the length in m by which the inner segment protrudes from the outer one; needed if the inner
    segment has a length only"""
    stroke: Annotated[Positive, In("m")] | None = None
    """the stroke in m, in place of extension, which then is that of the retracted boom plus it"""
    retracted: Annotated[NotNegative, In("m")] | None = None
    """the extension in m of the retracted boom; telescoping.retracted unless given"""
    drive: DriveTable | None = None
    """the table of the drive that telescopes the inner segment during the motion; without it the
    extension is constant"""
    lateral_stiffness: Annotated[Positive, In("N/m^n")] | None = None
    """the lateral contact stiffness in N/m^n; the same unless given"""
    lateral_exponent: Exponent | None = None
    """the exponent n of lateral contact; the same unless given"""

    @property
    def elastic_pads_key(self) -> str | None:
        """The key of the pads whose thickness determines the contact stiffness, or None."""
        if self.pads:
            return "pads"
        return "pad.thickness" if self.pad is not None and self.pad.thickness else None

    @model_validator(mode="after")
    def _one_law(self) -> Self:
        if self.pads and self.pad is not None:
            raise superfluous_error(self, "pads", "pad")
        if self.stroke and self.extension is not None:
            raise superfluous_error(self, "stroke", "extension")
        # With a lateral stiffness the lateral law is a power law, even if the vertical law is a
        # table.
        lateral = () if self.lateral_stiffness else ("lateral_exponent",)
        _check_law(self, (*_POWER_LAW_KEYS, *lateral))
        if self.pads and self.lateral_stiffness:
            raise superfluous_error(self, "pads", "lateral_stiffness")
        if self.lateral_exponent and not self.lateral_stiffness:
            raise error_at(self, "missing", "lateral_stiffness")
        return self

    def moving_drive(self, where: str, tail: float) -> Drive | None:
        """Return the drive of the joint; None without one, or if the extension is constant.

        ``where`` is the key of the joint, and ``tail`` the x in m of the inner segment's tail.

        Raises:
            BoomError: keys of the drive contradict one another, or a station is on no segment.
        """
        if self.drive is None:
            return None
        history = self.drive.history(f"{where}.drive")
        carriers = tuple(
            self._carrier(place, f"{where}.stations", "the station") for place in self.stations
        )
        locked: Carrier = "inner"
        if isinstance(self.locked_at, float) and self.locked_at < tail:
            # A cylinder, fixed at locked_at on the outer segment, pushes the tail.
            locked = "outer"
        elif self.locked_at is not None:
            locked = self._carrier(self.locked_at, f"{where}.locked_at", "the place")
        drive = Drive(history, carriers, self.drive.least_overlap, locked)
        low, high = drive.reach
        return drive if high - low > _MIN_TRAVEL else None

    def _carrier(self, place: float | Distance, where: str, what: str) -> Carrier:
        if not isinstance(place, Distance):
            raise BoomError(
                where,
                f"{place:g} m does not tell on which segment {what} moves as {self.inner!r} "
                "telescopes; give 'tail' or 'head', or a distance from one",
            )
        return "inner" if place.head is None else "outer"

    def exponent_of(self, key: str) -> float | None:
        along_z = 1.0 if self.elastic_pads_key else self.exponent
        return self.lateral_exponent or along_z if key == "lateral_stiffness" else along_z

    def law(self, direction: Direction) -> ContactLaw | None:
        if direction == "y" and self.lateral_stiffness:
            exponent = self.exponent_of("lateral_stiffness")
            return PowerContact(self.lateral_stiffness, exponent or 2.0, damping=self.damping)
        return self.pad_law(direction, self.damping) or super().law(direction)
