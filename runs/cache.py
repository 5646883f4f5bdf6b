# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results kept under the content of what they depend on, for whoever asks for the same again.

An entry is a folder that is renamed into its place when it is whole: whatever interrupts a run,
and whoever shares the cache, there is no half of one. Nothing is ever changed in place, and what
is out of date is never asked for again, so that it is the least recently used, and goes.
"""

from __future__ import annotations

import hashlib
import json
import os
import shutil
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, fields, is_dataclass
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np

# Bytes that the entries may take together.
ROOM = 4 * 1024**3

# Where another folder than the user's own is to be taken.
VARIABLE = "PROTRACTILE_CACHE"


def default_folder() -> Path:
    """``$PROTRACTILE_CACHE``, or ``protractile`` in the user's folder of caches."""
    given = os.environ.get(VARIABLE)
    if given:
        return Path(given)
    caches = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(caches) / "protractile"


def key(*content: Any) -> str:
    """SHA-256 of content: numbers to the last bit, dataclasses with their names.

    Raises:
        TypeError: something is neither a number, a text, an array nor made of these.
    """
    text = json.dumps([_canonical(thing) for thing in content], ensure_ascii=True)
    return hashlib.sha256(text.encode()).hexdigest()


def sources(*folders: Path) -> str:
    """SHA-256 of the Python files in folders."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.glob("*.py")):
            digest.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


@dataclass(frozen=True, slots=True)
class Cache:
    """Entries by key.

    Args:
        folder: of the entries; made when the first one is kept.
        room: bytes that they may take together; the least recently used go first.
    """

    folder: Path
    room: int = ROOM

    def find(self, key: str) -> Path | None:
        """The folder of an entry, None where there is none."""
        entry = self.folder / key
        try:
            os.utime(entry)
        except OSError:
            return None
        return entry

    @contextmanager
    def fill(self, key: str) -> Iterator[Path]:
        """A folder to write to, which becomes the entry when it is whole.

        Where another process has kept the same meanwhile, that one stays.
        """
        self.folder.mkdir(parents=True, exist_ok=True)
        part = Path(mkdtemp(prefix=".part-", dir=self.folder))
        try:
            yield part
            with suppress(OSError):
                os.rename(part, self.folder / key)
        finally:
            shutil.rmtree(part, ignore_errors=True)
        self._make_room()

    def drop(self, key: str) -> None:
        """Forget an entry, if it is there."""
        shutil.rmtree(self.folder / key, ignore_errors=True)

    def _make_room(self) -> None:
        used: list[tuple[float, int, Path]] = []
        for entry in self.folder.iterdir():
            # Another process may take it away while it is looked at.
            with suppress(OSError):
                size = sum(path.stat().st_size for path in entry.iterdir())
                used.append((entry.stat().st_mtime, size, entry))
        total = sum(size for _, size, _ in used)
        for _, size, entry in sorted(used)[:-1]:
            if total <= self.room:
                return
            shutil.rmtree(entry, ignore_errors=True)
            total -= size


def _canonical(thing: Any) -> Any:
    """The thing in JSON's terms; floats by their bits."""
    if thing is None or isinstance(thing, bool | int | str):
        return thing
    if isinstance(thing, float):
        return thing.hex()
    if isinstance(thing, np.ndarray):
        data = np.ascontiguousarray(thing)
        return [str(data.dtype), list(data.shape), hashlib.sha256(data.tobytes()).hexdigest()]
    if is_dataclass(thing) and not isinstance(thing, type):
        parts = {field.name: _canonical(getattr(thing, field.name)) for field in fields(thing)}
        return {type(thing).__qualname__: parts}
    if isinstance(thing, Mapping):
        return {str(name): _canonical(value) for name, value in thing.items()}
    if isinstance(thing, Sequence):
        return [_canonical(part) for part in thing]
    raise TypeError(f"{type(thing).__qualname__} has no content to tell it by")
