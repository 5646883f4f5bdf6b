# SPDX-License-Identifier: LGPL-3.0-or-later
"""Which process of ``mpirun -n N protractile`` this is, and how all of them end together.

MPI itself is entered for a shell alone: a beam's run neither needs nor imports mpi4py, and
its other processes have nothing to do.
"""

from __future__ import annotations

import fcntl
import os
import stat
import sys
import termios
import time
from array import array
from contextlib import suppress
from typing import TYPE_CHECKING, NoReturn

from runs.process.terminal import say

if TYPE_CHECKING:
    from mpi4py import MPI

# Rank as the launcher tells it before MPI is entered: Open MPI, PMIx, MPICH and its kin.
_LAUNCHERS = ("OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK")

# Seconds for which another rank's message waits: if rank 0 has failed too, it speaks alone.
_GRACE = 5.0
# Seconds for which a message may wait to be read.
_UNREAD = 5.0
# Seconds between looks at whether the launcher has read a message.
_LOOK = 1.0e-3


def launched() -> bool:
    """Whether a launcher has started this process."""
    return bool(_told())


def launched_rank() -> int:
    """This process's rank, 0 without a launcher."""
    return next(iter(_told()), 0)


def _told() -> list[int]:
    """This process's rank as each launcher tells it; what is no number is none's."""
    said = (os.environ.get(name, "") for name in _LAUNCHERS)
    return [int(number) for number in said if number.isdecimal()]


def fail(line: str, code: int, comm: MPI.Comm | None) -> NoReturn:
    """End all ranks, with one line on stderr.

    Args:
        line: what went wrong.
        code: exit status.
        comm: None as long as MPI has not been entered. Until then all ranks do the same and
            end by themselves; the status is rank 0's, since a launcher would cut its message
            short if another one ended before it with a status other than 0.
    """
    if comm is None or comm.size == 1:
        if launched_rank() != 0:
            sys.exit(0)
        say(line)
        sys.exit(code)
    if comm.rank != 0:
        time.sleep(_GRACE)
    say(line)
    with suppress(OSError):
        _until_read(sys.stderr.fileno())
    comm.Abort(code)
    raise AssertionError("MPI_Abort returned")


def _until_read(stream: int) -> None:
    """Wait until a pipe is empty, so that what its reader says of the end comes after it.

    Open MPI 5 else puts our line behind its own on the abort, and in the same line of the terminal.

    Args:
        stream: a file descriptor that can be written; only a pipe is waited for.
    """
    if not stat.S_ISFIFO(os.fstat(stream).st_mode):
        return
    unread = array("i", [1])
    deadline = time.monotonic() + _UNREAD
    while unread[0] and time.monotonic() < deadline:
        time.sleep(_LOOK)
        fcntl.ioctl(stream, termios.FIONREAD, unread)
