# SPDX-License-Identifier: LGPL-3.0-or-later
"""The time step against closed forms of impacts and free motion."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.special import gamma

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import ContactLaw, DryFriction, PowerContact
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.energy import check_energy
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Excitation, PiecewiseLinear, Sine
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import AdaptiveStep, FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import SCurve, Stroke
from studies.reference_models.impacting_beam import ELEMENTS, HEIGHT, falling, moreau_jean
from tests.dynamics.reference import (
    end_of,
    errors_in_the_step,
    runge_kutta,
    slopes,
    two_modes,
    with_rates,
)
from tests.dynamics.test_telescoping import lossy, pressed_along, rider
from tests.modal import modal_system, one_mass

THROWN = np.array([0.8, -0.5, 0.3, 0.4])
POWER = PowerContact(1.0e6, 1.0).with_clearance(1.0e-3)
ROWS = np.array([[0.9, 0.5, -0.3, 0.2], [0.4, -0.8, 0.5, 0.3]])
ACROSS = np.array([[0.3, 0.6, 0.8, -0.5], [-0.7, 0.4, 0.2, 0.6]])


def boom(law: ContactLaw = POWER, **changes: Any) -> GapSystem:
    """Return one rigid and three elastic modes with two contacts."""
    numbers: dict[str, Any] = {
        "omega2": [0.0, 40.0, 900.0, 2.5e4], "load": [-8.0, 3.0, 2.0, 1.0], "rows": ROWS,
        "laws": [law, law], "tip": [1.0, 0.7, -0.4, 0.2],
    }  # fmt: skip
    return modal_system(**numbers | changes)


def rubbing(*frictions: DryFriction, **changes: Any) -> GapSystem:
    return boom(friction_rows=ACROSS, frictions=frictions, **changes)


DRAGGED = {"dashpots": 2.0 * ACROSS}
# The second and third modes creep, the others swing.
DAMPED = {"damping": np.array([0.5, 60.0, 200.0, 20.0])}
PUSHED = np.array([30.0, -20.0, 10.0, 40.0])
KINKED = Excitation(PUSHED, PiecewiseLinear((0.0, 0.00037, 0.0101, 0.0733), (0.0, 1.0, -1.0, 2.0)))
SHAKEN = Excitation(PUSHED[::-1], Sine(7.3, 0.4))
PRESSED = DryFriction(0.4, 0, 0.0, (0, 1)), DryFriction(0.3, 1, 5.0, (1,))
# What moves, and the energy that it has to exchange.
MOVED: dict[str, tuple[GapSystem, str]] = {
    "linear": (boom(), "contact_energy"),
    "Hertz": (boom(PowerContact(1.0e8, 1.5).with_clearance(1.0e-3)), "contact_energy"),
    "quadratic": (boom(PowerContact(1.0e10, 2.0).with_clearance(1.0e-3)), "contact_energy"),
    "cubic": (boom(PowerContact(1.0e13, 3.0).with_clearance(1.0e-3)), "contact_energy"),
    "table": (
        boom(TableContact((1e-4, 1e-3), (200.0, 500.0)).with_clearance(1e-3)),
        "contact_energy",
    ),
    "unlike sides": (
        boom(PowerContact(1e9, 2.0, stiffness_below=2e9).with_clearance(4e-4, 1e-3)),
        "contact_energy",
    ),
    "shims": (boom(PowerContact(1.0e6, 1.0).with_clearance(-1.0e-4)), "contact_energy"),
    "Hunt-Crossley": (
        boom(PowerContact(1e8, 1.5, damping=0.5).with_clearance(1e-3)),
        "contact_loss",
    ),
    "prescribed friction": (
        rubbing(DryFriction(0.2, 0, 20.0), DryFriction(0.3, 1, 10.0)),
        "friction_loss",
    ),
    "pressed friction": (rubbing(*PRESSED), "friction_loss"),
    "dashpots": (boom(**DRAGGED), "damping_loss"),
    "modal damping": (boom(**DAMPED), "damping_loss"),
    "tipping": (boom(omega2=np.array([-9.0, 40.0, 900.0, 2.5e4])), "contact_energy"),
    "kinked load": (boom(excitations=[KINKED]), "work"),
    "sine": (boom(excitations=[SHAKEN]), "work"),
    "everything": (
        rubbing(*PRESSED, **DRAGGED, **DAMPED, excitations=[KINKED, SHAKEN]),
        "friction_loss",
    ),
    "moving rows": (lossy(Stroke(5.0, 12.5)), "drive_work"),
    "moving thrust": (pressed_along(Stroke(2.0, 2.0)), "drive_work"),
}


@pytest.mark.parametrize(
    ("step", "duration"), [(1e-2, 1.0), (1e-3, 0.5), (1e-4, 0.1), (1e-5, 0.05), (1e-6, 0.02)]
)
@pytest.mark.parametrize("what", MOVED)
def test_energy_balances_at_every_step(what: str, step: float, duration: float) -> None:
    """Reference: analytic, conservation of energy, with all parts of the balance."""
    system, exchanged = MOVED[what]
    velocity = THROWN if system.num_modes == 4 else np.zeros(0)
    run = FixedStep(step)(Motion(system, duration, 1.0e-2, velocity=velocity))
    assert run.energy_residual < 1e-11
    energies = [np.abs(run.data[x]).max() for x in ("work", "kinetic_energy", exchanged)]
    assert float(energies[2]) > 1e-5 * float(max(energies))
    assert run.data.attrs["contact_changes"] > 0
    for name in ("damping_loss", "friction_loss", "contact_loss"):
        assert np.diff(run.data[name]).min() >= -1e-14 * float(max(energies))


def pressed(exponent: float, **changes: Any) -> Motion:
    """Return the motion of a boom that its small initial velocity does not lift off the stops."""
    law = PowerContact({1.0: 1.0e4, 2.0: 5.0e6}[exponent], exponent).with_clearance(1.0e-3)
    system = boom(law, load=np.array([-80.0, 30.0, 2.0, 1.0]), **changes)
    held = replace(system, omega2=np.maximum(system.omega2, [0.0, 1.0, 1.0, 1.0]))
    return Motion(system, 0.4, 0.04, equilibrium(held, system.load), 0.02 * THROWN)


def sliding() -> Motion:
    """Return the motion of a boom that slides along its stops too fast to come to rest."""
    along = {"friction_rows": np.array([[0.1, -0.2, 0.3, 1.0]]), "frictions": [PRESSED[0]]}
    omega2 = np.array([0.0, 40.0, 900.0, 0.0])
    still = pressed(1.0, omega2=omega2, rows=ROWS * [1, 1, 1, 0], **along)
    return replace(still, velocity=np.array([0.05, -0.02, 0.03, 40.0]))


def telescoping() -> Motion:
    law = PowerContact(1.0e6, 2.0).lower()
    system = rider(SCurve(5.0, 0.4), law, mass=20.0, weight=2.0e3, start=2.0, count=4, drag=30.0)
    return Motion(system, 0.4, 0.04)


def driven() -> Motion:
    still = pressed(2.0)
    loads = [
        Excitation(0.2 * PUSHED, Sine(3.0, 0.4)),
        Excitation(PUSHED, PiecewiseLinear((0, 1), (0, 1))),
    ]
    return replace(still, system=replace(still.system, excitations=loads))


def lossy_press() -> Motion:
    motion = pressed(2.0, damping=np.array([0.5, 1.0, 2.0, 20.0]), **DRAGGED)
    laws = [PowerContact(1e4, 1.0, damping=5.0).with_clearance(1e-3)] * 2
    return replace(motion, system=replace(motion.system, laws=laws), velocity=0.05 * THROWN)


@pytest.mark.parametrize(
    ("motion", "bound"),
    [
        (pressed(1.0), 1e-5), (pressed(2.0), 1e-4), (lossy_press(), 5e-6), (sliding(), 5e-7),
        (telescoping(), 3e-4), (driven(), 1e-4), (Motion(two_modes(), 0.6, 0.04), 5e-6),
    ],
    ids=["linear", "quadratic", "losses", "sliding", "telescoping", "driven", "one blow"],
)  # fmt: skip
def test_second_order_in_the_step(motion: Motion, bound: float) -> None:
    """Reference: other code, scipy's DOP853. Order 2, and the error at 0.25 ms."""
    errors = errors_in_the_step(motion, runge_kutta(motion), 2e-3 * 0.5 ** np.arange(4))
    found = slopes(errors)
    assert found[1:] == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < bound


