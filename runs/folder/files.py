# SPDX-License-Identifier: LGPL-3.0-or-later
"""Atomic writing of files and folders.

Files are written to a hidden folder beside their final path. The process locks this folder, so that
a later process can remove the folders of killed processes. A finished folder has a manifest of its
files with checksums for ``sha256sum -c``. Its last line, a comment for ``sha256sum``, is the
checksum of the lines before.
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
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from glob import escape
from pathlib import Path
from secrets import token_hex

from protractile.runs.process.ending import when_interrupted

MANIFEST = ".manifest"

# Arguments of the system call renameat2: paths relative to the working folder; exchange two names.
_AT_FDCWD, _RENAME_EXCHANGE = -100, 2


def resolve_path(path: Path) -> Path:
    """Return a path with its links resolved.

    Raises:
        OSError: links form a loop. (:meth:`pathlib.Path.resolve` raises RuntimeError, or nothing
            from Python 3.13 on.)
    """
    resolved = Path(os.path.realpath(path))
    if resolved.is_symlink():
        raise OSError(errno.ELOOP, os.strerror(errno.ELOOP), str(path))
    return resolved


@contextmanager
def atomic_path(path: Path) -> Iterator[Path]:
    """Yield a temporary path to write to, and rename the complete file to ``path``."""
    with scratch_folder(path) as folder:
        yield folder / path.name
        os.replace(folder / path.name, path)


def write_atomically(path: Path, text: str) -> None:
    """Write a text file atomically."""
    with atomic_path(path) as part:
        part.write_text(text, encoding="utf-8")


@contextmanager
def atomic_folder(folder: Path) -> Iterator[Path]:
    """Yield an empty folder to write to, and replace ``folder`` with all its content at the end."""
    with scratch_folder(folder) as part:
        yield part
        with folder_lock(folder):
            _move_to_final_path(part, folder, _files(part))


@contextmanager
def modified_folder(folder: Path) -> Iterator[Path]:
    """Yield a copy of ``folder`` to modify, and replace the folder by it at the end.

    The files in the copy are hard links: replace them, but do not write to them. Files that the
    user added stay, without an entry in the manifest. Call it within :func:`folder_lock`.
    """
    with scratch_folder(folder) as part:
        for source in folder.rglob("*"):
            target = part / source.relative_to(folder)
            if source.is_dir() and not source.is_symlink():
                target.mkdir()
            elif target != part / MANIFEST:
                try:
                    os.link(source, target, follow_symlinks=False)
                except OSError:
                    # The file system has no links.
                    shutil.copy2(source, target, follow_symlinks=False)
        yield part
        checksums = _manifest_checksums(folder) or {}
        names = [
            name
            for name in _files(part)
            if name in checksums
            or not (folder / name).is_file()
            or not filecmp.cmp(part / name, folder / name)
        ]
        _move_to_final_path(part, folder, names)


@contextmanager
def folder_lock(folder: Path) -> Iterator[None]:
    """Lock a folder, so that no other process replaces it, while the context is open."""
    path = resolve_path(folder)
    with ExitStack() as stack:
        with suppress(OSError):
            parent = os.open(path.parent, os.O_RDONLY)
            stack.callback(os.close, parent)
            # Some network file systems have no locks.
            with suppress(OSError):
                fcntl.flock(parent, fcntl.LOCK_EX)
            if not path.exists():
                _exchange_path(path).rename(path)
        yield


@contextmanager
def scratch_folder(path: Path) -> Iterator[Path]:
    """Yield an empty hidden folder beside a path, and remove it at the end."""
    path = resolve_path(path)
    part = path.with_name(f"{_hidden(path)}{token_hex(4)}")
    # Other processes cannot find the folder before it is locked.
    new_folder = path.with_name(f".{part.name}")
    try:
        if not path.parent.exists():
            path.parent.mkdir(parents=True, exist_ok=True)
        # A locked folder belongs to a running process, others to killed ones.
        for old in path.parent.glob(f"{escape(_hidden(path))}*"):
            with suppress(OSError), (old / MANIFEST).open("r+", encoding="utf-8") as manifest:
                fcntl.flock(manifest, fcntl.LOCK_EX | fcntl.LOCK_NB)
                shutil.rmtree(old, ignore_errors=True)
        with ExitStack() as stack:
            for scratch in (new_folder, part):
                remove = partial(shutil.rmtree, scratch, ignore_errors=True)
                stack.enter_context(when_interrupted(remove))
                stack.callback(remove)
            new_folder.mkdir()
            manifest = stack.enter_context((new_folder / MANIFEST).open("a", encoding="utf-8"))
            with suppress(OSError):
                fcntl.flock(manifest, fcntl.LOCK_EX)
            new_folder.rename(part)
            yield part
    except OSError as error:
        # The error names the final path: the error of a full disk names no path, and the user does
        # not know hidden paths.
        place = os.path.abspath(error.filename or path)
        for scratch in (new_folder, part):
            place = place.replace(str(scratch), str(path))
        why = error.strerror or str(error)
        raise OSError(error.errno, why, place.removeprefix(f"{Path.cwd()}/")) from error


def find_damaged_file(folder: Path) -> str | None:
    """Return the name of a file whose checksum differs from the manifest; None if all agree.

    This may be the manifest itself. Missing and additional files are no damage.
    """
    checksums = _manifest_checksums(folder)
    if checksums is None:
        return MANIFEST
    for name, digest in checksums.items():
        path = folder / name
        if path.is_file() and not path.is_symlink() and digest != _digest(path):
            return name
    return None


def _hidden(path: Path) -> str:
    """Return the prefix that the names of all hidden folders beside a path have."""
    return f".{path.name[:50]}.protractile-"


def _exchange_path(path: Path) -> Path:
    """Return the path to which an old folder moves until the new one is in its place."""
    return path.with_name(f".{path.name[:50]}.away")


def _move_to_final_path(part: Path, folder: Path, file_names: Iterable[str]) -> None:
    """Write the manifest of a new folder, and move it to its final path in place of an old one."""
    sorted_names = sorted(file_names)
    with ThreadPoolExecutor() as threads:
        digests = threads.map(_digest, [part / name for name in sorted_names])
    pairs = zip(digests, sorted_names, strict=True)
    lines = "".join(f"{digest}  {name}\n" for digest, name in pairs)
    (part / MANIFEST).write_text(lines + _last_line(lines), "utf-8")
    folder = resolve_path(folder)
    if folder.is_dir():
        shutil.copymode(folder, part)
    try:
        os.rename(part, folder)
    except OSError as error:
        if error.errno not in (errno.ENOTEMPTY, errno.EEXIST):
            raise
        libc = ctypes.PyDLL(None)
        names = _AT_FDCWD, os.fsencode(part), _AT_FDCWD, os.fsencode(folder)
        # Not every system and file system can exchange two names.
        if not hasattr(libc, "renameat2") or libc.renameat2(*names, _RENAME_EXCHANGE) != 0:
            folder.rename(_exchange_path(folder))
            part.rename(folder)
            _exchange_path(folder).rename(part)


def _files(folder: Path) -> list[str]:
    """Return the relative paths of all files in a folder except manifest and links."""
    paths = (path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    return [name for path in paths if (name := str(path.relative_to(folder))) != MANIFEST]


def _manifest_checksums(folder: Path) -> dict[str, str] | None:
    """Return the checksums in the manifest of a folder by relative path; None if it is damaged."""
    manifest = folder / MANIFEST
    if not os.path.lexists(manifest):
        return {}
    try:
        # Reading a pipe of this name would block.
        text = manifest.read_text("utf-8") if manifest.is_file() else ""
    except (OSError, UnicodeDecodeError):
        return None
    lines, _, _ = text.rpartition("# ")
    if text != lines + _last_line(lines):
        return None
    return {name: digest for digest, _, name in (x.partition("  ") for x in lines.splitlines())}


def _last_line(lines: str) -> str:
    """Return the last line of a manifest, the checksum of the other lines."""
    return f"# {hashlib.sha256(lines.encode()).hexdigest()}\n"


def _digest(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
