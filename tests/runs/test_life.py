# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rainflow cycles and S-N curves of the standards."""

import numpy as np
import pytest

pytest.importorskip("rainflow", reason="the cycles are counted by it")

from protractile.runs.case.schema import LifeTable
from protractile.runs.pipeline.strength import StressCurve, count_stress_ranges, endurance, life


def test_cycles_are_those_of_the_standard() -> None:
    """Reference: external, ASTM E1049-85, figure 6: 3 and 4, 6, 8, 9 in half cycles."""
    sizes, counts = count_stress_ranges([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
    expected = {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}
    assert dict(zip(sizes.tolist(), counts.tolist(), strict=True)) == expected


def test_a_curve_has_the_points_of_the_code() -> None:
    """Reference: external, EN 1993-1-9, 7.1, category 71: 71, 52.3 and 28.7 N/mm²."""
    sizes = 1e6 * np.array([142.0, 71.0, 52.31, 40.0, 28.74, 28.70])
    expected = [2e6 / 8.0, 2e6, 5e6, 5e6 * (52.31 / 40.0) ** 5, 1e8, np.inf]
    np.testing.assert_allclose(endurance(sizes, 71e6), expected, rtol=1e-3)


def test_damage_of_a_sine_equals_the_damage_of_its_cycles() -> None:
    """Reference: by hand, 10/2e6 (115/71)³ for a run, and the equivalent range 10^⅓ 100 MPa."""
    time = np.linspace(0.0, 10.0, 10 * 400 + 1)
    stress = 50e6 * np.cos(2.0 * np.pi * time)
    table = LifeTable(detail_category=71.0, partial_factor=1.15, repeats=20_000)
    found = life(StressCurve("arm", (2.0, 0.0, 0.1), stress), table)
    assert (found.segment, found.x, found.z) == ("arm", 2.0, 0.1)
    assert found.cycles == pytest.approx(10.0)
    assert found.damage == pytest.approx(10.0 / 2e6 * (115.0 / 71.0) ** 3, rel=1e-9)
    assert found.life_damage == pytest.approx(20_000.0 * found.damage)
    assert found.equivalent == pytest.approx(100e6 * 10.0 ** (1.0 / 3.0), rel=1e-9)
    assert found.counts[-1] == pytest.approx(10.0)
    assert sum(found.counts) == pytest.approx(found.cycles)
    # Without a category ranges are counted alone.
    still = life(StressCurve("arm", (2.0, 0.0, 0.1), np.zeros(5)), LifeTable())
    assert (still.cycles, still.largest, still.equivalent, still.damage) == (0.0, 0.0, 0.0, None)
