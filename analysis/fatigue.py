# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fatigue damage of stress histories.

Cycles of the repeated history are counted by the rainflow method (Matsuishi and Endo 1968; ASTM
E1049). Miner's sum uses the S-N curve of the detail category (EN 1993-1-9, 7.1): N = 2e6 (C/Δσ)³
up to 5e6 cycles, slope 5 from there on, and no damage below the cut-off limit at 1e8 cycles.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib.util import find_spec

import numpy as np

from protractile.analysis.model import round_values
from protractile.analysis.stresses import StressCurve
from protractile.geometry.arrays import Array

# Numbers of cycles at the detail category, the constant-amplitude limit and the cut-off limit.
CATEGORY_CYCLES, LIMIT, CUT_OFF = 2.0e6, 5.0e6, 1.0e8
STEEP, FLAT = 3.0, 5.0

# Debian has no package rainflow. Without it the fatigue assessment is left out.
HAS_RAINFLOW = find_spec("rainflow") is not None

# Fraction of the largest stress range, the usual tolerance of the time step, up to which ranges are
# numerical errors. A million of them do 0.1 % of the damage of the largest range.
NOISE = 1.0e-3

# Unit of detail categories in Pa.
MEGA = 1.0e6

# Number of classes of stored stress ranges.
_CLASSES = 20


@dataclass(frozen=True, slots=True)
class Life:
    """Fatigue damage of a detail at the outer fibre with the largest stress variation."""

    segment: str  #: name of the segment
    x: float  #: position along the boom in m
    y: float  #: lateral position in m
    z: float  #: vertical position in m
    cycles: float  #: number of cycles in a repetition of the run
    largest: float  #: largest stress range in Pa
    equivalent: float  #: stress range in Pa of a single cycle with the same damage at slope 3
    ranges: list[float]  #: centres (num_classes) of the classes of stress ranges in Pa, ascending
    counts: list[float]  #: number of cycles in each class
    #: damage of the run for the detail category of the case; None without a category
    damage: float | None
    #: damage of all repetitions in the service life; None without a category
    life_damage: float | None


def count_stress_ranges(stress: Array) -> tuple[Array, Array]:
    """Return the stress ranges (num_ranges,) of a repeated stress history in Pa, and their counts.

    Each repetition returns from the last stress to the first one. The history is counted from its
    largest |stress| around to it, so that no half cycles remain (ASTM E1049-85, 5.4.5). Ranges that
    are small as errors of the motion do not count.
    """
    import rainflow

    start = int(np.abs(stress).argmax())
    cycles = [*rainflow.count_cycles([*np.roll(stress, -start), stress[start]])]
    sizes, counts = np.array(cycles, dtype=float).reshape(-1, 2).T
    counted = sizes > NOISE * np.ptp(stress)
    return sizes[counted], counts[counted]


def endurance(sizes: Array, category: float) -> Array:
    """Return the cycles to failure (num_ranges,), which are infinite below the cut-off limit.

    Stress ranges and detail category are in Pa.
    """
    limit = category * (CATEGORY_CYCLES / LIMIT) ** (1.0 / STEEP)
    cut_off = limit * (LIMIT / CUT_OFF) ** (1.0 / FLAT)
    relative = np.maximum(sizes, cut_off) / limit
    cycles = LIMIT * np.where(relative >= 1.0, relative**-STEEP, relative**-FLAT)
    return np.asarray(np.where(sizes >= cut_off, cycles, np.inf))


def life(
    stress_history: StressCurve, category: float | None, partial_factor: float, repeats: float
) -> Life:
    """Return the fatigue damage of a segment at the fibre with the largest stress variation.

    ``category`` is the detail category in MPa, ``repeats`` the number of runs in the service life.
    """
    sizes, counts = count_stress_ranges(stress_history.stress)
    damage = None
    if category is not None:
        raised = partial_factor * sizes
        damage = float((counts / endurance(raised, MEGA * category)).sum())
    largest = float(sizes.max(initial=0.0))
    kept, edges = np.histogram(sizes, _CLASSES, (0.0, largest or 1.0), weights=counts)
    return Life(
        stress_history.segment,
        *stress_history.at,
        cycles=float(counts.sum()),
        largest=largest,
        equivalent=float((counts @ sizes**STEEP) ** (1.0 / STEEP)),
        ranges=round_values(0.5 * (edges[1:] + edges[:-1])),
        counts=round_values(kept),
        damage=damage,
        life_damage=None if damage is None else repeats * damage,
    )
