# SPDX-License-Identifier: LGPL-3.0-or-later
"""Progress reporter of the stages of a computation, with their wall times."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter


class Stages:
    """Progress reporter; ``seconds`` has the wall time in s of each stage.

    >>> stages = Stages(print)
    >>> with stages.stage("mesh") as progress:
    ...     progress(0.5)
    mesh 0.0
    mesh 0.5
    mesh 1.0

    Args:
        progress: callback that receives the stage and its completed fraction.
    """

    def __init__(self, progress: Callable[[str, float], None] | None = None) -> None:
        self.progress = progress or (lambda stage, part: None)
        self.seconds: dict[str, float] = {}

    @contextmanager
    def stage(
        self, name: str, number: int = 0, count: int = 1
    ) -> Iterator[Callable[[float], None]]:
        """Measure part ``number`` of ``count`` of a stage, and yield a progress callback for it."""
        begin = perf_counter()
        self.progress(name, number / count)
        yield lambda part: self.progress(name, (number + part) / count)
        self.progress(name, (number + 1) / count)
        self.seconds[name] = self.seconds.get(name, 0.0) + perf_counter() - begin
