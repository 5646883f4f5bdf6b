# SPDX-License-Identifier: LGPL-3.0-or-later
"""Schemes of the 1990s against a textbook, and outcomes of the numerics of 1997."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from studies.numerics_1997.samples import (
    SERIES,
    STEPS,
    Example,
    ModelRun,
    Numerics,
    Sample,
    all_numerics,
)
from studies.numerics_1997.schemes import CENTRAL, NEWMARK, WILSON, Scheme, integrate
from studies.numerics_1997.survey import (
    METHODS,
    TOLERANCES,
    WITH,
    WITHOUT,
    Survey,
    solve,
)
from tests.modal import modal_system, oscillator
from tests.runs.case_texts import shipped

ALL = (NEWMARK, WILSON, CENTRAL)
DEEP = 100.0
# Number of steps for the measurement of an eigenvalue.
STEPS_OF_ERRORS = 100


def textbook_root(scheme: Scheme, phase: float) -> complex:
    """Return the eigenvalue λ of the amplification matrix of an undamped oscillator.

    Newmark's scheme and central differences have closed forms; Wilson's scheme has the matrix of
    Bathe (1996, section 9.4).

    Args:
        scheme: one of the three schemes.
        phase: ω h, the circular frequency times the step.
    """
    if scheme == NEWMARK:
        return complex(np.exp(2.0j * np.arctan(0.5 * phase)))
    if scheme == CENTRAL:
        return complex(np.exp(2.0j * np.arcsin(0.5 * phase)))
    theta = scheme.theta
    b = 1.0 / (theta / phase**2 + theta**3 / 6.0)
    matrix = [
        [1.0 - b * theta**2 / 3.0 - 1.0 / theta, -b * theta, -b],
        [1.0 - 0.5 / theta - b * theta**2 / 6.0, 1.0 - 0.5 * b * theta, -0.5 * b],
        [0.5 - (1.0 / theta + b * theta**2 / 3.0) / 6.0, 1.0 - b * theta / 6.0, 1.0 - b / 6.0],
    ]
    return _rotating_root(np.linalg.eigvals(matrix))


def measured_root(scheme: Scheme, phase: float) -> complex:
    """Return the eigenvalue λ of the amplification matrix from a computed motion."""
    motion = Motion(oscillator(), STEPS_OF_ERRORS * phase, phase, position=np.ones(1))
    way = integrate(motion, scheme, iterated=False).trajectory.states[:, 0]
    behind = np.stack([way[2:-1], way[1:-2], way[:-3]], axis=1)
    return _rotating_root(np.roots([1.0, *-np.linalg.lstsq(behind, way[3:], rcond=1.0e-9)[0]]))


def _rotating_root(roots: object) -> complex:
    """Return the eigenvalue with a positive imaginary part."""
    return complex(max(np.asarray(roots), key=lambda root: root.imag))


def sprung() -> GapSystem:
    """Return 1 kg always in contact with two stops of together 1 N/m, without another spring."""
    contact = PowerContact(0.5, 1.0).with_clearance(-DEEP)
    return modal_system([0.0], [0.0], [1.0], [contact], tip=[1.0])


def rubbing(force: float) -> GapSystem:
    """Return 1 kg that slides against a friction force in N."""
    friction = DryFriction(coefficient=1.0, station=0, normal_force=force)
    rows = {"friction_rows": np.ones((1, 1)), "frictions": [friction]}
    return replace(oscillator(), omega2=np.zeros(1), stations=[0.0], **rows)


@pytest.mark.parametrize("scheme", ALL, ids=str)
@pytest.mark.parametrize("phase", [0.1, 0.628, 1.5])
def test_an_oscillator_turns_as_the_textbook_says(scheme: Scheme, phase: float) -> None:
    """Reference: analytic, roots of the amplification matrix, Bathe 1996, section 9.4. Central
    differences are stable for ω h < 2 only.
    """
    assert measured_root(scheme, phase) == pytest.approx(textbook_root(scheme, phase), rel=1e-9)
    lost = integrate(Motion(oscillator(), 202.0, 2.02, position=np.ones(1)), CENTRAL, False)
    assert lost.finite_steps < 100


@pytest.mark.parametrize("scheme", ALL, ids=str)
def test_an_iterated_contact_is_a_spring_of_the_mode(scheme: Scheme) -> None:
    """Reference: other code path, the same spring as the stiffness of the mode."""
    of_mode, of_contact = (
        integrate(Motion(system, 20.0, 0.1, position=np.ones(1)), scheme, True).trajectory
        for system in (replace(sprung(), omega2=np.ones(1), rows=np.zeros((1, 1))), sprung())
    )
    assert of_contact.states == pytest.approx(of_mode.states, abs=1e-9)


def test_a_lagged_contact_gains_energy() -> None:
    """Reference: analytic. A lag is a dashpot of −k h: amplitudes grow as exp(h t/4)."""
    step, duration = 0.05, 20.0
    swings = []
    for iterated in (True, False):
        motion = Motion(sprung(), duration, step, position=np.ones(1))
        late = integrate(motion, NEWMARK, iterated).trajectory.states[-200:, 0]
        swings.append(np.abs(late).max())
    assert swings[0] == pytest.approx(1.0, abs=1e-2)
    assert swings[1] > np.exp(0.25 * step * duration)


def test_sliding_dissipates_the_work_of_friction() -> None:
    """Reference: analytic, v t − F t²/2 while it slides, and the loss F s."""
    motion = Motion(rubbing(0.5), 1.0, 0.01, velocity=np.ones(1))
    for iterated in (True, False):
        run = integrate(motion, NEWMARK, iterated).trajectory
        assert float(run.states[-1, 0]) == pytest.approx(0.75, abs=1e-9)
        assert float(run.data["friction_loss"][-1]) == pytest.approx(0.375, abs=1e-9)
        assert run.energy_residual < 1e-9


TIME = np.arange(0.0, 10.0, 1.6e-3)
CUTOFF = 1.7


def moved(tip: Array, head: float = 0.1, gained: float = 0.0, since: float = 0.0) -> ModelRun:
    """Return a tip, a head that is a part of it, and an energy in J of 1 J initially."""
    return ModelRun(TIME, tip, head * tip, np.where(since <= TIME, gained, 0.0), 1.0)


def swing(frequency: float = 0.9, late: float = 0.0) -> Array:
    """Return a vibration in m with a delay in s after six seconds."""
    return np.sin(2.0 * np.pi * frequency * (TIME - late * np.clip(TIME - 6.0, 0.0, 1.0)))


def sample(*tips: Array, gained: float = 0.0, since: float = 0.0) -> Sample:
    *series, elements = (moved(tip, gained=gained, since=since) for tip in tips)
    return Sample([*series, elements], moved(0.05 * tips[0]))


@pytest.mark.parametrize(
    ("others", "gained", "early", "late"),
    [(swing(), 0.0, 0.0, 0.0), (swing(late=0.15), 0.0, 0.0, 0.135),
     (swing(late=0.4), 0.0, 0.0, 0.36), (swing(late=0.4), 2.0, np.inf, np.nan)],
)  # fmt: skip
def test_peaks_conform_and_part(others: Array, gained: float, early: float, late: float) -> None:
    """Reference: analytic, sines of the same phase, and one with a delay after 6 s; motions whose
    energy diverges have no peaks.
    """
    found = sample(swing(), swing(), others, gained=gained, since=6.5)
    assert found.peaks(CUTOFF) == pytest.approx((early, late), abs=0.04, nan_ok=True)
    assert found.conforms_then_diverges(CUTOFF) == (late > 0.2)


@pytest.mark.parametrize(("head", "stratifies"), [(0.1, False), (1.0, True)])
def test_s7_takes_all_of_its_parts(head: float, stratifies: bool) -> None:
    """Reference: by hand, ±1 m and a tenth more after 6 s, which is 0.1 of 2.2. Heads differ by 0
    or all of it.
    """
    tips = swing(), swing(), np.where(TIME > 6.0, 1.1, 1.0) * swing()
    runs = [moved(tip, 0.1) for tip in tips[:2]] + [moved(tips[2], head)]
    found = Sample(runs, moved(0.05 * tips[0]))
    assert found.tip_distances() == pytest.approx((0.0, 0.1 / 2.2), rel=0.01)
    assert found.stratifies() == stratifies


@pytest.mark.parametrize("method", METHODS)
def test_a_general_solver_swings_an_oscillator(method: str) -> None:
    """Reference: analytic, 1 − cos t."""
    system = replace(oscillator(), load=np.ones(1))
    found = solve(system, 5.0, method, 1e-8, 2000)
    assert found.time[-1] == 5.0
    assert found.states[:, 0] == pytest.approx(1.0 - np.cos(found.time), abs=1e-5)
    assert found.velocities[:, 0] == pytest.approx(np.sin(found.time), abs=1e-5)


def test_outcomes_follow_from_the_runs() -> None:
    """Reference: by hand. Two of four runs diverge after 6 s, the energy of two diverges at 6.5 s,
    and a solver reaches 2 of 7 s.
    """
    alike, parting = (swing(), swing(), swing()), (swing(), swing(), swing(late=0.4))
    lost = sample(*alike, gained=2.0, since=6.5)
    samples = {way: [sample(*parting), sample(*parting), lost, lost] for way in all_numerics()}
    examples = [Example(shipped(of.stem), {}, CUTOFF, [sample(*alike)]) for of in (WITHOUT, WITH)]
    reached = dict.fromkeys(product(METHODS, TOLERANCES, SERIES, (False, True)), 2.0)
    outcomes = Survey(*examples, samples, samples, reached).outcomes
    first = str(Numerics(all_numerics()[0].scheme, True, STEPS[0]))
    assert (outcomes["S3"].shown, outcomes["S3"].why) == (True, f"in 50 % of runs by {first}")
    assert outcomes["S8"].why.endswith("energy breaks out in 2 of 4 runs, at 6.5 to 6.5 s")
    assert [outcomes[key].shown for key in ("S7", "S8", "S10")] == [True, True, False]
    assert outcomes["S10"].why.startswith("2000 steps of a general solver reach 2 s of the 7 s")
