# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of a case for measured channels."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Annotated, Literal, Self, cast, get_args

import numpy as np
from pydantic import Field, model_validator

from protractile.analysis.quantities import MEASURED, Quantity
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.fields import BoomError, Few, Flag, In, Name, Number, Positive, rising
from protractile.geometry.observation import KINDS, Recorded
from protractile.geometry.place import Place
from protractile.runs.case.limits import MOST_TIMES, CaseTable, Count, Text, error_at, unsuitable

if TYPE_CHECKING:
    from protractile.runs.case.schema import Case, ObserveTable

# Quantities with a value at each time, and those that the boom has as a whole.
Variable = Literal["tip", "tip_lateral", Recorded, "strain", "cylinder_force", "rope_force"]
Property = Literal["frequency", "damping_ratio", "free_travel"]

_SHOWN = {"m": "mm", "rad": "mrad"}

#: quantities that can be measured, by name
MEASURABLE: Mapping[str, Quantity] = {
    name: Quantity(name, kind.unit, kind.title.partition(",")[0], shown=_SHOWN.get(kind.unit, ""))
    for name, kind in KINDS.items()
    if name in get_args(Recorded)
} | {
    quantity.name: quantity
    for quantity in (
        *(MEASURED[name] for name in ("tip", "tip_lateral", "cylinder_force", "rope_force")),
        MEASURED["frequency"],
        Quantity("strain", "1", "strain", shown="µm/m"),
        Quantity("damping_ratio", "1", "damping ratio", shown="%"),
        Quantity("free_travel", "m", "free travel of the tip", shown="mm"),
    )
}

# Units of the keys that have the unit of the quantity.
_OF_QUANTITY = {"value", "uncertainty"}


class Channel(CaseTable):
    """A measured channel: a quantity over time, or a single value."""

    name: Name
    """the name of the channel in the results"""
    quantity: Literal[Variable, Property]
    """the quantity: deflection of the tip along z or y; deflection, rotation, velocity or
    acceleration at x; strain at x; force of a cylinder or of the hoist rope; and as single values a
    natural frequency, a damping ratio, or the free travel of the tip between its contacts"""
    uncertainty: Annotated[Positive, In("1")]
    """the standard uncertainty of a single reading, in the unit of the quantity"""
    systematic: Annotated[float, Field(strict=True, ge=0.0, lt=1.0), In("1")] = 0.0
    """the relative standard uncertainty that all readings share, of instrument and model together,
    in size and in frequency: 0.02 for a beam that no shell calibrates"""
    segment: str | None = None
    """the name of the segment of x"""
    x: Place | None = None
    """the x in m; strain and motions of a place need it"""
    side: Literal["top", "bottom", "left", "right"] = "top"
    """the side of the section with the strain gauge"""
    number: Count = 1
    """the number of the mode, or of the cylinder"""
    value: Annotated[Number, In("1")] | None = None
    """a single value in the unit of the quantity, at rest under the loads at t = 0"""
    table: (
        Annotated[
            tuple[tuple[Number, Number], ...],
            Field(min_length=2, max_length=MOST_TIMES),
            In("s", "1"),
            rising("times"),
        ]
        | None
    ) = None
    """pairs of a time in s and a reading in the unit of the quantity, at any times"""
    file: Text | None = None
    """a CSV file of such pairs; its path is relative to the case file; a line without a reading is
    a gap"""
    columns: tuple[Text, Text] | None = None
    """the names of the columns of times and readings in the heading of the file; not needed if the
    file has only two columns"""
    time_offset: Annotated[Number, In("s")] = 0.0
    """the time in s of the run at which the time of the readings is 0"""
    relative: Flag = False
    """whether the zero of the readings is unknown, so that only their changes count"""
    changes: Annotated[dict[str, Number], In("1")] = Field(default_factory=dict)
    """key = value of each number of the case that was another one in this measurement, in the
    units of the case: { "payload.mass" = 200.0 }"""
    since: Annotated[dict[str, Number], In("1")] = Field(default_factory=dict)
    """key = value of each number of the case in the state in which a single value was set to 0;
    unless given, the value is absolute"""

    @property
    def measures(self) -> Quantity:
        """The measured quantity with its unit and titles."""
        return MEASURABLE[self.quantity]

    @property
    def placed(self) -> bool:
        """True if the quantity needs a place."""
        return self.quantity == "strain" or self.quantity in KINDS

    @property
    def output(self) -> ObserveTable:
        """The output of a model at the place of the channel; of strains its deflection."""
        from protractile.runs.case.schema import ObserveTable

        assert self.x is not None
        quantity = "deflection" if self.quantity == "strain" else cast(Recorded, self.quantity)
        return ObserveTable(f"measured {self.name}", self.segment, self.x, quantity)

    @property
    def curve(self) -> str:
        """The name of the readings in messages on files."""
        return self.measures.title

    @property
    def times(self) -> Array:
        """The times of the readings (num_times,) in s of the run; (0,) of a single value."""
        return np.array([time for time, _ in self.table or ()]) + self.time_offset

    @property
    def readings(self) -> Array:
        """The readings (num_times,), or (1,) of a single value."""
        pairs = self.table or ((0.0, self.value or 0.0),)
        return np.array([reading for _, reading in pairs])

    def until(self, end: float) -> Channel:
        """Return the channel with its readings from 0 to ``end`` in s of the run."""
        pairs = zip(self.table or (), self.times.tolist(), strict=True)
        table = tuple(pair for pair, time in pairs if 0.0 <= time <= end) or None
        return self.model_copy(update={"table": table})

    def declared_units(self, key: str) -> tuple[str, ...]:
        unit = self.measures.unit
        if key == "table":
            return "s", unit
        return (unit,) if key in _OF_QUANTITY else super().declared_units(key)

    @model_validator(mode="after")
    def _is_complete(self) -> Self:
        """Check that the channel has one kind of data, and the place that it needs."""
        curves, title = self.table is not None or self.file is not None, self.measures.title
        for key in ["segment", "x"] * self.placed + ["value"] * (not curves):
            if getattr(self, key) is None:
                raise error_at(self, "missing", key)
        rules = (
            (curves and self.value is not None, "value",
             "the channel has readings over time; leave one of them out"),
            (curves and self.quantity in get_args(Property), "quantity",
             f"{title} is a single value; give it as value"),
            (not curves and self.quantity in ("velocity", "acceleration", "rope_force"), "quantity",
             f"{title} varies over time; give a table or a file"),
            (curves and self.since, "since", "only a single value has this key"),
            (not curves and self.relative, "relative", "a single value has since instead"),
        )  # fmt: skip
        for wrong, key, what in rules:
            if wrong:
                raise error_at(self, unsuitable(what), key)
        return self


