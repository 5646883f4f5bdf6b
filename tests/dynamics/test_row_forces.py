# SPDX-License-Identifier: LGPL-3.0-or-later
"""The time step: the modal flow, and forces that satisfy the laws of all rows."""

import re
from collections.abc import Mapping

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.linalg import expm

from protractile.dynamics import time_step
from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import ContactLaw, DryFriction, PowerContact
from protractile.dynamics.contact_table import TableContact
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.kernels import march
from protractile.dynamics.kernels.modal_flow import finish_flow, free_flow, modal_flow
from protractile.dynamics.kernels.row_forces import (
    row_laws,
    row_problem,
    solve_contact_forces,
)
from protractile.dynamics.motion import Motion
from tests.modal import modal_system

# What round-off leaves of a law, as a part of the largest force.
TOLERANCE = 1.0e-10

LAWS: list[ContactLaw] = [
    PowerContact(1.0e4, 1.0).with_clearance(1.0e-3),
    PowerContact(1.0e7, 2.0, damping=0.3).with_clearance(1.0e-3),
    PowerContact(1.0e5, 1.5).upper(),
    TableContact((1.0e-4, 1.0e-3), (20.0, 300.0)).with_clearance(1.0e-3),
    PowerContact(1.0e9, 3.0, stiffness_below=1.0e4).with_clearance(1.0e-3, 2.0e-3),
    PowerContact(1.0e4, 1.0).with_clearance(-1.0e-3),
    PowerContact(1.0e8, 2.7).with_clearance(1.0e-3),
]


