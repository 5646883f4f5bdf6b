# SPDX-License-Identifier: LGPL-3.0-or-later
"""The contact law gives back exactly the energy it took, on the sides where there is a stop."""

import re
from dataclasses import replace

import numpy as np
import pytest

from dynamics.contact import PowerContact

POWER = PowerContact(stiffness=1.0e13, exponent=2.0, stiffness_below=4.0e12)
LAW = POWER.behind(7.0e-3)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_force_is_the_gradient_of_the_energy(exponent: float) -> None:
    """Reference: analytic. A central difference of the potential, second order in its step."""
    law = PowerContact(1.0e13, exponent, stiffness_below=3.0e12).behind(7.0e-3)
    y = np.linspace(-8.0e-3, 8.0e-3, 41)
    y = y[np.abs(np.abs(y) - law.onset(1.0)) > 1.0e-5]
    errors = []
    for step in (2.0e-6, 1.0e-6):
        slope = (law.energy(y + step) - law.energy(y - step)) / (2.0 * step)
        errors.append(np.abs(slope - law.force(y)).max() / np.abs(law.force(y)).max())
    assert errors[-1] < 1.0e-5
    if exponent > 2.0:  # up to a quadratic force the difference is exact
        assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.1)


def test_each_side_has_its_own_stiffness() -> None:
    """Reference: analytic, 10 µm beyond 7 mm: k p² and k p³/3."""
    y = np.array([-7.01e-3, 7.01e-3])
    assert LAW.force(y) == pytest.approx([-4.0e2, 1.0e3], rel=1e-9)
    assert LAW.energy(y) == pytest.approx([4.0e-3 / 3.0, 1.0e-2 / 3.0], rel=1e-9)


def test_below_is_as_above_unless_given() -> None:
    law = PowerContact(stiffness=1.0e10, exponent=1.5)
    y = np.linspace(-1.0e-3, 1.0e-3, 7)
    assert law.below == 1.0e10
    np.testing.assert_array_equal(law.force(-y), -law.force(y))


def test_open_contact_has_no_force() -> None:
    y = np.array([-7.0e-3, -6.9e-3, 0.0, 6.9e-3, 7.0e-3])
    assert not LAW.force(y).any()
    assert not LAW.energy(y).any()


def test_sides_add_up_to_the_whole() -> None:
    y = np.linspace(-9.0e-3, 9.0e-3, 19)
    upper, lower = POWER.upper(), POWER.lower()
    assert not upper.force(y[y < 0.0]).any()
    assert not lower.force(y[y > 0.0]).any()
    np.testing.assert_array_equal(upper.force(y) + lower.force(y), POWER.force(y))
    np.testing.assert_array_equal(upper.energy(y) + lower.energy(y), POWER.energy(y))


def test_parts_of_a_law_are_damped_as_it_is() -> None:
    law = replace(POWER, damping=0.3)
    assert {part.damping for part in (law.upper(), law.lower(), law.shared(0.25))} == {0.3}
    assert POWER.damping == 0.0


@pytest.mark.parametrize(
    "law", [POWER, POWER.upper(), POWER.lower()], ids=["both", "upper", "lower"]
)
def test_shares_add_up_to_the_whole(law: PowerContact) -> None:
    y = np.linspace(-9.0e-3, 9.0e-3, 19)
    total = sum(law.shared(weight).force(y) for weight in (0.125, 0.25, 0.625))
    np.testing.assert_allclose(total, law.force(y), rtol=1e-14)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"stiffness": -1.0}, "stiffness must be a number of N/m^n, not negative, got -1.0"),
        ({"stiffness_below": -1.0},
         "stiffness_below must be a number of N/m^n, not negative, got -1.0"),
        ({"stiffness": float("inf")}, "stiffness must be a number of N/m^n, not negative, got inf"),
        ({"stiffness": 0.0}, "stiffness must be positive on one side at least, got 0.0 on both"),
        ({"stiffness": 0.0, "stiffness_below": 0.0},
         "stiffness must be positive on one side at least, got 0.0 on both"),
        ({"exponent": 0.5}, "exponent must be at least 1, got 0.5"),
        ({"exponent": float("nan")}, "exponent must be at least 1, got nan"),
        ({"damping": -1.0}, "damping must be finite and not negative, got -1.0 s/m"),
        ({"damping": float("nan")}, "damping must be finite and not negative, got nan s/m"),
    ],
)  # fmt: skip
def test_bad_values_are_refused(arguments: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        PowerContact(**{"stiffness": 1.0e13, "exponent": 2.0, **arguments})


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 10.0])
@pytest.mark.parametrize("force", [1.0e-40, 1.0e-18, 1.0e-3, 1.0e5, 1.0e200])
def test_the_slope_is_known_at_any_force(exponent: float, force: float) -> None:
    """Reference: analytic. k pⁿ = F, on the stiffer side; far less than a clearance and far more
    than any number of a case among them.
    """
    n, k = exponent, 1.0e13
    law = PowerContact(0.5 * k, n, stiffness_below=k).behind(7.0e-3)
    assert law.slope_at(force) == pytest.approx(n * k * (force / k) ** ((n - 1.0) / n), rel=1e-9)


@pytest.mark.parametrize("force", [0.0, np.inf])
def test_a_linear_law_has_its_slope_at_no_force_and_at_any(force: float) -> None:
    """Reference: analytic."""
    assert PowerContact(1.0e9, 1.0).slope_at(force) == pytest.approx(1.0e9)
