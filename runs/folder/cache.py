# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results kept under the content of what they depend on, for whoever asks for the same again.

An entry is a folder of files that is renamed into its place when it is whole: whatever interrupts a
run, and whoever shares the cache, there is no half of one. Beside the files lie their checksums
with the entry's own name, as ``sha256sum -c`` reads them in the cache's folder, so that a disk
that forgets and a file that was copied from elsewhere are found out. Nothing is ever changed in
place, and what is out of date is never asked for again, so that it is the least recently used, and
goes.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from runs.folder import records
from runs.folder.files import beside, checksum, in_turn
from runs.process.notices import NOTICES
from runs.process.shown import shown

Kept = TypeVar("Kept")
Files = Mapping[str, memoryview]

# Bytes that the entries of a user may take together.
ROOM = 4 * 1024**3

# Where another folder than the user's own is to be taken.
VARIABLE = "PROTRACTILE_CACHE"

SUMS = "SHA256SUMS"


def key(*content: Any) -> str:
    """SHA-256 of content: numbers to the last bit, dataclasses with their names.

    Raises:
        TypeError: something cannot be a record's, see :func:`runs.folder.records.pack`.
    """
    return checksum(chain.from_iterable(records.pack(content).values()))


@dataclass(frozen=True, slots=True)
class Cache:
    """Entries by key.

    Args:
        folder: of the entries; made when the first one is kept.
    """

    folder: Path

    @classmethod
    def of_user(cls) -> Cache | None:
        """In ``$PROTRACTILE_CACHE``, or in ``protractile`` in the user's folder of caches.

        None, and a notice, for one who has no home.
        """
        if given := os.environ.get(VARIABLE):
            return cls(Path(given))
        try:
            caches = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        except RuntimeError:
            NOTICES.warning(
                "there is no home folder, and what is computed is not kept for later runs; give a "
                "folder in %s, or --no-cache",
                VARIABLE,
            )
            return None
        return cls(Path(caches) / "protractile")

    def load(self, key: str, read: Callable[[Files], Kept]) -> Kept | None:
        """What an entry holds; None where there is none, or none that is as it was kept.

        Args:
            key: of the entry.
            read: makes something of the entry's files.
        """
        entry = self.folder / key
        # An entry of another user's can be read, too.
        with suppress(OSError):
            os.utime(entry)
        try:
            files = {path.name: _content(path) for path in entry.iterdir()}
            if files.pop(SUMS) == _sums(key, {name: [data] for name, data in files.items()}):
                return read(files)
        except MemoryError:
            raise
        except Exception:
            # Whatever has become of it on the disk, and whoever made it.
            if not os.path.lexists(entry):
                return None
        NOTICES.warning(
            "%s: is not as it was kept; it is dropped, and computed again", shown(str(entry))
        )
        self._drop(entry)
        return None

    @contextmanager
    def making(self, key: str) -> Iterator[None]:
        """Who else is at the same entry waits meanwhile, unless the cache cannot be written."""
        with ExitStack() as stack:
            with suppress(OSError):
                self.folder.mkdir(parents=True, exist_ok=True)
                stack.enter_context(in_turn(self.folder / f".{key}.lock"))
            yield

    def keep(self, key: str, files: Mapping[str, Sequence[bytes | memoryview]]) -> None:
        """Keep an entry. Where another process has kept the same meanwhile, that one stays.

        Args:
            key: of the entry.
            files: the parts of each file, by its name.

        Raises:
            OSError: it cannot be written.
        """
        entry = self.folder / key
        with beside(entry) as part:
            made = part / key
            made.mkdir()
            for name, content in {**files, SUMS: [_sums(key, files)]}.items():
                with (made / name).open("wb") as file:
                    file.writelines(content)
            try:
                made.rename(entry)
            except OSError:
                if not entry.is_dir():
                    raise

    def remember(self, key: str, files: Mapping[str, Sequence[bytes | memoryview]]) -> None:
        """Keep an entry, and room for others; a notice says so where it cannot be written."""
        try:
            self.keep(key, files)
            self.make_room()
        except OSError as error:
            NOTICES.warning(
                "%s: the cache cannot be written (%s), and what is computed is not kept for later "
                "runs; give another folder in %s, or --no-cache",
                shown(str(self.folder)),
                error.strerror,
                VARIABLE,
            )

    def make_room(self, room: int = ROOM) -> None:
        """Drop the least recently used entries until the others take ``room`` bytes together."""
        used: list[tuple[float, int, Path]] = []
        for entry in self.folder.iterdir():
            # Another process may take it away while it is looked at.
            with suppress(OSError):
                size = sum(path.stat().st_size for path in entry.rglob("*"))
                used.append((entry.stat().st_mtime, size, entry))
        total = sum(size for _, size, _ in used)
        for _, size, entry in sorted(used)[:-1]:
            if total <= room:
                return
            self._drop(entry)
            total -= size

    def _drop(self, entry: Path) -> None:
        """Take an entry away at once, since others may be reading it."""
        with suppress(OSError), beside(entry) as part:
            entry.rename(part / entry.name)


def _content(path: Path) -> memoryview:
    if not path.is_file():
        raise ValueError(f"{path} is no file")
    return np.fromfile(path, np.uint8).data


def _sums(key: str, files: Mapping[str, Sequence[bytes | memoryview]]) -> bytes:
    """A line for each file of an entry."""
    lines = [f"{checksum(content)}  {key}/{name}\n" for name, content in sorted(files.items())]
    return "".join(lines).encode()
