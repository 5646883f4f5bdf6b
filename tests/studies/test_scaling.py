# SPDX-License-Identifier: LGPL-3.0-or-later
"""Scaling is measured in separate processes, with complete tables; no time is asserted."""

import json
from pathlib import Path

import pytest
from rich.console import Console

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from studies.cost.scaling import STAGES, STEPS, Sizes, scaling

pytestmark = pytest.mark.slow


SIZES = Sizes(meshes=(1.0, 0.5), buckling=(0.5,), default=1.0, ranks=(1,), duration=0.2)


def test_every_stage_is_measured(tmp_path: Path) -> None:
    """Stages sum to the total, memory increases, and a finer mesh has more degrees of freedom."""
    scaling(SIZES, tmp_path, Console(quiet=True))
    data = json.loads((tmp_path / "scaling.json").read_text(encoding="utf-8"))
    by_size, by_default = data["scaling"], data["scaling-default"]
    for run in by_size + by_default:
        total = run["all s"]
        assert 0.5 * total < sum(run[f"{stage} s"] for stage in STAGES) <= total
    for run in data["scaling-memory"]:
        peaks = [run[stage] for stage in ("idle", "mesh", "reduction", "fields")]
        assert peaks == sorted(peaks)
    assert all(run["compliance error"] < 1.0e-7 for run in by_size)
    assert by_size[0]["dofs a segment"] < by_size[1]["dofs a segment"]
    assert len(data["scaling-goals"]) == 4
    assert [run["case"] for run in by_default] == ["paper", "friction"]
    (buckled,) = data["scaling-buckling"]
    assert buckled["ranks"] == 1
    assert buckled["lowest factor"] > 0.0
    motions = data["scaling-motion"]
    assert [motion["step s"] for motion in motions] == 2 * list(STEPS)
    assert all(motion["energy residual"] < 1.0e-2 for motion in motions[1::2])
    assert "| 0.5 |" in (tmp_path / "scaling.md").read_text(encoding="utf-8")