def random_system(random: np.random.Generator, equal_rows: bool) -> GapSystem:
    """Return random numbers of contacts, friction rows and dashpots, with fewer or more modes.

    Friction rows may be equal, like those of pads in the corners of a rigid section.
    """
    n, m, f, d = random.integers((3, 1, 0, 0), (20, 7, 7, 4))
    frictions = random.normal(size=(f, n))
    if equal_rows:
        frictions = frictions[np.arange(f) // 2]
    pressing = [tuple(np.flatnonzero(random.random(m) < 0.5).tolist()) for _ in range(f)]
    return modal_system(
        random.uniform(0.0, 1e4, n),
        np.zeros(n),
        random.normal(size=(m, n)),
        [LAWS[k] for k in random.integers(0, len(LAWS), m)],
        dashpots=random.normal(size=(d, n)) * 10.0 ** random.uniform(-1.0, 2.0),
        friction_rows=frictions,
        frictions=[
            DryFriction(random.uniform(0.0, 0.5), 0, random.choice([0.0, 5.0]), rows)
            for rows in pressing
        ],
    )


def contact_force(law: ContactLaw, before: float, after: float, time: float) -> float:
    """Return a step's mean force: the energy per distance, and damping at its rate."""
    total = 0.0
    for one in (law.one_sided(1), law.one_sided(-1)):
        if one is not None and after != before:
            gained = float(one.energy(np.array(after))) - float(one.energy(np.array(before)))
            side = 1.0 if one.one_sided(1) is not None else -1.0
            rate = side * (after - before) / time
            total += gained / (after - before) * max(0.0, 1.0 + law.damping * rate)
    return total


def violations(
    system: GapSystem, force: Array, start: Array, end: Array, slip_force: Array, time: float
) -> Array:
    """Return the violation of its law by each row in N; ``slip_force`` is the force during slip."""
    m, f = len(system.laws), len(system.frictions)
    pressed, rubbed, dragged = np.split(force, [m, m + f])
    contacts = [
        contact_force(law, *ends, time) - found
        for law, found, *ends in zip(system.laws, pressed, start, end, strict=False)
    ]
    found = [*contacts]
    for friction, own, asked in zip(system.frictions, rubbed, slip_force[m:], strict=False):
        bound = friction.coefficient * (
            friction.normal_force + np.abs(pressed[list(friction.normal_rows)]).sum()
        )
        # Coulomb's law as a projection: f = P(f + s/C) onto what the bound allows.
        found.append(own - np.clip(own + asked, -bound, bound))
    return np.array([*found, *((end - start)[m + f :] / time - dragged)])


@pytest.mark.parametrize("equal_rows", [False, True])
def test_random_steps_meet_their_laws(equal_rows: bool) -> None:
    """Reference: analytic, the energy differences of contacts, Coulomb's law and the rates of
    dashpots for 400 random systems, states and steps. Nearly all steps converge without halving.
    """
    random, solved = np.random.default_rng(5), 0
    for _ in range(400):
        system, time = random_system(random, equal_rows), 10.0 ** random.uniform(-5.0, -2.0)
        stacked = system.all_rows
        compliance = 0.5 * time**2 * stacked @ stacked.T
        start = 2.0e-3 * random.normal(size=len(stacked))
        problem = row_problem(len(stacked), len(system.frictions))
        problem.free[:] = start + time * stacked @ random.normal(size=system.num_modes)
        if not solve_contact_forces(row_laws(system), problem, compliance, start, time):
            continue
        solved += 1
        end = problem.free - compliance @ problem.force
        asked = (end - start) / np.diag(compliance)
        off = violations(system, problem.force, start, end, asked, time)
        # A way that round-off hides tells no force.
        noise = 1e-15 * np.abs(problem.free).max() / np.diag(compliance).min()
        assert np.abs(off).max() <= TOLERANCE * np.abs(problem.force).max() + noise
    assert solved > 390


def test_equal_friction_rows_stick_at_once() -> None:
    """Reference: analytic, no slip below the limit; equal rows make the Jacobian singular."""
    random, time = np.random.default_rng(3), 1.0e-3
    for _ in range(200):
        copies = random.permutation(np.repeat(random.normal(size=(3, 4)), 2, axis=0))
        rubbing = {"friction_rows": copies, "frictions": [DryFriction(1.0, 0, 1.0e9)] * 6}
        rows, laws = random.normal(size=(2, 4)), [PowerContact(1.0e6, 1.0)] * 2
        system = modal_system(np.zeros(4), np.zeros(4), rows, laws, **rubbing)
        stacked = system.all_rows
        compliance, start = 0.5 * time**2 * stacked @ stacked.T, np.zeros(8)
        problem = row_problem(8, 6)
        problem.free[:] = time * stacked @ random.normal(size=4)
        assert solve_contact_forces(row_laws(system), problem, compliance, start, time)
        slip = (problem.free - compliance @ problem.force)[2:]
        assert np.abs(slip).max() < 1e-12 * np.abs(problem.free).max()


def wedge(friction: float) -> GapSystem:
    """Return a block with friction that increases its contact force."""
    tilted = np.array([[-0.9, 1.0], [0.9, 1.0]])
    laws = [PowerContact(1.0e9, 1.0).with_clearance(1.0e-4)] * 2
    rubbing = {"friction_rows": tilted, "frictions": [DryFriction(friction, 0, 1.0, (0, 1))] * 2}
    one_place = {"station_of_row": np.array([0, 0]), "stations": [0.0]}
    more = rubbing | one_place
    return modal_system([0.0, 100.0], [30.0, 50.0], np.eye(2), laws, tip=[1.0, 1.0], **more)


@pytest.mark.parametrize("friction", [0.3, 2.0, 20.0])
def test_steps_are_halved_until_their_forces_converge(friction: float) -> None:
    """Reference: analytic, the energy balance and Coulomb's bound, with some additional steps."""
    run = FixedStep(1e-2)(Motion(wedge(friction), 1.0, 1e-2, velocity=np.array([0.4, -0.7])))
    assert 100 < run.data.attrs["steps"] < 150
    assert run.energy_residual < 1e-11
    force = np.abs(run.data["friction_force"].values[1:, 0])
    bound = friction * 2.0 * (1.0 + 2.0 * np.abs(run.data["contact_force_peak"].values[1:, 0]))
    assert (force <= bound * (1.0 + 1e-9)).all()


def test_diverging_forces_end_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: exact message, with the smallest step and the remedy."""
    monkeypatch.setattr(time_step, "_HALVINGS", 0)
    message = (
        "contact and friction forces do not converge even in steps of 0.01 s; make the contact "
        "softer"
    )
    with pytest.raises(NumericsError, match=f"^{re.escape(message)}$"):
        FixedStep(1e-2)(Motion(wedge(0.3), 1.0, 1e-2, velocity=np.array([0.4, -0.7])))


@pytest.mark.parametrize(("side", "slope"), [(-1.0, 1.0e9), (1.0, 0.0)])
def test_a_side_without_a_law_ends_search_for_its_deepest_press(side: float, slope: float) -> None:
    """Reference: analytic, a linear stop below. Round-off may cause a force on the other side."""
    system = modal_system([0.0], [0.0], [1.0], [PowerContact(1.0e9, 1.0).lower()])
    assert march._stiffness_at_energy(row_laws(system), 0, side, 1.0e-3) == pytest.approx(slope)


# ω² in rad²/s², c in 1/s, load in N/√kg
MODES = {
    "undamped": (40.0, 0.0, 3.0), "undamped, slow": (1.0e-6, 0.0, 3.0), "damped": (40.0, 0.7, 3.0),
    "critically damped": (2.25, 3.0, 3.0), "overdamped": (2.0, 9.0, 3.0), "rigid": (0.0, 0.0, 3.0),
    "rigid damped": (0.0, 0.7, 3.0), "stiff": (1.0e8, 20.0, 3.0), "tipping over": (-2.25, 0.0, 3.0),
    "tipping over, damped": (-2.25, 0.7, 3.0),
}  # fmt: skip


# Differences of numbers near 1 would have few digits.
NEARLY_UNDAMPED = {
    "hardly damped": (40.0, 1.0e-9, 3.0), "rigid, hardly damped": (0.0, 1.0e-9, 3.0),
    "heavily damped": (1.0e4, 1.0e5, 3.0),
}  # fmt: skip


def modes(numbers: Mapping[str, tuple[float, float, float]] = MODES) -> GapSystem:
    omega2, damping, load = np.array(list(numbers.values())).T
    return modal_system(omega2, load, damping=damping)


@pytest.mark.parametrize("step", [1.0e-6, 1.0e-5, 1.0e-4, 1.0e-2, 1.0])
def test_flow_is_the_matrix_exponential(step: float) -> None:
    """Reference: other code, scipy.linalg.expm of (a, v, load, ramp, mean) in units of the step."""
    numbers = MODES | NEARLY_UNDAMPED
    flow = modal_flow(modes(numbers), np.array([2.0 * step, step]))
    for k, (name, (omega2, damping, _)) in enumerate(numbers.items()):
        generator = np.eye(5, k=1)
        generator[1] = [-omega2 * step**2, -damping * step, 1.0, 0.0, 0.0]
        _, impulse, *responses = expm(generator)[0]
        reach = min(step, 1.0 / np.sqrt(abs(omega2))) if omega2 else step
        assert abs(flow.impulse[1, k] - impulse * step) <= 1e-11 * reach, name
        for entry, value in zip((flow.gain, flow.ramp, flow.drift), responses, strict=True):
            assert abs(entry[1, k] - value * step**2) <= 1e-11 * reach**2, name


@pytest.mark.parametrize("name", MODES)
def test_work_and_loss_of_a_step(name: str) -> None:
    """Reference: other code, scipy's quadrature of the exact motion; and the energy balance."""
    omega2, c, load = MODES[name]
    system, h, change = modes(), 0.3 if omega2 < 1e6 else 3e-4, np.full(len(MODES), 0.8)
    start, speed, force = (np.full(len(MODES), x) for x in (0.2, -0.7, load))
    flow, k = modal_flow(system, np.array([h])), list(MODES).index(name)
    generator = np.array([[0, 1, 0, 0], [-omega2, -c, 1, 0], [0, 0, 0, 0.8 / h], np.zeros(4)])

    def state(time: float) -> np.ndarray:
        return np.asarray(expm(generator * time) @ [0.2, -0.7, load - 0.4, 1.0])

    a, v, end = start.copy(), speed.copy(), np.zeros(len(MODES))
    free_flow(a, v, flow, 0, force, change, end)
    one = np.eye(len(MODES))[k]
    a, v = 0.0 * start + one * start, one * speed
    work, lost = finish_flow(a, v, flow, 0, one * force, one * change, one * end, one * force)
    assert (end[k], v[k]) == pytest.approx(tuple(state(h)[:2]), rel=1e-9)
    power = quad(lambda t: state(t)[1] * state(t)[2], 0.0, h, epsabs=1e-13)[0]
    taken = quad(lambda t: c * state(t)[1] ** 2, 0.0, h, epsabs=1e-13)[0]
    assert (work, lost) == pytest.approx((power, taken), rel=1e-7, abs=1e-11)
