# SPDX-License-Identifier: LGPL-3.0-or-later
"""Records: results as a line of JSON, followed by arrays in the format of numpy.

Tuples, dataclasses, named tuples and pydantic models of this program are restored exactly, with
validation. Files contain only data: an untrusted file cannot run code.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from typing import IO, Any, Protocol, TypeVar

import numpy as np
import xarray as xr
from pydantic import BaseModel

from runs.folder.versions import packages

# Permitted kinds of arrays: booleans, numbers, texts.
_KINDS = "biufcU"

Kind = TypeVar("Kind")


class Writable(Protocol):
    """Destination of bytes, such as a file."""

    def write(self, data: bytes, /) -> object:
        """Write more bytes."""
        ...


def write(thing: Any, file: Writable) -> None:
    """Write a record.

    Args:
        thing: a dataclass, a dataset, an array, a number, a text, or a combination of these.
        file: the destination.

    Raises:
        TypeError: the object contains another type.
    """
    arrays: list[np.ndarray[Any, Any]] = []
    file.write(json.dumps(_encode(thing, arrays)).encode() + b"\n")
    for array in arrays:
        np.lib.format.write_array(file, array, allow_pickle=False)


def read(file: IO[bytes], kind: type[Kind]) -> Kind:
    """Return the object that a file contains as a record.

    Raises:
        Exception: the file is not a record of the class ``kind``.
    """
    thing = _decode(json.loads(file.readline()), file)
    if not isinstance(thing, kind):
        raise ValueError(f"the record is no {kind.__qualname__}")
    return thing


def _encode(thing: Any, arrays: list[np.ndarray[Any, Any]]) -> Any:
    """Return an object as JSON data, and append its arrays to ``arrays``."""
    if thing is None or isinstance(thing, bool | int | float | str):
        return thing
    if isinstance(thing, np.generic):
        return thing.item()
    if isinstance(thing, np.ndarray) and thing.dtype.kind in _KINDS:
        arrays.append(thing)
        return {"array": thing.shape}
    if isinstance(thing, xr.Dataset):
        variables = {
            str(name): (variable.dims, variable.values, variable.attrs)
            for name, variable in thing.variables.items()
        }
        content = [variables, [str(name) for name in thing.coords], thing.attrs]
        return {"dataset": _encode(content, arrays)}
    if isinstance(thing, Mapping):
        entries = [[_encode(name, arrays), _encode(value, arrays)] for name, value in thing.items()]
        return {"mapping": entries}
    if (names := _names(type(thing))) is not None:
        # Of a pydantic model, only the fields that are set are written.
        present = thing.model_fields_set if isinstance(thing, BaseModel) else names
        parts = {name: _encode(getattr(thing, name), arrays) for name in names if name in present}
        return {"record": [type(thing).__module__, type(thing).__name__], "parts": parts}
    if isinstance(thing, list | tuple):
        return {type(thing).__name__: [_encode(part, arrays) for part in thing]}
    raise TypeError(f"{type(thing).__qualname__} cannot be kept: it is no data")


def _decode(encoded: Any, file: IO[bytes]) -> Any:
    """Return the object that JSON data describe, with its arrays from the file."""
    match encoded:
        case None | bool() | int() | float() | str():
            return encoded
        case {"array": _}:
            return np.lib.format.read_array(file, allow_pickle=False)
        case {"dataset": content}:
            variables, coordinates, attributes = _decode(content, file)
            # Coordinates are set afterwards, so that variables keep their order.
            return xr.Dataset(variables, attrs=attributes).set_coords(coordinates)
        case {"mapping": list(entries)}:
            return {_decode(name, file): _decode(value, file) for name, value in entries}
        case {"list": list(parts)}:
            return [_decode(part, file) for part in parts]
        case {"tuple": list(parts)}:
            return tuple(_decode(part, file) for part in parts)
        case {"record": [str(module), str(name)], "parts": dict(parts)}:
            return _class(module, name)(**{key: _decode(v, file) for key, v in parts.items()})
    raise ValueError("no record")


def _class(module: str, name: str) -> type:
    """Return a class of this program, or raise ValueError if its objects have more than fields."""
    if module.partition(".")[0] in {package.name for package in packages()}:
        content = vars(import_module(module)).get(name)
        if (
            isinstance(content, type)
            and content.__module__ == module
            and _names(content) is not None
        ):
            return content
    raise ValueError(f"{module}.{name} is no record")


def _names(kind: type) -> list[str] | None:
    """Return the field names of a class; None if its objects may have further data."""
    if issubclass(kind, BaseModel):
        return list(kind.model_fields)
    if is_dataclass(kind):
        return [field.name for field in fields(kind) if field.init]
    if issubclass(kind, tuple) and hasattr(kind, "_fields"):
        return list(kind._fields)
    return None
