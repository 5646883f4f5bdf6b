# SPDX-License-Identifier: LGPL-3.0-or-later
"""The elasticas that check small displacements, and the rule for their error."""

import numpy as np
import pytest
from scipy.optimize import brentq

from studies.large_deflections import PARTS, compare
from studies.reference_models.elastica import Rod, State


@pytest.mark.parametrize(
    ("load", "deflection", "shortening"),
    [(1, 0.301721, 0.056433), (2, 0.493457, 0.160642), (4, 0.669964, 0.328941),
     (8, 0.784982, 0.504828)],
)  # fmt: skip
def test_a_cantilever_with_a_dead_load(load: float, deflection: float, shortening: float) -> None:
    """Reference: external, elliptic integrals at P L²/(E J) = 1, 2, 4, 8, all digits given."""
    rod, force = Rod(1.0, 1.0), np.array([0.0, -float(load)])

    def end(moment: float) -> State:
        return rod.follow(State(0.0, 0.0, 0.0, moment), force, 1.0)[0]

    tip = end(brentq(lambda moment: end(moment).moment, -float(load), 0.0))
    assert (-tip.y, 1.0 - tip.x) == pytest.approx((deflection, shortening), abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("angle", "play"), [(0.0, 0.0), (45.0, 0.02), (70.0, 0.02)])
@pytest.mark.parametrize("part", PARTS[:2])
def test_the_rule_is_near_and_safe(part: float, angle: float, play: float) -> None:
    """Reference: other code, two elasticas; the rest is the couple P Δ of the axial force."""
    found = compare(part, angle, play)
    tip, moment = found.errors
    assert 0.9 * 1.1 * part**2 < tip < 1.1 * part**2 + 2.5e-3
    assert 0.8 * 0.65 * part**2 < moment < 0.65 * part**2 + 2.5e-3
