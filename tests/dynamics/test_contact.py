# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact laws, and equilibria with them: second-order effects of axial forces, and buckling."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import trapezoid

from protractile.dynamics.contact import Gap, PowerContact, contact_limits, restitution_damping
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.damping import closed_contact_damping, with_modal_damping
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.second_order import buckling_factor, soften_modes
from protractile.dynamics.stability import closed_contact_factor
from tests.modal import modal_system, one_mass

POWER = PowerContact(stiffness=1.0e13, exponent=2.0, stiffness_below=4.0e12)
LAW = POWER.with_clearance(7.0e-3)


SOFT_ABOVE = PowerContact(1.0e6, 2.0, stiffness_below=2.0e9)
UNEQUAL = SOFT_ABOVE.with_clearance(4.0e-3, 10.0e-3)
# Softer after the first millimetre, then stiff: a pad that gives way and bottoms out.
DEPTHS, FORCES = (1.0e-3, 3.0e-3, 4.0e-3), (2.0e3, 3.0e3, 9.0e3)
TABLE = TableContact(DEPTHS, FORCES).with_clearance(7.0e-3)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
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


def test_each_side_has_its_own_numbers() -> None:
    """Reference: analytic. k p² and k p³/3 at 10 µm beyond the play of 7 mm, and 0 within it; other
    clearances of both sides; lines of a table, the last one beyond it, and trapezoids below them.
    """
    y = np.array([-7.01e-3, -7.0e-3, -6.9e-3, 0.0, 6.9e-3, 7.0e-3, 7.01e-3])
    assert LAW.force(y) == pytest.approx([-4.0e2, *np.zeros(5), 1.0e3], rel=1e-9, abs=0.0)
    assert LAW.energy(y) == pytest.approx([4e-3 / 3.0, *np.zeros(5), 1e-2 / 3.0], rel=1e-9, abs=0.0)
    found = UNEQUAL.force(np.array([-11.0e-3, -9.0e-3, 3.0e-3, 5.0e-3]))
    assert found == pytest.approx([-2000.0, 0.0, 0.0, 1.0], rel=1e-9)
    (limits,) = contact_limits([UNEQUAL])
    assert (limits["low"], limits["high"]) == (-10.0e-3, 4.0e-3)
    moved = UNEQUAL.with_clearance(1.0e-3)
    assert (moved.above, moved.below) == pytest.approx((5.0e-3, 11.0e-3))
    depth = np.linspace(0.0, 4.0e-3, 33)
    expected = np.interp(depth, (0.0, *DEPTHS), (0.0, *FORCES))
    np.testing.assert_allclose(TABLE.force(7.0e-3 + depth), expected, atol=1e-8)
    np.testing.assert_allclose(TABLE.force(-7.0e-3 - depth), -expected, atol=1e-8)
    assert TABLE.force(np.array(12.0e-3)) == pytest.approx(9.0e3 + 6.0e6 * 1.0e-3, rel=1e-12)
    area = trapezoid((0.0, *FORCES), (0.0, *DEPTHS))
    assert TABLE.energy(np.array([-11.0e-3, 11.0e-3])) == pytest.approx([area] * 2, rel=1e-12)
    line = TableContact((1.0e-3,), (2.0e3,)).with_clearance(5.0e-3)
    power = PowerContact(2.0e6, 1.0).with_clearance(5.0e-3)
    np.testing.assert_allclose(line.force(y), power.force(y), rtol=1e-14)
    assert line.slope_at(3.0) == pytest.approx(power.slope_at(3.0), rel=1e-12)


@pytest.mark.parametrize("law", [LAW, UNEQUAL, TABLE], ids=["power", "unequal", "table"])
def test_parts_add_up_to_the_law(law: Gap) -> None:
    """Reference: by construction, one-sided laws, and parts by weight, damped as it is."""
    y = np.linspace(-12.0e-3, 12.0e-3, 25)
    above, below = law.one_sided(1), law.one_sided(-1)
    assert above is not None
    assert below is not None
    assert above.one_sided(-1) is below.one_sided(1) is None
    for parts in ((above, below), [law.with_weight(w) for w in (0.125, 0.25, 0.625)]):
        for name in ("force", "energy"):
            total = sum(getattr(part, name)(y) for part in parts)
            np.testing.assert_allclose(total, getattr(law, name)(y), rtol=1e-12, atol=1e-9)
    damped = replace(POWER, damping=0.3)
    assert {part.damping for part in (damped.upper(), damped.with_weight(0.25))} == {0.3}


@pytest.mark.parametrize("exponent", [1.0, 1.5, 10.0])
@pytest.mark.parametrize("force", [1.0e-40, 1.0e-18, 1.0e-3, 1.0e5, 1.0e200])
def test_the_slope_is_known_at_any_force(exponent: float, force: float) -> None:
    """Reference: analytic, k pⁿ = F on the stiffer side, also for extreme forces."""
    n, k = exponent, 1.0e13
    law = PowerContact(0.5 * k, n, stiffness_below=k).with_clearance(7.0e-3)
    assert law.slope_at(force) == pytest.approx(n * k * (force / k) ** ((n - 1.0) / n), rel=1e-9)
    linear = PowerContact(1.0e9, 1.0)
    assert linear.slope_at(0.0) == pytest.approx(1.0e9)
    assert linear.slope_at(np.inf) == pytest.approx(1.0e9)


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


