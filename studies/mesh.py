# SPDX-License-Identifier: LGPL-3.0-or-later
"""Mesh error of the shell of the paper's boom relative to the limit of fine meshes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from scipy.signal import find_peaks

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.trajectory import Trajectory
from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.models import MotionPlan
from studies.motions import friction_case, gap_system, scale_mesh, set_duration, shell_of
from studies.refined import Refined, refined_table
from studies.study import Piece, Progress, define_study

# Permitted error of the default mesh, relative to infinitely fine meshes.
ALLOWED = 0.01

NOTE = (
    "Order, Richardson's limit and the grid convergence index of the finest mesh, from the three "
    "finest, with the safety factor 1.25 (Roache 1994). No order where values do not go one way "
    "with ever smaller steps."
)


class Sizes(NamedTuple):
    """Parameters of the study."""

    #: Edge lengths over the default ones, each half the one before, three at least.
    meshes: Sequence[float] = (4.0, 2.0, 1.0, 0.5)
    default: float = 1.0  #: edge length of the mesh whose error is checked
    duration: float = 3.0  #: duration of the motion in s
    #: Numbers of natural frequencies and of first tip peaks.
    frequencies: int = 3
    peaks: int = 3


@define_study("mesh", "Meshes of the paper's boom")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Compare frequencies and tip peaks of the paper's boom on several meshes."""
    sizes = sizes or Sizes()
    case = set_duration(friction_case(), sizes.duration)
    results = []
    for part in sizes.meshes:
        progress(f"edges x {part:g}")
        model = scale_mesh(shell_of(case), part)
        system = gap_system(case, build_boom(case), model)
        motion = MotionPlan.of(system, case, model).trajectory(lambda part: None)
        results.append(_quantities(system, motion, sizes))
    found = [
        Refined(what, unit, sizes.meshes, [result[what, unit] for result in results])
        for what, unit in results[-1]
    ]
    yield refined_table("meshes", "Meshes, with friction", found, "edges × {:g}", (NOTE,))
    finest = f"edges × {sizes.meshes[-1]:g}"
    for one in found:
        yield one.against_limit(f"{one.what}, default mesh", sizes.default, finest, ALLOWED)


def peak_heights(motion: Trajectory) -> list[float]:
    """Return the heights of tip peaks in m, by parabolas through the three highest outputs."""
    tip = np.asarray(motion.data["tip"].values)
    places, _ = find_peaks(tip, prominence=0.2 * np.ptp(tip))
    before, top, after = tip[places - 1], tip[places], tip[places + 1]
    bend = before - 2.0 * top + after
    return [float(height) for height in top - 0.125 * (after - before) ** 2 / bend]


def _quantities(
    system: GapSystem, motion: Trajectory, sizes: Sizes
) -> dict[tuple[str, str], float]:
    """Return the values of one mesh by quantity and unit."""
    elastic = system.frequencies[system.frequencies > 0.0][: sizes.frequencies]
    found = {(f"natural frequency {i}", "Hz"): float(f) for i, f in enumerate(elastic, start=1)}
    for i, height in enumerate(peak_heights(motion)[: sizes.peaks], start=1):
        found[f"tip peak {i}", "mm"] = 1.0e3 * height
    return found
