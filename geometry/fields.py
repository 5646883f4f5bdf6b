# SPDX-License-Identifier: LGPL-3.0-or-later
"""Types of the fields of a boom's parts: numbers with limits and units, names, laws.

Parts are pydantic dataclasses for Python and for case files. Field names are the keys in case
files. The attribute docstring of a field is its description in the JSON Schema and in messages.
"""

from __future__ import annotations

import ast
import inspect
import math
import sys
from collections.abc import Iterable, Iterator
from dataclasses import field as dataclass_field
from dataclasses import is_dataclass
from functools import cache
from itertools import pairwise
from numbers import Real
from typing import (
    Annotated,
    Any,
    LiteralString,
    TypeVar,
    dataclass_transform,
    get_args,
)

from pydantic import (
    AfterValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationError,
)
from pydantic.dataclasses import dataclass
from pydantic.fields import FieldInfo
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from protractile.dynamics.contact import ContactLaw


class BoomError(ValueError):
    """Error in the data of a boom; ``where`` is an attribute, such as ``segments[1].start``."""

    def __init__(self, where: str, what: str) -> None:
        super().__init__(f"{where}: {what}")
        self.where = where
        self.what = what


# Pattern of a number with its unit, as text.
AMOUNT = r"\s*([+-]?[\d.]{1,40}(?:[eE][+-]?\d{1,3})?)(?:\s+|(?=[^\d\s.,+eE-]))(\S.*)"


