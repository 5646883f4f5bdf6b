# SPDX-License-Identifier: LGPL-3.0-or-later
"""Positions by numbers or by distances, from ends along x or from outer surfaces along z."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from numbers import Integral
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    Literal,
    LiteralString,
    Protocol,
    TypeVar,
    get_args,
)

from pydantic import BeforeValidator, GetCoreSchemaHandler, WithJsonSchema
from pydantic_core import CoreSchema, PydanticCustomError, PydanticKnownError

from protractile.geometry.fields import (
    BoomError,
    In,
    NotNegative,
    Number,
    format_value,
    is_finite,
    is_number,
    part,
)
from protractile.geometry.typography import choices


@part
class Distance:
    """Distance from an end of a segment or of an overlap."""

    tail: Annotated[NotNegative, In("m")] | None = None
    """the distance in m from the start of the segment, or of a joint's inner segment"""
    head: Annotated[NotNegative, In("m")] | None = None
    """the distance in m from the end of the segment, or of a joint's outer segment"""


# Names of the ends as places.
End = Literal["tail", "head"]


@part
class Level:
    """Height of a place by its distance from an outer surface of the section, as it is drawn."""

    bottom: Annotated[Number, In("m")] | None = None
    """the height in m above the outer surface of the bottom, negative below it"""
    top: Annotated[Number, In("m")] | None = None
    """the depth in m below the outer surface of the top, negative above it"""


@dataclass(frozen=True)
class _Position:
    """Validation of a number or a distance. Errors of a union type would be unreadable."""

    fault: LiteralString  #: error type
    distance: Any  #: class of the distance
    alone: tuple[str, ...] = ()  #: names whose distance may be left out, for 0

    def _validate(self, value: Any) -> Any:
        if isinstance(value, self.distance):
            return value
        if is_number(value):
            if not is_finite(value):
                raise PydanticKnownError("finite_number")
            return float(value)
        distances = {value: 0.0} if value in self.alone else value
        if isinstance(distances, Mapping) and len(distances) == 1:
            ((end, number),) = distances.items()
            if end in self.alone and is_finite(number) and number < 0.0:
                what = f"the distance from the {end} must not be negative, got {number:g}"
                raise PydanticCustomError("unsuitable", "{what}", {"what": what})
            with suppress(BoomError):
                return self.distance(**distances)
        raise PydanticCustomError(self.fault, "a position")

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        kinds = (Number | Literal[self.alone] if self.alone else Number) | self.distance
        check = BeforeValidator(self._validate, json_schema_input_type=kinds)
        return handler.generate_schema(Annotated[float | self.distance, check])


# Type of a position: x in m. Until the part is in a boom, it may be a distance from an end.
Place = Annotated[float, _Position("place", Distance, get_args(End)), In("m")]
# Type of a depth in m below the axis. Until then it may be a distance from an outer surface.
Depth = Annotated[float, _Position("depth", Level), In("m")]

# Type of the segment of a part: its name, or its index if the part is in a boom.
SegmentRef = Annotated[Any, WithJsonSchema({"type": "string"})]


if TYPE_CHECKING:
    from _typeshed import DataclassInstance

_Part = TypeVar("_Part", bound="DataclassInstance")


def at(place: float | Distance, tail: float, head: float) -> float:
    """Return the x in m of a position on a segment with the ends ``tail`` and ``head`` in m."""
    if not isinstance(place, Distance):
        return place
    if place.head is not None:
        return head - place.head
    assert place.tail is not None
    return tail + place.tail


def resolve_distances(part: _Part, tail: float, head: float) -> _Part:
    """Return a part with x in m instead of distances from the ends ``tail`` and ``head`` in m."""
    resolved: dict[str, Any] = {}
    for field in fields(part):
        value = getattr(part, field.name)
        if isinstance(value, Distance):
            resolved[field.name] = at(value, tail, head)
        elif isinstance(value, tuple) and any(isinstance(item, Distance) for item in value):
            resolved[field.name] = tuple(at(item, tail, head) for item in value)
    return replace(part, **resolved) if resolved else part


def resolve_level(part: _Part, where: str, at: Callable[[], tuple[float, float] | None]) -> _Part:
    """Return a part with depths in m below the axis instead of distances from outer surfaces.

    Args:
        part: support, cylinder or head.
        where: name of the part in messages.
        at: returns the z in m of the outer surfaces of bottom and top; None if they are unknown.

    Raises:
        BoomError: the surfaces are unknown.
    """
    for field in fields(part):
        level = getattr(part, field.name)
        if isinstance(level, Level):
            surfaces = at()
            if surfaces is None:
                what = "the segment has no section to measure it from; give it, or a depth in m"
                raise BoomError(f"{where}.{field.name}", what)
            bottom, top = surfaces
            depth = -bottom - (level.bottom or 0.0) if level.top is None else level.top - top
            part = replace(part, **{field.name: depth})
    return part


class _Spanned(Protocol):
    """Name of a segment, and x of its ends in m."""

    @property
    def name(self) -> str: ...
    @property
    def start(self) -> float: ...
    @property
    def end(self) -> float: ...
    def surfaces(self, x: float) -> tuple[float, float] | None: ...


def resolve_segments(part: _Part, where: str, segments: Sequence[_Spanned]) -> _Part:
    """Return a part with indices of segments instead of names, and x and depths in m.

    Args:
        part: joint, load, stop, observation or cylinder.
        where: attribute of the boom with this part, for messages.

    Raises:
        BoomError: a segment is unknown, or its outer surfaces are.
    """
    names = [segment.name for segment in segments]
    for key in ("outer", "inner", "segment"):
        name = getattr(part, key, 0)
        if isinstance(name, str) and name in names:
            part = replace(part, **{key: names.index(name)})
        elif not (isinstance(name, Integral) and 0 <= int(name) < len(names)):
            what = f"{format_value(name)} is no segment; give {choices(names)}"
            raise BoomError(f"{where}.{key}", what)
    outer, inner = (getattr(part, key, getattr(part, "segment", 0)) for key in ("outer", "inner"))
    part = resolve_distances(part, segments[inner].start, segments[outer].end)
    return resolve_level(part, where, lambda: segments[inner].surfaces(getattr(part, "x", 0.0)))
