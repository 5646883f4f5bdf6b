# SPDX-License-Identifier: LGPL-3.0-or-later
"""The context of a run: ranks, progress, cache."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from runs.folder.cache import Cache
from runs.process.progress import Progress

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from mpi4py import MPI


def silent(model: str, stage: str, part: float) -> None:
    """Ignore the progress, as a :data:`runs.process.progress.Progress` without display."""


@dataclass(frozen=True, slots=True)
class RunContext:
    """The context of a run: ranks, folders and progress.

    Args:
        comm: the ranks that share the shells and the ensembles; a case without shells can do
            without.
        progress: receives the progress of every stage.
        cache: cache of reduced shells.
        motions: store of completed motions, earlier ones and those of this run.
        helper: a process beside the only rank, for shells and pictures.
    """

    comm: MPI.Intracomm | None = None
    progress: Progress = silent
    cache: Cache | None = None
    motions: Cache | None = None
    helper: Executor | None = None

    @property
    def first_rank(self) -> bool:
        """True if this is the first rank, which writes files and integrates reduced models."""
        return self.comm is None or self.comm.rank == 0

    @property
    def alone(self) -> bool:
        """True if no other rank waits for this one."""
        return self.comm is None or self.comm.size == 1
