# SPDX-License-Identifier: LGPL-3.0-or-later
"""Scaling is measured in processes of their own and told whole; no time is asserted."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from rich.console import Console

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from runs.benchmarks.scaling import STAGES, STEPS, Sizes, scaling

pytestmark = pytest.mark.slow


SIZES = Sizes(meshes=(0.5, 0.3), default=0.5, ranks=(1,), duration=0.2)


def test_every_stage_is_measured(tmp_path: Path) -> None:
    """Stages make up the whole, memory only grows, a finer mesh has more degrees of freedom."""
    scaling(SIZES, tmp_path, Console(quiet=True))
    data = json.loads((tmp_path / "scaling.json").read_text(encoding="utf-8"))
    by_size, by_default = data["by_size"]["runs"], data["default"]["runs"]
    for run in by_size + by_default:
        assert set(run["seconds"]) == set(STAGES)
        assert 0.5 * run["total_seconds"] < sum(run["seconds"].values()) <= run["total_seconds"]
        peaks = [run["idle"], *(run["peaks"][stage] for stage in ("mesh", "reduction", "fields"))]
        assert peaks == sorted(peaks)
        assert run["errors"]["contact_compliance"] < 1.0e-7
    assert by_size[0]["degrees_of_freedom"] < by_size[1]["degrees_of_freedom"]
    assert [run["case"] for run in by_default] == ["paper", "friction"]
    for run in by_default:
        assert [motion["step"] for motion in run["motions"]] == list(STEPS)
        assert run["motions"][-1]["energy_residual"] < 1.0e-2
    assert "| 0.3 |" in (tmp_path / "scaling.md").read_text(encoding="utf-8")
