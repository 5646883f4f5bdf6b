# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the motion of a model leaves, kept as soon as it ends: the next run goes on from there.

It is kept in the user's cache, not beside the run's folder: it serves whatever folder the next run
writes to, has checksums, and goes when nobody has asked for it for long.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import xarray as xr

from dynamics.trajectory import Trajectory
from runs.folder import records
from runs.folder.cache import Files, key
from runs.folder.memory import Keeper
from runs.folder.versions import program
from runs.pipeline.summary import ModelSummary


@dataclass(frozen=True, slots=True)
class Finished:
    """A motion that has ended; ``ensemble`` where the case asks for one."""

    trajectory: Trajectory
    summary: ModelSummary
    ensemble: xr.Dataset | None


def finished(
    keeper: Keeper | None, content: Sequence[Any], compute: Callable[[], Finished]
) -> Finished:
    """A motion as ``compute`` gives it, or as it was kept when it ended before.

    Args:
        keeper: of motions, such as the user's cache, which need not be writable; always computed
            unless given.
        content: all that it depends on.
        compute: the motion.

    Raises:
        NumericsError: it cannot be computed.
    """
    if keeper is None:
        return compute()
    name = key(list(content), program())
    found = keeper.load(name, _read)
    if found is not None:
        return found
    result = compute()
    keeper.remember(name, records.pack(result))
    return result


def _read(files: Files) -> Finished:
    return records.unpack(files, Finished)
