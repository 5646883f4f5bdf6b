# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers of a case file in the units of the case, or as text with a unit of their own.

A text such as ``"150 kg"`` becomes a number in the units of the case before the case is validated.
Its unit is checked afterwards: that of some keys depends on other keys.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import fields
from fractions import Fraction
from typing import Any, NamedTuple, get_args

from protractile.geometry.fields import AMOUNT, declared_units, fields_of, format_value, names_of
from protractile.geometry.units import System, SystemName, Unit, scale
from protractile.runs.case.limits import (
    CaseTable,
    Steps,
    is_table,
    key_of,
    map_tables,
    share_of,
    tables_in,
    units_of,
)
from protractile.runs.case.schema import PLAIN_NUMBER_KEYS, Case
from protractile.runs.process.bad_input import BadInput


class Amount(NamedTuple):
    """A number of a case file with its unit."""

    steps: Steps  #: path of keys and indices to the number
    text: str  #: the number and its unit
    unit: Unit  #: the unit


# Expected quantities in messages, by their units.
_QUANTITIES = {
    "m": "a length", "kg": "a mass", "s": "a time", "N": "a force", "m/s": "a speed",
    "Pa": "a pressure or stress", "deg": "an angle",
}  # fmt: skip


def system_of(tables: Mapping[str, Any]) -> System:
    """Return the system of units of a case file; SI in place of an unknown one."""
    # Another name is refused afterwards.
    known = (name for name in get_args(SystemName) if name == tables.get("units"))
    return System(next(known, "SI"))


def read_amounts(tables: Mapping[str, Any], file: str) -> tuple[dict[str, Any], list[Amount]]:
    """Return the tables of a case file with numbers in the units of the case, and the texts.

    >>> read_amounts({"units": "mm-t-s", "payload": {"mass": "150 kg"}}, "case")[0]["payload"]
    {'mass': 0.15}

    Raises:
        BadInput: a unit is unknown, missing, or of another quantity than its key always has.
    """
    amounts: list[Amount] = []
    system = system_of(tables)

    def number(text: str, steps: Steps, units: Sequence[str]) -> Any:
        if (match := re.fullmatch(AMOUNT, text)) is None:
            if re.fullmatch(AMOUNT, f"{text} -"):
                what = f"has no unit; give one, or the number without quotes, got {text!r}"
                raise BadInput(file, key_of(steps), what)
            return text
        try:
            unit = Unit.of(match[2].replace("°", "deg"))
            length, mass, _ = unit.dimension
            size = Fraction(repr(unit.factor)) / system.size(f"m^{length:g} kg^{mass:g}")
            value = Fraction(match[1]) * size
        except (ValueError, ArithmeticError):
            what = "must have a known unit such as mm, kg, kN or MPa"
            if re.search(r"[\s+*×x]\s*\d", match[2]):
                what = "must be one number with one unit"
            raise BadInput(file, key_of(steps), f"{what}, got {format_value(text)}") from None
        amounts.append(Amount(steps, text, unit))
        # The limits of a key hold in its unit. Several units are checked after the limits.
        if len(units) == 1 and not re.search(r"\^\(?n", units[0]):
            _check_unit(amounts[-1], units[0], system, file)
        return float(value)

    def read(item: Any, steps: Steps, inside: Sequence[type], units: Sequence[str]) -> Any:
        """Return a value with numbers; ``inside`` are the classes that its table may have."""
        if isinstance(item, list):
            return [read(part, (*steps, i), inside, units) for i, part in enumerate(item)]
        if steps == ("limits", "tip_at_rest") and share_of(item) is not None:
            return item
        if isinstance(item, str):
            plain = units or not PLAIN_NUMBER_KEYS.keys().isdisjoint(inside)
            return number(item, steps, units) if plain else item
        if not isinstance(item, Mapping):
            return item
        parts = {}
        for key, value in item.items():
            known = [fields_of(one)[names_of(one)[key]] for one in inside if key in names_of(one)]
            # Without a field, the key is a name, such as that of a segment with a velocity.
            classes = [one for field in known for one in tables_in(field.annotation)]
            own = [*dict.fromkeys(unit for field in known for unit in declared_units(field))]
            # The unit may depend on another key.
            own *= 2 if any("declared_units" in vars(one) for one in inside) else 1
            parts[key] = read(value, (*steps, key), classes if known else inside, own or units)
        return parts

    plain: dict[str, Any] = read(tables, (), [Case], [])
    return plain, amounts


