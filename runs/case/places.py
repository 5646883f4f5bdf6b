# SPDX-License-Identifier: LGPL-3.0-or-later
"""Positions along a boom: an x, or a distance from an end of a segment or overlap."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator
from pydantic_core import PydanticCustomError, PydanticKnownError

from runs.case.limits import CaseTable, In, NotNegative, Number


class PlaceTable(CaseTable):
    """A distance from an end: of a segment, or of the overlap of a joint's."""

    tail: Annotated[NotNegative, In("m")] | None = None
    """the distance in m from the segment's start, in a joint the inner one's"""
    head: Annotated[NotNegative, In("m")] | None = None
    """the distance in m from the segment's end, in a joint the outer one's"""


# Names of places: the ends.
End = Literal["tail", "head"]


def _place(given: Any) -> Any:
    """Check a number or a distance; a union's own messages would name its branches."""
    if isinstance(given, PlaceTable):
        return given
    if isinstance(given, int | float) and not isinstance(given, bool):
        if not math.isfinite(given):
            raise PydanticKnownError("finite_number")
        return float(given)
    distances = {given: 0.0} if isinstance(given, str) else given
    if isinstance(distances, Mapping) and len(distances) == 1:
        ((end, distance),) = distances.items()
        if end in PlaceTable.model_fields and _is_distance(distance):
            return PlaceTable(**{end: distance})
    raise PydanticCustomError("place", "a place")


def _is_distance(given: Any) -> bool:
    number = isinstance(given, int | float) and not isinstance(given, bool)
    return number and 0.0 <= given < math.inf


Place = Annotated[
    float | PlaceTable,
    In("m"),
    BeforeValidator(_place, json_schema_input_type=Number | End | PlaceTable),
]


def at(place: float | PlaceTable, tail: float, head: float) -> float:
    """Return the x in m of a place between two ends."""
    if not isinstance(place, PlaceTable):
        return place
    if place.head is not None:
        return head - place.head
    assert place.tail is not None
    return tail + place.tail
