# SPDX-License-Identifier: LGPL-3.0-or-later
"""The time step against closed forms of impacts and free motion."""

import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh, expm

from protractile.dynamics import time_step
from protractile.dynamics.contact import ContactLaw, DryFriction, PowerContact
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Excitation, PiecewiseLinear, Sine
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
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


@pytest.mark.parametrize(("step", "duration"), [(1e-2, 1.0), (1e-4, 0.1), (1e-6, 0.02)])
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
    # No interval has a mean above its largest force, resolved or not.
    means, peaks = (np.abs(run.data[x].values) for x in ("contact_force", "contact_force_peak"))
    assert (peaks >= means * (1.0 - 1e-12)).all()


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
        (lossy_press(), 5e-6), (sliding(), 5e-7), (telescoping(), 3e-4), (driven(), 1e-4),
        (Motion(two_modes(), 0.6, 0.04), 5e-6),
    ],
    ids=["losses", "sliding", "telescoping", "driven", "one blow"],
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


# ω² in rad²/s² and c in 1/s of free modes; differences of numbers near 1 would have few digits.
FREE = np.array([
    (40.0, 0.0), (1.0e-6, 0.0), (40.0, 0.7), (2.25, 3.0), (2.0, 9.0), (0.0, 0.0), (0.0, 0.7),
    (1.0e8, 20.0), (-2.25, 0.0), (-2.25, 0.7), (40.0, 1.0e-9), (0.0, 1.0e-9), (1.0e4, 1.0e5),
])  # fmt: skip


@pytest.mark.parametrize("step", [1e-6, 1e-3, 0.5])
def test_free_flight_is_exact(step: float) -> None:
    """Reference: other code, scipy.linalg.expm of (a, v, load), for any step and damping."""
    omega2, damping = FREE.T
    system = modal_system(omega2, np.full(len(FREE), 3.0), damping=damping)
    velocity = np.full(len(FREE), -0.7)
    run = FixedStep(step)(Motion(system, 2.0 * step, step, velocity=velocity))
    for k, (w2, c) in enumerate(FREE.tolist()):
        generator = np.array([[0.0, step, 0.0], [-w2 * step, -c * step, step], np.zeros(3)])
        expected = [expm(generator * count)[0] @ [0.0, -0.7, 3.0] for count in (1, 2)]
        size = np.abs(expected).max()
        np.testing.assert_allclose(run.states[1:, k], expected, rtol=0.0, atol=1e-10 * size)


SOME: list[ContactLaw] = [
    POWER, PowerContact(1.0e7, 2.0, damping=0.3).with_clearance(1.0e-3),
    PowerContact(1.0e5, 1.5).upper(),
    TableContact((1.0e-4, 1.0e-3), (20.0, 300.0)).with_clearance(1.0e-3),
    PowerContact(1.0e9, 3.0, stiffness_below=1.0e4).with_clearance(1.0e-3, 2.0e-3),
    PowerContact(1.0e4, 1.0).with_clearance(-1.0e-3),
]  # fmt: skip


