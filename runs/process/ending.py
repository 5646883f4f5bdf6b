# SPDX-License-Identifier: LGPL-3.0-or-later
"""Early end of a process: by Ctrl-C, by SIGTERM, or by an error on one rank.

A signal ends a command at any time, with one line on stderr. No clean-up is necessary, since files
are written atomically. If a compiled loop or an MPI call delays the signal handler of Python, a
separate thread ends the process. A run of beams does not import mpi4py; only the first process of
``mpirun -n N protractile`` then works.
"""

from __future__ import annotations

import ctypes
import fcntl
import os
import signal
import stat
import sys
import termios
import time
from array import array
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from threading import Event, RLock, Thread
from typing import TYPE_CHECKING, NoReturn

from protractile.runs.process.terminal import say

if TYPE_CHECKING:
    from mpi4py import MPI

LINE = b"protractile: interrupted\n"

# Time in s that the thread gives the signal handler to end the process.
GRACE = 1.0

# Escape sequence that clears the line of a progress bar and shows the cursor.
_CLEAR = b"\r\x1b[K\x1b[?25h"

# Environment variables in which Open MPI, PMIx and MPICH give a process its rank.
_LAUNCHERS = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK")
# Settings of Open MPI for a process without launcher, which needs no daemon, no network and no
# folder: a process that is killed would leave the folder behind. MPI starts in 0.06 s with these
# settings, and in 0.4 s without them.
SINGLE_PROCESS = {
    "OMPI_MCA_ess_singleton_isolated": "1",
    "OMPI_MCA_orte_create_session_dirs": "0",
    "OMPI_MCA_pml": "ob1",
    "OMPI_MCA_btl": "self",
}

# Time in s that other ranks wait before they report: rank 0 reports alone if it also fails.
_GRACE_OF_RANKS = 5.0
# Longest time in s to wait until a message is read, and interval of the checks.
_MAX_WAIT, _INTERVAL = 5.0, 1.0e-3

# Option of the system call prctl: the signal that a process receives when its parent ends.
_PARENT_DEATH_SIGNAL = 1

_cleanups: list[Callable[[], object]] = []
_ending = RLock()
_signals: list[int] = []


def listen() -> None:
    """Install handlers that end the process on Ctrl-C and SIGTERM, with status 130 or 143.

    A signal that the parent process ignores stays ignored, as with ``nohup``.
    """
    reader, wakeup = os.pipe()
    os.set_blocking(wakeup, False)
    signal.set_wakeup_fd(wakeup)
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) is not signal.SIG_IGN:
            signal.signal(number, _end)
    Thread(target=_watch, args=(reader,), daemon=True).start()


def end_with_parent(parent: int) -> None:
    """Let SIGTERM end this process as soon as the thread of its parent that started it has ended.

    A parent that is killed cannot end its children. ``parent`` is the number of the parent process.
    """
    ctypes.CDLL(None).prctl(_PARENT_DEATH_SIGNAL, signal.SIGTERM)
    if os.getppid() != parent:
        os.kill(os.getpid(), signal.SIGTERM)


@contextmanager
def when_interrupted(work: Callable[[], object]) -> Iterator[None]:
    """Call a function if a signal ends the process within the context."""
    _cleanups.append(work)
    try:
        yield
    finally:
        _cleanups.remove(work)


def launched_rank() -> int | None:
    """Return the rank that a launcher has given this process; None without a launcher."""
    ranks = (os.environ.get(name, "") for name in _LAUNCHERS)
    # Values that are not numbers are ignored.
    return next((int(number) for number in ranks if number.isdecimal()), None)


def leave(status: int) -> NoReturn:
    """End this process at once: the libraries would take up to a second to free their memory.

    A rank ends as usual, since its launcher waits for all ranks.
    """
    if launched_rank() is not None:
        sys.exit(status)
    # Without this call Open MPI's folder in the temporary folder remains.
    if mpi := sys.modules.get("mpi4py.MPI"):
        mpi.Finalize()
    os._exit(status)


def fail(line: str, code: int, comm: MPI.Comm | None) -> NoReturn:
    """End all ranks with an exit status, and print one line on stderr.

    Without a communicator, before MPI starts, every rank ends by itself, but only rank 0 with the
    message and the status: an earlier error of another rank would make the launcher cut the message
    off.
    """
    if comm is None or comm.size == 1:
        if launched_rank():
            sys.exit(0)
        say(line)
        sys.exit(code)
    if comm.rank != 0:
        time.sleep(_GRACE_OF_RANKS)
    say(line)
    with suppress(OSError):
        _wait_until_read(sys.stderr.fileno())
    comm.Abort(code)
    raise AssertionError("MPI_Abort returned")


def _wait_until_read(stream: int) -> None:
    """Wait until a pipe is empty, since Open MPI 5 would mix the line with its own message."""
    if not stat.S_ISFIFO(os.fstat(stream).st_mode):
        return
    unread = array("i", [1])
    deadline = time.monotonic() + _MAX_WAIT
    while unread[0] and time.monotonic() < deadline:
        time.sleep(_INTERVAL)
        fcntl.ioctl(stream, termios.FIONREAD, unread)


def _watch(reader: int) -> None:
    while True:
        (number,) = os.read(reader, 1)
        if number in (signal.SIGINT, signal.SIGTERM):
            time.sleep(GRACE)
            _end(number)


def _end(number: int, frame: object = None) -> None:
    if not _ending.acquire(blocking=False):
        # Another thread is ending the process.
        Event().wait()
    _signals.append(number)
    if len(_signals) > 1:
        # A second signal may interrupt this function, which then continues.
        return
    # An interrupt reaches all ranks, and the first one reports it.
    if not launched_rank():
        with suppress(OSError):
            os.write(2, _CLEAR + LINE if os.isatty(2) else LINE)
        # Nothing follows this line: other threads may still report progress, or killed processes.
        with suppress(OSError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
    for work in reversed(_cleanups):
        with suppress(Exception):
            work()
    os._exit(128 + number)
