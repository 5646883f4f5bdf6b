# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of a case for histories, loads, payload, rope, wind and telescoping."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import (
    BeforeValidator,
    Field,
    SerializerFunctionWrapHandler,
    model_serializer,
    model_validator,
)

from protractile.dynamics.excitation import History, PiecewiseLinear, Ramp, Sine, Step
from protractile.geometry.cylinder import EarthPoint
from protractile.geometry.fields import (
    BoomError,
    Flag,
    In,
    NotNegative,
    Number,
    Positive,
    describe,
    is_number,
    names_of,
    rising,
)
from protractile.geometry.head import Sheave
from protractile.geometry.place import Place
from protractile.geometry.typography import choices
from protractile.geometry.wind import AIR_DENSITY
from protractile.runs.case.limits import (
    MOST_TIMES,
    CaseTable,
    Count,
    Text,
    error_at,
    superfluous_error,
    unsuitable,
    validation_error,
)

# Groups of loads with a common factor in a combination.
Group = Literal["dead", "payload", "wind", "dynamic", "test"]

Times = Annotated[tuple[tuple[Number, Number], ...], In("s", "1"), rising("times")]


class HistoryTable(CaseTable):
    """History over time; constant from t = 0 on unless a key is given."""

    ramp: Annotated[Positive, In("s")] | None = None
    """the time in s of the rise to the full value"""
    frequency: Annotated[Positive, In("Hz")] | None = None
    """the frequency of a sine in Hz"""
    half_sine: Annotated[Positive, In("s")] | None = None
    """the duration in s of a pulse of half a sine from t = 0 on; 0 afterwards"""
    table: Annotated[Times, Field(min_length=2, max_length=MOST_TIMES)] | None = None
    """pairs of a time in s and a factor, linear between them and constant beyond"""
    file: Text | None = None
    """a CSV file of such pairs; its path is relative to the case file"""
    columns: tuple[Text, Text] | None = None
    """the names of the columns of times and factors in the heading of the file; not needed if the
    file has only two columns"""

    # Key of the quantity that the history multiplies.
    amount: ClassVar[str]

    @property
    def description(self) -> str:
        """The history in words; empty if it is constant."""
        given = ((text, getattr(self, key)) for key, (_, text) in _HISTORIES.items())
        return next((text(value) for text, value in given if value is not None), "")

    @model_validator(mode="after")
    def _has_an_amount(self) -> Self:
        # A file with the unit of the quantity makes this key superfluous.
        if self.file is None and self.amount not in self.model_fields_set:
            raise error_at(self, "missing", self.amount)
        return self


# History of each key, and the description of its value.
_HISTORIES: Mapping[str, tuple[Callable[[Any], History], Callable[[Any], str]]] = {
    "ramp": (Ramp, "ramp of {:g} s".format),
    "frequency": (Sine, "sine of {:g} Hz".format),
    "half_sine": (lambda t: Sine(0.5 / t, end=t), "half sine of {:g} s".format),
    "table": (lambda pairs: PiecewiseLinear(*zip(*pairs, strict=True)),
              lambda pairs: f"{len(pairs)} values"),
}  # fmt: skip


def build_history(where: str, table: HistoryTable) -> History:
    """Return the history of a load or of an acceleration.

    Raises:
        BoomError: keys contradict one another, or the table is invalid.
    """
    given = [(key, value) for key in _HISTORIES if (value := getattr(table, key)) is not None]
    if len(given) > 1:
        raise BoomError(f"{where}.{given[1][0]}", f"{given[0][0]} is given; leave one of them out")
    for key, value in given:
        try:
            return _HISTORIES[key][0](value)
        except ValueError as error:
            raise BoomError(f"{where}.{key}", str(error)) from None
    return Step()


# Angles in degrees of the names of horizontal directions.
HORIZONTAL = {"behind": 0.0, "side": 90.0, "front": 180.0}
_Angle = Annotated[float, Field(ge=-360.0, le=360.0)]


def _direction(*others: str) -> BeforeValidator:
    """Return the check of a horizontal direction, which becomes an angle, or of another one."""
    names = [*others, *HORIZONTAL]

    def check(value: Any) -> Any:
        text = isinstance(value, str) and value not in names
        if text or not (isinstance(value, str) or (is_number(value) and abs(value) <= 360.0)):
            what = f"must be {choices(names)}, or an angle in degrees, got {value!r}"
            raise unsuitable(what)
        return HORIZONTAL.get(value, value)

    texts: Any = Literal[tuple(names)]
    return BeforeValidator(check, json_schema_input_type=texts | float)


