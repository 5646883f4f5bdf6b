# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a designer is answered is what statics, exact beams and standards say."""

from __future__ import annotations

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from studies.answers import station_forces, support_forces


def test_forces_by_hand_are_in_balance() -> None:
    """Reference: analytic, the sum of all forces and of their moments about the origin."""
    tail, head = station_forces()
    assert tail + head == pytest.approx(55.07 * 10.0)
    assert tail * 9.0 + head * 10.0 == pytest.approx(55.07 * 10.0 * 14.0)
    foot, far = support_forces()
    assert foot + far + 831.6 + tail + head == pytest.approx(0.0, abs=1e-9)
    moments = far * 2.0 + 831.6 * 5.0 + tail * 9.0 + head * 10.0
    assert moments == pytest.approx(0.0, abs=1e-9)
