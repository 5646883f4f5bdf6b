# SPDX-License-Identifier: LGPL-3.0-or-later
"""Short runs and reports of all shipped cases on coarse meshes."""

from html import unescape
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.run import run_case
from protractile.runs.report.additions import Addition
from protractile.runs.report.document import render
from protractile.runs.report.figures import figures_of

pytestmark = pytest.mark.slow


NAMES = ["drawn-out", "friction-walk", "paper", "paper-friction", "spatial", "three-segments"]


@pytest.mark.usefixtures("unprinted")
@pytest.mark.parametrize("name", NAMES)
def test_a_case_runs_and_is_reported(name: str, tmp_path: Path) -> None:
    """Reference: the other models, which agree up to the first contact."""
    file = str(CASES / f"{name}.toml")
    whole = case_file.load(file)
    mesh_size = 0.5 if any(model.needs_shell for model in whole.models) else None
    case = case_file.select(whole, file, mesh_size=mesh_size, members=0)
    short = case.time.model_copy(update={"duration": 0.15})
    # As the command does it: a shell that calibrates beams is reduced once.
    means = RunContext(MPI.COMM_SELF, cache=Cache(tmp_path / "cache"))
    run = run_case(case.model_copy(update={"time": short}), file, means)
    run.evaluate()
    results = run.results
    page = render(results, Addition(), figures_of(results), [])
    assert case.title in unescape(page)
    assert ("First vertical and lateral peaks of the tip" in page) == (name == "spatial")
    models = results.summary.models
    assert list(models) == [model.name for model in case.models]
    assert max(model.energy_residual for model in models.values()) < 1e-3
    with_play = [
        str(model)
        for model in results.trajectories["model"].values
        if not str(model).endswith("bonded")
    ]
    tips = results.trajectories["tip"].sel(model=with_play).values
    before = results.trajectories["time"].values < 0.11
    # Nothing touches yet. The inner segment is free, or bends under friction, for which the
    # shortest series have no function.
    falling = tips[:, before]
    alike = 0.1 if any(joint.friction > 0.0 for joint in case.joints) else 0.02
    assert np.ptp(falling, axis=0).max() < alike * np.ptp(falling)