def test_a_pressed_boom_swings_in_its_pressed_modes() -> None:
    """Reference: analytic, the eigenvalues of diag(ω²) + k Bᵀ B, at a step of a 50th of 1/ω."""
    motion = pressed(1.0)
    omega2, shapes = eigh(np.diag(motion.system.omega2) + 1.0e4 * ROWS.T @ ROWS)
    assert (omega2 > 5.0 * motion.system.omega2).sum() >= 2
    omega = np.sqrt(omega2)
    run = FixedStep(0.02 / omega[-1])(motion)
    swings = np.sin(omega * run.time[:, None]) / omega * (shapes.T @ motion.velocity)
    expected = motion.position + swings @ shapes.T
    assert run.data.attrs["contact_changes"] == 0
    assert np.abs(run.states - expected).max() < 3e-4 * np.ptp(expected, axis=0).max()


@pytest.mark.parametrize("damping", [0.0, 60.0])
@pytest.mark.parametrize("step", [1e-4, 1e-2, 0.5])
def test_free_flight_is_exact(step: float, damping: float) -> None:
    """Reference: analytic, a parabola and vibrations about the equilibrium, for any step."""
    system = boom(rows=np.zeros((2, 4)), damping=np.array([0.0, damping, 0.0, 0.0]))
    run = FixedStep(step)(Motion(system, 2.0, 0.5, velocity=THROWN))
    time, omega, rest = run.time[:, None], system.omega[1:], system.load[1:] / system.omega2[1:]
    decay = 0.5 * system.damping[1:]
    beat = np.emath.sqrt(omega**2 - decay**2)
    off = (THROWN[1:] - decay * rest) / beat
    swings = np.exp(-decay * time) * (rest * np.cos(beat * time) - off * np.sin(beat * time))
    fall = THROWN[0] * time + 0.5 * system.load[0] * time**2
    expected = np.hstack([fall, rest - np.real(swings)])
    np.testing.assert_allclose(run.states, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0, 3.0])
