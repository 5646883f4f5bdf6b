# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results as two files: their numbers, bare, and JSON that tells what these are.

All comes back to the last bit, tuples as tuples, and this program's dataclasses, named tuples and
pydantic models as what they were, checks of their own included. Files hold data alone: whoever
writes them has no say in what runs when they are read, other than which of these classes are made
of what.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from importlib import import_module
from typing import Any, Literal, TypeVar

import numpy as np
import xarray as xr
from pydantic import BaseModel

from runs.folder.versions import packages

_RECORD = "record.json"
_NUMBERS = "numbers.bin"

# Of arrays: booleans, numbers, texts.
_KINDS = "biufcU"

# Arrays begin at multiples of as many bytes.
_ALIGNED = 64

Kind = TypeVar("Kind")


def pack(thing: Any) -> dict[str, Sequence[bytes | memoryview]]:
    """The files of a result, each as its parts.

    Args:
        thing: a dataclass, a dataset, an array, a number, a text, or made of these.

    Raises:
        TypeError: there is something else in it.
    """
    numbers = _Numbers()
    record = json.dumps(_written(thing, numbers)).encode()
    return {_RECORD: [record], _NUMBERS: numbers.parts}


def unpack(files: Mapping[str, memoryview], kind: type[Kind]) -> Kind:
    """A result of a class from its files, of whose memory its arrays are parts.

    Raises:
        Exception: the files are no record, or one of another class.
    """
    thing = _read(json.loads(bytes(files[_RECORD])), files[_NUMBERS])
    if not isinstance(thing, kind):
        raise ValueError(f"the record is no {kind.__qualname__}")
    return thing


class _Numbers:
    """Arrays one after the other."""

    def __init__(self) -> None:
        self.parts: list[bytes | memoryview] = []
        self._size = 0

    def add(self, array: np.ndarray[Any, Any]) -> list[Any]:
        """Put an array behind the others; type, shape, first byte and order."""
        order: Literal["C", "F"]
        order = "C" if array.flags.c_contiguous or not array.flags.f_contiguous else "F"
        data = array.ravel(order).view(np.uint8).data
        gap = -self._size % _ALIGNED
        first = self._size + gap
        self.parts += [bytes(gap), data]
        self._size = first + len(data)
        return [array.dtype.str, array.shape, first, order]


def _written(thing: Any, numbers: _Numbers) -> Any:
    """The thing in JSON's terms, its arrays by their number."""
    if thing is None or isinstance(thing, bool | int | float | str):
        return thing
    if isinstance(thing, np.generic):
        return thing.item()
    if isinstance(thing, np.ndarray) and thing.dtype.kind in _KINDS:
        return {"array": numbers.add(thing)}
    if isinstance(thing, xr.Dataset):
        variables = {
            str(name): (variable.dims, variable.values, variable.attrs)
            for name, variable in thing.variables.items()
        }
        content = [variables, [str(name) for name in thing.coords], thing.attrs]
        return {"dataset": _written(content, numbers)}
    if isinstance(thing, Mapping):
        entries = [
            [_written(name, numbers), _written(value, numbers)] for name, value in thing.items()
        ]
        return {"mapping": entries}
    if (names := _names(type(thing))) is not None:
        # Of a pydantic model, what was never set stays so.
        own = thing.model_fields_set if isinstance(thing, BaseModel) else names
        parts = {name: _written(getattr(thing, name), numbers) for name in names if name in own}
        return {"record": [type(thing).__module__, type(thing).__name__], "parts": parts}
    if isinstance(thing, list | tuple):
        return {type(thing).__name__: [_written(part, numbers) for part in thing]}
    raise TypeError(f"{type(thing).__qualname__} cannot be kept: it is no data")


def _read(written: Any, numbers: memoryview) -> Any:
    match written:
        case None | bool() | int() | float() | str():
            return written
        case {"array": [str(dtype), list(shape), int(first), "C" | "F" as order]}:
            return np.ndarray(shape, dtype, numbers, first, order=order)
        case {"dataset": content}:
            variables, coordinates, attributes = _read(content, numbers)
            # Their order is that of a file that they are written to.
            return xr.Dataset(variables, attrs=attributes).set_coords(coordinates)
        case {"mapping": list(entries)}:
            return {_read(name, numbers): _read(value, numbers) for name, value in entries}
        case {"list": list(parts)}:
            return [_read(part, numbers) for part in parts]
        case {"tuple": list(parts)}:
            return tuple(_read(part, numbers) for part in parts)
        case {"record": [str(module), str(name)], "parts": dict(parts)}:
            return _class(module, name)(**{key: _read(v, numbers) for key, v in parts.items()})
    raise ValueError("no record")


def _class(module: str, name: str) -> type:
    """One of this program's classes that are nothing but their parts."""
    if module.partition(".")[0] in {package.name for package in packages()}:
        found = vars(import_module(module)).get(name)
        if isinstance(found, type) and found.__module__ == module and _names(found) is not None:
            return found
    raise ValueError(f"{module}.{name} is no record")


def _names(kind: type) -> list[str] | None:
    """Of the parts that make an object of a class; None of what may be more than its parts."""
    if issubclass(kind, BaseModel):
        return list(kind.model_fields)
    if is_dataclass(kind):
        return [field.name for field in fields(kind) if field.init]
    if issubclass(kind, tuple) and hasattr(kind, "_fields"):
        return list(kind._fields)
    return None
