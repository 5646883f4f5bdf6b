# SPDX-License-Identifier: LGPL-3.0-or-later
"""Types of the fields of a boom's parts: numbers with limits and units, names, positions along x.

Parts are pydantic dataclasses for Python and for case files. Field names are the keys in case
files. The attribute docstring of a field is its description in the JSON Schema and in messages.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal, TypeVar, get_args

from pydantic import (
    AfterValidator,
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    WithJsonSchema,
)
from pydantic.dataclasses import dataclass
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, PydanticKnownError


class BoomError(ValueError):
    """Error in the data of a boom; ``where`` is an attribute, such as ``segments[1].start``."""

    def __init__(self, where: str, what: str) -> None:
        super().__init__(f"{where}: {what}")
        self.where = where
        self.what = what


class In:
    """Unit of the numbers of a field, one of :mod:`.runs.case.units`.

    Args:
        units: one unit for all numbers, or one for each column of a table; ``1`` means
            dimensionless, ``^n`` the exponent of a contact law.
    """

    def __init__(self, *units: str) -> None:
        self.units = units

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {**handler(schema), "unit": ", ".join(self.units)}


def fields_of(table: type) -> dict[str, FieldInfo]:
    """Return the fields of a part of the boom or of a table of a case, with their descriptions.

    Pydantic finds the descriptions of inherited fields only in the base class.
    """
    bases = [getattr(base, "__pydantic_fields__", {}) for base in table.__mro__]
    described = {
        name: next((base[name] for base in bases if name in base and base[name].description), None)
        for name in bases[0]
    }
    return {name: field or bases[0][name] for name, field in described.items()}


def names_of(table: type) -> dict[str, str]:
    """Return the field names of a table, by their keys in the case file."""
    return {field.alias or name: name for name, field in fields_of(table).items()}


def declared_units(field: FieldInfo) -> tuple[str, ...]:
    """Return the units of a field; empty for a field without units."""
    return next((unit.units for unit in _units((*field.metadata, field.annotation))), ())


def _units(parts: Iterable[Any]) -> Iterator[In]:
    for part in parts:
        if isinstance(part, In):
            yield part
        else:
            yield from _units(get_args(part))


def describe(field: FieldInfo) -> str:
    """Return the description of a field on one line."""
    return " ".join(str(field.description).split())


def _shorten(schema: JsonSchemaValue, table: type) -> None:
    """Shorten the descriptions in a JSON Schema to one line each."""
    schema["description"] = " ".join(str(table.__doc__).split("\n\n")[0].split())
    for key, rule in schema.get("properties", {}).items():
        rule["description"] = describe(fields_of(table)[names_of(table)[key]])


# Pydantic configuration of parts: unknown fields are errors.
PART = ConfigDict(extra="forbid", use_attribute_docstrings=True, json_schema_extra=_shorten)

Positive = Annotated[float, Field(strict=True, gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(strict=True, ge=0.0, allow_inf_nan=False)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Length = Annotated[Positive, In("m")]
# The number of a detail category by EN 1993-1-9: 71 for 71 N/mm².
Category = Annotated[Positive, In("1")]
# Names occur in file names and comma-separated lists.
NAME = r"^[A-Za-zÀ-ÖØ-öø-ž0-9][A-Za-zÀ-ÖØ-öø-ž0-9 ._+-]*$"
Name = Annotated[str, Field(pattern=NAME, max_length=60)]
Flag = Annotated[bool, Field(strict=True)]
# Maximum number of parts of a kind. More are an input error.
Few = Field(max_length=100)
MOST_STATIONS = 50


@dataclass(frozen=True, slots=True, config=PART)
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
        if not math.isfinite(value):
            raise PydanticKnownError("finite_number")
        return float(value)
    distances = {value: 0.0} if isinstance(value, str) else value
    if isinstance(distances, Mapping) and len(distances) == 1:
        ((end, distance),) = distances.items()
        if end in get_args(End) and is_number(distance) and 0.0 <= distance < math.inf:
            return Distance(**{end: distance})
    raise PydanticCustomError("place", "a place")


def is_number(value: Any) -> bool:
    """Return whether a value is a number; booleans are not."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def rising(what: str, falling: str = "", least: int = 1) -> AfterValidator:
    """Return the check that the first numbers of pairs rise, and that others do not.

    Args:
        what: the first numbers in messages, for example ``times``.
        falling: the second numbers, if they must not rise.
        least: number of pairs that a table must have, unless it is empty.
    """

    def check(pairs: tuple[tuple[float, float], ...]) -> tuple[tuple[float, float], ...]:
        if 0 < len(pairs) < least:
            wrong = f"must have {least} pairs at least, got {len(pairs)}"
            raise PydanticCustomError("unsuitable", "{what}", {"what": wrong})
        for number, (before, after) in enumerate(pairwise(pairs), start=1):
            wrong = ""
            if after[0] == before[0]:
                wrong = f"{what} must rise; entry {number + 1} repeats that of entry {number}"
            elif after[0] < before[0]:
                wrong = f"{what} must rise; entry {number + 1} is below entry {number}: sort them"
            elif falling and after[1] > before[1]:
                wrong = f"{falling} must not rise; entry {number + 1} is above entry {number}"
            if wrong:
                raise PydanticCustomError("unsuitable", "{what}", {"what": wrong})
        return pairs

    return AfterValidator(check)


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
        elif isinstance(value, tuple) and any(isinstance(one, Distance) for one in value):
            resolved[field.name] = tuple(at(one, tail, head) for one in value)
    return replace(part, **resolved) if resolved else part
