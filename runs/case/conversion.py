# SPDX-License-Identifier: LGPL-3.0-or-later
"""Conversion of a case to SI units. Each field of the schema declares its unit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction
from typing import Any

from runs.case.limits import CaseTable, is_table, units_of
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
    models = []
    for model in case.models:
        contact_exponents = (
            [] if model.contact is None else [model.contact.exponent_of("stiffness")]
        )
        models.append(_convert(model, system, next(iter([*contact_exponents, *laws]), None) or 2.0))
    changes = {
        "units": "SI",
        "shown_units": case.shown_units or case.units,
        "models": tuple(models),
    }
    converted: Case = _convert(case, system).model_copy(update=changes)
    return converted


def _convert(table: Any, system: System, exponent: float = 2.0) -> Any:
    # Defaults are in SI units.
    if isinstance(table, CaseTable):
        keys = table.model_fields_set
    else:
        keys = {one.name for one in fields(table) if getattr(table, one.name) != one.default}
    changed = {}
    for key in keys:
        sizes = [system.size(unit) for unit in units_of(table, key, exponent)]
        changed[key] = _convert_value(getattr(table, key), sizes, system, exponent)
    if isinstance(table, CaseTable):
        return table.model_copy(update=changed)
    return replace(table, **changed)


def _convert_value(value: Any, sizes: Sequence[Fraction], system: System, exponent: float) -> Any:
    """Return a value in SI units; several sizes convert the numbers of a tuple one by one."""
    if is_table(value):
        return _convert(value, system, exponent)
    if isinstance(value, dict):
        return {key: _convert_value(item, sizes, system, exponent) for key, item in value.items()}
    if isinstance(value, tuple) and len(sizes) == len(value) > 1 and isinstance(value[0], float):
        return tuple(scale(number, size) for number, size in zip(value, sizes, strict=True))
    if isinstance(value, tuple):
        return tuple(_convert_value(item, sizes, system, exponent) for item in value)
    return scale(value, sizes[0]) if isinstance(value, float) and sizes else value
