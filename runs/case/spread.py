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

    def replace_by_means(item: object, steps: tuple[str | int, ...]) -> object:
        if isinstance(item, list):
            return [replace_by_means(value, (*steps, i)) for i, value in enumerate(item)]
        if not isinstance(item, Mapping):
            return item
        if item.keys() != {"mean", "sd"}:
            return {key: replace_by_means(value, (*steps, key)) for key, value in item.items()}
        mean, sd = item["mean"], item["sd"]
        if not (_is_finite(mean) and _is_finite(sd) and sd > 0.0):
            key = "".join(f"[{s + 1}]" if isinstance(s, int) else f".{s}" for s in steps)[1:]
            what = f"must have a finite mean and an sd above 0, got {mean!r} and {sd!r}"
            raise BadInput(file, key, what)
        spreads.append(Spread(steps, float(mean), float(sd)))
        return mean

    return {key: replace_by_means(value, (key,)) for key, value in tables.items()}, spreads


def _is_finite(value: object) -> TypeGuard[float]:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return math.isfinite(value)
