# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cache of results under the hash of their inputs.

An entry is a file. Its first line is the SHA-256 of its key and content, by which disk errors and
foreign files are detected. Entries are written atomically and never change. The cache removes the
least recently used entries.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from dataclasses import dataclass, replace
from hashlib import file_digest, sha256
from io import BufferedIOBase
from pathlib import Path
from struct import Struct
from time import perf_counter
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, TypeVar

from runs.folder import records
from runs.folder.files import atomic_path
from runs.folder.versions import program
from runs.process.terminal import NOTICES, shorten

if TYPE_CHECKING:
    from mpi4py import MPI

    from shell_model.reduced_shell import ReducedShell

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


def key(*content: Any) -> str:
    """Return the key of an entry: the SHA-256 of its inputs and of the version of the program.

    Raises:
        TypeError: an input is of a type that :func:`runs.folder.records.write` does not write.
    """
    digest = sha256()
    records.write((content, program()), SimpleNamespace(write=digest.update))
    return digest.hexdigest()


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
                    return records.read(file, kind)
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
                lock = stack.enter_context((self.folder / ".lock").open("a", encoding="utf-8"))
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
            records.write(thing, file)
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
    cannot be read or written causes a notice.

    Args:
        cache: cache of the user; None to compute the shell.
        content: all inputs of the shell.
        comm: ranks that share the work; the first one reads and writes.
        compute: function that computes the shell; all ranks call it.
    """
    if cache is None:
        return compute()
    from shell_model.reduced_shell import ReducedShell

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
