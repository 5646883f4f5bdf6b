# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact and friction of one implicit step, solved as they stand."""

from __future__ import annotations

import numpy as np
import pytest

from dynamics.contact import PowerContact, contact_terms
from dynamics.failure import NumericsError
from dynamics.friction import DryFriction
from studies.reference_models.resisting_rows import ResistingRows, resist


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_forces_of_a_step_obey_their_laws_to_round_off(exponent: float) -> None:
    """Reference: analytic. Contacts follow (4); what friction holds stays, what it does not hold
    moves its way. Rows depend on one another as those of a station do: it slides by their mean.
    """
    random = np.random.default_rng(1)
    law = PowerContact(10.0 ** (5.0 + 3.0 * exponent), exponent).behind(1.0e-3)
    laws = [law.one_sided(side) for side in (1, -1, 1, -1)]
    mean = np.array([[0.5, 0.5, 0.0, 0.0], [0.0, 0.0, 0.5, 0.5]])
    states = set()
    for _ in range(200):
        factor = random.normal(size=(4, 4))
        contact = 1.0e-7 * (factor @ factor.T + 0.1 * np.eye(4))
        rows = np.vstack([np.eye(4), mean])
        compliance = rows @ contact @ rows.T
        free = rows @ random.normal(scale=2.0e-3, size=4)
        bound, place = np.array([900.0, 1000.0]), random.normal(scale=1.0e-4, size=2)
        force = np.zeros(6)
        assert resist((compliance, free, contact_terms(laws), bound, place), force)
        read = free - compliance @ force
        noise = 1.0e-12 * np.abs(compliance).max() * np.abs(force).sum() + 1.0e-15
        for reading, one, pushed in zip(read[:4], laws, force[:4], strict=True):
            # By the reading that the force belongs to, as a stiff law multiplies round-off.
            k = max(one.law.stiffness, one.law.below)
            depth = (abs(pushed) / k) ** (1.0 / exponent)
            side = 1.0 if one.law.stiffness else -1.0
            if pushed:
                assert side * reading - one.onset(side) == pytest.approx(depth, abs=noise)
            else:
                assert side * reading <= one.onset(side) + noise
        for reading, at, most, rubbed in zip(read[4:], place, bound, force[4:], strict=True):
            held = abs(rubbed) < most
            assert abs(rubbed) <= most
            assert abs(reading - at) < noise if held else (reading - at) * rubbed > -noise * most
        states.add((*(force[:4] != 0.0).tolist(), *(np.abs(force[4:]) < bound).tolist()))
    assert len(states) > 10


def test_a_block_on_a_rough_floor_stays_or_slides() -> None:
    """Reference: analytic. Below μN a push moves nothing; above, the compliance times what is left,
    and friction takes μN times the way.
    """
    rows = ResistingRows([], [DryFriction(0.5, 0, 20.0)], np.array([[1.0e-3]]), onward=2.0)
    assert rows.forces(np.array([9.0e-3])) == pytest.approx([9.0], rel=1.0e-14)
    assert rows.readings == pytest.approx([0.0], abs=1.0e-17)
    assert rows.friction_loss == pytest.approx(0.0, abs=1.0e-15)
    assert rows.forces(np.array([14.0e-3])) == pytest.approx([10.0], rel=1.0e-14)
    assert rows.readings == pytest.approx([2.0 * 4.0e-3], rel=1.0e-12)
    assert rows.friction_loss == pytest.approx(10.0 * 8.0e-3, rel=1.0e-12)


def test_forces_that_are_no_numbers_are_refused() -> None:
    rows = ResistingRows([], [DryFriction(0.5, 0, 20.0)], np.array([[1.0e-3]]), onward=2.0)
    message = "^the forces of contact and friction are not found; halve the step$"
    with pytest.raises(NumericsError, match=message):
        rows.forces(np.array([np.nan]))
