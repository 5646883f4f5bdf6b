# SPDX-License-Identifier: LGPL-3.0-or-later
"""Standard output and standard error: printable texts, notices, closed streams."""

from __future__ import annotations

import io
import logging
import os
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress

from rich.console import Console

# Users of the package may listen as to any logger of Python's.
NOTICES = logging.getLogger("protractile")

# Characters of a message, with its newline, and of a path or a key in it.
LONGEST, LONGEST_PART = 300, 120

_GAP = " ... "


class Terminal(Console):
    """A console whose reader may leave early, as ``head`` does."""

    def on_broken_pipe(self) -> None:
        """Continue: the reader has enough."""
        _discard_output()


def prepare() -> None:
    """Make closed streams discard output, and others print every letter they can."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            # Open for the life of the process.
            swallowed = io.TextIOWrapper(io.FileIO(os.devnull, "w"), encoding="utf-8")
            setattr(sys, name, swallowed)
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


@contextmanager
def flushed() -> Iterator[None]:
    """Flush all output of the context, while an error can still be reported.

    Raises:
        OSError: the output cannot be written. There is no second attempt.
    """
    try:
        yield
    finally:
        try:
            sys.stdout.flush()
        except BrokenPipeError:
            _discard_output()
        except OSError:
            _discard_output()
            raise


def say(line: str) -> None:
    """Write a line to stderr at once, so that no other text comes between it and its newline."""
    with suppress(OSError):
        sys.stderr.write(f"{line}\n")
        sys.stderr.flush()


def message(text: str) -> str:
    """Return a text as one line for stderr."""
    return shown(f"protractile: {' '.join(text.split())}", LONGEST - 1)


def shown(text: str, longest: int = LONGEST_PART) -> str:
    """Return a printable text, its middle left out if it is long."""
    # Escaping makes it longer, never shorter: ends of this length are enough.
    safe = printable(text if len(text) <= 2 * longest else text[:longest] + text[-longest:])
    if len(safe) <= longest:
        return safe
    half = (longest - len(_GAP)) // 2
    return safe[:half] + _GAP + safe[-half:]


def printable(text: str) -> str:
    """Return a text with control characters escaped."""
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text
    )


def show_notices() -> None:
    """Print notices from now on, and suppress the warnings of libraries to their callers.

    A user cannot fix these. Filters hold as before: tests turn warnings into errors.
    """
    NOTICES.addHandler(_LINES)
    # Some warn while they are imported.
    warnings.showwarning = lambda *_, **__: None
    logging.getLogger().addHandler(logging.NullHandler())


class _Lines(logging.Handler):
    """A handler that prints each notice as a line on stderr, once."""

    def __init__(self) -> None:
        super().__init__(logging.WARNING)
        self._printed: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        line = message(record.getMessage())
        if line not in self._printed:
            self._printed.add(line)
            say(line)


_LINES = _Lines()


def _discard_output() -> None:
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