class Keys(CaseTable):
    """Keys of a case for measurements."""

    measured: Annotated[tuple[Channel, ...], Few] = ()
    """the measured channels, one [[measured]] each, for compare and identify"""


def check(case: Case, boom: Boom) -> None:
    """Check that the boom and the run of a case have what its channels measure.

    Raises:
        BoomError: a channel does not fit, or has the name of another one.
    """
    assert isinstance(case, Keys)
    names, end = [channel.name for channel in case.measured], case.time.duration
    for number, channel in enumerate(case.measured):
        where, quantity, segment = f"measured[{number + 1}]", channel.quantity, None
        inside = channel.until(end).times
        try:
            if channel.placed:
                (place,) = replace(boom, observations=(channel.output,)).observations
                segment = boom.segments[int(place.segment)]
        except BoomError as error:
            raise BoomError(f"{where}.{error.where.rpartition('.')[2]}", error.what) from None
        rules = (
            (channel.name in names[:number], "name",
             f"{channel.name!r} is the name of another channel already; give each its own"),
            (channel.table is not None and inside.size < 2, "time_offset",
             f"has no two readings from 0 to {end:g} s of the run"),
            (quantity == "cylinder_force" and channel.number > len(boom.cylinders), "number",
             f"the boom has {len(boom.cylinders)} cylinders"),
            (quantity == "rope_force" and case.hoist is None, "quantity",
             "the case has no hoist, whose rope would have this force"),
            (quantity == "tip_lateral" and not boom.spatial, "quantity",
             "the boom is flat; give the joints lateral_play"),
            (quantity == "strain" and segment is not None and segment.section is None, "segment",
             f"{channel.segment!r} has no section, which strains need"),
        )  # fmt: skip
        for wrong, key, what in rules:
            if wrong:
                raise BoomError(f"{where}.{key}", what)
