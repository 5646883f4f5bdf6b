# SPDX-License-Identifier: LGPL-3.0-or-later
"""The paper's boom on three coarse meshes."""

from __future__ import annotations

import pytest

from studies.mesh import Sizes, study

pytestmark = pytest.mark.slow


TINY = Sizes(meshes=(8.0, 4.0, 2.0), default=4.0, duration=0.9, frequencies=2, peaks=1)


def test_coarse_meshes_close_in() -> None:
    """Reference: other code, the limit of uniform meshes.

    Refinement softens: the lowest frequency falls, compliances rise.
    """
    told: list[str] = []
    found = study(told.append, TINY)
    assert told == ["edges x 8", "edges x 4", "edges x 2"]
    values = {
        row["quantity"]: [row[f"edges × {part:g}"] for part in TINY.meshes]
        for row in found.data["meshes"]
    }
    lowest = values["natural frequency 1 (Hz)"]
    assert lowest[0] > lowest[1] > lowest[2]
    for what in ("local compliance at 9 m (m/N)", "local compliance at 10 m (m/N)"):
        assert values[what][0] < values[what][1] < values[what][2]
    proofs = {proof.what: proof for proof in found.proofs}
    frequency = proofs["natural frequency 1, default mesh"]
    assert frequency.holds
    assert frequency.value == lowest[1]
    assert frequency.order == pytest.approx(2.0, abs=0.5)
    assert frequency.source.startswith("limit of its refinement")
    assert lowest[2] == pytest.approx(7.2565, rel=1.0e-3)
    assert values["tip peak 1 (mm)"][2] == pytest.approx(177.5, rel=0.005)
