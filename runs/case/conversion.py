# SPDX-License-Identifier: LGPL-3.0-or-later
"""Conversion of a case to SI units. Each field of the schema declares its unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields
from fractions import Fraction
from typing import Any

from runs.case.limits import CaseTable, map_tables, units_of
from runs.case.schema import Case
from runs.case.units import System, scale


def convert_to_si(case: Case) -> Case:
    """Return the case in SI units; ``shown_units`` keeps the original units for display.

    Args:
        case: a case without references to files.

    Raises:
        OverflowError: a number overflows in SI units.
    """
    if case.units == "SI":
        return case
    system = System(case.units)
    laws = [joint.exponent for joint in case.joints]
    exponents = {}
    for number, model in enumerate(case.models, start=1):
        own = [] if model.contact is None else [model.contact.exponent_of("stiffness")]
        exponents[f"model[{number}]"] = next(iter([*own, *laws]), None) or 2.0

    def convert(key: str, table: Any) -> dict[str, Any]:
        # Defaults are in SI units.
        if isinstance(table, CaseTable):
            names = table.model_fields_set
        else:
            names = {one.name for one in fields(table) if getattr(table, one.name) != one.default}
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
