# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files and folders that are there whole or not at all, whatever interrupts the writing.

What is being written lies in a hidden folder beside its place, which is locked as long as its
process lives: who writes there next takes away what a killed process has left. A folder that takes
another's place has a manifest of the files that came with it, with their checksums as ``sha256sum
-c`` reads them. All others in it are the user's, and are carried over.
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import filecmp
import hashlib
import os
import shutil
from collections.abc import Collection, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import partial
from glob import escape
from pathlib import Path
from secrets import token_hex
from stat import S_ISDIR, S_ISREG
from typing import IO

from runs.process.interruption import undone

MANIFEST = ".manifest"

# Of a folder that makes way on a disk where two names cannot be exchanged at once.
_AWAY = ".away"
# renameat2(2): paths are seen from the current folder; what it is to do.
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2
# In place of the checksum of a link or a folder; begins a comment for sha256sum.
_NONE = "#"
# Bytes of a file that are read at a time.
_PART = 1 << 20
# What a disk without locks says, some of clusters.
_NO_LOCKS = (errno.ENOSYS, errno.ENOLCK, errno.EOPNOTSUPP)


def real(path: Path) -> Path:
    """A path without links.

    Raises:
        OSError: its links go round in a loop, where :meth:`pathlib.Path.resolve` raises
            RuntimeError, or from Python 3.13 on nothing.
    """
    found = Path(os.path.realpath(path))
    if found.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    return found


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A name to write to; the file gets its own when it is complete."""
    with beside(path) as folder:
        yield folder / path.name
        os.replace(folder / path.name, path)


def write_whole(path: Path, text: str) -> None:
    """A file of text, there when it is complete."""
    with whole(path) as part:
        part.write_text(text, encoding="utf-8")


@contextmanager
def whole_folder(folder: Path, own: Collection[str] = ()) -> Iterator[Path]:
    """An empty folder to write to, which takes the place of ``folder`` when it is complete.

    What the user has put into ``folder`` stays there, but for what has the name of something new.

    Args:
        folder: may be there or not.
        own: names of files in it that go with it, though it did not bring them.
    """
    with beside(folder) as part:
        yield part
        with alone(folder):
            _take_the_place(part, real(folder), own)


@contextmanager
def changed_folder(folder: Path) -> Iterator[Path]:
    """The files of ``folder`` to change some of them, all at once when all is complete.

    They share their content with those in ``folder``: replace them, do not write to them. To be
    used :func:`alone`.
    """
    with beside(folder) as part:
        _carry(folder, part, _entries(folder))
        yield part
        _take_the_place(part, real(folder))


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Nobody else puts another folder in the place of this one meanwhile."""
    _clear(real(folder))
    while True:
        try:
            manifest = (folder / MANIFEST).open("r+", encoding="utf-8")
        except OSError:
            # It is not there, or nobody who would wait has written it.
            yield
            return
        with manifest:
            _lock(manifest, fcntl.LOCK_EX)
            if _is_at(folder / MANIFEST, manifest):
                yield
                return


@contextmanager
def in_turn(path: Path) -> Iterator[None]:
    """Processes that name the same file go on one after another; nothing is left of it.

    Raises:
        OSError: no file can be there.
    """
    while True:
        with path.open("a", encoding="utf-8") as lock:
            _lock(lock, fcntl.LOCK_EX)
            # Who went before has taken it away, and another one may have come since.
            if _is_at(path, lock):
                remove = partial(path.unlink, missing_ok=True)
                try:
                    with undone(remove):
                        yield
                finally:
                    remove()
                return


@contextmanager
def beside(path: Path) -> Iterator[Path]:
    """An empty folder to work in beside a path; it goes in the end, and so do earlier ones."""
    path = real(path)
    part = path.with_name(f"{_hidden(path)}{token_hex(4)}")
    try:
        if not path.parent.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
        _clear(path)
        with undone(partial(shutil.rmtree, part, ignore_errors=True)), _locked(part):
            try:
                yield part
            finally:
                shutil.rmtree(part, ignore_errors=True)
    except OSError as error:
        # A full disk does not say which file it was, and users know it by the name it was to get.
        place = os.path.abspath(error.filename or path).replace(str(part), str(path))
        why = error.strerror or str(error)
        raise OSError(error.errno, why, place.removeprefix(f"{Path.cwd()}/")) from error


def _hidden(path: Path) -> str:
    """How the names of folders beside a path begin."""
    return f".{path.name[:50]}.protractile-"


def _locked(part: Path) -> IO[str]:
    """The manifest of a new folder, locked as long as it is open."""
    while True:
        # Another process may clear it away before it is locked.
        with suppress(FileExistsError):
            part.mkdir()
        with suppress(FileNotFoundError, BlockingIOError):
            manifest = (part / MANIFEST).open("a", encoding="utf-8")
            _lock(manifest, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if _is_at(part / MANIFEST, manifest):
                return manifest


def _clear(path: Path) -> None:
    """Take away what killed processes have left beside a path."""
    for left in path.parent.glob(f"{escape(_hidden(path))}*"):
        with suppress(OSError):
            # One look: the manifest is the first file of all, and may come at any moment.
            names = os.listdir(left)
            if MANIFEST in names:
                with (left / MANIFEST).open("r+", encoding="utf-8") as lock:
                    if _lock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB):
                        _put_away(left, path)
            elif names or left.suffix == _AWAY:
                _put_away(left, path)
            else:
                left.rmdir()


