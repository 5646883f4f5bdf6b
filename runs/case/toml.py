# SPDX-License-Identifier: LGPL-3.0-or-later
"""Writer of cases as TOML. Reading the text gives the same case."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from typing import Any

from protractile.runs.case.schema import Case

_BARE = re.compile(r"[A-Za-z0-9_-]+")


def dumps(case: Case) -> str:
    """Return the case as TOML, defaults included; values that are None are omitted."""
    data = case.model_dump(by_alias=True, exclude_none=True)
    return "\n".join(_table(data, "")) + "\n"


def digest(case: Case) -> str:
    """Return the SHA-256 of the case's TOML text, in hexadecimal digits."""
    return hashlib.sha256(dumps(case).encode()).hexdigest()


def _table(table: Mapping[str, Any], path: str) -> Iterator[str]:
    """Yield the lines of a table: plain values first, as TOML requires, then nested tables."""
    nested = {
        key: value
        for key, value in table.items()
        if isinstance(value, Mapping)
        or (value and isinstance(value, tuple) and all(isinstance(item, Mapping) for item in value))
    }
    for key, value in table.items():
        if key not in nested:
            yield f"{_key(key)} = {_value(value)}"
    for key, value in nested.items():
        inner = f"{path}{_key(key)}"
        heading = f"[{inner}]" if isinstance(value, Mapping) else f"[[{inner}]]"
        for entry in [value] if isinstance(value, Mapping) else value:
            yield f"\n{heading}"
            yield from _table(entry, f"{inner}.")


def _key(name: str) -> str:
    """Return a key as TOML, quoted if needed. Names of segments occur as keys of velocities."""
    return name if _BARE.fullmatch(name) else _value(name)


def _value(value: bool | int | float | str | tuple[Any, ...] | Mapping[str, Any]) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        # TOML has the escapes of JSON, and requires that DEL is escaped, too.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        inside = ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items())
        return f"{{ {inside} }}"
    if isinstance(value, tuple):
        return f"[{', '.join(_value(item) for item in value)}]"
    short = f"{value:g}"
    return short if "e" in short and float(short) == value else repr(value)
