# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact laws, and equilibria with them: second-order effects of axial forces, and buckling."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from protractile.dynamics.contact import PowerContact, contact_limits, restitution_damping
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.damping import closed_contact_damping, with_modal_damping
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.second_order import buckling_factor, soften_modes
from protractile.dynamics.stability import closed_contact_factor
from tests.modal import modal_system, one_mass

POWER = PowerContact(stiffness=1.0e13, exponent=2.0, stiffness_below=4.0e12)
LAW = POWER.with_clearance(7.0e-3)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_force_is_the_gradient_of_the_energy(exponent: float) -> None:
    """Reference: analytic, a central difference of the potential, of second order in its step."""
    law = PowerContact(1.0e13, exponent, stiffness_below=3.0e12).with_clearance(7.0e-3)
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
    """Reference: analytic, k p² and k p³/3 at 10 µm beyond the play of 7 mm, and 0 within it."""
    y = np.array([-7.01e-3, -7.0e-3, -6.9e-3, 0.0, 6.9e-3, 7.0e-3, 7.01e-3])
    assert LAW.force(y) == pytest.approx([-4.0e2, *np.zeros(5), 1.0e3], rel=1e-9, abs=0.0)
    assert LAW.energy(y) == pytest.approx([4e-3 / 3.0, *np.zeros(5), 1e-2 / 3.0], rel=1e-9, abs=0.0)


def test_below_is_as_above_unless_given() -> None:
    law = PowerContact(stiffness=1.0e10, exponent=1.5)
    y = np.linspace(-1.0e-3, 1.0e-3, 7)
    assert law.below == 1.0e10
    np.testing.assert_array_equal(law.force(-y), -law.force(y))


def test_sides_add_up_to_the_whole() -> None:
    y = np.linspace(-9.0e-3, 9.0e-3, 19)
    upper, lower = POWER.upper(), POWER.lower()
    assert not upper.force(y[y < 0.0]).any()
    assert not lower.force(y[y > 0.0]).any()
    np.testing.assert_array_equal(upper.force(y) + lower.force(y), POWER.force(y))
    np.testing.assert_array_equal(upper.energy(y) + lower.energy(y), POWER.energy(y))


def test_parts_of_a_law_are_damped_as_it_is() -> None:
    law = replace(POWER, damping=0.3)
    assert {part.damping for part in (law.upper(), law.lower(), law.with_weight(0.25))} == {0.3}
    assert POWER.damping == 0.0


@pytest.mark.parametrize(
    "law", [POWER, POWER.upper(), POWER.lower()], ids=["both", "upper", "lower"]
)
def test_shares_add_up_to_the_whole(law: PowerContact) -> None:
    y = np.linspace(-9.0e-3, 9.0e-3, 19)
    total = sum(law.with_weight(weight).force(y) for weight in (0.125, 0.25, 0.625))
    np.testing.assert_allclose(total, law.force(y), rtol=1e-14)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 10.0])
@pytest.mark.parametrize("force", [1.0e-40, 1.0e-18, 1.0e-3, 1.0e5, 1.0e200])
def test_the_slope_is_known_at_any_force(exponent: float, force: float) -> None:
    """Reference: analytic, k pⁿ = F on the stiffer side, also for extreme forces."""
    n, k = exponent, 1.0e13
    law = PowerContact(0.5 * k, n, stiffness_below=k).with_clearance(7.0e-3)
    assert law.slope_at(force) == pytest.approx(n * k * (force / k) ** ((n - 1.0) / n), rel=1e-9)


@pytest.mark.parametrize("force", [0.0, np.inf])
def test_a_linear_law_has_its_slope_at_no_force_and_at_any(force: float) -> None:
    """Reference: analytic."""
    assert PowerContact(1.0e9, 1.0).slope_at(force) == pytest.approx(1.0e9)


SOFT_ABOVE = PowerContact(1.0e6, 2.0, stiffness_below=2.0e9)
UNEQUAL = SOFT_ABOVE.with_clearance(4.0e-3, 10.0e-3)


