# SPDX-License-Identifier: LGPL-3.0-or-later
"""Context of a run: ranks, progress reporter, caches and helper process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from runs.folder.cache import Cache
from runs.process.terminal import Progress

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from mpi4py import MPI


def ignore_progress(model: str, stage: str, part: float) -> None:
    """Ignore a progress report, in runs without a display of progress."""


@dataclass(frozen=True, slots=True)
class RunContext:
    """Ranks, progress reporter, caches and helper process of a run."""

    #: ranks that share the shells and the ensembles; None for a case without shells
    comm: MPI.Intracomm | None = None
    #: callback that receives model, stage and completed fraction
    progress: Progress = ignore_progress
    cache: Cache | None = None  #: cache of reduced shells
    motions: Cache | None = None  #: cache of completed motions
    #: second process for shells and pictures if there is only one rank
    helper: Executor | None = None
    #: modules for pictures, which the helper imports after it has reduced a shell
    renderers: Sequence[str] = ()

    @property
    def first_rank(self) -> bool:
        """True for the first rank, which writes files and integrates reduced models."""
        return self.comm is None or self.comm.rank == 0

    @property
    def alone(self) -> bool:
        """True if no other rank waits for this one."""
        return self.comm is None or self.comm.size == 1
