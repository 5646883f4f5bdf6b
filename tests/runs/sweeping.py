# SPDX-License-Identifier: LGPL-3.0-or-later
"""A sweep of the coarse case's quick models, run in this process."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from protractile.runs import CASES
from protractile.runs.sweep import run as sweep
from protractile.runs.sweep.points import Plan
from protractile.runs.sweep.run import Outcome

COARSE = CASES / "coarse.toml"
FAST = ["kantorovich-4", "beam-fe-bonded"]

Planned = Callable[..., Plan]


def run(planned: Plan, folder: Path = Path("out")) -> list[Outcome]:
    """Return all outcomes of a sweep, run in this process."""
    sweep.prepare(folder, planned.file)
    with ThreadPoolExecutor(1) as pool:
        return sweep.run_points(planned, folder, pool, lambda *_: None)
