# SPDX-License-Identifier: LGPL-3.0-or-later
"""Standard output and standard error: printable text, notices, progress, closed streams."""

from __future__ import annotations

import io
import logging
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.progress import Progress as ProgressBars

# Logger of notices. Users of the package may configure it.
NOTICES = logging.getLogger("protractile")

# Maximum numbers of characters of a message, and of a path or key in it.
LONGEST, LONGEST_PART = 300, 120

_GAP = " ... "

# Callback that receives the name of the model, the stage, and the completed fraction of the stage.
Progress = Callable[[str, str, float], None]

# Minimum time in s between two lines; a shorter stage may print none.
EVERY = 5.0
# Completed fraction of a stage above which its remaining time is estimated.
LEAST_PART = 0.05


class Terminal(Console):
    """Console that ignores a closed pipe, for example to ``head``."""

    def on_broken_pipe(self) -> None:
        """Ignore a closed pipe, whose reader needs no more output."""
        _discard_output()


def prepare() -> None:
    """Let closed output streams discard text, and let others escape unprintable characters."""
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            # This file stays open until the process ends.
            null_stream = io.TextIOWrapper(io.FileIO(os.devnull, "w"), encoding="utf-8")
            setattr(sys, name, null_stream)
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


@contextmanager
def flush_output() -> Iterator[None]:
    """Flush all output at the end of the context, while errors can still be reported.

    Raises:
        OSError: the output cannot be written.
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
    """Write a line to stderr in one call, so that other output cannot split it."""
    with suppress(OSError):
        sys.stderr.write(f"{line}\n")
        sys.stderr.flush()


def message(text: str) -> str:
    """Return a text as one printable line with the prefix of the program."""
    return shorten(f"protractile: {' '.join(text.split())}", LONGEST - 1)


def shorten(text: str, longest: int = LONGEST_PART) -> str:
    """Return a text with control characters escaped, and without its middle if it is too long."""
    # Escaping never shortens a text, so that ``longest`` characters of each end suffice.
    escaped = printable(text if len(text) <= 2 * longest else text[:longest] + text[-longest:])
    if len(escaped) <= longest:
        return escaped
    half = (longest - len(_GAP)) // 2
    return escaped[:half] + _GAP + escaped[-half:]


def printable(text: str) -> str:
    """Return a text with control characters escaped."""
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text
    )


def show_notices() -> None:
    """Make the program print notices, and suppress library warnings, which users cannot fix.

    Explicit warning filters stay active: tests turn warnings into errors.
    """
    NOTICES.addHandler(_LINES)
    # Some libraries warn during import.
    warnings.showwarning = lambda *_, **__: None
    logging.getLogger().addHandler(logging.NullHandler())


class _Lines(logging.Handler):
    """Log handler that prints each notice once, as a line on stderr."""

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


def ignore_progress(model: str, stage: str, part: float) -> None:
    """Ignore a progress report, in runs without a display of progress."""


@contextmanager
def display(models: Sequence[str] = (), case: str = "") -> Iterator[Progress]:
    """Yield a function that displays the progress of each stage of these models on stderr.

    Lines begin with the name of the case, since several cases may run at the same time.
    """
    console = Console(stderr=True)
    if not console.is_terminal:
        yield ProgressLines(models, case)
        return
    columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()
    bars: dict[str, TaskID] = {}
    with ProgressBars(*columns, console=console) as progress_bars:

        def update(model: str, stage: str, part: float) -> None:
            label = f"{model}: {stage}"
            if label not in bars:
                bars[label] = progress_bars.add_task(label, total=1.0)
            progress_bars.update(bars[label], completed=part)

        yield update


class ProgressLines:
    """Progress reporter that prints lines with case, model, stage and time."""

    def __init__(
        self,
        models: Sequence[str],
        case: str = "",
        say: Callable[[str], None] = say,
        clock: Callable[[], float] = perf_counter,
    ) -> None:
        self._models, self._say, self._clock = list(models), say, clock
        self._case = f"{case}: " if case else ""
        self._last_time = clock()
        self._starts: dict[tuple[str, str], float] = {}

    def __call__(self, model: str, stage: str, part: float) -> None:
        """Print the progress of a stage."""
        now = self._clock()
        elapsed = now - self._starts.setdefault((model, stage), now)
        if now - self._last_time < EVERY:
            return
        self._last_time = now
        state = f"{stage} started"
        if part >= 1.0:
            # Some stages report only their end.
            state = f"{stage} took {elapsed:.0f} s" if elapsed >= 1.0 else f"{stage} finished"
        elif part > 0.0:
            state = f"{stage} {100.0 * part:.0f} %"
            # Earlier estimates are unreliable.
            if part >= LEAST_PART:
                state += f", {elapsed * (1.0 - part) / part:.0f} s left"
        place = ""
        if model in self._models:
            place = f" ({self._models.index(model) + 1} of {len(self._models)})"
        self._say(printable(f"{self._case}{model}{place}: {state}"))
