# SPDX-License-Identifier: LGPL-3.0-or-later
"""The inspection arm with friction, and equal friction rows of pads in the corners."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

import protractile as pt

CASES = Path(pt.__file__).parents[1] / "runs" / "cases"


@pytest.mark.parametrize("friction", [0.05, 0.15])
def test_arm_with_friction_moves_in_a_gust(friction: float) -> None:
    """Reference: analytic, the balance of energy; steps of half the length, to 1 % of the range."""
    tables = tomllib.loads((CASES / "inspection-arm.toml").read_text("utf-8"))
    for name in ("load_case", "combination", "spectrum"):
        del tables[name]
    gust = str(CASES / "gust.csv")
    tables["load"] = [load | {"file": gust} for load in tables["load"]]
    tables["joint"] = [
        joint | {"friction": friction, "lateral_play": 0.002} for joint in tables["joint"]
    ]
    tables["time"]["duration"] = 1.6
    beam = tables["model"][1]
    tables["model"] = [beam | {"step": 1e-3}, beam | {"name": "fine", "step": 5e-4}]
    results = pt.run_case(pt.load_case(tables))
    coarse, fine = (
        results.trajectories["tip_lateral"].sel(model=m).values for m in ("timoshenko", "fine")
    )
    assert float(np.abs(coarse - fine).max()) < 0.01 * float(np.ptp(fine))
    for model in results.summary.models.values():
        assert model.energy_residual < 1e-10