def test_each_side_has_its_own_clearance() -> None:
    """Reference: analytic, 1e6 · 1e-6 and 2e9 · 1e-6 at 1 mm beyond the clearance of each side."""
    y = np.array([-11.0e-3, -9.0e-3, 3.0e-3, 5.0e-3])
    assert UNEQUAL.force(y) == pytest.approx([-2000.0, 0.0, 0.0, 1.0], rel=1e-9)
    (limits,) = contact_limits([UNEQUAL])
    assert (limits["low"], limits["high"]) == (-10.0e-3, 4.0e-3)


def test_parts_are_those_of_its_law() -> None:
    y = np.linspace(-0.02, 0.02, 41)
    above = UNEQUAL.one_sided(1)
    assert above.terms == SOFT_ABOVE.upper().with_clearance(4.0e-3, 10.0e-3).terms
    assert above.one_sided(-1) is None
    assert SOFT_ABOVE.upper().with_clearance(4.0e-3).one_sided(-1) is None
    np.testing.assert_allclose(
        UNEQUAL.with_weight(0.25).force(y), 0.25 * UNEQUAL.force(y), rtol=1e-12
    )
    moved = UNEQUAL.with_clearance(1.0e-3)
    assert (moved.above, moved.below) == pytest.approx((5.0e-3, 11.0e-3))


def test_preloaded_mass_leaves_one_contact_side() -> None:
    """Reference: analytic. √(2 k/m) up to the interference, then √(k/m) about F/k − δ."""
    k, pressed, load = 1.0e4, 2.0e-3, 60.0
    both, one = np.sqrt([2.0 * k, k])
    system = one_mass(1.0, PowerContact(k, 1.0).with_clearance(-pressed), force=load)
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


@pytest.mark.parametrize("restitution", [0.05, 0.3, 0.8, 0.99, 0.99999, 1.0 - 1e-12])
def test_damping_of_a_restitution(restitution: float) -> None:
    """Reference: analytic, (e + 1) v = ln[(1 + d v)/(1 − d e v)]/d, and d = 3(1 − e)/(2 v) near e =
    1 (Hunt and Crossley 1975).
    """
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
def test_a_mass_rebounds_as_it_should(exponent: float, restitution: float) -> None:
    """Reference: analytic, the same e for every exponent. The error decreases with the step."""
    mass, speed = 3.0, 2.0
    damping = restitution_damping(restitution, speed)
    stiffness = {1.0: 1.0e6, 1.5: 1.0e8, 2.0: 1.0e9}[exponent]
    stop = PowerContact(stiffness, exponent, damping=damping).upper().with_clearance(0.01)
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


def test_contact_never_pulls() -> None:
    """A load pulls a mass off a stop faster than 1/d; the contact opens and loses its energy."""
    stop = PowerContact(stiffness=1.0e4, exponent=1.0, damping=5.0).upper()
    system = one_mass(1.0, stop, force=-2.0e3)
    run = FixedStep(1e-5)(Motion(system, 0.05, output_step=1e-4, position=np.array([0.1])))
    force = run.data["contact_force"].values
    assert force.min() >= 0.0
    tip = run.data["tip"].values
    assert (force[1:, 0][(tip[1:] > 0.01) & (tip[1:] < 0.09)] == 0.0).any()
    assert float(run.data["contact_loss"][-1]) > 0.5 * 0.5 * 1.0e4 * 0.1**2


# Softer after the first millimetre, then stiff: a pad that gives way and bottoms out.
DEPTHS, FORCES = (1.0e-3, 3.0e-3, 4.0e-3), (2.0e3, 3.0e3, 9.0e3)
TABLE = TableContact(DEPTHS, FORCES).with_clearance(7.0e-3)


