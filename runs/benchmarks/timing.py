# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wall times, and as many of their digits as mean something."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from statistics import median
from time import perf_counter

# What takes less is run as often as takes so many seconds together, and the mean counts.
MEASURABLE = 0.05

NOISE = (
    "Medians. The last digit shown is the first that the spread, half the range of the "
    "repetitions, reaches; ~ where the noise exceeds one digit. One repetition shows one digit."
)


def shown(values: Sequence[float]) -> str:
    """The median with the digits that the spread leaves, ``~`` before it if not one is left.

    The spread is half the range; its first digit is the last that is shown. A single value
    has no known spread and is shown with one digit.
    """
    middle = median(values)
    if middle == 0.0 or not math.isfinite(middle):
        return f"{middle:g}"
    spread = 0.5 * (max(values) - min(values))
    leading = math.floor(math.log10(abs(middle)))
    last = math.floor(math.log10(spread)) if spread > 0.0 else leading
    digits = max(1, min(leading - last + 1, 3)) if len(values) > 1 else 1
    place = leading - digits + 1
    text = f"{round(middle, -place):.{max(0, -place)}f}"
    return f"~{text}" if len(values) > 1 and last >= leading and spread > 0.0 else text


def by_turns(runs: Sequence[Callable[[], object]], most: int, budget: float) -> list[list[float]]:
    """Wall seconds of each run, all once before any is repeated.

    Args:
        runs: what takes the time.
        most: repetitions of each.
        budget: wall seconds of one run, all its repetitions, beyond which it is not repeated.
    """
    seconds: list[list[float]] = [[] for _ in runs]
    for _ in range(most):
        for run, taken in zip(runs, seconds, strict=True):
            if sum(taken) < budget:
                taken.append(_mean(run))
    return seconds


def _mean(run: Callable[[], object]) -> float:
    count, seconds = 0, 0.0
    start = perf_counter()
    while seconds < MEASURABLE:
        run()
        count += 1
        seconds = perf_counter() - start
    return seconds / count
