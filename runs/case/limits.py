# SPDX-License-Identifier: LGPL-3.0-or-later
"""Types and limits of the tables and values of a case file."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import reduce
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, get_args

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    ValidationError,
    ValidatorFunctionWrapHandler,
    WrapValidator,
)
from pydantic_core import InitErrorDetails, PydanticCustomError

from protractile.geometry.fields import PART, In, Positive, declared_units, fields_of, names_of


class CaseTable(BaseModel):
    """An immutable table of the case file. Unknown keys are errors."""

    # The case builds the schema of the tables within it once, for all of them.
    model_config = ConfigDict(**PART, frozen=True, defer_build=True)

    def declared_units(self, key: str) -> tuple[str, ...]:
        """Return the units that a field declares by :class:`.geometry.fields.In`."""
        return declared_units(type(self).model_fields[key])


# Path to a value in nested tables and lists: keys, and indices from 0.
Steps = tuple[str | int, ...]


def key_of(steps: Iterable[str | int]) -> str:
    """Return a path as the key in messages, with indices from 1: ``segment[2].span``."""
    parts = (f"[{step + 1}]" if isinstance(step, int) else f".{step}" for step in steps)
    return "".join(parts).removeprefix(".")


def leaves(item: Any, steps: Steps = ()) -> Iterator[tuple[Steps, Any]]:
    """Yield path and value of all entries of nested tables and lists that are none themselves."""
    if isinstance(item, Mapping | list):
        for step, value in item.items() if isinstance(item, Mapping) else enumerate(item):
            yield from leaves(value, (*steps, step))
    else:
        yield steps, item


def is_table(value: Any) -> bool:
    """Return True if a value is a table of a case: a :class:`CaseTable`, or a part of a boom."""
    return hasattr(type(value), "__pydantic_fields__")


def tables_in(annotation: Any) -> Iterator[type]:
    """Yield the classes of the tables that an annotation contains."""
    if isinstance(annotation, type) and hasattr(annotation, "__pydantic_fields__"):
        yield annotation
    for part in get_args(annotation):
        yield from tables_in(part)


def walk_tables(table: Any, key: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the key and the table of a table and of all tables within it."""
    yield key, table
    for step, name in names_of(type(table)).items():
        value, inner = getattr(table, name), f"{key}.{step}" if key else step
        parts = {inner: value}
        if isinstance(value, dict):
            parts = {f"{inner}.{name}": part for name, part in value.items()}
        elif isinstance(value, tuple):
            parts = {f"{inner}[{i}]": part for i, part in enumerate(value, start=1)}
        for where, part in parts.items():
            if is_table(part):
                yield from walk_tables(part, where)


def map_tables(table: Any, change: Callable[[str, Any], Mapping[str, Any]], key: str = "") -> Any:
    """Return a copy of a table with changed values, also in all tables within it.

    ``change`` takes the key of a table and the table, and returns changed values by field name.
    """

    def mapped(value: Any, key: str) -> Any:
        if is_table(value):
            return map_tables(value, change, key)
        if isinstance(value, dict):
            return {name: mapped(item, f"{key}.{name}") for name, item in value.items()}
        if isinstance(value, tuple) and any(map(is_table, value)):
            return tuple(mapped(item, f"{key}[{i}]") for i, item in enumerate(value, start=1))
        return value

    changed = dict(change(key, table))
    for step, name in names_of(type(table)).items():
        before = getattr(table, name)
        after = mapped(changed.get(name, before), f"{key}.{step}" if key else step)
        if after != before:
            changed[name] = after
    if isinstance(table, CaseTable):
        return table.model_copy(update=changed) if changed else table
    return replace(table, **changed) if changed else table


def units_of(table: Any, key: str, exponent: float = 2.0) -> tuple[str, ...]:
    """Return the units of the numbers of a key; an empty tuple for other values.

    ``exponent`` is that of the contact law if the table has none.
    """
    if isinstance(table, CaseTable):
        units = table.declared_units(key)
    else:
        units = declared_units(fields_of(type(table))[key])
    n = getattr(table, "exponent", None)
    if hasattr(table, "exponent_of"):
        n = table.exponent_of(key)
    n = n or exponent
    powers = (("^(n+2)", f"^{n + 2.0:g}"), ("^n", "" if n == 1.0 else f"^{n:g}"))
    return tuple(reduce(lambda unit, power: unit.replace(*power), powers, u) for u in units)


def validation_error(
    table: Any, kind: str | PydanticCustomError, *at: tuple[Any, ...]
) -> ValidationError:
    """Return the validation error of a table, from the path and the value of each wrong key."""
    errors = [InitErrorDetails(type=kind, loc=path, input=value) for path, value in at]
    return ValidationError.from_exception_data(type(table).__name__, errors)


def error_at(table: Any, kind: str | PydanticCustomError, *keys: str) -> ValidationError:
    """Return the validation error at keys of a table."""
    return validation_error(table, kind, *(((key,), getattr(table, key)) for key in keys))


