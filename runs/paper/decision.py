# SPDX-License-Identifier: LGPL-3.0-or-later
"""Decisions on comparisons of numbers that have standard errors.

The round-off of another processor gives another sample of a chaotic motion. A number that depends
on the sample is compared with a threshold only if it is three standard errors away from it, so that
every processor gives the same verdict.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr, stdtrit

from protractile.geometry.arrays import Array
from protractile.runs.paper.verdicts import Judgement

# Least distance from a threshold, in standard errors, that decides a verdict.
DECISIVE = 3.0


class Excess(NamedTuple):
    """Excess of a number over another, which reproduces a statement if it is positive."""

    greater: float
    less: float
    error: float = 0.0  #: standard error of the excess; 0 if it does not depend on the sample

    @property
    def distance(self) -> float:
        """The excess in standard errors; infinite without a standard error."""
        excess = self.greater - self.less
        if self.error == 0.0:
            return float(np.copysign(np.inf, excess)) if excess else 0.0
        return excess / self.error


def decide(*parts: Excess) -> tuple[Judgement, float | None]:
    """Return the verdict on a statement of several parts, and its distance from the thresholds.

    The part with the lowest excess decides: the statement is contradicted if this excess is below
    minus three standard errors, reproduced if above three, otherwise undecided. The distance is the
    size of this excess in standard errors; None if it has no standard error.
    """
    lowest = min(part.distance for part in parts)
    distance = abs(lowest) if np.isfinite(lowest) else None
    if abs(lowest) < DECISIVE:
        return "undecided", distance
    return ("reproduced" if lowest > 0.0 else "contradicted"), distance


@dataclass(frozen=True, slots=True)
class Finding:
    """Result of a rule. Its fields are those of :class:`.runs.paper.verdicts.Verdict`."""

    verdict: Judgement
    why: str
    measured: float | None = None
    threshold: float | None = None
    unit: str = ""
    distance: float | None = None


def finding(
    parts: Sequence[Excess], why: str, measured: float, threshold: float, unit: str
) -> Finding:
    """Return the finding on a statement of several parts."""
    judgement, distance = decide(*parts)
    return Finding(judgement, why, measured, threshold, unit, distance)


def mean_of(samples: Array) -> tuple[float, float]:
    """Return the mean of samples, and its standard error.

    The error of few samples is larger, so that three errors have the probability of a normal
    distribution (Student 1908).
    """
    error = samples.std(ddof=1) / np.sqrt(samples.size)
    return float(samples.mean()), float(
        error * stdtrit(samples.size - 1, ndtr(DECISIVE)) / DECISIVE
    )