@pytest.mark.parametrize("equal_rows", [False, True])
def test_forces_of_random_systems_meet_their_laws(equal_rows: bool) -> None:
    """Reference: analytic, the energy balance and Coulomb's bound; nearly no step is halved.

    Friction rows may be equal, like those of pads in the corners of a rigid section.
    """
    random, halved = np.random.default_rng(5), 0
    for _ in range(40):
        n, m, f, d = random.integers((3, 1, 1, 0), (20, 7, 7, 4))
        rows = random.normal(size=(f, n))[np.arange(f) // 2 if equal_rows else np.arange(f)]
        pressing = [tuple(np.flatnonzero(random.random(m) < 0.5).tolist()) for _ in range(f)]
        frictions = [
            DryFriction(random.uniform(0.0, 0.5), 0, random.choice([0.0, 5.0]), each)
            for each in pressing
        ]
        laws = [SOME[k] for k in random.integers(0, len(SOME), m)]
        dashpots = random.normal(size=(d, n)) * 10.0 ** random.uniform(-1.0, 2.0)
        more: dict[str, Any] = {"dashpots": dashpots, "friction_rows": rows, "frictions": frictions}
        loaded = random.uniform(0.0, 1e4, n), random.normal(size=n), random.normal(size=(m, n))
        system = modal_system(*loaded, laws, **more)
        motion = Motion(system, 0.02, 1e-3, velocity=random.normal(size=n))
        run = FixedStep(1e-3)(motion)
        assert run.energy_residual < 1e-10
        normal = np.abs(run.data["contact_force_peak"].values).sum(axis=1)
        bound = sum(one.coefficient * (one.normal_force + normal) for one in frictions)
        assert (np.abs(run.data["friction_force"].values[:, 0]) <= bound * (1.0 + 1e-9)).all()
        halved += run.data.attrs["steps"] > 20
    assert halved < 4


def wedge(friction: float) -> Motion:
    """Return the motion of a block with friction that increases its contact force."""
    tilted = np.array([[-0.9, 1.0], [0.9, 1.0]])
    laws = [PowerContact(1.0e9, 1.0).with_clearance(1.0e-4)] * 2
    rubbing = {"friction_rows": tilted, "frictions": [DryFriction(friction, 0, 1.0, (0, 1))] * 2}
    more = rubbing | {"station_of_row": np.array([0, 0]), "stations": [0.0]}
    system = modal_system([0.0, 100.0], [30.0, 50.0], np.eye(2), laws, tip=[1.0, 1.0], **more)
    return Motion(system, 1.0, 1e-2, velocity=np.array([0.4, -0.7]))


@pytest.mark.parametrize("friction", [0.3, 20.0])
def test_steps_are_halved_until_their_forces_converge(
    friction: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: analytic, the energy balance and Coulomb's bound, with some additional steps."""
    run = FixedStep(1e-2)(wedge(friction))
    assert 100 < run.data.attrs["steps"] < 150
    assert run.energy_residual < 1e-11
    force = np.abs(run.data["friction_force"].values[1:, 0])
    bound = friction * 2.0 * (1.0 + 2.0 * np.abs(run.data["contact_force_peak"].values[1:, 0]))
    assert (force <= bound * (1.0 + 1e-9)).all()
    monkeypatch.setattr(time_step, "_HALVINGS", 0)
    message = (
        "contact and friction forces do not converge even in steps of 0.01 s; make the contact "
        "softer"
    )
    with pytest.raises(NumericsError, match=f"^{re.escape(message)}$"):
        FixedStep(1e-2)(wedge(friction))


@pytest.mark.parametrize("exponent", [1.0, 3.0])
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


def test_falling_mass() -> None:
    """Reference: external, SDND108 of the Code_Aster validation manual. Of two rows that close
    within one step the earlier one is told; linear interpolation of a fall errs by g h²/8.
    """
    stop = PowerContact(stiffness=100.0, exponent=1.0).lower().with_clearance(2.0)
    motion = Motion(one_mass(1.0, stop, force=-10.0), 1.2, 1e-3, velocity=np.array([-1.0]))
    run = FixedStep(1e-3)(motion)
    assert run.data.attrs["contact_changes"] == 2
    assert float(run.data["contact_force"].max()) == 0.0
    inside = run.time[run.data["tip"].values < -2.0]
    assert (inside[0], inside[-1]) == pytest.approx([0.5403124, 0.8854562], abs=1e-3)
    for step in (2.0e-2, 1.0e-3):
        found = FixedStep(step)(replace(motion, output_step=2e-2)).first_contact
        assert abs(found - 0.1 * (np.sqrt(41.0) - 1.0)) < 10.0 * step**2 / 8.0 / np.sqrt(41.0)
    system = replace(
        boom(), laws=[POWER.law.with_clearance(gap) for gap in (0.0105, 0.0102)],
        rows=np.eye(4)[[0, 0]], load=np.zeros(4),
    )  # fmt: skip
    run = FixedStep(0.01)(Motion(system, 0.1, 0.01, velocity=np.eye(4)[0]))
    assert run.first_contact == pytest.approx(0.0102, rel=1e-9)


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


@pytest.mark.parametrize(
    ("stiffness", "exponent", "step"), [(1e8, 1.0, 1e-2), (1e10, 1.5, 1e-5), (1e13, 2.0, 1e-3)]
)
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


@pytest.mark.parametrize(
    ("place", "speed", "first"), [(-0.1003, 1.0, 0.2003), (0.11, -0.1, 0.0), (0.0, 0.1, np.nan)]
)
def test_first_contact_late_at_once_or_never(place: float, speed: float, first: float) -> None:
    """Reference: analytic. A mass reaches a stop at 0.1 m, begins in contact, or never touches."""
    system = one_mass(1.0, PowerContact(stiffness=1.0, exponent=1.0).upper().with_clearance(0.1))
    run = FixedStep(3e-4)(Motion(system, 0.5, 0.01, np.array([place]), np.array([speed])))
    assert run.first_contact == pytest.approx(first, rel=1e-6, nan_ok=True)
    assert run.data.attrs["contact_changes"] == (0 if np.isnan(first) else 1)


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