def test_motion_runs_back_through_its_contacts(exponent: float) -> None:
    """Reference: analytic, time reversibility under a constant load."""
    start, system = np.array([0.02, -0.01]), with_rates(two_modes(exponent))
    there = FixedStep(1e-3)(Motion(system, 1.8, 0.02, start))
    place, speed = end_of(there)
    back = FixedStep(1e-3)(Motion(system, 1.8, 0.02, place, -speed))
    assert there.data.attrs["contact_changes"] == back.data.attrs["contact_changes"] >= 6
    assert np.abs(back.states[::-1] - there.states).max() < 1e-9 * np.abs(there.states).max()
    assert np.abs(end_of(back)[1]).max() < 1e-9 * np.abs(speed).max()


def test_mass_on_a_spring_against_a_spring_stop() -> None:
    """Reference: external, SDND101 of the Code_Aster validation manual; analytic, the impulse."""
    stop = PowerContact(stiffness=1.0e6, exponent=1.0).upper()
    system = one_mass(100.0, stop, spring=1.0e4)
    run = FixedStep(1e-4)(Motion(system, 0.04, 1.0e-3, velocity=np.array([10.0])))
    assert float(run.data["contact_force_peak"].max()) == pytest.approx(9950.372, rel=1e-4)
    impulse = 1.0e-3 * float(run.data["contact_force"].sum())
    assert impulse == pytest.approx(200.0 * 1.0e6 / 1.01e6, rel=1e-4)


def crossings(time: Array, y: Array, level: float) -> Array:
    """Return times at which y passes the level, by linear interpolation."""
    (before,) = np.nonzero((y[:-1] > level) != (y[1:] > level))
    part = (level - y[before]) / (y[before + 1] - y[before])
    return np.asarray(time[before] + part * (time[before + 1] - time[before]))


