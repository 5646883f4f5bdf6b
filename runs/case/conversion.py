# SPDX-License-Identifier: LGPL-3.0-or-later
"""Conversion of a case to SI units, by the units that the fields of its tables declare."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace
from fractions import Fraction
from typing import Any

from runs.case.limits import CaseTable, is_table, units_of
from runs.case.schema import Case
from runs.case.units import System, scaled


def in_si(case: Case) -> Case:
    """Return the case in SI units; its field ``units`` stays, for display.

    Args:
        case: a case that stands alone, without files.

    Raises:
        OverflowError: a number overflows in SI units.
    """
    if case.units == "SI":
        return case
    system = System(case.units)
    laws = [joint.exponent for joint in case.joints]
    models = []
    for model in case.models:
        own = [] if model.contact is None else [model.contact.exponent_of("stiffness")]
        models.append(_converted(model, system, next(iter([*own, *laws]), None) or 2.0))
    shown = {"units": "SI", "shown_units": case.shown_units or case.units, "models": tuple(models)}
    found: Case = _converted(case, system).model_copy(update=shown)
    return found


def _converted(table: Any, system: System, exponent: float = 2.0) -> Any:
    # Defaults are in SI units.
    if isinstance(table, CaseTable):
        keys = table.model_fields_set
    else:
        keys = {one.name for one in fields(table) if getattr(table, one.name) != one.default}
    changed = {}
    for key in keys:
        sizes = [system.size(unit) for unit in units_of(table, key, exponent)]
        changed[key] = _scaled(getattr(table, key), sizes, system, exponent)
    if isinstance(table, CaseTable):
        return table.model_copy(update=changed)
    return replace(table, **changed)


def _scaled(value: Any, sizes: Sequence[Fraction], system: System, exponent: float) -> Any:
    """Return a value of a table with all numbers scaled; several sizes apply to a row's columns."""
    if is_table(value):
        return _converted(value, system, exponent)
    if isinstance(value, dict):
        return {key: _scaled(item, sizes, system, exponent) for key, item in value.items()}
    if isinstance(value, tuple) and len(sizes) == len(value) > 1 and isinstance(value[0], float):
        return tuple(scaled(number, size) for number, size in zip(value, sizes, strict=True))
    if isinstance(value, tuple):
        return tuple(_scaled(item, sizes, system, exponent) for item in value)
    return scaled(value, sizes[0]) if isinstance(value, float) and sizes else value
