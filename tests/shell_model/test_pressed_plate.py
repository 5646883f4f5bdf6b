# SPDX-License-Identifier: LGPL-3.0-or-later
"""A wall under a pad: the shell against plate theory, and the theory against tables."""

from __future__ import annotations

import pytest

from studies.reference_models.plates import STEEL
from studies.reference_models.pressed_plate import Edges, PressedPlate, flange

pytestmark = pytest.mark.slow


@pytest.mark.parametrize(("edges", "factor"), [("simply supported", 0.0116), ("clamped", 0.0056)])
def test_a_small_patch_is_a_point(edges: Edges, factor: float) -> None:
    """Reference: external, α of w = α P a²/D in the middle of a square plate (Timoshenko and
    Woinowsky-Krieger 1959, tables 23 and 37).
    """
    a, t = 1.0, 2.0e-3
    plate = PressedPlate(a, a, t, (0.49, 0.49), (0.51, 0.51), edges)
    stiffness = STEEL.youngs_modulus * t**3 / (12.0 * (1.0 - STEEL.poissons_ratio**2))
    assert plate.theory() == pytest.approx(factor * a**2 / stiffness, rel=0.01)


def test_polynomials_find_the_series_of_sines() -> None:
    """Reference: analytic, Navier's double series."""
    plate = flange("simply supported")
    assert plate.theory() == pytest.approx(plate.navier(), rel=1.0e-3)


@pytest.mark.parametrize("edges", ["simply supported", "clamped"])
def test_the_shell_gives_way_as_the_plate(edges: Edges) -> None:
    """Reference: other code, Ritz's method; four edges over the shorter side of the patch."""
    plate = flange(edges)
    assert plate.shell(0.0125) == pytest.approx(plate.theory(), rel=0.01)
