# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error messages on user input: one line that names the key, the error and the remedy."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from difflib import get_close_matches
from typing import Any

from pydantic import ValidationError

from protractile.geometry.fields import (
    MESSAGES,
    NAME,
    UNKNOWN,
    VALID_INPUT,
    VALID_NAME,
    BoomError,
    describe,
    fields_of,
    format_value,
    names_of,
)
from protractile.geometry.typography import choices
from protractile.geometry.units import System
from protractile.runs.case import schema
from protractile.runs.case.kinds import KINDS
from protractile.runs.case.limits import key_of, tables_in
from protractile.runs.case.load_tables import AxialTable, HistoryTable
from protractile.runs.case.sections import SHAPES
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.terminal import shorten

# Key of the case file for each attribute of a boom.
_PARTS = {f"{key}s": key for key in ("segment", "joint", "load", "stop", "cylinder")}
_PARTS["observations"] = "observe"
# Keys for other names that engineers use. A key without a dot applies where the table has it.
_SYNONYMS = {
    "overlap": "extension", "clearance": "play", "gap": "play", "angle": "gravity.angle",
    "luffing_angle": "gravity.angle", "e": "youngs_modulus", "e_modulus": "youngs_modulus",
    "modulus": "youngs_modulus", "nu": "poissons_ratio", "rho": "density", "fy": "yield_strength",
    "force": "magnitude", "value": "magnitude", "inertia": "second_moment_of_area",
    "friction_coefficient": "friction", "mu": "friction", "position": "x", "at": "x",
    "location": "x", "t": "thickness", "thickness": "flange", "h": "height", "b": "width",
    "depth": "height", "k": "stiffness", "pulse": "half_sine", "rise_time": "ramp",
    "damping": "damping_ratio", "tip_mass": "payload.mass",
    "g": "gravity.acceleration",
}  # fmt: skip

# Advice on unknown keys of a table.
_ADVICE = {
    "pad.position": "a pad is one of a mirrored pair; give offset, its distance from the corner",
    "load.mass": "give magnitude, -m g cos(luffing angle) in N, or the table payload",
}


@contextmanager
def translated_errors(file: str, system: System | None = None) -> Iterator[None]:
    """Raise errors in the tables and in the boom of a case file as :class:`BadInput`.

    ``system`` has the units of the case, SI unless given. If a misspelled key causes two errors,
    the message is on the unknown key, not the missing one.
    """
    try:
        yield
    except ValidationError as error:
        faults = error.errors(include_url=False)
        first = next((f for f in faults if f["type"] in UNKNOWN), faults[0])
        explained = _explain(first["type"], first["loc"], first["input"], first.get("ctx"), system)
        raise BadInput(file, *explained) from None
    except BoomError as error:
        raise BadInput(file, key_of_part(error.where), error.what) from None


def key_of_part(where: str) -> str:
    """Return the key of a boom's part: ``segment[2].span`` for ``segments[1].start``."""
    part = re.split(r"\W", where)[0]
    if part not in _PARTS:
        return where
    key = _PARTS[part] + where.removeprefix(part)
    key = re.sub(r"\[(\d+)\]", lambda match: f"[{int(match[1]) + 1}]", key)
    return re.sub(r"\.start$", ".span", key)


def _explain(
    fault: str,
    location: tuple[int | str, ...],
    value: Any,
    context: Mapping[str, Any] | None,
    system: System | None,
) -> tuple[str, str]:
    """Return the key and the message of a validation error."""
    key = _key(location)
    units = system or System()
    limits = {"m": units.unit("m"), "near": f"{units.of(0.2, 'm'):g}"} | dict(context or {})
    if fault == "missing" and isinstance(location[-1], int):
        return _key(location[:-1]), f"must be {_pair(location)}, got {format_value(value)}"
    if fault == "missing":
        return key, f"missing; it is {describe(*_field(location))}"
    if fault == "union_tag_not_found":
        return f"{key}.kind", f"missing; give {choices([*KINDS])}"
    if fault in UNKNOWN:
        return key, _unknown_key(location)
    if fault == "union_tag_invalid":
        tag, tags = ("kind", [*KINDS]) if location[0] == "model" else ("shape", [*SHAPES])
        return f"{key}.{tag}", f"must be {choices(tags)}, got {format_value(value[tag])}"
    if fault == "too_short" and limits["min_length"] == 1:
        return key, "empty; give at least one"
    if fault == "too_long" and limits["max_length"] == 2:
        must = _pair(location)
    elif fault in MESSAGES:
        return key, MESSAGES[fault].format(**limits)
    elif fault == "string_pattern_mismatch" and limits["pattern"] == NAME:
        must = VALID_NAME
    elif fault == "string_pattern_mismatch":
        must = "a line of printable characters"
    elif fault == "tuple_type" and key in names_of(schema.Case):
        must = f"an array of tables, each headed [[{key}]]"
    elif fault.startswith(("model_", "dict_", "dataclass_")):
        must = "a table"
    else:
        must = VALID_INPUT[fault].format(**limits)
    return key, f"must be {must}, got {format_value(value)}"


def _pair(location: Sequence[int | str]) -> str:
    kinds = {"columns": "names", "force_columns": "names", "pins": "pins"}
    return f"a list of two {next((kinds[step] for step in location if step in kinds), 'numbers')}"


def _key(location: Sequence[int | str]) -> str:
    """Return the key of a path in the schema, whose steps include the kinds of some tables."""
    steps = list(location)
    if len(steps) > 2 and steps[0] == "model":
        del steps[2]
    for key in ("section", "head_section", "calibrated_by"):
        if key in steps[:-1]:
            del steps[steps.index(key) + 1]
    return key_of(steps)


def _table(location: Sequence[int | str]) -> type:
    """Return the class of the innermost table of a path."""
    names = [step for step in location[:-1] if isinstance(step, str)]
    if names[:2] == ["start", "velocity"]:
        # The next step of the path is the name of a segment.
        del names[2:]
    return _TABLES[names[-1]] if names else schema.Case


def _tables(table: type) -> Iterator[tuple[str, type]]:
    """Yield key and class of each table within a table, at all levels."""
    for key, name in names_of(table).items():
        for inner in tables_in(fields_of(table)[name].annotation):
            yield key, inner
            yield from _tables(inner)


def _field(location: Sequence[int | str]) -> tuple[type, str]:
    """Return the class and the name of the field at a path."""
    table = _table(location)
    return table, names_of(table)[str(location[-1])]


def _unknown_key(location: Sequence[int | str]) -> str:
    table, key = _table(location), str(location[-1])
    keys = list(names_of(table))
    if table is AxialTable and key in HistoryTable.model_fields:
        return "an axial force is constant; give it at its largest, or one [[load_case]] per value"
    heading = next((step for step in reversed(location[:-1]) if isinstance(step, str)), "")
    if (advice := _ADVICE.get(f"{heading}.{key}")) is not None:
        return f"unknown key; {advice}"
    synonym = _SYNONYMS.get(key.lower(), "")
    if "." in synonym:
        return f"unknown key; use {synonym}"
    if synonym in keys:
        return f"unknown key; use {synonym}, {describe(table, names_of(table)[synonym])}"
    near = [known for known in keys if sorted(known.split("_")) == sorted(key.split("_"))]
    near = near or get_close_matches(shorten(key), keys, n=1)
    if near:
        return f"unknown key; the nearest known one is {near[0]}"
    return f"unknown key; known ones are {', '.join(keys)}"


_TABLES = {**dict(_tables(schema.Case)), **SHAPES, **KINDS}
