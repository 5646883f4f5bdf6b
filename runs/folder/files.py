# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files and folders that are complete or absent, at any interruption of the writing.

Incomplete files lie in a hidden folder beside their place. That folder is locked as long as its
process lives, so that the next process that writes there can remove those of a killed one. A
finished folder has a manifest of its files with their checksums, as ``sha256sum -c`` reads them.
"""

from __future__ import annotations

import ctypes
import errno
import fcntl
import filecmp
import hashlib
import os
import shutil
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from glob import escape
from pathlib import Path
from secrets import token_hex

from runs.process.ending import when_interrupted

MANIFEST = ".manifest"

# renameat2(2): paths are relative to the current folder; exchange two names.
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2


def real(path: Path) -> Path:
    """Return a path without links.

    Raises:
        OSError: its links form a loop, where :meth:`pathlib.Path.resolve` raises RuntimeError, or
            from Python 3.13 on nothing.
    """
    found = Path(os.path.realpath(path))
    if found.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    return found


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """Give a name to write to; the file gets its own when it is complete."""
    with scratch_folder(path) as folder:
        yield folder / path.name
        os.replace(folder / path.name, path)


def write_whole(path: Path, text: str) -> None:
    """Write a file of text, which appears when it is complete."""
    with whole(path) as part:
        part.write_text(text, encoding="utf-8")


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """Give an empty folder to write to, which replaces ``folder`` when it is complete.

    Args:
        folder: may exist; everything in it is removed.
    """
    with scratch_folder(folder) as part:
        yield part
        with exclusive(folder):
            _take_the_place(part, folder, _files(part))


@contextmanager
def changed_folder(folder: Path) -> Iterator[Path]:
    """Give a copy of ``folder`` to change, which replaces it when it is complete.

    The copies share their content with the files in ``folder``: replace them, do not write to them.
    Files that the user has put there stay, and are not listed in the manifest. To be used
    :func:`exclusive`.
    """
    with scratch_folder(folder) as part:
        for source in folder.rglob("*"):
            target = part / source.relative_to(folder)
            if source.is_dir() and not source.is_symlink():
                target.mkdir()
            elif target != part / MANIFEST:
                _link(source, target)
        yield part
        listed = _listed(folder)
        own = [name for name in _files(part) if name in listed or not _same(name, part, folder)]
        _take_the_place(part, folder, own)


@contextmanager
def exclusive(folder: Path) -> Iterator[None]:
    """Wait until no other process replaces a folder beside this one, and keep others waiting."""
    path = real(folder)
    with ExitStack() as stack:
        with suppress(OSError):
            parent = os.open(path.parent, os.O_RDONLY)
            stack.callback(os.close, parent)
            # Some network disks have no locks.
            with suppress(OSError):
                fcntl.flock(parent, fcntl.LOCK_EX)
            if not path.exists():
                _away(path).rename(path)
        yield


@contextmanager
def scratch_folder(path: Path) -> Iterator[Path]:
    """Give an empty folder to work in beside a path; remove it at the end, with earlier ones."""
    path = real(path)
    part = path.with_name(f"{_hidden(path)}{token_hex(4)}")
    # Other processes do not find it until it is locked.
    unlocked = path.with_name(f".{part.name}")
    try:
        if not path.parent.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
        _remove_left(path)
        with ExitStack() as stack:
            for scratch in (unlocked, part):
                remove = partial(shutil.rmtree, scratch, ignore_errors=True)
                stack.enter_context(when_interrupted(remove))
                stack.callback(remove)
            unlocked.mkdir()
            manifest = stack.enter_context((unlocked / MANIFEST).open("a", encoding="utf-8"))
            with suppress(OSError):
                fcntl.flock(manifest, fcntl.LOCK_EX)
            unlocked.rename(part)
            yield part
    except OSError as error:
        # The error of a full disk names no file, and users know it by its final name.
        place = os.path.abspath(error.filename or path)
        for scratch in (unlocked, part):
            place = place.replace(str(scratch), str(path))
        why = error.strerror or str(error)
        raise OSError(error.errno, why, place.removeprefix(f"{Path.cwd()}/")) from error


def damaged(folder: Path) -> str | None:
    """Return the first file whose checksum is not that of the manifest, None where there is none.

    Missing files, and files of the user, count as none.
    """
    for name, digest in _listed(folder).items():
        path = folder / name
        if path.is_file() and not path.is_symlink() and digest != _digest(path):
            return name
    return None


def _hidden(path: Path) -> str:
    """Return the prefix of the names of folders beside a path."""
    return f".{path.name[:50]}.protractile-"


def _away(path: Path) -> Path:
    """Return the path of a folder while another one takes its place in two steps."""
    return path.with_name(f".{path.name[:50]}.away")


def _remove_left(path: Path) -> None:
    """Remove the remains of killed processes beside a path."""
    for left in path.parent.glob(f"{escape(_hidden(path))}*"):
        # The folder of a live process is locked.
        with suppress(OSError), (left / MANIFEST).open("r+", encoding="utf-8") as manifest:
            fcntl.flock(manifest, fcntl.LOCK_EX | fcntl.LOCK_NB)
            shutil.rmtree(left, ignore_errors=True)


def _take_the_place(part: Path, folder: Path, own: Iterable[str]) -> None:
    """Write a manifest, and exchange two folders.

    Args:
        part: the new folder.
        folder: the old one, if there is one; ``part`` gets its name.
        own: files of the new folder that the manifest lists.
    """
    lines = [f"{_digest(part / name)}  {name}\n" for name in sorted(own)]
    (part / MANIFEST).write_text("".join(lines), "utf-8")
    folder = real(folder)
    if folder.is_dir():
        shutil.copymode(folder, part)
    try:
        os.rename(part, folder)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
        libc = ctypes.PyDLL(None)
        names = _AT_FDCWD, os.fsencode(part), _AT_FDCWD, os.fsencode(folder)
        # Not every system and not every disk can exchange two names at once.
        if not hasattr(libc, "renameat2") or libc.renameat2(*names, _RENAME_EXCHANGE) != 0:
            folder.rename(_away(folder))
            part.rename(folder)
            _away(folder).rename(part)


def _files(folder: Path) -> list[str]:
    """Return all files but the manifest and links, by their paths in a folder."""
    paths = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return [name for path in paths if (name := str(path.relative_to(folder))) != MANIFEST]


def _same(name: str, one: Path, other: Path) -> bool:
    """Return whether two folders have the same file under a name."""
    return (other / name).is_file() and filecmp.cmp(one / name, other / name)


def _listed(folder: Path) -> dict[str, str]:
    """Return the checksums of a folder's manifest, by paths in the folder."""
    manifest = folder / MANIFEST
    try:
        # A pipe in its place would wait for its writer.
        lines = manifest.read_text("utf-8").splitlines() if manifest.is_file() else []
    except (OSError, UnicodeDecodeError):
        lines = []
    return {name: digest for digest, _, name in (line.partition("  ") for line in lines)}


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _link(source: Path, target: Path) -> None:
    """Link a file, or copy it if links are impossible."""
    try:
        os.link(source, target, follow_symlinks=False)
    except OSError:
        shutil.copy2(source, target, follow_symlinks=False)
