# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact damping gives the restitution that it was chosen for, and never pulls."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from dynamics.contact import PowerContact, restitution_damping
from dynamics.gap_system import GapSystem
from dynamics.integrator import FixedStep
from dynamics.motion import Motion

OneMass = Callable[..., GapSystem]


@pytest.mark.parametrize("restitution", [0.05, 0.3, 0.8, 0.99, 0.99999, 1.0 - 1e-12])
def test_damping_of_a_restitution(restitution: float) -> None:
    """Reference: analytic, (e + 1) v = ln[(1 + d v)/(1 − d e v)]/d, and d = 3(1 − e)/(2 v) close to
    e = 1 (Hunt and Crossley 1975)."""
    speed = 1.7
    damping = restitution_damping(restitution, speed)
    x = damping * speed
    assert 0.0 < x < 1.0 / restitution
    left, right = (1.0 + restitution) * x, np.log1p(x) - np.log1p(-restitution * x)
    assert left == pytest.approx(right, rel=1e-9 if restitution > 0.1 else 1e-6)
    if restitution > 0.999:
        assert x == pytest.approx(1.5 * (1.0 - restitution), rel=1.1 * (1.0 - restitution) + 1e-4)


def test_a_full_rebound_needs_no_damping_and_speed_divides_it() -> None:
    assert restitution_damping(1.0, 3.0) == 0.0
    assert restitution_damping(0.6, 2.0) == pytest.approx(restitution_damping(0.6, 1.0) / 2.0)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
@pytest.mark.parametrize("restitution", [0.3, 0.8])
def test_a_mass_rebounds_as_it_should(
    one_mass: OneMass, exponent: float, restitution: float
) -> None:
    """Reference: analytic, the same e for every exponent. The error falls with the step."""
    mass, speed = 3.0, 2.0
    damping = restitution_damping(restitution, speed)
    stiffness = {1.0: 1.0e6, 1.5: 1.0e8, 2.0: 1.0e9}[exponent]
    stop = PowerContact(stiffness, exponent, damping=damping).upper().behind(0.01)
    errors = []
    motion = Motion(one_mass(mass, stop), 0.05, 1.0e-3, velocity=np.array([speed * np.sqrt(mass)]))
    for step in (4.0e-5, 1.0e-5):
        run = FixedStep(step)(motion)
        assert run.data.attrs["contact_changes"] == 2
        after = float(np.diff(run.data["tip"].values)[-1]) / -1.0e-3
        errors.append(abs(after / speed - restitution))
        lost = 0.5 * mass * speed**2 * (1.0 - restitution**2)
        assert float(run.data["contact_loss"][-1]) == pytest.approx(lost, rel=2e-3)
        assert float(run.data["contact_force"].min()) >= 0.0
    assert errors[0] < 1e-3
    assert errors[1] < errors[0] / 8.0


def test_contact_never_pulls(one_mass: OneMass) -> None:
    """A load tears a mass off a stop faster than 1/d: the contact lets go, and what it still
    stored is lost."""
    stop = PowerContact(stiffness=1.0e4, exponent=1.0, damping=5.0).upper()
    system = one_mass(1.0, stop, force=-2.0e3)
    run = FixedStep(1e-5)(Motion(system, 0.05, output_step=1e-4, position=np.array([0.1])))
    force = run.data["contact_force"].values
    assert force.min() >= 0.0
    tip = run.data["tip"].values
    assert (force[1:, 0][(tip[1:] > 0.01) & (tip[1:] < 0.09)] == 0.0).any()
    assert float(run.data["contact_loss"][-1]) > 0.5 * 0.5 * 1.0e4 * 0.1**2


@pytest.mark.parametrize(
    ("restitution", "speed", "message"),
    [
        (0.0, 1.0, "restitution must be above 0 and at most 1, got 0.0"),
        (1.1, 1.0, "restitution must be above 0 and at most 1, got 1.1"),
        (0.5, 0.0, "speed must be finite and positive, got 0.0 m/s"),
        (0.5, float("inf"), "speed must be finite and positive, got inf m/s"),
    ],
)
def test_bad_values_are_refused(restitution: float, speed: float, message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        restitution_damping(restitution, speed)
