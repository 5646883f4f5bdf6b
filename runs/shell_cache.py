# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduced shells from the cache: a second run of the same boom neither meshes nor reduces it."""

from __future__ import annotations

import pickle
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any, NamedTuple

from runs.cache import Cache, key, sources
from runs.versions import versions

if TYPE_CHECKING:
    from mpi4py import MPI

    from shell_model.boom_shell import ReducedShell

_FILE = "shell.pickle"
# What decides a reduction beside its data.
_ROOMS = ("geometry", "dynamics", "shell_model")


class _Kept(NamedTuple):
    """A shell, and gmsh's files by their names: whole in one file, or damaged together."""

    reduced: ReducedShell
    meshes: dict[str, bytes]


def remembered(
    cache: Cache,
    content: Sequence[Any],
    comm: MPI.Comm,
    mesh_folder: Path,
    compute: Callable[[], ReducedShell],
) -> ReducedShell:
    """A shell as ``compute`` gives it, from the cache if it is there. Collective.

    A cache that cannot be read or written costs time and nothing else.

    Args:
        cache: of the user.
        content: all that the shell depends on.
        comm: the ranks that share the work; the first one reads and writes.
        mesh_folder: where ``compute`` leaves gmsh's files ``SEGMENT.msh``.
        compute: the shell. Collective.
    """
    start = perf_counter()
    top = Path(__file__).parents[1]
    name = key(list(content), sources(*(top / room for room in _ROOMS)), versions())
    found = _load(cache, name, mesh_folder) if comm.rank == 0 else None
    # Fields and meshes are the first rank's alone.
    shared = comm.bcast(None if found is None else replace(found, fields=None, meshes=[]))
    if shared is not None:
        return replace(found or shared, seconds={"cache": perf_counter() - start})
    reduced = compute()
    if comm.rank == 0:
        with suppress(OSError):
            _keep(cache, name, mesh_folder, reduced)
    return reduced


def _load(cache: Cache, name: str, mesh_folder: Path) -> ReducedShell | None:
    entry = cache.find(name)
    if entry is None:
        return None
    try:
        with (entry / _FILE).open("rb") as file:
            kept: _Kept = pickle.load(file)
    except Exception:
        # Whatever has become of an entry on the disk: it is made again.
        cache.drop(name)
        return None
    for file_name, content in kept.meshes.items():
        (mesh_folder / file_name).write_bytes(content)
    return kept.reduced


def _keep(cache: Cache, name: str, mesh_folder: Path, reduced: ReducedShell) -> None:
    meshes = {path.name: path.read_bytes() for path in mesh_folder.glob("*.msh")}
    with cache.fill(name) as folder, (folder / _FILE).open("wb") as file:
        pickle.dump(_Kept(reduced, meshes), file, protocol=pickle.HIGHEST_PROTOCOL)