def test_the_force_is_the_table_and_its_last_line() -> None:
    """Reference: analytic, linear interpolation in the table, and 6e6 N/m beyond it."""
    depth = np.linspace(0.0, 4.0e-3, 33)
    expected = np.interp(depth, (0.0, *DEPTHS), (0.0, *FORCES))
    np.testing.assert_allclose(TABLE.force(7.0e-3 + depth), expected, atol=1e-8)
    np.testing.assert_allclose(TABLE.force(-7.0e-3 - depth), -expected, atol=1e-8)
    assert TABLE.force(np.array(12.0e-3)) == pytest.approx(9.0e3 + 6.0e6 * 1.0e-3, rel=1e-12)


def test_the_energy_is_the_area_under_the_table() -> None:
    """Reference: analytic, trapezoids."""

    expected = trapezoid((0.0, *FORCES), (0.0, *DEPTHS))
    assert TABLE.energy(np.array([-11.0e-3, 11.0e-3])) == pytest.approx([expected] * 2, rel=1e-12)


def test_parts_are_tables_again() -> None:
    y = np.linspace(-12.0e-3, 12.0e-3, 25)
    above, below = TABLE.one_sided(1), TABLE.one_sided(-1)
    assert above.one_sided(-1) is None
    np.testing.assert_allclose(above.force(y) + below.force(y), TABLE.force(y), atol=1e-8)
    np.testing.assert_allclose(TABLE.with_weight(0.25).force(y), 0.25 * TABLE.force(y), atol=1e-8)
    np.testing.assert_allclose(
        TABLE.with_clearance(7.0e-3).force(y + 7.0e-3), above.force(y), atol=1e-8
    )


def test_one_line_is_a_linear_stop() -> None:
    """Reference: other code, the linear law, including the stiffness for the step."""
    table, power = (
        TableContact((1.0e-3,), (2.0e3,)).with_clearance(5.0e-3),
        PowerContact(2.0e6, 1.0).with_clearance(5.0e-3),
    )
    y = np.linspace(-9.0e-3, 9.0e-3, 19)
    np.testing.assert_allclose(table.force(y), power.force(y), rtol=1e-14)
    assert table.slope_at(3.0) == pytest.approx(power.slope_at(3.0), rel=1e-12)


def test_a_mass_on_a_table_swings_on_its_lines() -> None:
    """Reference: analytic. ½ m v² equals the area under the table up to the largest penetration."""
    motion = Motion(one_mass(100.0, TABLE), 0.5, 1e-2, velocity=np.array([4.0]))
    run = FixedStep(1e-5)(motion)
    deepest = float(run.data["contact_force_peak"].max())
    left = 0.5 * 4.0**2 - trapezoid((0.0, *FORCES[:2]), (0.0, *DEPTHS[:2]))
    assert deepest == pytest.approx(np.sqrt(3.0e3**2 + 2.0 * 6.0e6 * left), rel=1e-5)
    assert 3.0e3 < deepest < 9.0e3


def mass_over_stop(exponent: float, omega2: float) -> GapSystem:
    """Return 2 kg on a spring, with a stop of 3e6 N/mⁿ after 4 mm on the upper side only."""
    row = np.array([1.0 / np.sqrt(2.0)])
    law = PowerContact(3.0e6, exponent).upper().with_clearance(4.0e-3)
    return modal_system([omega2], [0.0], row, [law], tip=row)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_free_mass_rests_on_its_stop(exponent: float) -> None:
    """Reference: analytic. k pⁿ = 50 N."""
    system = mass_over_stop(exponent, 0.0)
    position = equilibrium(system, 50.0 * system.rows[0])
    depth = (50.0 / 3.0e6) ** (1.0 / exponent)
    assert system.rows[0] @ position == pytest.approx(4.0e-3 + depth, rel=1e-6)


def test_spring_carries_the_load_before_contact() -> None:
    """Reference: analytic. 2 kg · 900 rad²/s² = 1800 N/m, 5 N."""
    system = mass_over_stop(1.0, 900.0)
    assert system.rows[0] @ equilibrium(system, 5.0 * system.rows[0]) == pytest.approx(5.0 / 1800.0)


