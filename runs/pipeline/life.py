# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the stress ranges of a motion do to a welded detail.

Cycles are counted by the rainflow method (Matsuishi and Endo 1968; ASTM E1049). A range does damage
by the curve of its detail category after EN 1993-1-9, 7.1, in Miner's sum: N = 2e6 (C/Δσ)³ up to
5e6 cycles, from there on of the slope 5, and none below the cut-off at 1e8.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from geometry.arrays import Array
from runs.case.schema import LifeTable
from runs.pipeline.answers import Life, rounded
from runs.pipeline.moved import Varying

# Cycles at which a category is named, at the constant-amplitude limit, and at the cut-off.
NAMED, LIMIT, CUT_OFF = 2.0e6, 5.0e6, 1.0e8
STEEP, FLAT = 3.0, 5.0

# Debian's own packages have no such counter: there a run goes without it.
COUNTS = find_spec("rainflow") is not None

# In Pa, as categories are named.
_MEGA = 1.0e6

# Classes of ranges that are kept.
_CLASSES = 20


class Ranges(NamedTuple):
    """Ranges in Pa and how many cycles each has, halves among them, (num_ranges,) each."""

    sizes: Array
    counts: Array


def counted(stress: Sequence[float] | Array) -> Ranges:
    """The cycles of a stress in Pa, rainflow counted."""
    import rainflow

    found = [(size, count) for size, count in rainflow.count_cycles(stress) if size > 0.0]
    sizes, counts = np.array(found, dtype=float).reshape(-1, 2).T
    return Ranges(sizes, counts)


def endurance(sizes: Array, category: float) -> Array:
    """(num_ranges,) cycles to failure of ranges in Pa; infinite below the cut-off.

    Args:
        sizes: the ranges.
        category: in Pa.
    """
    limit = category * (NAMED / LIMIT) ** (1.0 / STEEP)
    cut_off = limit * (LIMIT / CUT_OFF) ** (1.0 / FLAT)
    relative = np.maximum(sizes, cut_off) / limit
    cycles = LIMIT * np.where(relative >= 1.0, relative**-STEEP, relative**-FLAT)
    return np.asarray(np.where(sizes >= cut_off, cycles, np.inf))


def life(varying: Varying, table: LifeTable) -> Life:
    """What a segment goes through where its stress varies most.

    Args:
        varying: the stress.
        table: of the case.
    """
    sizes, counts = counted(varying.stress)
    damage = None
    if table.detail_category is not None:
        raised = table.partial_factor * sizes
        damage = float((counts / endurance(raised, _MEGA * table.detail_category)).sum())
    largest = float(sizes.max(initial=0.0))
    kept, edges = np.histogram(sizes, _CLASSES, (0.0, largest or 1.0), weights=counts)
    return Life(
        varying.segment,
        *varying.at,
        cycles=float(counts.sum()),
        largest=largest,
        equivalent=float((counts @ sizes**STEEP) ** (1.0 / STEEP)),
        ranges=rounded(0.5 * (edges[1:] + edges[:-1])),
        counts=rounded(kept),
        damage=damage,
        life_damage=None if damage is None else table.repeats * damage,
    )
