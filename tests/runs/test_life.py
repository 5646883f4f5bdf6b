# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rainflow cycles and S-N curves of the standards."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rainflow", reason="the cycles are counted by it")

from protractile.analysis.fatigue import count_stress_ranges
from protractile.cases import run_case
from tests.runs.case_texts import CLAMPED, STEEL, box, elements, read_case


@pytest.mark.parametrize("seed", range(5))
def test_a_repetition_adds_what_the_history_written_twice_adds(seed: int) -> None:
    """Reference: other code, rainflow cycles of the history twice in a row, less those of one."""
    import rainflow

    stress = np.random.default_rng(seed).normal(0.0, 50e6, 100)
    added = Counter(dict(rainflow.count_cycles([*stress, *stress])))
    added.subtract(dict(rainflow.count_cycles(stress)))
    sizes, counts = count_stress_ranges(stress)
    cubes = sum(count * size**3 for size, count in added.items())
    assert counts @ sizes**3 == pytest.approx(cubes, rel=1e-9)


@pytest.mark.parametrize(
    ("load", "ramp", "damping", "damage"),
    [(-7704.9, 2.0, 0.3, 0.0282), (-3852.45, 0.001, 0.05, 0.0570)],
)
def test_damage_of_a_load_that_remains(
    tmp_path: Path, load: float, ramp: float, damping: float, damage: float
) -> None:
    """Reference: by hand, a load that rises slowly to 100 MPa or suddenly to 50 MPa.

    Slowly: one full cycle. Suddenly: full cycles of 110.6, 77.1, 56.3, 41.0 and 29.9 MPa, from each
    trough to the next peak of the decaying vibration, whose stress includes higher modes.
    """
    text = f"""
title = "Load that remains"
time = {{ duration = 4.0, output_step = 0.002 }}
damping = {{ modal = {damping} }}
life = {{ detail_category = 71.0, repeats = 20000 }}
load = [{{ segment = "a", x = "head", magnitude = {load}, ramp = {ramp} }}]
{STEEL}
{box("a", 4.0, (0.2, 0.15, 0.008, 0.006), CLAMPED)}
{elements("beam", theory="euler-bernoulli")}
"""
    results = run_case(read_case(tmp_path, text))
    (found,) = results.rows.where(quantity="damage")
    assert found.value == pytest.approx(damage, rel=0.005)