class LoadTable(HistoryTable):
    """A load on one segment, or where the payload hangs."""

    segment: str | None = None
    """the name of the segment; unless given, a force of a direction acts where the payload hangs"""
    direction: Annotated[_Angle | Literal["z", "y"], _direction("z", "y"), In("deg")] = "z"
    """z (up) or y (lateral), across the boom; or horizontal at one place, at each luffing angle:
    behind (from there), side (towards +y), front, or an angle in degrees from behind towards +y"""
    x: Place | None = None
    """the x in m of a point load; along the whole segment unless given"""
    start: Place | None = Field(None, alias="from")
    """the x in m from which a load along the segment acts; its start unless given"""
    end: Place | None = Field(None, alias="to")
    """the x in m up to which a load along the segment acts; its end unless given"""
    magnitude: Annotated[Number, In("N/m")] = 1.0
    """the load across the boom in N at x, or in N/m along the segment, or the moment in N m; a
    factor, 1 unless given, if the heading of its file has such a unit"""
    moment: Flag = False
    """whether the load is a moment at x, positive where it increases the slope of the segment"""
    released: Flag = False
    """whether the load acts before t = 0 and is released at t = 0; static results at t = 0, and
    under the maximum load, include it, while modes are those after the release"""
    group: Group = "payload"
    """the group of the load, whose factor combinations give"""

    amount: ClassVar[str] = "magnitude"

    def declared_units(self, key: str) -> tuple[str, ...]:
        if key == "magnitude" and self.moment:
            return ("N m",)
        if key == "magnitude" and (self.x is not None or self.segment is None):
            return ("N",)
        return super().declared_units(key)

    @model_validator(mode="after")
    def _is_a_force(self) -> Self:
        if self.segment is None and "direction" not in self.model_fields_set:
            raise error_at(self, "missing", "segment")
        spread = ("from", "to", "moment", "released", *([] if self.segment else ["x"]))
        for key, name in names_of(LoadTable).items():
            if self.oblique and key in spread and getattr(self, name) not in (None, False):
                what = "the load is a force at one place that stays; leave it out, or give segment"
                raise validation_error(self, unsuitable(what), ((key,), getattr(self, name)))
        if self.oblique and self.segment is not None and self.x is None:
            raise error_at(self, "missing", "x")
        return self

    @property
    def heading(self) -> str:
        """The direction in words."""
        return self.direction if isinstance(self.direction, str) else f"at {self.direction:g}°"

    @property
    def oblique(self) -> bool:
        """True if the load has parts along or beside the axis of a segment."""
        return self.segment is None or not isinstance(self.direction, str)