@pytest.mark.parametrize(("weight", "expected"), [(0.0, 1.0e-3), (4.0, 1.0e-3 - 4.0 / 3.0e6)])
def test_shim_preload_displaces_an_unloaded_mass(weight: float, expected: float) -> None:
    """Reference: analytic. A shim 1 mm thicker than the play lifts a mass until it is free."""
    below = PowerContact(3.0e6, 1.0).lower().with_clearance(-1.0e-3)
    above = mass_over_stop(1.0, 0.0)
    row, laws, places = above.rows[0], [*above.laws, below], np.zeros(2, dtype=np.int64)
    system = replace(above, rows=np.vstack([row, row]), laws=laws, station_of_row=places)
    assert row @ equilibrium(system, -weight * row) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("weight", [40.0, 60.0, -30.0])
def test_the_start_of_the_search_does_not_matter(weight: float) -> None:
    """Reference: analytic, a spring and a Hertzian stop below; the start is 50 N on the stop."""
    system = mass_over_stop(1.5, 900.0)
    near = equilibrium(system, 50.0 * system.rows[0])
    found = equilibrium(system, weight * system.rows[0], near)
    gap = float(system.rows[0] @ found)
    force = 1800.0 * gap + 3.0e6 * max(gap - 4.0e-3, 0.0) ** 1.5
    assert force == pytest.approx(weight, rel=1e-6)


def test_unsupported_mass_has_no_equilibrium() -> None:
    """The mass has no stop below it."""
    system = mass_over_stop(1.0, 0.0)
    with pytest.raises(NumericsError, match="no static equilibrium"):
        equilibrium(system, -50.0 * system.rows[0])


def test_buckled_system_has_no_equilibrium() -> None:
    """The axial forces exceed the stiffness of its spring."""
    buckled = modal_system([900.0], [0.0], geometric_stiffness=np.array([[901.0]]))
    message = "nothing holds the boom, or axial forces buckle it: it has no static equilibrium"
    with pytest.raises(NumericsError, match=f"^{message}$"):
        equilibrium(buckled, np.ones(1))


MASS, NEGATIVE, STIFFNESS, CLEARANCE = 3.0, -48.0, 1.0e6, 0.01
GROWTH = np.sqrt(-NEGATIVE / MASS)
STOPS = PowerContact(STIFFNESS, 1.0).with_clearance(CLEARANCE)


@pytest.fixture(name="tipping")
def _tipping() -> GapSystem:
    """Return a mass on a negative spring between two stops."""
    return one_mass(MASS, STOPS, spring=NEGATIVE)


def test_modes_soften_like_the_whole_stiffness() -> None:
    """Reference: analytic, eigenvalues of diag(ω²) − G by another routine; translations keep 0."""
    omega2 = np.array([0.0, 0.0, 4.0e2, 9.0e4])
    slope = np.array([[0.0, 0.3, 0.7, -0.2], [0.0, 0.5, -0.4, 0.6]])
    geometric = 20.0 * slope.T @ slope
    found, shapes = soften_modes(omega2, geometric)
    expected = np.linalg.eigvals(np.diag(omega2) - geometric).real
    np.testing.assert_allclose(found, np.sort(expected), rtol=1e-9, atol=1e-9)
    assert np.count_nonzero(found == 0.0) == 1
    assert np.count_nonzero(found < 0.0) == 1
    turned = shapes.T @ (np.diag(omega2) - geometric) @ shapes
    np.testing.assert_allclose(turned, np.diag(found), atol=1e-9)


def test_mode_buckles_at_zero_stiffness() -> None:
    """Reference: analytic, K/K_G for one coordinate, and the root of a determinant for two."""
    assert buckling_factor(np.array([[9.0]]), np.array([[2.0]])) == pytest.approx(4.5, rel=1e-14)
    stiffness, geometric = np.array([[9.0, 2.0], [2.0, 16e6]]), np.array([[2.0, 1.0], [1.0, 1e6]])
    factor = buckling_factor(stiffness, geometric)
    left = stiffness - factor * geometric
    assert np.linalg.det(left) == pytest.approx(0.0, abs=1e-12 * 9.0 * 16e6)
    assert np.trace(left) > 1.0
    # A tension never buckles it, and nothing is left to buckle where nothing moves.
    assert buckling_factor(np.array([[9.0]]), np.array([[-2.0]])) == float("inf")
    assert buckling_factor(np.zeros((0, 0)), np.zeros((0, 0))) == float("inf")


