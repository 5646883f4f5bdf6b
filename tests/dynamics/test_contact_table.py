# SPDX-License-Identifier: LGPL-3.0-or-later
"""A contact law by a table: what it says, what it keeps, what it refuses."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import trapezoid

from dynamics.contact import PowerContact
from dynamics.contact_table import TableContact
from dynamics.gap_system import GapSystem
from dynamics.integrator import FixedStep
from dynamics.motion import Motion

# Softer after the first millimetre, then stiff: a pad that gives way and bottoms out.
DEPTHS, FORCES = (1.0e-3, 3.0e-3, 4.0e-3), (2.0e3, 3.0e3, 9.0e3)
LAW = TableContact(DEPTHS, FORCES).behind(7.0e-3)


def test_the_force_is_the_table_and_its_last_line() -> None:
    """Reference: analytic, linear interpolation and, beyond, 6e6 N/m."""
    depth = np.linspace(0.0, 4.0e-3, 33)
    expected = np.interp(depth, (0.0, *DEPTHS), (0.0, *FORCES))
    np.testing.assert_allclose(LAW.force(7.0e-3 + depth), expected, atol=1e-8)
    np.testing.assert_allclose(LAW.force(-7.0e-3 - depth), -expected, atol=1e-8)
    assert LAW.force(np.array(12.0e-3)) == pytest.approx(9.0e3 + 6.0e6 * 1.0e-3, rel=1e-12)


def test_the_energy_is_the_area_under_the_table() -> None:
    """Reference: analytic, trapezoids."""

    expected = trapezoid((0.0, *FORCES), (0.0, *DEPTHS))
    assert LAW.energy(np.array([-11.0e-3, 11.0e-3])) == pytest.approx([expected] * 2, rel=1e-12)


def test_parts_are_tables_again() -> None:
    y = np.linspace(-12.0e-3, 12.0e-3, 25)
    above, below = LAW.one_sided(1), LAW.one_sided(-1)
    assert above is not None
    assert below is not None
    assert above.one_sided(-1) is None
    np.testing.assert_allclose(above.force(y) + below.force(y), LAW.force(y), atol=1e-8)
    np.testing.assert_allclose(LAW.shared(0.25).force(y), 0.25 * LAW.force(y), atol=1e-8)
    np.testing.assert_allclose(LAW.behind(7.0e-3).force(y + 7.0e-3), above.force(y), atol=1e-8)


def test_one_line_is_a_linear_stop() -> None:
    """Reference: other code, the linear law; stiffnesses for the step among it."""
    table, power = (
        TableContact((1.0e-3,), (2.0e3,)).behind(5.0e-3),
        PowerContact(2.0e6, 1.0).behind(5.0e-3),
    )
    y = np.linspace(-9.0e-3, 9.0e-3, 19)
    np.testing.assert_allclose(table.force(y), power.force(y), rtol=1e-14)
    assert table.slope_at(3.0) == pytest.approx(power.slope_at(3.0), rel=1e-12)


def test_a_mass_on_a_table_swings_on_its_lines(one_mass: Callable[..., GapSystem]) -> None:
    """Reference: analytic, ½ m v² is the area under the table, at the end of the stiff line."""
    motion = Motion(one_mass(100.0, LAW), 0.5, 1e-2, velocity=np.array([4.0]))
    run = FixedStep(1e-5)(motion)
    deepest = float(run.data["contact_force_peak"].max())
    left = 0.5 * 4.0**2 - trapezoid((0.0, *FORCES[:2]), (0.0, *DEPTHS[:2]))
    assert deepest == pytest.approx(np.sqrt(3.0e3**2 + 2.0 * 6.0e6 * left), rel=1e-5)
    assert 3.0e3 < deepest < 9.0e3


@pytest.mark.parametrize(
    ("depths", "forces", "message"),
    [
        ((), (), "a table needs one force for each depth, and one at least"),
        ((1e-3,), (1.0, 2.0), "a table needs one force for each depth, and one at least"),
        ((1e-3, 1e-3), (1.0, 2.0), "depths must be finite and rise from above 0"),
        ((0.0,), (1.0,), "depths must be finite and rise from above 0"),
        ((1e-3,), (-1.0,), "forces must be positive, and must not fall at the end"),
        ((1e-3, 2e-3), (2.0, 1.0), "forces must be positive, and must not fall at the end"),
    ],
)
def test_bad_values_are_refused(
    depths: tuple[float, ...], forces: tuple[float, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=f"^{message}$"):
        TableContact(depths, forces)
