# SPDX-License-Identifier: LGPL-3.0-or-later
"""The unreduced shell beside the reduced one, on a coarse mesh, until the first blow."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from studies.direct import Sizes, study

pytestmark = pytest.mark.slow


TINY = Sizes(
    mesh=2.0,
    duration=0.37,
    steps=(1.0e-3, 5.0e-4),
    hard_steps=(2.5e-4, 1.25e-4),
    shifts=(5.0, 50.0, 300.0, 1500.0, 8000.0),
    moments=4,
)


def test_the_tip_is_that_of_the_unreduced_shell() -> None:
    """Reference: other code, the unreduced shell by the generalised-α method."""
    told: list[str] = []
    found = study(told.append, TINY)
    assert told == [
        "the reduced shell",
        "the unreduced shell, step 0.001 s",
        "the unreduced shell, step 0.0005 s",
        "the reduced shell",
        "the unreduced shell, step 0.00025 s",
        "the unreduced shell, step 0.000125 s",
    ]
    assert list(found.data) == ["direct-webs", "direct-pads"]
    own, larger, coarse, fine = found.data["direct-webs"]
    assert own["unknowns"] < larger["unknowns"] < 0.1 * coarse["unknowns"]
    off, off_larger = "off the reduced (%)", "off more coordinates (%)"
    assert own[off] == larger[off_larger] == 0.0
    assert 0.0 < fine[off_larger] < coarse[off_larger] < 0.2
    impulse = "contact impulse (N s)"
    assert fine[impulse] == pytest.approx(larger[impulse], rel=0.2)
    assert len(found.proofs) == 6
    assert all(proof.holds for proof in found.proofs)
    tips = [np.array(curve[1]) for curve in found.plots[0].curves.values()]
    assert np.abs(tips[0] - tips[1]).max() == pytest.approx(0.01 * fine[off] * np.ptp(tips[0]))
