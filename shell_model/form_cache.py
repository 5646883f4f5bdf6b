# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compiled forms on the disk, one process at a time.

FFCx marks a form as begun before it compiles it. Whoever meets the mark waits for the rest, ten
seconds at most, and fails: behind a slow process, and for ever behind one that was killed. So this
program's forms lie in a folder of their own, in which one process compiles at a time: what is only
begun there when its turn has come was left by a killed one.
"""

from __future__ import annotations

import fcntl
from collections.abc import Callable
from contextlib import suppress
from functools import wraps
from pathlib import Path
from typing import Any

from mpi4py import MPI

Compile = Callable[..., Any]

OWN = "protractile"


def one_at_a_time(compile_form: Compile, folder: Callable[[], Path]) -> Compile:
    """A compiler that waits until no other process compiles. Collective, as it is without.

    Args:
        compile_form: of the communicator and a form; the first rank compiles.
        folder: where compiled forms are, which is this program's own if it is called ``OWN``.
    """

    @wraps(compile_form)
    def compiled(comm: MPI.Comm, *arguments: Any, **options: Any) -> Any:
        if comm.rank != 0 or folder().name != OWN:
            return compile_form(comm, *arguments, **options)
        folder().mkdir(parents=True, exist_ok=True)
        with (folder() / "lock").open("w") as lock:
            # Some disks of clusters have no locks.
            with suppress(OSError):
                fcntl.flock(lock, fcntl.LOCK_EX)
            for begun in folder().glob("*.c"):
                if not begun.with_suffix(".c.cached").exists():
                    begun.unlink()
            return compile_form(comm, *arguments, **options)

    return compiled
