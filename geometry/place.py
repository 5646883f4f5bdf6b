# SPDX-License-Identifier: LGPL-3.0-or-later
"""Positions along x, given by numbers or by distances from ends, and the segments of parts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from numbers import Integral
from typing import TYPE_CHECKING, Annotated, Any, Literal, Protocol, TypeVar, get_args

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


def _place(value: Any) -> Any:
    """Validate a number or a distance. Errors of a union type would be unreadable."""
    if isinstance(value, Distance):
        return value
    if is_number(value):
        if not is_finite(value):
            raise PydanticKnownError("finite_number")
        return float(value)
    distances = {value: 0.0} if isinstance(value, str) else value
    if isinstance(distances, Mapping) and len(distances) == 1:
        ((end, distance),) = distances.items()
        if end in get_args(End) and is_number(distance) and 0.0 <= distance < math.inf:
            return Distance(**{end: distance})
    raise PydanticCustomError("place", "a place")


class _AnyPlace:
    """Validation of a position: x, or a distance from an end."""

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        check = BeforeValidator(_place, json_schema_input_type=Number | End | Distance)
        return handler.generate_schema(Annotated[float | Distance, check])


# Type of a position: x in m. Until the part is in a boom, it may be a distance from an end.
Place = Annotated[float, _AnyPlace(), In("m")]

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


class _Spanned(Protocol):
    """Name of a segment, and x of its ends in m."""

    @property
    def name(self) -> str: ...
    @property
    def start(self) -> float: ...
    @property
    def end(self) -> float: ...


def resolve_segments(part: _Part, where: str, segments: Sequence[_Spanned]) -> _Part:
    """Return a part with indices of segments instead of names, and x in m instead of distances.

    Args:
        part: joint, load, stop, observation or cylinder.
        where: attribute of the boom with this part, for messages.

    Raises:
        BoomError: a segment is unknown.
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
    return resolve_distances(part, segments[inner].start, segments[outer].end)