def check_amounts(case: Case, amounts: Sequence[Amount], file: str) -> None:
    """Check that numbers of a case, in the units of its file, have units of their keys.

    Raises:
        BadInput: a unit is one of another quantity.
    """
    for amount in amounts:
        steps = amount.steps
        # A normal distribution has the unit of its number.
        path = steps[:-1] if steps[-1] in ("mean", "sd") else steps
        units = units_of(*innermost(path, case), _exponents(case).get(key_of(path[:2]), 2.0))
        column = path[-1] if len(units) > 1 else 0
        expected = units[column] if isinstance(column, int) else units[0]
        _check_unit(amount, expected, System(case.units), file)


def _check_unit(amount: Amount, expected: str, system: System, file: str) -> None:
    steps, text, unit = amount
    angles = [set(re.findall("deg|rad|°", one)) for one in (expected, text.replace("°", "deg"))]
    if unit.dimension != Unit.of(expected).dimension or angles[0] != angles[1]:
        name = "%" if expected == "1" else system.unit(expected)
        what = f"in {name} or another unit of the kind"
        if expected in _QUANTITIES:
            what = f"{_QUANTITIES[expected]}, such as in {name}"
        raise BadInput(file, key_of(steps), f"must be {what}, got {format_value(text)}")


def innermost(steps: Steps, case: Case) -> tuple[Any, str]:
    """Return the innermost table of a case that contains a number, and the field in this table."""
    table: Any = case
    name, here = "", table
    for step in steps:
        if is_table(here):
            table, name = here, names_of(type(here))[str(step)]
            here = getattr(table, name)
        else:
            here = here[step]
    key = PLAIN_NUMBER_KEYS.get(type(here))
    return (table, name) if key is None else (here, key)


def _exponents(case: Case) -> dict[str, float]:
    """Return the exponent of the contact laws within each model that give none, by its key."""
    laws = [joint.exponent for joint in case.joints]
    exponents = {}
    for number, model in enumerate(case.models, start=1):
        own = [] if model.contact is None else [model.contact.exponent_of("stiffness")]
        exponents[f"model[{number}]"] = next(iter([*own, *laws]), None) or 2.0
    return exponents


def convert_to_si(case: Case) -> Case:
    """Return a case without files in SI units; ``shown_units`` keeps the original ones for display.

    Raises:
        OverflowError: a number overflows in SI units.
    """
    if case.units == "SI":
        return case
    system, exponents = System(case.units), _exponents(case)

    def convert(key: str, table: Any) -> dict[str, Any]:
        # Defaults are in SI units.
        if isinstance(table, CaseTable):
            names = table.model_fields_set
        else:
            names = {
                attribute.name
                for attribute in fields(table)
                if getattr(table, attribute.name) != attribute.default
            }
        exponent, converted = exponents.get(key.partition(".")[0], 2.0), {}
        for name in names:
            if sizes := [system.size(unit) for unit in units_of(table, name, exponent)]:
                converted[name] = _convert_value(getattr(table, name), sizes)
        return converted

    changes = {"units": "SI", "shown_units": case.shown_units or case.units}
    converted: Case = map_tables(case, convert).model_copy(update=changes)
    return converted


def _convert_value(value: Any, sizes: Sequence[Fraction]) -> Any:
    """Return a value in SI units; of several unit sizes, each converts one item of a tuple."""
    if isinstance(value, dict):
        return {key: _convert_value(item, sizes) for key, item in value.items()}
    if isinstance(value, tuple) and len(sizes) == len(value) > 1 and isinstance(value[0], float):
        return tuple(scale(number, size) for number, size in zip(value, sizes, strict=True))
    if isinstance(value, tuple):
        return tuple(_convert_value(item, sizes) for item in value)
    return scale(value, sizes[0]) if isinstance(value, float) else value