def _put_away(left: Path, path: Path) -> None:
    """What nobody writes any more goes, or back to where it has been."""
    if left.suffix == _AWAY and not path.exists():
        left.rename(path)
    else:
        shutil.rmtree(left, ignore_errors=True)


def _lock(file: IO[str], how: int) -> bool:
    """Lock a file as long as it is open; False where there are no locks.

    Raises:
        BlockingIOError: another process has it, and ``how`` does not wait.
    """
    try:
        fcntl.flock(file, how)
    except OSError as error:
        if error.errno not in _NO_LOCKS:
            raise
        return False
    return True


def _is_at(path: Path, file: IO[str]) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(file.fileno()))
    except FileNotFoundError:
        return False


def _take_the_place(part: Path, folder: Path, own: Collection[str] = ()) -> None:
    theirs = _theirs(folder, own)
    carried = {
        name
        for name in theirs
        if not os.path.lexists(part / name) or _same(part / name, folder / name)
    }
    brought = _entries(part) - carried
    _carry(folder, part, carried)
    if folder.is_dir():
        shutil.copymode(folder, part)
    sums = {name: _checksum(part / name) if _is_file(part / name) else _NONE for name in brought}
    lines = [f"{sums[name]}  {name}\n" for name in sorted(brought)]
    (part / MANIFEST).write_text("".join(lines), "utf-8")
    try:
        os.rename(part, folder)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
        _exchange(part, folder)
        # What has come meanwhile.
        _carry(part, folder, _theirs(part, own) - theirs)


def _exchange(one: Path, other: Path) -> None:
    """Give two folders each other's name."""
    try:
        libc = ctypes.PyDLL(None, use_errno=True)
        names = _AT_FDCWD, os.fsencode(one), _AT_FDCWD, os.fsencode(other)
        if libc.renameat2(*names, _RENAME_EXCHANGE) == 0:
            return
    except AttributeError:
        # Not Linux.
        pass
    # Not every disk can do it at once.
    away = one.with_name(f"{one.name}{_AWAY}")
    other.rename(away)
    one.rename(other)
    away.rename(one)


def _entries(folder: Path) -> set[Path]:
    """All files and empty folders, by their paths in a folder."""
    found = {
        path.relative_to(folder)
        for path in folder.rglob("*")
        if path.is_symlink() or not path.is_dir() or not any(path.iterdir())
    }
    return found - {Path(MANIFEST)}


def _theirs(folder: Path, own: Collection[str]) -> set[Path]:
    """Of those, what the user has put there."""
    return _entries(folder) - {Path(name) for name in (*_listed(folder), *own)}


def damaged(folder: Path) -> str | None:
    """The first file that is not as it came with a folder; None where there is none.

    Files that are missing, and files of the user, count as none.
    """
    for name, sums in _listed(folder).items():
        path = folder / name
        if sums != _NONE and _is_file(path) and sums != _checksum(path):
            return name
    return None


def checksum(parts: Iterable[bytes | memoryview]) -> str:
    """SHA-256 of a file's content."""
    digest = hashlib.sha256()
    for part in parts:
        digest.update(part)
    return digest.hexdigest()


def _listed(folder: Path) -> dict[str, str]:
    """Checksums of what came with a folder, by paths in it; ``#`` of what has none."""
    manifest = folder / MANIFEST
    try:
        # A pipe in its place would wait for its writer.
        lines = manifest.read_text("utf-8").splitlines() if manifest.is_file() else []
    except (OSError, UnicodeDecodeError):
        lines = []
    # Lines of earlier versions are names alone.
    parts = (line.partition("  ") if "  " in line else (_NONE, "", line) for line in lines)
    return {name: sums for sums, _, name in parts}


def _checksum(path: Path) -> str:
    with path.open("rb") as file:
        return checksum(iter(partial(file.read, _PART), b""))


def _is_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()


def _same(one: Path, other: Path) -> bool:
    """Whether one is the other, carried over."""
    first, second = one.lstat(), other.lstat()
    if S_ISREG(first.st_mode) and S_ISREG(second.st_mode):
        return filecmp.cmp(one, other)
    return os.path.samestat(first, second) or S_ISDIR(first.st_mode & second.st_mode)


def _carry(old: Path, new: Path, names: Iterable[Path]) -> None:
    """What is not in a new folder yet, linked into it from an old one, or copied."""
    for name in names:
        if os.path.lexists(new / name):
            continue
        (new / name).parent.mkdir(parents=True, exist_ok=True)
        if (old / name).is_dir() and not (old / name).is_symlink():
            (new / name).mkdir()
            continue
        try:
            os.link(old / name, new / name, follow_symlinks=False)
        except OSError:
            shutil.copy2(old / name, new / name, follow_symlinks=False)
