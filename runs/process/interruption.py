# SPDX-License-Identifier: LGPL-3.0-or-later
"""Ctrl-C and SIGTERM end a command with one line, whatever it is doing.

Nothing is unwound: what is being written lies beside its place until it is whole, so that a process
may end at any moment. Python runs a signal's handler between two of its own instructions. Where a
compiled loop, or a message of another rank, keeps it waiting, a thread of its own does the same.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Event, RLock, Thread
from time import sleep

from runs.process import ranks

LINE = b"protractile: interrupted\n"

# Seconds for which the thread leaves it to the handler.
GRACE = 1.0

# Clears the line of a progress bar, and shows the cursor again.
_CLEAR = b"\r\x1b[K\x1b[?25h"

_undone: list[Callable[[], object]] = []
_ending = RLock()
_signals: list[int] = []


def listen() -> None:
    """From now on Ctrl-C and SIGTERM end this process, with exit status 130 or 143.

    A signal that whoever has started the process ignores stays ignored, as with ``nohup``.
    """
    caught, told = os.pipe()
    os.set_blocking(told, False)
    signal.set_wakeup_fd(told)
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _end)
    Thread(target=_watch, args=(caught,), daemon=True).start()


@contextmanager
def undone(work: Callable[[], object]) -> Iterator[None]:
    """What is to be done besides if the process is interrupted meanwhile."""
    _undone.append(work)
    try:
        yield
    finally:
        _undone.remove(work)


def _watch(caught: int) -> None:
    while True:
        (number,) = os.read(caught, 1)
        if number in (signal.SIGINT, signal.SIGTERM):
            sleep(GRACE)
            _end(number)


def _end(number: int, frame: object = None) -> None:
    if not _ending.acquire(blocking=False):
        # The other one is at it.
        Event().wait()
    _signals.append(number)
    if len(_signals) > 1:
        # A second one interrupts this very function, which goes on.
        return
    # The first rank speaks for all; it is interrupted when another one is.
    if ranks.launched_rank() == 0:
        with suppress(OSError):
            os.write(2, _CLEAR + LINE if os.isatty(2) else LINE)
    for work in reversed(_undone):
        with suppress(Exception):
            work()
    os._exit(128 + number)