class In:
    """Unit of the numbers of a field, one of :mod:`.geometry.units`.

    Args:
        units: one unit for all numbers, or one for each column of a table; ``1`` means
            dimensionless, ``^n`` the exponent of a contact law.
    """

    def __init__(self, *units: str) -> None:
        self.units = units

    def __get_pydantic_json_schema__(
        self, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        return {**_or_text(handler(schema)), "unit": ", ".join(self.units)}


def _or_text(schema: Any) -> Any:
    """Return a JSON Schema with a text of a number and its unit wherever it has a number."""
    if isinstance(schema, list):
        return [_or_text(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    text = {"type": ["number", "string"], "pattern": f"^{AMOUNT}$"}
    parts = {key: _or_text(part) for key, part in schema.items()}
    return parts | text if schema.get("type") == "number" else parts


def fields_of(table: type) -> dict[str, FieldInfo]:
    """Return the fields of a part of the boom or of a table of a case, by name."""
    fields: dict[str, FieldInfo] = getattr(table, "__pydantic_fields__", {})
    return fields


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


def describe(table: type, name: str) -> str:
    """Return the description of a field on one line.

    It is the string below the field in its class or a base, if the field has none of its own.
    """
    text = fields_of(table)[name].description
    for base in table.__mro__:
        if text is None and name in vars(base).get("__annotations__", {}):
            text = _strings_below_fields(base.__module__).get((base.__name__, name))
    return " ".join((text or "").split())


@cache
def _strings_below_fields(module: str) -> dict[tuple[str, str], str]:
    """Return the string below each field of a module's classes, by class and field.

    Pydantic would read the source of every class when it is made, which takes half a second.
    """
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    return {
        (table.name, field.target.id): below.value.value
        for table in ast.walk(tree)
        if isinstance(table, ast.ClassDef)
        for field, below in pairwise(table.body)
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
        if isinstance(below, ast.Expr) and isinstance(below.value, ast.Constant)
        if isinstance(below.value.value, str)
    }


def _shorten(schema: JsonSchemaValue, table: type) -> None:
    """Shorten the descriptions in a JSON Schema to one line each."""
    schema["description"] = " ".join(str(table.__doc__).split("\n\n")[0].split())
    for key, rule in schema.get("properties", {}).items():
        rule["description"] = describe(table, names_of(table)[key])


# Pydantic configuration of parts: unknown fields are errors.
PART = ConfigDict(extra="forbid", json_schema_extra=_shorten)

Positive = Annotated[float, Field(strict=True, gt=0.0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(strict=True, ge=0.0, allow_inf_nan=False)]
Number = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Length = Annotated[Positive, In("m")]
# The number of a detail category by EN 1993-1-9: 71 for 71 N/mm².
Category = Annotated[Positive, In("1")]
# Names occur in file names and comma-separated lists. Latin letters are those of Unicode's blocks
# of Latin up to Extended-B, and Extended Additional: ä, é, ß, ș, ẞ.
NAME = r"^[A-Za-zÀ-ÖØ-öø-ɏḀ-ỿ0-9][A-Za-zÀ-ÖØ-öø-ɏḀ-ỿ0-9 ._+-]*$"
Name = Annotated[str, Field(pattern=NAME, max_length=60)]
Flag = Annotated[bool, Field(strict=True)]
# Maximum number of parts of a kind. More are an input error.
Few = Field(max_length=100)
MOST_STATIONS = 50

VALID_NAME = "made of Latin letters, digits, blanks and . _ + -, starting with a letter or a digit"
# Descriptions of valid input by error type, for messages that quote the given value. Limits of the
# schema replace the braces.
VALID_INPUT = {
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "string_type": "a text",
    "finite_number": "a finite number",
    "greater_than": "a number greater than {gt:g}",
    "greater_than_equal": "a number not less than {ge:g}",
    "less_than": "a number less than {lt:g}",
    "less_than_equal": "a number not greater than {le:g}",
    "literal_error": "{expected}",
    "tuple_type": "a list",
    "place": "a number of {m}, 'tail', 'head' or a distance in {m} from one of them such as "
    "{{ tail = {near} }}",
    "depth": "a number of {m} below the axis, or a distance in {m} from an outer surface such as "
    "{{ bottom = {near} }}",
    "ground": "a list of two numbers, or a table of two such as {{ front = 0.7, below = 1.1 }}",
    "modes": "a whole number above 0, or 'auto'",
    "contact_tolerance": "a number from {least} to below 1, or 'any'",
}
# Descriptions of valid input in Python where they differ from those in case files.
_VALID_IN_PYTHON = {
    "bool_type": "True or False",
    "tuple_type": "a sequence",
    "place": "a number of m, 'tail', 'head' or a distance in m from one of them such as "
    "Distance(tail=0.2)",
    "depth": "a number of m below the axis, or a distance in m from an outer surface such as "
    "Level(bottom=0.2)",
    "ground": "two numbers, x and z in m",
    "dataclass_type": "a {class_name}",
    "string_pattern_mismatch": VALID_NAME,
    "contact_law": "a contact law such as PowerContact(1e9, exponent=1.0)",
    "history": "a history such as Step()",
    "section": "a section such as BoxSection(height=0.4, width=0.3, flange=0.01, web=0.01)",
}
# Messages by error type that do not quote the given value.
MESSAGES = {
    "unsuitable": "{what}",
    "too_short": "too short; give {min_length} at least",
    "too_long": "too many; give {max_length} at most",
    "string_too_long": "too long; give {max_length} characters at most",
}


def format_value(value: Any) -> str:
    """Return a given value for a message."""
    text = repr(value) if not isinstance(value, bool) else str(value).lower()
    return text if len(text) <= 60 else f"{text[:57]}..."


_Table = TypeVar("_Table")


@dataclass_transform(frozen_default=True, field_specifiers=(dataclass_field, Field))
def part(table: type[_Table]) -> type[_Table]:
    """Return the pydantic dataclass of a part of a boom.

    Its constructor raises errors as :class:`BoomError`, which names class and field in one line.
    Validation of a case file does not call the constructor.
    """
    checked: Any = dataclass(frozen=True, slots=True, config=PART)(table)
    validate = checked.__init__

    def __init__(self: Any, *values: Any, **keys: Any) -> None:
        try:
            validate(self, *values, **keys)
        except ValidationError as error:
            raise error_in_python(checked, error) from None

    __init__.__qualname__ = validate.__qualname__
    checked.__init__ = __init__
    made: type[_Table] = checked
    return made


# Error types in the order in which they explain several errors best: a misspelled or forgotten name
# shifts values that are given by position.
UNKNOWN = ("extra_forbidden", "unexpected_keyword_argument")
_FIRST = (*UNKNOWN, "missing", "unexpected_positional_argument")


def error_in_python(table: Any, error: ValidationError) -> BoomError:
    """Return the most informative error of a part that is made in Python."""
    faults = error.errors(include_url=False)
    fault = min(faults, key=lambda fault: (*_FIRST, fault["type"]).index(fault["type"]))
    kind, steps, limits = fault["type"], list(fault["loc"]), fault.get("ctx", {})
    by_position = [
        attribute.name
        for attribute in getattr(table, "__dataclass_fields__", {}).values()
        if not attribute.kw_only
    ]
    if kind == "unexpected_positional_argument":
        what = f"takes {len(by_position)} values by position, {', '.join(by_position)}"
        return BoomError(table.__name__, f"{what}; give others by name")
    if steps and isinstance(steps[0], int):
        steps[0] = by_position[steps[0]]
    where = table.__name__ + "".join(f"[{i}]" if isinstance(i, int) else f".{i}" for i in steps)
    known = fields_of(table) if len(steps) == 1 else {}
    if kind in UNKNOWN:
        return BoomError(where, f"unknown; known are {', '.join(known)}" if known else "unknown")
    if kind == "missing" and not known:
        return BoomError(where, "missing")
    if kind == "missing":
        name = str(steps[0])
        how = "" if name in by_position else f"; give {name}=… by name"
        return BoomError(where, f"missing{how}; it is {describe(table, name)}")
    if kind in MESSAGES:
        return BoomError(where, MESSAGES[kind].format(**limits))
    valid = {**VALID_INPUT, **_VALID_IN_PYTHON}.get(kind)
    if valid is None:
        return BoomError(where, fault["msg"])
    must = valid.format(**limits)
    return BoomError(where, f"must be {must}, got {format_value(fault['input'])}")


def is_positive(value: Any) -> bool:
    """Return whether a value is a finite number above 0."""
    return is_finite(value) and value > 0.0


def is_finite(value: Any) -> bool:
    """Return whether a value is a number that a float can hold."""
    try:
        return isinstance(value, Real) and math.isfinite(value)
    except OverflowError:
        return False


def check_numbers(where: str, **numbers: float) -> None:
    """Check that arguments from Python are finite numbers.

    Raises:
        BoomError: an argument is none.
    """
    for name, value in numbers.items():
        if not is_finite(value):
            what = f"must be a finite number, got {format_value(value)}"
            raise BoomError(f"{where}.{name}", what)


def check_kind(where: str, value: Any, kind: type) -> None:
    """Check that an argument from Python is of a class.

    Raises:
        BoomError: it is of another one.
    """
    if not isinstance(value, kind):
        raise BoomError(where, f"must be a {kind.__name__}, got {format_value(value)}")


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


class Having:
    """Validation of an object by an attribute, without its class.

    Args:
        fault: error type.
        attribute: name of the attribute.
        optional: whether None is valid as well.
    """

    def __init__(self, fault: LiteralString, attribute: str, optional: bool = True) -> None:
        self.fault = fault
        self.attribute = attribute
        self.optional = optional

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._check)

    def _check(self, value: Any) -> Any:
        if hasattr(value, self.attribute) or (self.optional and value is None):
            return value
        raise PydanticCustomError(self.fault, "another object")


def _is_history(value: Any) -> Any:
    """Validate a history, or a marker in place of a history."""
    if is_dataclass(value) or callable(value):
        return value
    raise PydanticCustomError("history", "a history")


# Types of a contact law, and of the history of a load.
LawRef = Annotated[ContactLaw, Having("contact_law", "with_clearance", optional=False)]
LawOrNone = Annotated[ContactLaw | None, Having("contact_law", "with_clearance")]
HistoryRef = Annotated[Any, AfterValidator(_is_history)]
