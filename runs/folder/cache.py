# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cache of results under the hash of their inputs.

An entry is a file. Its first line is the SHA-256 of its key and content, by which disk errors and
foreign files are detected. Entries are written atomically and never change. The cache removes the
least recently used entries.

The content is a record: results as a line of JSON, followed by arrays in the format of numpy.
Tuples, dataclasses, named tuples and pydantic models of this program are restored exactly, with
validation. Records contain only data: an untrusted file cannot run code.
"""

from __future__ import annotations

import fcntl
import json
import os
import stat
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from dataclasses import dataclass, fields, is_dataclass, replace
from hashlib import file_digest, sha256
from importlib import import_module
from io import BufferedIOBase, BytesIO
from pathlib import Path
from struct import Struct
from time import perf_counter
from typing import IO, TYPE_CHECKING, Any, TypeVar

import numpy as np
import xarray as xr
from pydantic import BaseModel

from protractile.runs.folder.files import atomic_path
from protractile.runs.folder.versions import program
from protractile.runs.process.terminal import NOTICES, shorten

if TYPE_CHECKING:
    from mpi4py import MPI

    from protractile.shell_model.reduced_shell import ReducedShell

Entry = TypeVar("Entry")

# Maximum total size of all entries in bytes.
MAX_SIZE = 4 * 1024**3

# Environment variable that replaces the user's cache folder.
VARIABLE = "PROTRACTILE_CACHE"

# Fields of struct flock in Linux: type, whence, start, length, process.
_LOCK = Struct("hhqqi4x")

_SUFFIX = ".record"
# Number of bytes of the line with the checksum.
_HEAD = 65

# Permitted kinds of arrays: booleans, numbers, texts.
_KINDS = "biufcU"

Kind = TypeVar("Kind")


def key(*content: Any) -> str:
    """Return the key of an entry: the SHA-256 of its inputs and of the version of the program.

    Raises:
        TypeError: an input is of a type that :func:`write_record` does not write.
    """
    record = BytesIO()
    write_record((content, program()), record)
    return sha256(record.getbuffer()).hexdigest()


@dataclass(frozen=True, slots=True)
class Cache:
    """A folder of entries with their keys as names."""

    folder: Path  #: folder of the entries, which is created with the first entry

    @classmethod
    def of_user(cls) -> Cache | None:
        """Return the cache in ``$PROTRACTILE_CACHE``, or in the cache folder of the user.

        Print a notice and return None if there is no home folder.
        """
        if path := os.environ.get(VARIABLE):
            return cls(Path(path))
        try:
            caches = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        except RuntimeError:
            NOTICES.warning(
                "there is no home folder, and results are not kept for later runs; give a "
                "folder in %s, or --no-cache",
                VARIABLE,
            )
            return None
        return cls(Path(caches) / "protractile")

    def load(self, key: str, kind: type[Entry]) -> Entry | None:
        """Return the entry of a key, of the class ``kind``; None if it is missing or damaged."""
        entry = self._entry(key)
        # The entry may belong to another user.
        with suppress(OSError):
            os.utime(entry)
        if not entry.is_file():
            return None
        try:
            with entry.open("rb") as file:
                if file.read(_HEAD) == _head(key, file):
                    file.seek(_HEAD)
                    return read_record(file, kind)
        except MemoryError:
            raise
        except FileNotFoundError:
            return None
        except Exception:
            # The file may be damaged, or come from elsewhere.
            pass
        NOTICES.warning("%s: is damaged; it is removed and computed again", shorten(str(entry)))
        with suppress(OSError):
            entry.unlink()
        return None

    @contextmanager
    def entry_lock(self, key: str) -> Iterator[None]:
        """Lock an entry, so that other processes and threads wait until it is computed.

        There is no lock if the cache is not writable.
        """
        with ExitStack() as stack:
            with suppress(OSError):
                self.folder.mkdir(parents=True, exist_ok=True)
                # A pipe of this name would block without O_NONBLOCK.
                flags = os.O_WRONLY | os.O_CREAT | os.O_NONBLOCK
                lock = os.open(self.folder / ".lock", flags, 0o666)
                stack.callback(os.close, lock)
                # Each entry locks its own byte of a file, so that no lock files remain. The lock
                # belongs to the open file, so that it holds between threads, too.
                byte = _LOCK.pack(fcntl.F_WRLCK, os.SEEK_SET, int(key[:15], 16), 1, 0)
                fcntl.fcntl(lock, fcntl.F_OFD_SETLKW, byte)
            yield

    def store(self, key: str, thing: Any) -> None:
        """Store an entry.

        Raises:
            OSError: the entry cannot be written.
            TypeError: the object is of a type that records do not have.
        """
        with atomic_path(self._entry(key)) as part, part.open("w+b") as file:
            file.write(bytes(_HEAD))
            write_record(thing, file)
            file.seek(_HEAD)
            head = _head(key, file)
            file.seek(0)
            file.write(head)

    def try_to_store(self, key: str, thing: Any) -> None:
        """Store an entry and remove old ones; give a notice if the cache is not writable."""
        try:
            self.store(key, thing)
            self.make_room()
        except OSError as error:
            NOTICES.warning(
                "%s: the cache cannot be written (%s), and results are not kept for later "
                "runs; give another folder in %s, or --no-cache",
                shorten(str(self.folder)),
                error.strerror,
                VARIABLE,
            )

    def make_room(self, room: int = MAX_SIZE) -> None:
        """Remove the least recently used entries until the others fit into ``room`` bytes."""
        files: list[tuple[float, int, Path]] = []
        for entry in self.folder.glob(f"*{_SUFFIX}"):
            # Another process may remove the same entry.
            with suppress(OSError):
                status = entry.stat()
                if stat.S_ISREG(status.st_mode):
                    files.append((status.st_mtime, status.st_size, entry))
        total = sum(size for _, size, _ in files)
        for _, size, entry in sorted(files)[:-1]:
            if total <= room:
                return
            entry.unlink(missing_ok=True)
            total -= size

    def _entry(self, key: str) -> Path:
        return self.folder / f"{key}{_SUFFIX}"


def load_or_compute(
    cache: Cache | None,
    content: Sequence[Any],
    comm: MPI.Comm,
    compute: Callable[[], ReducedShell],
) -> ReducedShell:
    """Return a reduced shell from the cache, or compute it. All ranks must call it.

    If several processes need the same shell, one computes it and the others wait. A cache that
    cannot be read or written causes a notice. ``content`` has all inputs of the shell; the first
    rank reads and writes.
    """
    if cache is None:
        return compute()
    from protractile.shell_model.reduced_shell import ReducedShell

    start = perf_counter()
    name = key(list(content))
    with cache.entry_lock(name) if comm.rank == 0 else nullcontext():
        cached = cache.load(name, ReducedShell) if comm.rank == 0 else None
        # Only the first rank has fields and meshes.
        common = comm.bcast(None if cached is None else replace(cached, fields=None, meshes=[]))
        if common is not None:
            return replace(cached or common, seconds={"cache": perf_counter() - start})
        result = compute()
        if comm.rank == 0:
            cache.try_to_store(name, result)
    return result


def _head(key: str, file: BufferedIOBase) -> bytes:
    """Return the first line of an entry: the SHA-256 of its key and of the rest of the file."""
    return file_digest(file, lambda: sha256(key.encode())).hexdigest().encode() + b"\n"


def write_record(thing: Any, file: IO[bytes]) -> None:
    """Write a dataclass, dataset, array, number, text or combination of these as a record.

    Raises:
        TypeError: the object contains another type.
    """
    arrays: list[np.ndarray[Any, Any]] = []
    file.write(json.dumps(_encode(thing, arrays)).encode() + b"\n")
    for array in arrays:
        np.lib.format.write_array(file, array, allow_pickle=False)


def read_record(file: IO[bytes], kind: type[Kind]) -> Kind:
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
    if module.startswith("protractile."):
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
