# SPDX-License-Identifier: LGPL-3.0-or-later
"""The chart of where a beam may stand for the shell."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from runs.studies.calibrated_beams import EULER, PLAIN, SPRUNG, WITH_FIELDS, Sizes, measure
from runs.studies.motions import friction_case
from runs.studies.validity import chart, draw, table

pytestmark = pytest.mark.slow


def test_better_beams_are_nearer_to_the_shell(tmp_path: Path) -> None:
    """Reference: other code, the shell; each beam has what the one before it lacks."""
    sizes = Sizes(
        mesh_size=0.4, plays=(4e-3, 14e-3), loads=(5.0, 10.0), coordinates=(), duration=1.5
    )
    compared = measure(friction_case(), "near webs", sizes)
    off = chart(compared, sizes)
    worst = {name: float(values.max()) for name, values in off.items()}
    assert worst[EULER] > 1.5 * worst[PLAIN] > 3.0 * worst[SPRUNG] > 3.0 * worst[WITH_FIELDS], worst
    assert worst[WITH_FIELDS] < 0.2
    # Of all proofs the tip's depends on the duration least.
    assert all(proof.holds for proof in compared.proofs() if "tip" in proof.what)
    numbers = table(off, sizes)
    assert [row["load, over\nthe paper's"] for row in numbers.data] == ["5", "10", "5", "10"]
    draw(off, sizes, tmp_path / "chart.png")
    assert (tmp_path / "chart.png").stat().st_size > 10_000