@pytest.mark.parametrize("restitution", [0.05, 0.8, 0.99999, 1.0 - 1e-12])
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


@pytest.mark.parametrize(("exponent", "restitution"), [(1.0, 0.8), (1.5, 0.3), (2.0, 0.8)])
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


@pytest.mark.parametrize(("weight", "expected"), [(0.0, 1.0e-3), (4.0, 1.0e-3 - 4.0 / 3.0e6)])
def test_shim_preload_displaces_an_unloaded_mass(weight: float, expected: float) -> None:
    """Reference: analytic. A shim 1 mm thicker than the play lifts a mass until it is free."""
    below = PowerContact(3.0e6, 1.0).lower().with_clearance(-1.0e-3)
    above = mass_over_stop(1.0, 0.0)
    row, laws, places = above.rows[0], [*above.laws, below], np.zeros(2, dtype=np.int64)
    system = replace(above, rows=np.vstack([row, row]), laws=laws, station_of_row=places)
    assert row @ equilibrium(system, -weight * row) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 3.0])
def test_free_mass_rests_on_its_stop(exponent: float) -> None:
    """Reference: analytic, k pⁿ = 50 N. Without a stop below it, or with axial forces above the
    stiffness of its spring, it has no equilibrium.
    """
    system = mass_over_stop(exponent, 0.0)
    position = equilibrium(system, 50.0 * system.rows[0])
    depth = (50.0 / 3.0e6) ** (1.0 / exponent)
    assert system.rows[0] @ position == pytest.approx(4.0e-3 + depth, rel=1e-6)
    buckled = modal_system([900.0], [0.0], geometric_stiffness=np.array([[901.0]]))
    for loose, load, message in (
        (system, -50.0 * system.rows[0],
         "no static equilibrium is found: look for a segment that nothing holds"),
        (buckled, np.ones(1),
         "nothing holds the boom, or axial forces buckle it: it has no static equilibrium"),
    ):  # fmt: skip
        with pytest.raises(NumericsError, match=f"^{message}$"):
            equilibrium(loose, load)


@pytest.mark.parametrize("weight", [5.0, 60.0, -30.0])
def test_the_start_of_the_search_does_not_matter(weight: float) -> None:
    """Reference: analytic, a spring and a Hertzian stop below; the start is 50 N on the stop."""
    system = mass_over_stop(1.5, 900.0)
    near = equilibrium(system, 50.0 * system.rows[0])
    found = equilibrium(system, weight * system.rows[0], near)
    gap = float(system.rows[0] @ found)
    force = 1800.0 * gap + 3.0e6 * max(gap - 4.0e-3, 0.0) ** 1.5
    assert force == pytest.approx(weight, rel=1e-6)


MASS, NEGATIVE, STIFFNESS, CLEARANCE = 3.0, -48.0, 1.0e6, 0.01
GROWTH = np.sqrt(-NEGATIVE / MASS)
STOPS = PowerContact(STIFFNESS, 1.0).with_clearance(CLEARANCE)


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


def test_unstable_mass_between_stops() -> None:
    """Reference: analytic. From rest at a, a cosh κt, which touches at acosh(Δ/a)/κ; under a force,
    F = k (y − Δ) = P + κ² m y.
    """
    start, tipping = 1.0e-4, one_mass(MASS, STOPS, spring=NEGATIVE)
    motion = Motion(tipping, 2.0, 1e-3, position=np.array([start * np.sqrt(MASS)]))
    run = FixedStep(1e-5)(motion)
    meets = np.arccosh(CLEARANCE / start) / GROWTH
    assert run.first_contact == pytest.approx(meets, abs=2e-5)
    before = run.time < meets
    tip = run.data["tip"].values
    np.testing.assert_allclose(tip[before], start * np.cosh(GROWTH * run.time[before]), rtol=1e-9)
    assert np.abs(tip).max() < 1.1 * CLEARANCE
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


@pytest.mark.parametrize(("exponent", "force"), [(1.0, 300.0), (2.0, 1200.0)])
def test_a_bar_on_a_contact_buckles_as_its_stiffness_says(exponent: float, force: float) -> None:
    """Reference: analytic, a hinged bar on a contact with tangent stiffness k buckles at k b²/L.

    The bar turns by a/√I with the moment of inertia I, and its tip is pressed onto a contact at
    the distance b. The stiffness k at rest follows from the force and the exponent.
    """
    inertia, arm, length, axial = 40.0, 2.0, 5.0, 1e4
    law = PowerContact(1e6, exponent).lower()
    geometric = np.array([[axial * length / inertia]])
    row = arm / np.sqrt(inertia)
    system = modal_system(-geometric[0], [-force * row], [row], [law])
    rest = equilibrium(system, system.load)
    factor = closed_contact_factor(system, geometric, rest)
    stiffness = float(law.slope(system.rows[0] @ rest))
    assert factor == pytest.approx(stiffness * arm**2 / (axial * length), rel=1e-9)
    assert closed_contact_factor(system, 0.0 * geometric, rest) == float("inf")
