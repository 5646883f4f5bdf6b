# SPDX-License-Identifier: LGPL-3.0-or-later
"""Display of progress: bars in a terminal, lines elsewhere."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from time import perf_counter

from rich.console import Console
from rich.progress import BarColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.progress import Progress as ProgressBars

from runs.process.terminal import printable, say

# Callback that receives the name of the model, the stage, and the completed fraction of the stage.
Progress = Callable[[str, str, float], None]

# Minimum time in s between two lines; a shorter stage may print none.
EVERY = 5.0
# Completed fraction of a stage above which its remaining time is estimated.
LEAST_PART = 0.05


@contextmanager
def display(models: Sequence[str] = ()) -> Iterator[Progress]:
    """Yield a function that displays the progress of each stage on stderr.

    Args:
        models: names of the models to run, in order.
    """
    console = Console(stderr=True)
    if not console.is_terminal:
        yield Lines(models)
        return
    columns = TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn()
    bars: dict[str, TaskID] = {}
    with ProgressBars(*columns, console=console) as progress_bars:

        def update(model: str, stage: str, part: float) -> None:
            label = f"{model}: {stage}"
            if label not in bars:
                bars[label] = progress_bars.add_task(label, total=1.0)
            progress_bars.update(bars[label], completed=part)

        yield update


class Lines:
    """Progress reporter that prints lines with model, stage and time.

    Args:
        models: names of the models to run, in order.
        say: function that prints a line.
        clock: function that returns the time in s.
    """

    def __init__(
        self,
        models: Sequence[str],
        say: Callable[[str], None] = say,
        clock: Callable[[], float] = perf_counter,
    ) -> None:
        self._models, self._say, self._clock = list(models), say, clock
        self._last_time = clock()
        self._starts: dict[tuple[str, str], float] = {}

    def __call__(self, model: str, stage: str, part: float) -> None:
        """Print the progress of a stage."""
        now = self._clock()
        elapsed = now - self._starts.setdefault((model, stage), now)
        if now - self._last_time < EVERY:
            return
        self._last_time = now
        state = f"{stage} started"
        if part >= 1.0:
            # Some stages report only their end.
            state = f"{stage} took {elapsed:.0f} s" if elapsed >= 1.0 else f"{stage} finished"
        elif part > 0.0:
            state = f"{stage} {100.0 * part:.0f} %"
            # Earlier estimates are unreliable.
            if part >= LEAST_PART:
                state += f", {elapsed * (1.0 - part) / part:.0f} s left"
        place = ""
        if model in self._models:
            place = f" ({self._models.index(model) + 1} of {len(self._models)})"
        self._say(printable(f"{model}{place}: {state}"))
