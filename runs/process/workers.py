# SPDX-License-Identifier: LGPL-3.0-or-later
"""Worker processes on other cores."""

from __future__ import annotations

import os
import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, InvalidStateError, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import active_children, get_context, parent_process
from multiprocessing.util import Finalize
from threading import Thread
from typing import Any

from protractile.runs.process.ending import SINGLE_PROCESS, leave, when_interrupted
from protractile.runs.process.terminal import show_notices

# Environment variables of workers: one thread each, and no warnings at import or when killed.
_WORKER_VARIABLES = dict.fromkeys(
    ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"), "1"
) | {"PYTHONWARNINGS": "ignore"}
# Time in s for which a killed process is awaited.
_KILL_TIME = 1.0
# Prefixes of environment variables by which Open MPI, PMIx and MPICH make a process a rank.
_RANK_PREFIXES = ("OMPI_", "PMIX_", "PMI_")


class _Task(Future[Any]):
    """Work of a pool. A process may end after a task is cancelled, and the task stays cancelled.

    The error of a plain future would be printed by the thread of the pool.
    """

    def set_exception(self, exception: BaseException | None) -> None:
        """Set the error of the work, unless it is cancelled."""
        with suppress(InvalidStateError):
            super().set_exception(exception)


class _SignalProofPool(ProcessPoolExecutor):
    """Pool of processes that ignore signals to the process group, such as Ctrl-C."""

    def submit(self, work: Callable[..., Any], /, *positional: Any, **named: Any) -> Future[Any]:
        """Submit work; processes start with blocked signals and the environment of workers."""
        with _worker_environment():
            task = super().submit(work, *positional, **named)
        task.__class__ = _Task
        return task


@contextmanager
def _worker_environment() -> Iterator[None]:
    """Block signals and set environment variables for processes that start in this context."""
    signals = {signal.SIGINT, signal.SIGTERM}
    signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    previous = {name: os.environ[name] for name in _WORKER_VARIABLES if name in os.environ}
    os.environ.update(_WORKER_VARIABLES)
    try:
        yield
    finally:
        for name in _WORKER_VARIABLES:
            del os.environ[name]
        os.environ.update(previous)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, signals)


@contextmanager
def workers(count: int | None = None, prepare: Callable[[], object] = int) -> Iterator[Executor]:
    """Yield an executor of several processes, by default one per core, which end with this process.

    Each process calls ``prepare`` first.
    """
    # Python's resource tracker starts with the pool; the variables switch its warnings off.
    with _worker_environment():
        pool = _SignalProofPool(count or os.cpu_count(), get_context("spawn"), _start, (prepare,))
    try:
        with when_interrupted(end):
            yield pool
    except BaseException:
        end()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


@contextmanager
def helper(prepare: Callable[[], object] = int) -> Iterator[Executor | None]:
    """Yield an executor of one process on another core; None if there is only one core.

    The process starts with the first work, calls ``prepare``, and ends with this process.
    """
    if len(os.sched_getaffinity(0)) == 1:
        yield None
        return
    with workers(1, prepare) as executor:
        yield executor


def end() -> None:
    """End all worker processes, and wait until they have ended."""
    children = active_children()
    for process in children:
        process.kill()
    for process in children:
        process.join(_KILL_TIME)


def _start(prepare: Callable[[], object]) -> None:
    """Initialise a worker, which is no MPI rank and ends with its parent."""
    show_notices()
    for name in [name for name in os.environ if name.startswith(_RANK_PREFIXES)]:
        del os.environ[name]
    os.environ.update(SINGLE_PROCESS)
    Finalize(None, leave, (0,), exitpriority=-1)
    Thread(target=_end_with_parent, daemon=True).start()
    prepare()


def _end_with_parent() -> None:
    parent = parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)
