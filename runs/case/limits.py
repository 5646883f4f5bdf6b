# SPDX-License-Identifier: LGPL-3.0-or-later
"""Types and limits of the tables and values of a case file."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import reduce
from typing import Annotated, Any, ClassVar, Literal, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    ValidationError,
)
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, InitErrorDetails, PydanticCustomError


class In:
    """The unit of the numbers of a field, by the names of :mod:`runs.case.units`.

    Args:
        units: one for all of them, or one for each column of a table; ``1`` for none, ``^n`` a
            power that is the exponent of a contact law.
    """

    def __init__(self, *units: str) -> None:
        self.units = units

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {**handler(schema), "unit": ", ".join(self.units)}


def _on_one_line(schema: JsonSchemaValue) -> None:
    for rule in schema.get("properties", {}).values():
        rule["description"] = " ".join(rule["description"].split())


class CaseTable(BaseModel):
    """A table of the case file: nothing but its own keys, and not changed once read."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, use_attribute_docstrings=True, json_schema_extra=_on_one_line
    )

    # The key that a plain number sets, where a number may replace the table.
    bare: ClassVar[str] = ""

    def exponent_of(self, key: str) -> float | None:
        """Return the exponent of the contact law of a key; None where the table gives none."""
        return getattr(self, "exponent", None)

    def units_of(self, key: str, exponent: float = 2.0) -> tuple[str, ...]:
        """Return the units of the numbers of a key, as of :class:`In`; empty for other values.

        Args:
            key: its name in the class.
            exponent: that of the contact law of a table without one.
        """
        declared = declared_units(type(self).model_fields[key])
        n = self.exponent_of(key) or exponent
        powers = (("^(n+2)", f"^{n + 2.0:g}"), ("^n", f"^{n:g}"))
        return tuple(reduce(lambda unit, power: unit.replace(*power), powers, u) for u in declared)


def described(field: FieldInfo) -> str:
    """Return the description of a key, the string below it in its table, on one line."""
    return " ".join(str(field.description).split())


def declared_units(field: FieldInfo) -> tuple[str, ...]:
    """Return the units in a field's :class:`In`."""
    return next((said.units for said in _said((*field.metadata, field.annotation))), ())


def _said(parts: Iterable[Any]) -> Iterator[In]:
    for part in parts:
        if isinstance(part, In):
            yield part
        else:
            yield from _said(get_args(part))


def fault_at(table: CaseTable, fault: str | PydanticCustomError, *keys: str) -> ValidationError:
    """Return an error at a key, for validators of a whole table, whose own errors name no key."""
    at = [InitErrorDetails(type=fault, loc=(k,), input=getattr(table, k)) for k in keys]
    return ValidationError.from_exception_data(type(table).__name__, at)


def left_out(table: CaseTable, given: str, *keys: str) -> ValidationError:
    """Return a validator's error for keys that repeat another one."""
    what = {"what": f"{given} is given; leave one of them out"}
    return fault_at(table, PydanticCustomError("unsuitable", "{what}", what), *keys)


Positive = Annotated[float, Field(strict=True, gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(strict=True, ge=0.0, allow_inf_nan=False)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Length = Annotated[Positive, In("m")]
# A Hertz contact has 3/2; the upper limit excludes input errors.
Exponent = Annotated[float, Field(strict=True, ge=1.0, le=10.0, allow_inf_nan=False), In("1")]
Count = Annotated[int, Field(strict=True, ge=1, le=1000)]
Part = Annotated[float, Field(strict=True, gt=0.0, lt=1.0), In("1")]
Flag = Annotated[bool, Field(strict=True)]
# A name becomes a part of file names, and an element of a comma-separated list.
NAME = r"^[A-Za-z0-9][A-Za-z0-9 ._+-]*$"
Name = Annotated[str, Field(pattern=NAME, max_length=60)]
# No control characters, line breaks or marks of text direction.
PRINTABLE = r"^[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]*$"
Text = Annotated[str, Field(pattern=PRINTABLE, max_length=200)]

# The run stores the whole tip history of each.
MOST_MEMBERS = 10_000
# A boom has a few of each; many more are an input error, and would take too long to draw.
MOST_SEGMENTS, MOST_STATIONS, MOST_MODELS, MOST_FACETS = 20, 50, 50, 20
Few = Field(max_length=100)
# Enough for measured accelerations of a minute at 1 kHz, and more.
MOST_TIMES = 100_000


def _modes(given: Any) -> Any:
    """Check a number of modes or a word; a union's own messages would name its branches."""
    if given == "auto" or (isinstance(given, int) and not isinstance(given, bool) and given > 0):
        return given
    raise PydanticCustomError("modes", "a whole number above 0, or 'auto'")


Modes = Annotated[
    int | Literal["auto"],
    BeforeValidator(_modes, json_schema_input_type=Annotated[int, Field(gt=0)] | Literal["auto"]),
]


# A mesh of a smaller size is too fine for one machine.
LEAST_CONTACT_TOLERANCE = 1.0e-3


def _contact_tolerance(given: Any) -> Any:
    """Check a part or a word; a union's own messages would name its branches."""
    number = isinstance(given, float) and LEAST_CONTACT_TOLERANCE <= given < 1.0
    if given == "any" or number:
        return given
    raise PydanticCustomError(
        "contact_tolerance",
        "a number from {least} to below 1, or 'any'",
        {"least": f"{LEAST_CONTACT_TOLERANCE:g}"},
    )


ContactTolerance = Annotated[
    float | Literal["any"],
    In("1"),
    BeforeValidator(_contact_tolerance, json_schema_input_type=Part | Literal["any"]),
]
