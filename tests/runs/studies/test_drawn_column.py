# SPDX-License-Identifier: LGPL-3.0-or-later
"""A column that a force presses ever farther is what closed forms say of it."""

from __future__ import annotations

from runs.studies.drawn_column import study


def test_a_column_that_is_pressed_ever_farther() -> None:
    """Reference: analytic, Euler's column of the length that is pressed, and its beam-column."""
    proofs = study(lambda _: None).proofs
    assert len(proofs) == 7
    assert [proof.what for proof in proofs if not proof.holds] == []
    first, last = (proof.value for proof in proofs[1:3])
    assert last > 1.2 * first
