# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers of a case file with a tolerance, ``{ mean = 0.003, sd = 0.0005 }``."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple, TypeGuard

from runs.case.messages import BadInput


class Spread(NamedTuple):
    """Normal distribution of one number of a case file, in the units of the file."""

    steps: tuple[str | int, ...]  #: path of keys and indices to the number
    mean: float  #: mean value, which runs and checks take
    sd: float  #: standard deviation


def take_means(tables: Mapping[str, object], file: str) -> tuple[dict[str, object], list[Spread]]:
    """Return the tables of a case file with means in place of distributions, and the distributions.

    Raises:
        BadInput: a mean is not a finite number, or a standard deviation is not a number above 0.
    """
    spreads: list[Spread] = []

    def taken(here: object, steps: tuple[str | int, ...]) -> object:
        if isinstance(here, list):
            return [taken(value, (*steps, i)) for i, value in enumerate(here)]
        if not isinstance(here, Mapping):
            return here
        if here.keys() != {"mean", "sd"}:
            return {key: taken(value, (*steps, key)) for key, value in here.items()}
        mean, sd = here["mean"], here["sd"]
        if not (_finite(mean) and _finite(sd) and sd > 0.0):
            key = "".join(f"[{s + 1}]" if isinstance(s, int) else f".{s}" for s in steps)[1:]
            what = f"must have a finite mean and an sd above 0, got {mean!r} and {sd!r}"
            raise BadInput(file, key, what)
        spreads.append(Spread(steps, float(mean), float(sd)))
        return mean

    return {key: taken(value, (key,)) for key, value in tables.items()}, spreads


def _finite(value: object) -> TypeGuard[float]:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return math.isfinite(value)
