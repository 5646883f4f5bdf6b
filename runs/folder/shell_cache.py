# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduced shells from the cache: a second run of the same boom neither meshes nor reduces it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING, Any

from runs.folder import records
from runs.folder.cache import Cache, Files, key
from runs.folder.versions import program

if TYPE_CHECKING:
    from mpi4py import MPI

    from shell_model.reduced_shell import ReducedShell


def remembered(
    cache: Cache,
    content: Sequence[Any],
    comm: MPI.Comm,
    compute: Callable[[], ReducedShell],
) -> ReducedShell:
    """A shell as ``compute`` gives it, from the cache if it is there. Collective.

    A cache that cannot be read or written costs time and a line to say so, and nothing else. Of
    processes that want the same shell at a time one makes it, and the others wait for it.

    Args:
        cache: of the user.
        content: all that the shell depends on.
        comm: the ranks that share the work; the first one reads and writes.
        compute: the shell. Collective.
    """
    start = perf_counter()
    name = key(list(content), program())
    with cache.making(name) if comm.rank == 0 else nullcontext():
        found = cache.load(name, _read) if comm.rank == 0 else None
        # Fields and meshes are the first rank's alone.
        shared = comm.bcast(None if found is None else replace(found, fields=None, meshes=[]))
        if shared is not None:
            return replace(found or shared, seconds={"cache": perf_counter() - start})
        reduced = compute()
        if comm.rank == 0:
            cache.remember(name, records.pack(reduced))
    return reduced


def _read(files: Files) -> ReducedShell:
    from shell_model.reduced_shell import ReducedShell

    return records.unpack(files, ReducedShell)
