# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files and folders that are there whole or not at all, whatever interrupts the writing."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory


@contextmanager
def whole(path: Path) -> Iterator[Path]:
    """A name to write to; the file gets its own when it is complete."""
    part = path.with_name(f".{path.stem}.{os.getpid()}{path.suffix}")
    try:
        yield part
        os.replace(part, path)
    except OSError as error:
        # A full disk does not say which file it was.
        raise OSError(error.errno, error.strerror, str(path)) from error
    finally:
        part.unlink(missing_ok=True)


@contextmanager
def whole_folder(folder: Path) -> Iterator[Path]:
    """A folder to write to; its files replace those of ``folder`` when all are complete."""
    with TemporaryDirectory(dir=folder.parent, prefix=f".{folder.name}-") as part:
        yield Path(part)
        folder.mkdir(exist_ok=True)
        new = {path.name for path in Path(part).iterdir()}
        for name in new:
            os.replace(Path(part) / name, folder / name)
    for path in folder.iterdir():
        if path.name not in new:
            path.unlink()
    if not new:
        folder.rmdir()
