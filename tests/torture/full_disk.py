# SPDX-License-Identifier: LGPL-3.0-or-later
"""Refusal of every single write call, after which old files must be unchanged to the last byte.

A full disk stays full; a disk error occurs once. The calls are those of Python that write the files
of a run, a report and a sweep.
"""

import builtins
import errno
import io
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, Self
from unittest.mock import patch

from protractile.runs.folder.cache import VARIABLE
from tests.system.run_folder import write_coarse
from tests.torture.shared_cache import IN_THE_MAKING, Row, left, run_here

_CHANGES = "mkdir", "rename", "replace", "link", "symlink", "write"
_WRITES = set("wax+")
# What does not depend on the time of a command.
_SAME = {".nc", ".csv", ".toml", ".png", ".manifest"}


class Disk:
    """Disk of a folder that refuses one of the write calls.

    Args:
        folder: folder of the files.
        last: number of successful calls.
        number: ``errno`` of the next call, and of all later ones if the disk is full.
    """

    def __init__(self, folder: Path, last: float, number: int) -> None:
        self.calls = 0
        self._folder, self._last, self._number = str(folder), last, number

    def check(self, path: object) -> None:
        if isinstance(path, str | os.PathLike) and not os.path.abspath(path).startswith(
            self._folder
        ):
            return
        self.calls += 1
        over = self.calls - self._last
        if over == 1 or (over > 1 and self._number == errno.ENOSPC):
            raise OSError(self._number, os.strerror(self._number))

    def in_use(self) -> ExitStack:
        """Return a context in which Python writes to this disk."""
        stack = ExitStack()
        for name in _CHANGES:
            stack.enter_context(patch.object(os, name, self._checked(getattr(os, name))))
        for module in (builtins, io):
            stack.enter_context(patch.object(module, "open", self._open(open)))
        return stack

    def _checked(self, call: Callable[..., Any]) -> Callable[..., Any]:
        def checked(path: object, *rest: Any, **options: Any) -> Any:
            self.check(path)
            return call(path, *rest, **options)

        return checked

    def _open(self, call: Callable[..., Any]) -> Callable[..., Any]:
        def opened(path: Any, mode: str = "r", *rest: Any, **options: Any) -> Any:
            written = bool(_WRITES & set(mode)) and not isinstance(path, int)
            if not written or not os.path.abspath(path).startswith(self._folder):
                return call(path, mode, *rest, **options)
            self.check(path)
            return _File(call(path, mode, *rest, **options), self)

        return opened


class _File:
    """A file that asks the disk before each write, and before it closes."""

    def __init__(self, file: Any, disk: Disk) -> None:
        self._file, self._disk = file, disk
        self._written = False

    def write(self, content: Any) -> Any:
        self._disk.check(None)
        self._written = True
        return self._file.write(content)

    def close(self) -> None:
        if not self._file.closed:
            self._file.close()
            if self._written:
                self._disk.check(None)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def __iter__(self) -> Iterator[Any]:
        return iter(self._file)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._file, name)


def rows(folder: Path, tries: int = 10**6) -> Iterator[Row]:
    """Yield the remains of a run, a report and a sweep; a breach is neither old nor new.

    Args:
        folder: an empty one to work in.
        tries: tries of each, spread over all calls; no more than there are.
    """
    with patch.dict(os.environ, {VARIABLE: str(folder / "cache")}):
        models = "--models", "beam-fe-bonded"
        run = "run", _case(folder, 0.02), *models, "--out", str(folder / "run" / "out")
        other = "run", _case(folder, 0.01), *models, "--out", str(folder / "run" / "out")
        yield from _torture("a run", folder / "run", other, run, tries)
        yield from _torture("a report", folder / "run", other, ("report", run[-1]), tries)
        out = "--out", str(folder / "sweep" / "out")
        plays = "--vary", "joint.play=0.010:0.014:2"
        other = "sweep", _case(folder, 0.01), *models, *plays, *out
        yield from _torture(
            "a sweep", folder / "sweep", other, ("sweep", _case(folder, 0.02), *other[2:]), tries
        )


def _case(folder: Path, duration: float) -> str:
    """Return the coarse case for a duration, in a folder of its own."""
    place = folder / f"{duration:g}"
    place.mkdir(exist_ok=True)
    return str(write_coarse(place, duration))


def _torture(
    name: str, place: Path, before: Sequence[str], command: Sequence[str], tries: int
) -> Iterator[Row]:
    """Run a command beside the files of another one."""
    place.mkdir(exist_ok=True)
    assert run_here(before)[0] == 0
    old = left(place, _SAME)
    disk = Disk(place, float("inf"), 0)
    with disk.in_use():
        assert run_here(command)[0] == 0
    new = left(place, _SAME)
    for number in (errno.ENOSPC, errno.EIO):
        done = breaches = 0
        for last in range(0, disk.calls, max(1, disk.calls // tries)):
            if left(place, _SAME) != old:
                assert run_here(before)[0] == 0
            with Disk(place, last, number).in_use():
                status, said = run_here(command)
            done += 1
            whole = left(place, _SAME) == (new if status == 0 else old)
            rests = any(place.rglob(f"*{IN_THE_MAKING}*"))
            breaches += not whole or rests or said != (status != 0)
        what = f"of {disk.calls} calls: what was there, or all that is new, and one line"
        yield f"{name}, {os.strerror(number)}", done, breaches, what
