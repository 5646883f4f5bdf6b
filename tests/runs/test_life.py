# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rainflow cycles and S-N curves of the standards."""

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("rainflow", reason="the cycles are counted by it")

from protractile.analysis.fatigue import Life, count_stress_ranges, endurance, life_rows
from protractile.analysis.measure import Measured
from protractile.analysis.rows import Row
from protractile.cases import run_case
from protractile.geometry.arrays import Array
from tests.runs.case_texts import CLAMPED, STEEL, box, elements, read_case


def life(
    stress: Array, category: float | None = None, factor: float = 1.0, repeats: float = 1.0
) -> dict[str, Row]:
    """Return the rows of a stress history in Pa at x = 2 m, z = 0.1 m of a segment."""
    at = np.array([2.0]), np.array([0.0]), np.array([0.1])
    measured = Measured("stress", "arm", "", stress[:, None], None, at)
    found = life_rows([measured], "beam", True, Life(category, factor, repeats))
    return {row.quantity: row for row in found}


def test_cycles_are_those_of_the_standard() -> None:
    """Reference: external, ASTM E1049-85, figure 7 for repeated histories: 3, 4, 7 and 9 once."""
    stress = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
    for start in range(8):
        # The history may begin anywhere.
        sizes, counts = count_stress_ranges(np.roll(stress[:-1], start))
        counted = {size: counts[sizes == size].sum() for size in sizes.tolist()}
        assert counted == {3.0: 1.0, 4.0: 1.0, 7.0: 1.0, 9.0: 1.0}


def test_a_repetition_of_loading_also_unloads() -> None:
    """Reference: by hand, 20000/2e6 (100/71)³ for a rise to 100 MPa; noise makes no cycles."""
    rise = 100e6 * np.minimum(np.linspace(0.0, 2.0, 401), 1.0)
    noise = 1e4 * np.resize([0.0, 1.0], 200)
    rise[-200:] -= noise
    found = life(rise, 71.0, 1.0, 20_000)
    assert found["cycles"].value == 1.0
    assert found["damage"].value == pytest.approx(20_000 / 2e6 * (100.0 / 71.0) ** 3, rel=1e-6)


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


def test_a_curve_has_the_points_of_the_code() -> None:
    """Reference: external, EN 1993-1-9, 7.1, category 71: 71, 52.3 and 28.7 N/mm²."""
    sizes = 1e6 * np.array([142.0, 71.0, 52.31, 40.0, 28.74, 28.70])
    expected = [2e6 / 8.0, 2e6, 5e6, 5e6 * (52.31 / 40.0) ** 5, 1e8, np.inf]
    np.testing.assert_allclose(endurance(sizes, 71e6), expected, rtol=1e-3)


def test_damage_of_a_sine_equals_the_damage_of_its_cycles() -> None:
    """Reference: by hand, 10/2e6 (115/71)³ for a run, and the equivalent range 10^⅓ 100 MPa."""
    time = np.linspace(0.0, 10.0, 10 * 400 + 1)
    stress = 50e6 * np.cos(2.0 * np.pi * time)
    found = life(stress, 71.0, 1.15, 20_000)
    values = {name: row.value for name, row in found.items()}
    assert (found["damage"].part, found["damage"].x, found["damage"].z) == ("arm", 2.0, 0.1)
    assert values["cycles"] == pytest.approx(10.0)
    assert values["run_damage"] == pytest.approx(10.0 / 2e6 * (115.0 / 71.0) ** 3, rel=1e-9)
    assert values["damage"] == pytest.approx(20_000.0 * values["run_damage"])
    assert found["damage"].utilisation == values["damage"]
    assert values["equivalent_range"] == pytest.approx(100e6 * 10.0 ** (1.0 / 3.0), rel=1e-9)
    # Without a category ranges are counted alone.
    still = {name: row.value for name, row in life(np.zeros(5)).items()}
    assert still == {"cycles": 0.0, "stress_range": 0.0, "equivalent_range": 0.0}