def superfluous_error(table: Any, key: str, *keys: str) -> ValidationError:
    """Return the validation error at keys that contradict or repeat another key."""
    return error_at(table, unsuitable(f"{key} is given; leave one of them out"), *keys)


def unsuitable(what: str) -> PydanticCustomError:
    """Return the error of a value with a message of its own."""
    return PydanticCustomError("unsuitable", "{what}", {"what": what})


# A Hertz contact has the exponent 3/2; the upper limit excludes input errors.
Exponent = Annotated[float, Field(strict=True, ge=1.0, le=10.0, allow_inf_nan=False), In("1")]
Count = Annotated[int, Field(strict=True, ge=1, le=1000)]
Part = Annotated[float, Field(strict=True, gt=0.0, lt=1.0), In("1")]
# No control characters, line breaks or marks of text direction.
PRINTABLE = r"^[^\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069]*$"
Text = Annotated[str, Field(pattern=PRINTABLE, max_length=200)]

# The run stores the whole tip history of each member.
MOST_MEMBERS = 10_000
# Larger numbers are input errors, and would take too long to draw.
MOST_SEGMENTS, MOST_MODELS, MOST_FACETS = 20, 50, 20
# This suffices for one minute of measured accelerations at 1 kHz.
MOST_TIMES = 100_000


def _check_modes(value: Any) -> Any:
    """Check a number of modes or ``auto``. A union type would give two messages."""
    if value == "auto" or (isinstance(value, int) and not isinstance(value, bool) and value > 0):
        return value
    raise PydanticCustomError("modes", "a whole number above 0, or 'auto'")


Modes = Annotated[
    int | Literal["auto"],
    BeforeValidator(
        _check_modes, json_schema_input_type=Annotated[int, Field(gt=0)] | Literal["auto"]
    ),
]


# With a smaller tolerance the mesh is too fine for one machine.
LEAST_CONTACT_TOLERANCE = 1.0e-3


def _check_contact_tolerance(value: Any) -> Any:
    """Check a fraction or ``any``. A union type would give two messages instead of one."""
    number = isinstance(value, float) and LEAST_CONTACT_TOLERANCE <= value < 1.0
    if value == "any" or number:
        return value
    raise PydanticCustomError(
        "contact_tolerance",
        "a number from {least} to below 1, or 'any'",
        {"least": f"{LEAST_CONTACT_TOLERANCE:g}"},
    )


ContactTolerance = Annotated[
    float | Literal["any"],
    In("1"),
    BeforeValidator(_check_contact_tolerance, json_schema_input_type=Part | Literal["any"]),
]


def share_of(value: Any) -> float | None:
    """Return the number of a text in percent such as ``2 %``; None for any other value."""
    text = value if isinstance(value, str) else ""
    share = re.fullmatch(r"\s*([+-]?\d*\.?\d+)\s*%\s*", text)
    return share and 0.01 * float(share[1])


def _check_length_or_share(value: Any, check: ValidatorFunctionWrapHandler) -> Any:
    """Check a length, or the number of a share. A union type would give two messages."""
    share = share_of(value)
    return check(value) if share is None else check(share) and value


if TYPE_CHECKING:
    LengthOrShare = float | str
else:
    LengthOrShare = Annotated[
        Positive,
        In("m"),
        WrapValidator(_check_length_or_share),
        PlainSerializer(lambda value: value),
    ]


class LimitsTable(CaseTable):
    """Limits of results; the exit status of a run is 1 if its leading model exceeds one."""

    tip: Annotated[Positive, In("m")] | None = None
    """the largest permitted tip deflection in m, of the motion"""
    tip_at_rest: LengthOrShare | None = None
    """the largest permitted static tip deflection in m, or as text such as '2 %' its share of the
    length from the foot to the tip, in each load case that of its boom"""
    tip_lateral: Annotated[Positive, In("m")] | None = None
    """the largest permitted lateral tip deflection in m, of the motion; only in space"""
    stress: Annotated[Positive, In("Pa")] | None = None
    """the largest permitted bending stress in Pa, axial in outer fibres"""
    wall_stress: Annotated[Positive, In("Pa")] | None = None
    """the largest permitted local plate stress of a shell in Pa, a mean over a patch"""
    pad_pressure: Annotated[Positive, In("Pa")] | None = None
    """the largest permitted pressure of a pad in Pa"""
    first_frequency: Annotated[Positive, In("Hz")] | None = None
    """the least permitted first natural frequency in Hz"""
    decay_time: Annotated[Positive, In("s")] | None = None
    """the longest permitted time in s in which modal damping leaves a tenth of the vibration"""
    settling_time: Annotated[Positive, In("s")] | None = None
    """the longest permitted time in s until the tip stays near its final mean"""

    # The quantities whose limit is the smallest permitted value.
    LEAST: ClassVar = frozenset({"first_frequency"})

    def tip_of(self, length: float) -> float | None:
        """Return the largest static tip deflection in m of a boom of a length in m, if limited."""
        tip = self.tip_at_rest
        return (share_of(tip) or 0.0) * length if isinstance(tip, str) else tip
