# SPDX-License-Identifier: LGPL-3.0-or-later
"""A contact may have one play above and another below, and may be pressed in from both sides."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from dynamics.contact import PowerContact, contact_limits
from dynamics.gap_system import GapSystem
from dynamics.integrator import FixedStep
from dynamics.motion import Motion

OneMass = Callable[..., GapSystem]

POWER = PowerContact(1.0e6, 2.0, stiffness_below=2.0e9)
LAW = POWER.behind(4.0e-3, 10.0e-3)


def test_each_side_has_its_own_clearance() -> None:
    """Reference: analytic, 1 mm beyond either: 1e6 · 1e-6 and 2e9 · 1e-6."""
    y = np.array([-11.0e-3, -9.0e-3, 3.0e-3, 5.0e-3])
    assert LAW.force(y) == pytest.approx([-2000.0, 0.0, 0.0, 1.0], rel=1e-9)
    (limits,) = contact_limits([LAW])
    assert (limits["low"], limits["high"]) == (-10.0e-3, 4.0e-3)


def test_parts_are_those_of_its_law() -> None:
    y = np.linspace(-0.02, 0.02, 41)
    above = LAW.one_sided(1)
    assert above is not None
    assert above.terms == POWER.upper().behind(4.0e-3, 10.0e-3).terms
    assert above.one_sided(-1) is None
    assert POWER.upper().behind(4.0e-3).one_sided(-1) is None
    np.testing.assert_allclose(LAW.shared(0.25).force(y), 0.25 * LAW.force(y), rtol=1e-12)
    moved = LAW.behind(1.0e-3)
    assert (moved.above, moved.below) == pytest.approx((5.0e-3, 11.0e-3))


@pytest.mark.parametrize(
    ("clearance", "message"),
    [
        (
            -1.0e-3,
            "a law must be linear behind a negative clearance, got k 1e+06, 2e+09 below, n 2",
        ),
        (np.nan, "clearance must be a finite number of m, got nan and nan"),
    ],
)
def test_bad_gaps_are_refused(clearance: float, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        POWER.behind(clearance)


def test_preloaded_mass_leaves_one_contact_side(one_mass: OneMass) -> None:
    """Reference: analytic. √(2 k/m) up to the interference, then √(k/m) about F/k − δ."""
    k, pressed, load = 1.0e4, 2.0e-3, 60.0
    both, one = np.sqrt([2.0 * k, k])
    system = one_mass(1.0, PowerContact(k, 1.0).behind(-pressed), force=load)
    leaves = np.arccos(1.0 - 2.0 * k * pressed / load) / both
    speed = load / (2.0 * k) * both * np.sin(both * leaves)
    middle = load / k - pressed
    run = FixedStep(1e-6)(Motion(system, 0.03, output_step=1.0e-4))
    time = run.data["time"].values
    flight = one * (time - leaves)
    after = middle + (pressed - middle) * np.cos(flight) + speed / one * np.sin(flight)
    before = load / (2.0 * k) * (1.0 - np.cos(both * time))
    exact = np.where(time < leaves, before, after)
    assert exact.max() > 1.5 * pressed
    assert exact[-1] > pressed
    np.testing.assert_allclose(run.data["tip"], exact, atol=1e-6 * exact.max())
