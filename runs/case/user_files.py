# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a user names: regular files of a sensible size are read, folders around nobody replaced."""

from __future__ import annotations

import errno
import os
import stat
from pathlib import Path

from runs.case.messages import BadInput

# Bytes of a text: a case of as many tabulated times as are allowed has less.
LARGEST = 16_000_000


def check_regular(path: Path) -> None:
    """Refuse what would never end: a pipe waits for its writer, a device has no end.

    Raises:
        OSError: there is no such file, or it is none.
    """
    mode = path.stat().st_mode
    if stat.S_ISDIR(mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(mode):
        raise OSError(errno.EINVAL, "not a regular file", str(path))


def check_left(folder: Path, file: str, key: str) -> None:
    """Refuse a folder that its user is in: a shell stays in what has been replaced, and is empty.

    Args:
        folder: that another one is to take the place of.
        file, key: for messages.

    Raises:
        BadInput: this process has been started in it.
    """
    if Path.cwd().is_relative_to(folder.resolve()):
        raise BadInput(
            file, key, "is where you are, and will be replaced; start from another folder"
        )


def read_text(path: Path) -> str:
    """The text of a file.

    Raises:
        OSError: it cannot be read, is no regular file, or a too large one.
        ValueError: it is not UTF-8, or no path.
    """
    check_regular(path)
    with path.open("rb") as file:
        data = file.read(LARGEST + 1)
    if len(data) > LARGEST:
        raise OSError(errno.EFBIG, f"larger than {LARGEST // 1_000_000} MB", str(path))
    return data.decode("utf-8-sig")
