# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys that tables of a case file take from ``[segments]`` and ``[joints]``, or by ``based_on``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic.json_schema import GenerateJsonSchema

from protractile.geometry.fields import format_value
from protractile.runs.process.bad_input import BadInput

# Tables whose keys are taken one by one, and keys that replace one another.
_BY_KEY = ("pad", "material", "factors", "resistance")
_PAIRS = ("pad", "pads"), ("stroke", "extension"), ("span", "length")
_INSTEAD = {key: other for pair in _PAIRS for key, other in (pair, pair[::-1])}


def with_inherited_keys(tables: Mapping[str, Any], file: str) -> dict[str, Any]:
    """Return the tables of a case file with the keys that parts and named tables take.

    >>> with_inherited_keys({"joints": {"play": 0.002}, "joint": [{"inner": "fly"}]}, "case")
    {'joint': [{'play': 0.002, 'inner': 'fly'}]}

    Raises:
        BadInput: a table is based on none before it.
    """
    plain = dict(tables)
    for key in ("segment", "joint"):
        parts = _tables(plain.get(key))
        if parts and isinstance(plain.get(f"{key}s"), Mapping):
            common = plain.pop(f"{key}s")
            plain[key] = [_over(part, common) for part in parts]
    for key in ("load_case", "combination"):
        done: list[Mapping[str, Any]] = []
        for table in _tables(plain.get(key)):
            own = dict(table)
            if (base := own.pop("based_on", None)) is not None:
                names = [other.get("name") for other in done]
                if base not in names:
                    what = f"must be the name of a {key} before it, got {format_value(base)}"
                    raise BadInput(file, f"{key}[{len(done) + 1}].based_on", what)
                own = _over(own, done[names.index(base)])
            done.append(own)
        plain |= {key: done} if done else {}
    return plain


def schema_of_file(schema: dict[str, Any]) -> dict[str, Any]:
    """Return the JSON Schema of a case file, by that of its tables with all keys."""
    tables, keys = schema["$defs"], schema["properties"]
    for key, name, inner, required in (
        ("segment", "SegmentTable", "material", ["name"]),
        ("joint", "JointTable", "pad", ["outer", "inner"]),
    ):
        common = f"the table of keys that hold for each {key} without them, also single ones of "
        keys[f"{key}s"] = {"$ref": f"#/$defs/{name}", "description": common + inner}
        keys[key]["items"]["required"] = required
        del tables[name]["required"]
    keys["material"]["required"] = tables["Material"].pop("required")
    del tables["Pad"]["required"]
    based_on = "the name of one before it, whose keys hold unless given, also single factors"
    for name in ("LoadCaseTable", "CombinationTable"):
        tables[name]["properties"]["based_on"] = {"type": "string", "description": based_on}
        tables[name]["required"] = ["name"]
    return {"$schema": GenerateJsonSchema.schema_dialect, **schema}


def _tables(value: Any) -> list[Mapping[str, Any]]:
    """Return a value if it is a list of tables; otherwise an empty list."""
    several = isinstance(value, list) and all(isinstance(item, Mapping) for item in value)
    return value if several else []


def _over(own: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, Any]:
    """Return a table with the keys that it leaves out from another one."""
    left = {key: value for key, value in other.items() if _INSTEAD.get(key) not in own}
    whole = {**left, **own}
    for key in _BY_KEY:
        if isinstance(left.get(key), Mapping) and isinstance(whole[key], Mapping):
            whole[key] = {**left[key], **whole[key]}
    return whole
