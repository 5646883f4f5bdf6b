# SPDX-License-Identifier: LGPL-3.0-or-later
"""Standard output and standard error, whatever the user has connected them to."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from rich.console import Console


class Terminal(Console):
    """A console whose reader may leave early, as ``head`` does."""

    def on_broken_pipe(self) -> None:
        """What has been read is enough; the command goes on."""
        _discard_output()


def prepare() -> None:
    """Make closed streams swallow what is written, and others show every letter they can."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            # Open for as long as the process lives.
            swallowed = io.TextIOWrapper(io.FileIO(os.devnull, "w"), encoding="utf-8")
            setattr(sys, name, swallowed)
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


@contextmanager
def flushed() -> Iterator[None]:
    """Write all that is printed within, as long as it can still be told whether it was.

    Raises:
        OSError: it cannot be written. Nothing more is tried then.
    """
    try:
        yield
    finally:
        _flush()


def say(line: str) -> None:
    """One write with its newline, which nobody else's words can come between."""
    with suppress(OSError):
        sys.stderr.write(f"{line}\n")
        sys.stderr.flush()


def _flush() -> None:
    try:
        sys.stdout.flush()
    except BrokenPipeError:
        _discard_output()
    except OSError:
        _discard_output()
        raise


def _discard_output() -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
