# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reader of the user's text files, and a check of folders that a run replaces."""

from __future__ import annotations

import codecs
import errno
import os
import stat
from pathlib import Path

from protractile.runs.folder.files import resolve_path
from protractile.runs.process.bad_input import BadInput

# Maximum size of a text file; a case with the largest permitted tables is smaller.
MAX_BYTES = 16_000_000


def check_regular(path: Path) -> None:
    """Check that a path is a regular file, since a pipe may block and a device may never end.

    Raises:
        OSError: the file is missing, or is no regular file.
    """
    mode = path.stat().st_mode
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "not a regular file", str(path))


def check_not_working_folder(folder: Path, file: str, key: str) -> None:
    """Check that a folder to replace is not the working folder.

    After a replacement, the user's terminal would remain in the deleted folder.

    Raises:
        BadInput: the folder, or a folder within it, is the working folder.
    """
    if Path.cwd().is_relative_to(resolve_path(folder)):
        raise BadInput(
            file, key, "is where you are, and will be replaced; start from another folder"
        )


def read_text(path: Path) -> str:
    """Return the text of a file.

    Raises:
        OSError: the file cannot be read, is too large, or is no regular file.
        ValueError: the content is not UTF-8, or the path is invalid.
    """
    return _read(path).decode("utf-8-sig")


def read_any_text(path: Path) -> str:
    """Return the text of a file, also in the encodings that spreadsheets write.

    A byte order mark identifies UTF-16. Text that is not UTF-8 is read as Windows-1252.
    """
    data = _read(path)
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return data.decode("utf-16")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252")


def _read(path: Path) -> bytes:
    check_regular(path)
    with path.open("rb") as file:
        data = file.read(MAX_BYTES + 1)
    if len(data) > MAX_BYTES:
        raise OSError(errno.EFBIG, f"larger than {MAX_BYTES // 1_000_000} MB", str(path))
    return data