def test_falling_mass() -> None:
    """Reference: external, SDND108 of the Code_Aster validation manual."""
    stop = PowerContact(stiffness=100.0, exponent=1.0).lower().with_clearance(2.0)
    system = one_mass(1.0, stop, force=-10.0)
    run = FixedStep(1e-3)(Motion(system, 1.2, 1.0e-3, velocity=np.array([-1.0])))
    assert run.first_contact == pytest.approx(0.5403124, rel=1e-4)
    passed = crossings(run.time, run.data["tip"].values, -2.0)
    assert passed == pytest.approx([0.5403124, 0.8854562], rel=1e-4)
    assert run.data.attrs["contact_changes"] == 2
    assert float(run.data["contact_force"].max()) == 0.0


def test_mass_between_two_stops_of_unlike_stiffness() -> None:
    """Reference: analytic. Flights last 2Δ/v, contacts π √(m/k) of each side."""
    law = PowerContact(stiffness=4.0e4, exponent=1.0, stiffness_below=9.0e4).with_clearance(0.1)
    period = 2.0 * 0.2 / 2.0 + np.pi / 200.0 + np.pi / 300.0
    motion = Motion(one_mass(1.0, law), 3.0 * period, period / 1e3, velocity=np.array([2.0]))
    run = FixedStep(2e-5)(motion)
    np.testing.assert_allclose(run.data["tip"][::1000], 0.0, atol=1e-5)
    force = run.data["contact_force_peak"].values
    assert force.max() == pytest.approx(2.0 * np.sqrt(4.0e4), rel=1e-4)
    assert force.min() == pytest.approx(-2.0 * np.sqrt(9.0e4), rel=1e-4)
    assert run.data.attrs["contact_changes"] == 12
    assert run.first_contact == pytest.approx(0.05, rel=1e-6)
    # Impulse: each press turns the momentum around.
    impulse = np.maximum(run.data["contact_force"].values, 0.0).sum() * period / 1000.0
    assert impulse == pytest.approx(3 * 4.0, rel=1e-6)


def test_quadratic_stop_at_its_deepest() -> None:
    """Reference: analytic. A mass m with the speed v penetrates by p = (3 m v² / 2 k)^⅓ under
    F = k p², by energy, after the time Γ(⅓) Γ(½) / (3 Γ(⅚)) p/v, by a Beta integral.
    """
    stop = PowerContact(stiffness=1.0e6, exponent=2.0).upper()
    depth = (3.0 * 100.0 * 2.0**2 / (2.0 * 1.0e6)) ** (1.0 / 3.0)
    half = gamma(1.0 / 3.0) * gamma(0.5) / (3.0 * gamma(5.0 / 6.0)) * depth / 2.0
    motion = Motion(one_mass(100.0, stop), 2.0 * half, half, velocity=np.array([20.0]))
    run = FixedStep(half / 1000.0)(motion)
    assert run.data["tip"].values[1:] == pytest.approx([depth, 0.0], abs=1e-5 * depth)
    assert float(run.data["contact_force_peak"][1, 0]) == pytest.approx(1.0e6 * depth**2, rel=1e-5)
    np.testing.assert_allclose(half * run.data["contact_force"][1:, 0], 200.0, rtol=1e-5)


