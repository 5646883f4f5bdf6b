# SPDX-License-Identifier: LGPL-3.0-or-later
"""The paper's boom with the dry friction of (28), whose motion is regular."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from beam_model.component import SegmentModel
from beam_model.segment_model import gap_system
from dynamics.contact import DryFriction, PowerContact
from dynamics.gap_system import GapSystem
from dynamics.integrator import AdaptiveStep, FixedStep
from dynamics.motion import Motion
from geometry.boom import Boom
from tests.touching import touching

# Nearly three times the default step: what is shown here does not need that.
STEP = 4.0e-6


@pytest.fixture
def five_terms(
    paper_boom: Boom, series: Callable[..., list[SegmentModel]], paper_law: PowerContact
) -> GapSystem:
    """Return the five-term series with normal forces of 4500 N (tail) and 5000 N (head)."""
    system = gap_system(touching(paper_boom, paper_law), series((2, 3)))
    return replace(
        system,
        friction_rows=system.rows,
        frictions=[DryFriction(0.2, 0, 4500.0), DryFriction(0.2, 1, 5000.0)],
    )


def test_a_small_change_stays_small(five_terms: GapSystem) -> None:
    """Reference: the same boom. 1e-9 of the load changes its motion for 5 s as little."""
    changed = replace(five_terms, load=five_terms.load * (1.0 + 1e-9))
    one, other = (FixedStep(STEP)(Motion(system, 5.0)) for system in (five_terms, changed))
    tip = one.data["tip"].values
    assert np.abs(tip - other.data["tip"].values).max() < 1e-7 * np.ptp(tip)
    assert one.data.attrs["contact_changes"] > 20
    # Without friction the same change grows to the size of the motion.
    free = [
        FixedStep(STEP)(Motion(replace(system, friction_rows=np.zeros((0, 5)), frictions=()), 5.0))
        for system in (five_terms, changed)
    ]
    apart = np.abs(free[0].data["tip"].values - free[1].data["tip"].values)
    assert apart.max() > 0.1 * np.ptp(tip)


def test_friction_takes_energy_and_the_ledger_closes(five_terms: GapSystem) -> None:
    """Reference: analytic. The loss is force times sliding distance, and never decreases."""
    run = FixedStep(STEP)(Motion(five_terms, 3.0))
    loss = run.data["friction_loss"].values
    # Where it sticks, round-off is left.
    assert np.diff(loss).min() >= -1e-15 * loss[-1]
    assert loss[-1] > 0.5 * float(run.data["work"][-1])
    assert run.energy_residual < 1e-11
    force = np.abs(run.data["friction_force"].values)
    assert (force <= np.array([900.0, 1000.0]) * (1.0 + 1e-12)).all()
    # Both joints rub as hard as they can, and hold at times.
    assert (force.max(axis=0) > np.array([899.9, 999.9])).all()
    assert (np.median(force, axis=0) < np.array([899.9, 999.9])).all()


@pytest.mark.slow
def test_the_ledger_closes_beside_damping_for_long(five_terms: GapSystem) -> None:
    """Reference: analytic. Energy is conserved over 40 s of friction and Rayleigh damping."""
    damped = replace(five_terms, damping=0.2 + 1.0e-4 * np.maximum(five_terms.omega2, 0.0))
    run = AdaptiveStep()(Motion(damped, 40.0, 1.0e-2))
    losses = [float(run.data[name][-1]) for name in ("friction_loss", "damping_loss")]
    assert min(losses) > 0.05 * float(run.data["work"][-1])
    assert run.energy_residual < 1e-9


def test_a_smaller_step_changes_little(five_terms: GapSystem) -> None:
    """Reference: a step of 1 µs. Joints that stick give order 1: a tenth for a sixteenth."""
    tips = [
        FixedStep(step)(Motion(five_terms, 1.0)).data["tip"].values
        for step in (2.56e-4, 1.6e-5, 1e-6)
    ]
    errors = [np.abs(tip - tips[-1]).max() / np.ptp(tips[-1]) for tip in tips[:-1]]
    assert errors[0] < 1e-3
    assert errors[1] < errors[0] / 10.0