def test_unstable_mass_reaches_its_stop_at_the_analytic_time(tipping: GapSystem) -> None:
    """Reference: analytic. From rest at a, a cosh κt, which touches at acosh(Δ/a)/κ."""
    start = 1.0e-4
    motion = Motion(tipping, 2.0, 1e-3, position=np.array([start * np.sqrt(MASS)]))
    run = FixedStep(1e-5)(motion)
    meets = np.arccosh(CLEARANCE / start) / GROWTH
    assert run.first_contact == pytest.approx(meets, abs=2e-5)
    before = run.time < meets
    tip = run.data["tip"].values[before]
    np.testing.assert_allclose(tip, start * np.cosh(GROWTH * run.time[before]), rtol=1e-9)
    assert np.abs(run.data["tip"].values).max() < 1.1 * CLEARANCE


def test_unstable_mass_rests_on_its_stop(tipping: GapSystem) -> None:
    """Reference: analytic, F = k (y − Δ) = P + κ² m y."""
    pushed = replace(tipping, load=np.array([5.0 / np.sqrt(MASS)]))
    rest = (5.0 + STIFFNESS * CLEARANCE) / (STIFFNESS + NEGATIVE)
    found = equilibrium(pushed, pushed.load) / np.sqrt(MASS)
    np.testing.assert_allclose(found, [rest], rtol=1e-9)


def test_boom_in_contact_has_the_given_damping() -> None:
    """Reference: the given ratio, for a mass bonded to an elastic one."""
    two = modal_system([NEGATIVE / MASS, 400.0], [-9.0, 0.0], [0.5, -0.4], [STOPS], tip=[1.0, 1.0])
    omega, ratios = closed_contact_damping(with_modal_damping(two, 0.03))
    assert (omega > 0.0).all()
    assert ratios[0] == pytest.approx(0.03, rel=1e-6)


@pytest.mark.parametrize(("exponent", "force"), [(1.0, 300.0), (2.0, 300.0), (2.0, 1200.0)])
def test_a_bar_on_a_contact_buckles_as_its_stiffness_says(exponent: float, force: float) -> None:
    """Reference: analytic, a hinged bar on a contact with tangent stiffness k buckles at k b²/L.

    The bar turns by a/√I with the moment of inertia I, and its tip is pressed onto a contact at
    the distance b. The stiffness k at rest follows from the force and the exponent.
    """
    inertia, arm, length, axial = 40.0, 2.0, 5.0, 1e4
    law = PowerContact(1e6, exponent).lower()
    geometric = np.array([[axial * length / inertia]])
    system = GapSystem(
        omega2=-geometric[0],
        load=np.array([-force * arm / np.sqrt(inertia)]),
        rows=np.array([[arm / np.sqrt(inertia)]]),
        laws=[law],
        station_of_row=np.array([0]),
        stations=[arm],
        observers={"tip": Observer(np.array([length / np.sqrt(inertia)]))},
    )
    rest = equilibrium(system, system.load)
    stiffness = float(law.slope(system.rows[0] @ rest))
    factor = closed_contact_factor(system, geometric, rest)
    assert factor == pytest.approx(stiffness * arm**2 / (axial * length), rel=1e-9)


def test_a_boom_without_axial_forces_does_not_buckle() -> None:
    """Reference: analytic."""
    bar = GapSystem(
        omega2=np.array([4.0]),
        load=np.array([1.0]),
        rows=np.zeros((0, 1)),
        laws=[],
        station_of_row=np.zeros(0, dtype=int),
        stations=[],
        observers={"tip": Observer(np.ones(1))},
    )
    assert closed_contact_factor(bar, np.zeros((1, 1)), np.array([0.25])) == float("inf")