@pytest.mark.parametrize("step", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize(("stiffness", "exponent"), [(1e8, 1.0), (1e10, 1.5), (1e13, 2.0)])
def test_bouncing_ball_keeps_its_height(stiffness: float, exponent: float, step: float) -> None:
    """Reference: analytic. 1 kg falls 1 mm on a stiff floor repeatedly, and returns to the initial
    height, even if the step does not resolve the impact of 10 to 100 µs.
    """
    floor = PowerContact(stiffness, exponent).lower().with_clearance(1.0e-3)
    run = FixedStep(step)(Motion(one_mass(1.0, floor, force=-10.0), 3.0, 1e-3))
    assert run.data.attrs["contact_changes"] > 60
    tip = run.data["tip"].values
    assert -1e-4 < tip[-200:].max() < 1e-12
    assert tip.max() < 1e-12
    flying = run.data["contact_energy"] == 0.0
    total = run.data["kinetic_energy"] + 10.0 * (run.data["tip"])
    assert np.abs(total.where(flying, drop=True)).max() < 1e-13


@pytest.mark.parametrize("step", [2.0e-2, 1.0e-2, 1.0e-3, 1.0e-4])
def test_first_contact_does_not_depend_on_the_step(step: float) -> None:
    """Reference: analytic. Linear interpolation of a fall has an error of at most g h²/8."""
    stop = PowerContact(stiffness=100.0, exponent=1.0).lower().with_clearance(2.0)
    motion = Motion(one_mass(1.0, stop, force=-10.0), 1.0, 2.0e-2, velocity=np.array([-1.0]))
    exact = (np.sqrt(41.0) - 1.0) / 10.0
    found = FixedStep(step)(motion).first_contact
    assert abs(found - exact) < 10.0 * step**2 / 8.0 / np.sqrt(41.0) + 1e-13


def test_first_contact_is_the_earliest_of_all_rows() -> None:
    """Reference: analytic. Two rows close within one step; the second in the list does so first."""
    system = replace(
        boom(), laws=[POWER.law.with_clearance(gap) for gap in (0.0105, 0.0102)],
        rows=np.eye(4)[[0, 0]], load=np.zeros(4),
    )  # fmt: skip
    run = FixedStep(0.01)(Motion(system, 0.1, 0.01, velocity=np.eye(4)[0]))
    assert run.first_contact == pytest.approx(0.0102, rel=1e-9)


@pytest.mark.parametrize(
    ("place", "speed", "first"), [(-0.1003, 1.0, 0.2003), (0.11, -0.1, 0.0), (0.0, 0.1, np.nan)]
)
def test_first_contact_late_at_once_or_never(place: float, speed: float, first: float) -> None:
    """Reference: analytic. A mass reaches a stop at 0.1 m, begins in contact, or never touches."""
    system = one_mass(1.0, PowerContact(stiffness=1.0, exponent=1.0).upper().with_clearance(0.1))
    run = FixedStep(3e-4)(Motion(system, 0.5, 0.01, np.array([place]), np.array([speed])))
    assert run.first_contact == pytest.approx(first, rel=1e-6, nan_ok=True)
    assert run.data.attrs["contact_changes"] == (0 if np.isnan(first) else 1)


def test_a_closed_contact_is_a_spring() -> None:
    """Reference: analytic, a mass on a spring under a load that rises to −5 N within 10.4 ms; and
    the impulse by the change of momentum.
    """
    weight, stiffness, rise, load = 10.0, 1.0e6, 0.0104, -5.0
    ramp = Excitation(np.array([load]), PiecewiseLinear((0.0, rise), (0.0, 1.0)))
    seen = {"tip": Observer(np.ones(1)), "speed": Observer(np.ones(1), "m/s", 1)}
    law = PowerContact(stiffness, 1.0).with_clearance(2.0e-3)
    system = modal_system([0.0], [-weight], [1.0], [law], observers=seen, excitations=[ramp])
    run = FixedStep(1e-5)(Motion(system, 0.2, 1.0e-3, equilibrium(system, system.load)))
    time, omega = run.time, np.sqrt(stiffness)
    since = np.maximum(time - rise, 0.0)
    grown = (time - since - (np.sin(omega * time) - np.sin(omega * since)) / omega) / rise
    rest = -2.0e-3 - weight / stiffness
    np.testing.assert_allclose(run.data["tip"], rest + load / stiffness * grown, atol=1e-8)
    impulse = np.where(time < rise, 0.5 * time**2 / rise, time - 0.5 * rise)
    asked = 1.0e3 * (np.diff(load * impulse) - np.diff(run.data["speed"])) - weight
    np.testing.assert_allclose(run.data["contact_force"][1:, 0], asked, atol=1e-8)


def test_output_intervals_change_nothing() -> None:
    """Reference: other code path, output intervals ten times as long: means and maxima."""
    motion = Motion(rubbing(*PRESSED, excitations=[SHAKEN]), 0.1, 1e-3, velocity=THROWN)
    fine, coarse = (FixedStep(1e-3)(replace(motion, output_step=s)) for s in (1e-3, 1e-2))
    np.testing.assert_allclose(fine.states[::10], coarse.states, atol=1e-11)
    for name in ("contact_force", "friction_force"):
        means = fine.data[name].values[1:].reshape(-1, 10, 2).mean(axis=1)
        np.testing.assert_allclose(means, coarse.data[name][1:], rtol=1e-7, atol=1e-7)
    peaks = np.abs(fine.data["contact_force_peak"].values[1:]).reshape(-1, 10, 2).max(axis=1)
    np.testing.assert_allclose(peaks, np.abs(coarse.data["contact_force_peak"][1:]), rtol=1e-6)


def test_energy_residual_gives_a_warning() -> None:
    """Reference: by hand. 0.3 J of an input of 2 J are missing."""
    energies = np.array([np.zeros(7), [1.0, 0.5, 0.2, 2.0, 0.0, 0.0, 0.0]])
    check_energy(energies, bound=0.16)
    message = "the energy residual is 0.15 of the work done, above the bound of 1e-06"
    with pytest.raises(NumericsError, match=f"^{re.escape(message)}$"):
        check_energy(energies)
    message = "the motion is not finite; check the loads and the stiffnesses"
    with pytest.raises(NumericsError, match=f"^{re.escape(message)}$"):
        check_energy(energies + np.inf)


def test_unloaded_segments_stay_at_rest() -> None:
    """Reference: analytic. Segments without load stay at rest."""
    run = AdaptiveStep()(Motion(one_mass(1.0, PowerContact(1.0e6, 2.0).with_clearance(0.1)), 0.1))
    assert not run.states.any()
    assert np.isnan(run.first_contact)


@pytest.mark.parametrize("what", ["linear", "Hertz", "unlike sides", "Hunt-Crossley"])
@pytest.mark.parametrize("step", [5e-3, 5e-4, 5e-5])
def test_a_peak_is_no_less_than_the_mean(what: str, step: float) -> None:
    """Reference: analytic. No interval has a mean above its largest force, resolved or not."""
    run = FixedStep(step)(Motion(MOVED[what][0], 0.5, 1.0e-2, velocity=THROWN))
    means, peaks = (
        np.abs(run.data[name].values) for name in ("contact_force", "contact_force_peak")
    )
    assert (means > 0.0).sum() > 5
    assert (peaks >= means * (1.0 - 1e-12)).all()


def test_shims_touch_from_the_start() -> None:
    """Reference: analytic, two one-sided rows. With shims both contacts are closed at t = 0. Each
    side opens and closes as it does alone.
    """
    shims = PowerContact(1.0e4, 1.0).with_clearance(-1.0e-3)
    both = boom(shims)
    apart = boom(
        laws=[PowerContact(1.0e4, 1.0, stiffness_below=0.0).with_clearance(-1.0e-3)] * 2
        + [PowerContact(0.0, 1.0, stiffness_below=1.0e4).with_clearance(-1.0e-3)] * 2,
        rows=np.concatenate([ROWS, ROWS]), station_of_row=np.array([0, 1, 0, 1]),
    )  # fmt: skip
    runs = [FixedStep(1e-4)(Motion(each, 0.3, 1e-2, velocity=THROWN)) for each in (both, apart)]
    assert [run.first_contact for run in runs] == [0.0, 0.0]
    changes = [run.data.attrs["contact_changes"] for run in runs]
    assert changes[0] == changes[1] > 4


def test_a_ball_rides_on_a_cantilever() -> None:
    """Reference: other code, scheme and data of Siconos' ImpactingEulerBernouilliBeam with steps of
    20 µs. Chatter causes a scatter of the time of about 50 ms at which the ball leaves.
    """
    stop = PowerContact(1.0e7, 1.0, damping=5.0).lower().with_clearance(HEIGHT)
    run = FixedStep(1e-4)(falling(ELEMENTS, stop, 0.06))
    expected = moreau_jean(2e-5)[::50] - [HEIGHT, 0.0]
    found = np.column_stack([run.data["ball"], run.data["tip"]])
    assert np.abs(found - expected).max() < 0.03 * np.ptp(expected[:, 1])
    assert run.data.attrs["contact_changes"] > 10


def test_blows_of_a_coarse_cantilever() -> None:
    """Reference: other code, scipy's DOP853 with the same contact, through its blows."""
    motion = falling(2, PowerContact(1.0e6, 1.0).lower().with_clearance(HEIGHT), 0.03)
    expected = runge_kutta(motion, 2e-5)
    errors = errors_in_the_step(motion, expected, 4e-5 * 0.5 ** np.arange(4))
    assert FixedStep(5e-6)(motion).data.attrs["contact_changes"] >= 6
    assert slopes(errors)[1:] == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < 2e-5
