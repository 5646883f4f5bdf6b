# SPDX-License-Identifier: LGPL-3.0-or-later
"""Systems in fewer coordinates."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.calibration import elastic_compliance
from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.reduction import condense
from tests.modal import modal_system

MODES = 60


def system(num_modes: int = MODES) -> GapSystem:
    """Return a system with one rigid mode, elastic modes of ascending frequency, and two rows."""
    random = np.random.default_rng(3)
    rows = random.normal(size=(4, MODES))[:, :num_modes]
    omega = np.concatenate([[0.0], 20.0 * np.arange(1, MODES) ** 1.5])[:num_modes]
    laws = [PowerContact(1e7, 1.0).with_clearance(0.01)] * 2
    rubbing = {"friction_rows": rows[2:3], "frictions": [DryFriction(0.2, 0, 100.0, ())]}
    return modal_system(omega**2, rows[3], rows[:2], laws, tip=rows[2], **rubbing)


def test_condensed_system_has_the_same_slow_response() -> None:
    """Reference: analytic, C(σ) = B (Ω² + σ)⁻¹ Bᵀ of the whole system."""
    whole = system()
    few, shapes = condense(whole, 20)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(20), atol=1e-12)
    assert few.num_modes == 20
    np.testing.assert_allclose(few.frequencies[:12], whole.frequencies[:12], rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(elastic_compliance(few), elastic_compliance(whole), rtol=1e-9)

    def answer(one: GapSystem) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
        rows = np.vstack([one.rows, one.load])
        return np.asarray(rows / (one.omega2 + (2.0 * np.pi * 20.0) ** 2) @ rows.T)

    # The truncated modes alone miss by far more.
    cut = system(20)
    error = np.abs(answer(few) - answer(whole)).max()
    assert error < 1e-3 * np.abs(answer(cut) - answer(whole)).max()


def test_excited_modes_are_kept_before_slower_unexcited_modes() -> None:
    """Reference: analytic. Modes are in the order of b²/ω⁴ for loads of equal size; the slowest
    eighth of 24 modes is always kept.
    """
    whole = system()
    signs = np.sign(np.vstack([whole.rows, whole.friction_rows, whole.load]))
    signs[:, 1::2] = 0.0
    few, _ = condense(replace(whole, rows=signs[:2], friction_rows=signs[2:3], load=signs[3]), 24)
    expected = whole.frequencies[np.r_[0, 1, 2, 4:30:2]]
    np.testing.assert_allclose(few.frequencies[:16], expected, rtol=1e-12, atol=1e-9)


def test_rigid_motions_remain_in_small_condensed_systems() -> None:
    """Reference: analytic, the compliance of the whole system; its rigid mode is the last one."""
    rows = np.random.default_rng(4).normal(size=(24, MODES))
    whole = replace(
        system(),
        omega2=system().omega2[::-1],
        rows=rows,
        laws=[PowerContact(1e7, 1.0).with_clearance(0.01)] * 24,
        station_of_row=np.arange(24) % 2,
    )
    few, _ = condense(whole, 24)
    assert few.omega2.min() == 0.0
    np.testing.assert_allclose(elastic_compliance(few), elastic_compliance(whole), rtol=1e-8)


def test_condense_returns_a_small_system_unchanged() -> None:
    """Reference: non-regression, the same object."""
    few = system(12)
    assert condense(few, 12)[0] is few


def test_a_system_is_condensed_before_it_is_damped() -> None:
    damped = replace(system(), damping=np.ones(MODES))
    with pytest.raises(ValueError, match="a system is condensed before it is damped"):
        condense(damped, 20)
