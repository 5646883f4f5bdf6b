# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a run is made with, whatever its case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from runs.folder.cache import Cache, Memory

if TYPE_CHECKING:
    from mpi4py import MPI

# Called with the model's name, the stage, and the part of it that is done.
Progress = Callable[[str, str, float], None]


def silent(model: str, stage: str, part: float) -> None:
    """A :data:`Progress` that nobody watches."""


@dataclass(frozen=True, slots=True)
class Means:
    """Ranks, places, and who is told.

    Args:
        comm: the ranks that share the shells and the ensembles; a case without shells can do
            without.
        progress: told about every stage.
        cache: of reduced shells.
        kept: where motions are that have ended before, and those that end now are kept.
    """

    comm: MPI.Intracomm | None = None
    progress: Progress = silent
    cache: Cache | None = None
    kept: Cache | Memory | None = None

    @property
    def first_rank(self) -> bool:
        """Whether this one writes, and moves what is reduced."""
        return self.comm is None or self.comm.rank == 0

    @property
    def alone(self) -> bool:
        """Whether no other rank waits for this one."""
        return self.comm is None or self.comm.size == 1
