# SPDX-License-Identifier: LGPL-3.0-or-later
"""Energy balance of damped booms under their weight. Reference: conservation of energy."""

from pathlib import Path

import numpy as np
import pytest

from tests.runs.case_texts import REST, STEEL, box, elements, joint, read_case, table
from tests.runs.summaries import motion_of

HEAD = f"""
title = "Under its weight"
time = {{ duration = 0.5, output_step = 1e-2 }}
{STEEL}{REST}{elements("elements", element_length=2.5)}
"""

# Three segments of 18 m with a cage, on which a load comes.
LIFT = f"""
{box("base", (0.0, 7.0), (0.40, 0.26, 0.008, 0.006), "supports = [0.0, 1.5]")}
load = -640.0
{box("middle", (6.0, 12.5), (0.36, 0.22, 0.006, 0.005), "load = -480.0")}
{box("fly", (11.5, 18.0), (0.32, 0.18, 0.005, 0.004), "load = -330.0")}
{joint("middle", "base", 0.006, (6.0, 7.0))}
{joint("fly", "middle", 0.006, (11.5, 12.5))}
{table("[payload]", mass=230.0)}
{table("[[load]]", segment="fly", x=18.0, magnitude=-300.0, ramp=0.2)}
"""

# An arm in space in a gust from a file.
ARM = f"""
{box("base", (0.0, 8.0), (0.50, 0.32, 0.008, 0.006), "supports = [0.0, 1.5]")}
load = -800.0
{box("fly", (7.0, 14.0), (0.46, 0.28, 0.006, 0.005), "load = -500.0")}
{joint("fly", "base", 0.006, (7.0, 8.0), "lateral_play = 0.006")}
{table("[[load]]", segment="fly", direction="y", magnitude=120.0, file="gust.csv")}
"""


@pytest.mark.parametrize("damping", ["modal = 0.015", "stiffness = 3e-4"])
@pytest.mark.parametrize("boom", [LIFT, ARM], ids=["lift", "arm in space"])
def test_a_pressed_boom_keeps_its_ledger(tmp_path: Path, boom: str, damping: str) -> None:
    gust = np.column_stack([np.linspace(0.0, 1.0, 21), np.abs(np.sin(np.linspace(0.0, 9.0, 21)))])
    np.savetxt(tmp_path / "gust.csv", gust, delimiter=",")
    run = motion_of(read_case(tmp_path, HEAD + boom + f"[damping]\n{damping}\n"))
    assert run.energy_residual < 1e-4
    loss = np.diff(run.data["damping_loss"].values)
    assert loss.min() >= 0.0
    assert loss.sum() > 0.0
