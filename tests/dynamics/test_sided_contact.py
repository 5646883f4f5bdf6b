# SPDX-License-Identifier: LGPL-3.0-or-later
"""A contact may have one play above and another below, and may be pressed in from both sides."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from dynamics.contact import ContactLaw, PowerContact, contact_limits
from dynamics.gap_system import GapSystem
from dynamics.integrator import FixedStep
from dynamics.motion import Motion
from dynamics.sided_contact import SidedContact

OneMass = Callable[..., GapSystem]

NEAR = PowerContact(1.0e6, 1.0, clearance=4.0e-3)
FAR = PowerContact(2.0e9, 2.0, clearance=10.0e-3)
LAW = SidedContact(NEAR, FAR)


def test_each_side_follows_its_own_law() -> None:
    """Reference: analytic, 1 mm beyond either play: 1e6 · 1e-3 and 2e9 · 1e-6."""
    y = np.array([-11.0e-3, -9.0e-3, 3.0e-3, 5.0e-3])
    assert LAW.force(y) == pytest.approx([-2000.0, 0.0, 0.0, 1000.0], rel=1e-9)
    (limits,) = contact_limits([LAW])
    assert (limits["low"], limits["high"]) == (-10.0e-3, 4.0e-3)


def test_the_play_is_that_of_both_sides() -> None:
    """Reference: by hand; a rigid segment falls across all of it."""
    assert pytest.approx(14.0e-3) == LAW.play
    assert NEAR.play == NEAR.upper().play == 8.0e-3
    assert replace(NEAR, clearance=-1.0e-3).play == 0.0


def test_parts_are_those_of_its_laws() -> None:
    y = np.linspace(-0.02, 0.02, 41)
    above, below = LAW.one_sided(1), LAW.one_sided(-1)
    assert above == NEAR.upper()
    assert below == FAR.lower()
    np.testing.assert_allclose(LAW.shared(0.25).force(y), 0.25 * LAW.force(y), rtol=1e-12)
    moved = LAW.behind(5.0e-3)
    assert (moved.above.clearance, moved.below.clearance) == pytest.approx((5.0e-3, 11.0e-3))


@pytest.mark.parametrize(
    ("above", "below", "message"),
    [
        (NEAR.lower(), FAR, "each law must touch on its own side"),
        (
            NEAR,
            replace(FAR, damping=0.5),
            "both laws must have the same damping, got 0.0 and 0.5 s/m",
        ),
    ],
)
def test_refuses_what_is_no_contact(above: ContactLaw, below: ContactLaw, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        SidedContact(above, below)


def test_a_mass_leaves_one_side_of_what_presses_it(one_mass: OneMass) -> None:
    """Reference: analytic. √(2 k/m) up to the interference, then √(k/m) about F/k − δ."""
    k, pressed, load = 1.0e4, 2.0e-3, 60.0
    both, one = np.sqrt([2.0 * k, k])
    system = one_mass(1.0, PowerContact(k, 1.0, clearance=-pressed), force=load)
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