class WindPressureTable(HistoryTable):
    """Horizontal wind on the exposed parts of the segments, and on the load at the tip.

    The pressure acts on the outer height and width of the sections; of a wind oblique to the axis,
    only the flow across the axis counts.
    """

    pressure: Annotated[NotNegative, In("Pa")] = 1.0
    """the dynamic pressure in Pa; a factor, 1 unless given, if the heading of its file has such a
    unit"""
    speed: Annotated[NotNegative, In("m/s")] | None = None
    """the wind speed in m/s, instead of the pressure: 0.5 x 1.25 kg/m^3 x speed^2 (EN 13001-2)"""
    direction: Annotated[_Angle, _direction(), In("deg")] = 0.0
    """the direction: behind, side (towards +y), front, or an angle in degrees from behind towards
    +y"""
    shape_factor: Annotated[
        tuple[Positive, ...],
        In("1"),
        Field(min_length=1),
        BeforeValidator(
            lambda value: (value,) if is_number(value) else value,
            json_schema_input_type=Positive | tuple[Positive, ...],
        ),
    ] = ()
    """the shape factor (force coefficient) of all segments, or one for each segment"""
    load_area: Annotated[NotNegative, In("m^2")] = 0.0
    """the area in m^2 of the load at the tip in the wind; it does not act without a mass at the tip
    or, with a table rope, without one of another group than dead, which is that of hook and rope"""
    load_shape_factor: Annotated[Positive, In("1")] = 1.0
    """the shape factor of the load, 1 unless given, as for an area that has it already"""

    amount: ClassVar[str] = "pressure"

    @property
    def dynamic_pressure(self) -> float:
        """The dynamic pressure in Pa at the value 1 of the history.

        Raises:
            BoomError: neither pressure nor speed is given.
        """
        if self.speed is not None:
            return 0.5 * AIR_DENSITY * self.speed**2
        self.demand("pressure")
        return self.pressure

    def demand(self, key: str) -> None:
        """Check that the table, or that of the case beneath it, has a key.

        Raises:
            BoomError: it has not.
        """
        if key not in self.model_fields_set:
            raise BoomError(f"wind.{key}", f"missing; it is {describe(type(self), key)}")

    def over(self, other: Self | None) -> Self:
        """Return this wind of a load case with the keys that it leaves out from another wind.

        A pressure or a speed replaces both and the history, and a history replaces the history.
        """
        given = self.model_fields_set
        left = set() if other is None else other.model_fields_set - given
        amounts, histories = {"pressure", "speed"}, {*HistoryTable.model_fields}
        if given & amounts:
            left -= amounts
        if given & (amounts | histories):
            left -= histories
        return self.model_copy(update={key: getattr(other, key) for key in left})

    @model_serializer(mode="wrap")
    def _given(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Return the keys that are given: what a saved load case leaves out is the case's."""
        return {
            key: value for key, value in serialize(self).items() if key in self.model_fields_set
        }

    @model_validator(mode="after")
    def _has_an_amount(self) -> Self:
        if self.speed is not None and self.pressure != 1.0:
            raise superfluous_error(self, "pressure", "speed")
        return self


class RopeTable(CaseTable):
    """The hoist rope: all masses at the tip hang on it, and it leads back along the boom.

    The force of the lead is their weight over the falls. It follows the boom: it points from the
    tip to the winch as the boom deflects.
    """

    falls: Count | None = None
    """the number of falls between head and hook; those of the table hoist unless given"""
    winch: Annotated[NotNegative, In("m")] = 0.0
    """the distance in m of the winch behind the boom's foot, on its axis, which goes through the
    centroid"""
    ground: EarthPoint | None = None
    """the place { front, below } of a winch that does not luff, from the foot pin in earth axes;
    then leave winch out"""

    sheave: Sheave | None = None
    """the place { ahead, below } of the sheave at the head, where the lead begins, and the falls
    unless the table head gives a place of the load; that of the table head, or the end of the axis,
    unless given"""

    @model_validator(mode="after")
    def _one_winch(self) -> Self:
        if self.ground is not None and self.winch:
            raise superfluous_error(self, "ground", "winch")
        return self


class AxialTable(CaseTable):
    """A constant axial force towards the base that keeps its direction."""

    segment: str | None = None
    """the name of the segment on which it acts; the last one unless given"""
    x: Place | None = None
    """the x in m of its point of application; the segment's end unless given"""
    force: Annotated[Number, In("N")]
    """the force in N towards the base"""
    group: Group = "payload"
    """the group of the force, whose factor combinations give"""


class PayloadTable(CaseTable):
    """A mass at the tip."""

    mass: Annotated[Positive, In("kg")]
    """the mass in kg"""
    gravity: Annotated[NotNegative, In("m/s^2")] | None = None
    """the acceleration of gravity in m/s^2 that acts on the payload alone from t = 0, 0 for none;
    unless given, the acceleration of the table gravity, or 9.80665"""
    group: Group = "payload"
    """the group of its weight, whose factor combinations give; dead for a cage or a hook"""


class GroundAccelerationTable(HistoryTable):
    """An acceleration of the ground, which acts as an inertia load on all masses."""

    direction: Literal["z", "y"] = "z"
    """the direction: up, or lateral"""
    acceleration: Annotated[Number, In("m/s^2")] = 1.0
    """the acceleration in m/s^2; a factor, 1 unless given, if the heading of its file has
    such a unit"""
    group: Group = "dynamic"
    """the group of the inertia loads, whose factor combinations give"""

    amount: ClassVar[str] = "acceleration"


# Fraction of the stroke: 0 retracted, 1 extended.
Telescoped = Annotated[float, Field(strict=True, ge=0.0, le=1.0), In("1")]


class TelescopingTable(CaseTable):
    """How far the boom is telescoped; the extensions of the joints are those of its full length."""

    extension: Telescoped = 1.0
    """the fraction of the stroke: 0 for the retracted boom, 1 for the extensions of the joints"""
    order: Literal["in proportion", "from the base", "from the tip"] = "in proportion"
    """the order in which the segments move: all in proportion, as ropes and chains couple them, or
    one after the other from the base or from the tip"""
    retracted: Annotated[NotNegative, In("m")] = 0.0
    """the least extension in m of each joint in the retracted boom; longer segments stay out by
    their difference in length"""
